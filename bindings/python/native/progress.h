// A Python callable as the library's progress callback.
#pragma once
#include "native.h"

namespace pel::python {

// A device and what to call while it works.
struct Device {
    pellucid::Device handle;
    py::object progress = py::none();

    explicit Device(pellucid::Device device);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
};

// Raises what a progress callback on this thread raised (or Ctrl-C seen there), if anything. Needs the GIL.
void raiseProgressException();

}  // namespace pel::python
