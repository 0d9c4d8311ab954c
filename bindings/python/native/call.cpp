#include <CL/cl.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "native.h"

namespace pel::python {
namespace {
using Clock = std::chrono::steady_clock;
// How long Ctrl-C may go unnoticed.
constexpr auto signalPeriod = std::chrono::milliseconds(50);

pid_t opener = 0;  // the process that first used OpenCL

// The thread that ends the interpreter, which releases objects while it does so.
std::atomic<std::thread::id> endingThread{};

// The exception of a progress callback, kept until the cancelled call has returned on the same thread.
thread_local std::unique_ptr<py::error_already_set> raised;

thread_local std::shared_ptr<Cancel> watched;

bool interpreterGoes() {
#if PY_VERSION_HEX >= 0x030D0000
    return Py_IsFinalizing();
#else
    return _Py_IsFinalizing();
#endif
}

// Before version 3.14, CPython ends other threads that request the GIL during interpreter shutdown with
// pthread_exit, which unwinds C++ frames and aborts the process at the first noexcept function. No thread
// joins them, so they block here until the process ends.
[[noreturn]] void stayHere() {
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

template <class Take>
auto takeGil(Take&& take) {
    const bool gone = !Py_IsInitialized() || interpreterGoes();
    if (gone && std::this_thread::get_id() != endingThread.load()) stayHere();
    try {
        return take();
        // only pthread_exit gets here; leaving this block without rethrowing would abort the process, too
    } catch (...) {
        stayHere();
    }
}

// Long work also checks for Ctrl-C here. 0 cancels.
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

WithoutGil::~WithoutGil() {
    takeGil([&] { PyEval_RestoreThread(state_); });
}

WithGil::WithGil() : state_(takeGil([] { return PyGILState_Ensure(); })) {}

void opensDevices() {
    refuseForked();
    opener = getpid();
}

void refuseForked() {
    if (opener && opener != getpid())
        throw CallError{PEL_ERROR_INVALID_STATE,
                        "this process was forked from one that had used OpenCL, whose threads do not exist "
                        "here: start processes with "
                        "multiprocessing.get_context(\"spawn\"), or open no device before the fork"};
}

// Raises the pending exception of a progress callback on this thread (or its Ctrl-C), if any. Needs the GIL.
static void raiseProgressException() {
    if (!raised) return;
    const std::unique_ptr<py::error_already_set> error = std::move(raised);
    throw py::error_already_set(*error);
}

void call(const std::function<PelError()>& body) {
    refuseForked();
    PelError error;
    std::string message;
    {
        WithoutGil free;
        error = body();
        if (error != PEL_SUCCESS) message = pelGetErrorMessage();
    }
    raiseProgressException();
    if (error != PEL_SUCCESS) throw CallError{error, message};
}

bool signalled() {
    WithGil gil;
    return PyErr_CheckSignals() != 0;
}

void waitInterruptibly(const pellucid::Event& event) {
    const Clock::time_point start = Clock::now();
    int done = 0;
    while (!done) {
        call([&] {
            const Clock::time_point look = Clock::now() + signalPeriod;
            PelError error;
            while ((error = pelEventIsDone(event.get(), &done)) == PEL_SUCCESS && !done &&
                   Clock::now() < look) {
                // Sleeping a sixteenth of the time waited so far delays the result by at most that much.
                const auto nap = (Clock::now() - start) / 16;
                std::this_thread::sleep_for(std::clamp<Clock::duration>(nap, std::chrono::microseconds(5),
                                                                        std::chrono::milliseconds(2)));
            }
            return error;
        });
        if (!done && PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
}

pellucid::Event markerOf(const pellucid::Device& device) {
    PelEvent event = nullptr;
    call([&] {
        void* queue = nullptr;
        PelError error = pelDeviceGetCl(device.get(), nullptr, nullptr, &queue);
        cl_event marker = nullptr;
        if (!error && clEnqueueMarkerWithWaitList(cl_command_queue(queue), 0, nullptr, &marker) != CL_SUCCESS)
            return pelDeviceFinish(device.get());  // which says what is wrong with the device
        if (!error) {
            clFlush(cl_command_queue(queue));
            error = pelEventCreateFromCl(device.get(), marker, &event);
            clReleaseEvent(marker);
        }
        return error;
    });
    return pellucid::Event(event);
}

void interpreterEnds() {
    endingThread = std::this_thread::get_id();
}

void Cancel::watch() {
    watched = shared_from_this();
}

Device::Device(pellucid::Device device) : handle(std::move(device)) {
    pelDeviceSetProgress(handle.get(), onProgress, this);
}
Device::~Device() {
    pelDeviceSetProgress(handle.get(), nullptr, nullptr);
    WithoutGil free;  // as Owner does; `progress` goes after this, with the GIL
    handle = pellucid::Device(nullptr);
}

PelImageDesc imageDesc(const ImageView& v) {
    const auto& [buffer, format, width, height, offset, pixelStride, rowStride, planeStride] = v;
    PelImageDesc d = pellucid::imageDesc(buffer, PelFormat(format), width, height, offset);
    d.pixelStride = pixelStride, d.rowStride = rowStride, d.planeStride = planeStride;
    return d;
}

}  // namespace pel::python
