#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>

#include "progress.h"

namespace pel::python {

namespace {
using Clock = std::chrono::steady_clock;
// How long Ctrl-C may go unnoticed.
constexpr auto signalPeriod = std::chrono::milliseconds(50);

// Calls on threads of their own, and threads of Settling, which the process must outlive.
std::mutex countMutex;
std::condition_variable fewer;
int calls = 0, settling = 0;

// Counts one of them for as long as it is there.
class Running {
  public:
    explicit Running(int& count) : count_(&count) {
        std::lock_guard lock(countMutex);
        ++*count_;
    }
    Running(Running&& other) noexcept : count_(std::exchange(other.count_, nullptr)) {}
    ~Running() {
        if (!count_) return;
        std::lock_guard lock(countMutex);
        --*count_;
        fewer.notify_all();
    }

  private:
    int* count_;
};

// A call on a thread of its own, and what it has to say to the one that waits for it.
struct Task {
    std::mutex mutex;
    std::condition_variable changed;
    bool done = false, abandoned = false;
    PelError error = PEL_SUCCESS;
    std::string message;
    std::exception_ptr thrown;
    const Device* asking = nullptr;  // whose progress callback is to be called, with:
    double fraction = 0;
    const char* what = "";
    int answer = 1;
};
thread_local Task* ownTask = nullptr;
thread_local bool answering = false;

pid_t opener = 0;  // the process that first used OpenCL

bool onMainThread() {
    const py::module_ threading = py::module_::import("threading");
    return threading.attr("current_thread")().is(threading.attr("main_thread")());
}

void raiseSignals() {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

void throwOn(PelError error, const std::string& message) {
    raiseProgressException();
    if (error != PEL_SUCCESS) throw CallError{error, message};
}

// The one that ends the interpreter, which releases objects meanwhile.
std::atomic<std::thread::id> endingThread{};

bool interpreterGoes() {
#if PY_VERSION_HEX >= 0x030D0000
    return Py_IsFinalizing();
#else
    return _Py_IsFinalizing();
#endif
}

// Until version 3.14 CPython ends other threads that ask for the GIL while the interpreter goes, by pthread_exit, which unwinds C++
// and stops the whole process at the first function that may not be left so. Nobody waits for such threads: they stay here, for the
// end of the process.
[[noreturn]] void stayHere() {
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

template <class Take>
auto takeGil(Take&& take) {
    const bool gone = !Py_IsInitialized() || interpreterGoes();
    if (gone && std::this_thread::get_id() != endingThread.load()) stayHere();
    try {
        return take();
    } catch (...) {  // nothing else comes out of CPython; and who leaves this block without throwing on stops the process, too
        stayHere();
    }
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
                        "this process was forked from one that had used OpenCL, whose threads did not come "
                        "along: start processes by "
                        "multiprocessing.get_context(\"spawn\"), or open no device before"};
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
    throwOn(error, message);
}

void waitInterruptibly(const pellucid::Event& event) {
    const Clock::time_point start = Clock::now();
    int done = 0;
    while (!done) {
        call([&] {
            const Clock::time_point look = Clock::now() + signalPeriod;
            PelError error;
            while ((error = pelEventIsDone(event.get(), &done)) == PEL_SUCCESS && !done && Clock::now() < look) {
                // Sleeping a sixteenth of the time waited so far finds the end at most that much late.
                const auto nap = (Clock::now() - start) / 16;
                std::this_thread::sleep_for(std::clamp<Clock::duration>(nap, std::chrono::microseconds(5),
                                                                        std::chrono::milliseconds(2)));
            }
            return error;
        });
        if (!done) raiseSignals();
    }
}

bool answersProgress() {
    return answering;
}

bool abandoned() {
    if (!ownTask) return false;
    std::lock_guard lock(ownTask->mutex);
    return ownTask->abandoned;
}

std::optional<int> relayProgress(const Device& device, double fraction, const char* what) {
    Task* task = ownTask;
    if (!task) return std::nullopt;
    std::unique_lock lock(task->mutex);
    if (task->abandoned) return 0;
    task->asking = &device, task->fraction = fraction, task->what = what;
    task->changed.notify_all();
    task->changed.wait(lock, [&] { return !task->asking || task->abandoned; });
    return task->abandoned ? 0 : task->answer;
}

void callInterruptibly(std::function<PelError()> body) {
    refuseForked();
    if (answering || !onMainThread()) return call(body);
    const auto task = std::make_shared<Task>();
    std::thread thread([task, body = std::move(body), one = Running(calls)]() mutable {
        ownTask = task.get();
        PelError error = PEL_SUCCESS;
        std::string message;
        std::exception_ptr thrown;
        try {
            error = body();
            if (error != PEL_SUCCESS) message = pelGetErrorMessage();
        } catch (...) {
            thrown = std::current_exception();
        }
        body = nullptr;  // what it holds goes before anybody is told that nothing runs
        std::lock_guard lock(task->mutex);
        task->error = error;
        task->message = std::move(message);
        task->thrown = std::move(thrown);
        task->done = true;
        task->changed.notify_all();
    });
    thread.detach();
    try {
        for (bool done = false; !done;) {
            const Device* asking = nullptr;
            {
                WithoutGil free;
                std::unique_lock lock(task->mutex);
                task->changed.wait_for(lock, signalPeriod, [&] { return task->done || task->asking; });
                done = task->done;
                asking = task->asking;
            }
            raiseSignals();
            if (asking) {
                answering = true;
                const int answer = tellProgress(*asking, task->fraction, task->what);
                answering = false;
                std::lock_guard lock(task->mutex);
                task->answer = answer;
                task->asking = nullptr;
                task->changed.notify_all();
            }
        }
    } catch (...) {
        std::lock_guard lock(task->mutex);
        task->abandoned = true;
        task->changed.notify_all();
        throw;
    }
    if (task->thrown) std::rethrow_exception(task->thrown);
    throwOn(task->error, task->message);
}

struct Settling::State {
    std::mutex mutex;
    std::condition_variable changed;
    bool done = false;
};

Settling::Settling(pellucid::Device device) : state_(std::make_shared<State>()) {
    refuseForked();
    std::thread([state = state_, device = std::move(device), one = Running(settling)]() mutable {
        {
            std::unique_lock lock(countMutex);
            fewer.wait(lock, [] { return calls == 0; });
        }
        pelDeviceFinish(device.get());
        device = {};
        std::lock_guard lock(state->mutex);
        state->done = true;
        state->changed.notify_all();
    }).detach();
}

bool Settling::done() const {
    std::lock_guard lock(state_->mutex);
    return state_->done;
}

void Settling::wait() const {
    for (bool done = false; !done;) {
        {
            WithoutGil free;
            std::unique_lock lock(state_->mutex);
            done = state_->changed.wait_for(lock, signalPeriod, [&] { return state_->done; });
        }
        if (!done) raiseSignals();
    }
}

void interpreterEnds() {
    endingThread = std::this_thread::get_id();
    if (opener && opener != getpid()) return;  // they did not come along
    WithoutGil free;
    std::unique_lock lock(countMutex);
    fewer.wait(lock, [] { return calls + settling == 0; });
}

PelImageDesc imageDesc(const ImageView& v) {
    PelImageDesc d = pellucid::imageDesc(std::get<0>(v), PelFormat(std::get<1>(v)), std::get<2>(v),
                                         std::get<3>(v), std::get<4>(v));
    d.pixelStride = std::get<5>(v);
    d.rowStride = std::get<6>(v);
    d.planeStride = std::get<7>(v);
    return d;
}

}  // namespace pel::python
