// A Python callable as the library's progress callback.
#pragma once
#include <atomic>
#include <memory>

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

// Ends the call of the thread that watches it, where that call next tells its progress.
class Cancel : public std::enable_shared_from_this<Cancel> {
  public:
    void watch();
    void ask() { asked_ = true; }
    bool asked() const { return asked_; }

  private:
    std::atomic<bool> asked_{false};
};

// Raises what a progress callback on this thread raised (or Ctrl-C seen there), if anything. Needs the GIL.
void raiseProgressException();

}  // namespace pel::python
