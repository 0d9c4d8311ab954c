// A Python callable as the library's progress callback.
#pragma once
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

// Calls the device's callback, on the thread that Python called from: 0 cancels. Needs the GIL.
int tellProgress(const Device& device, double fraction, const char* what);
// Asks that thread to, from one of callInterruptibly's; nothing on others.
std::optional<int> relayProgress(const Device& device, double fraction, const char* what);

// Work that may still use Python's memory: calls that were left behind, and what the device has to do. Done when all of it is.
class Settling {
  public:
    explicit Settling(pellucid::Device device);
    bool done() const;
    void wait() const;

  private:
    struct State;
    std::shared_ptr<State> state_;
};

// Raises what a progress callback on this thread raised (or Ctrl-C seen there), if anything. Needs the GIL.
void raiseProgressException();

}  // namespace pel::python
