#include "progress.h"

#include <memory>

namespace pel::python {

namespace {
// What the callback raised, kept until the cancelled call has returned on the same thread.
thread_local std::unique_ptr<py::error_already_set> raised;

thread_local std::shared_ptr<Cancel> watched;

// Also where long work notices Ctrl-C. 0 cancels.
int onProgress(void* user, double fraction, const char* what) {
    if (watched && watched->asked()) return 0;
    WithGil gil;
    try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        const py::object callback = static_cast<Device*>(user)->progress;
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
}  // namespace

void Cancel::watch() {
    watched = shared_from_this();
}

void raiseProgressException() {
    if (!raised) return;
    const std::unique_ptr<py::error_already_set> error = std::move(raised);
    throw py::error_already_set(*error);
}

Device::Device(pellucid::Device device) : handle(std::move(device)) {
    pelDeviceSetProgress(handle.get(), onProgress, this);
}
Device::~Device() {
    pelDeviceSetProgress(handle.get(), nullptr, nullptr);
    WithoutGil free;  // as Owner does; `progress` goes after this, with the GIL
    handle = pellucid::Device(nullptr);
}

}  // namespace pel::python
