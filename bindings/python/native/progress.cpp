#include "progress.h"

#include <memory>

namespace pel::python {

namespace {
// What the callback raised, kept until the cancelled call has returned on the same thread.
thread_local std::unique_ptr<py::error_already_set> raised;

int onProgress(void* user, double fraction, const char* what) {
    const Device& device = *static_cast<Device*>(user);
    if (const std::optional<int> answer = relayProgress(device, fraction, what)) return *answer;
    WithGil gil;
    return tellProgress(device, fraction, what);
}
}  // namespace

int tellProgress(const Device& device, double fraction, const char* what) {
    try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        const py::object callback = device.progress;
        if (callback.is_none()) return 1;
        const py::object answer = callback(fraction, what);
        return answer.is_none() || answer.cast<bool>();
    } catch (py::error_already_set& error) {
        raised = std::make_unique<py::error_already_set>(error);
    } catch (const py::cast_error&) {
        PyErr_SetString(PyExc_TypeError, "a progress callback returns True, False or None");
        raised = std::make_unique<py::error_already_set>();
    }
    return 0;
}

void raiseProgressException() {
    if (!raised) return;
    const std::unique_ptr<py::error_already_set> error = std::move(raised);
    throw py::error_already_set(*error);
}

// Always installed, because it is also where long work notices Ctrl-C.
Device::Device(pellucid::Device device) : handle(std::move(device)) {
    pelDeviceSetProgress(handle.get(), onProgress, this);
}
Device::~Device() {
    pelDeviceSetProgress(handle.get(), nullptr, nullptr);
    WithoutGil free;  // as Owner does; `progress` goes after this, with the GIL
    handle = {};
}

}  // namespace pel::python
