#include <algorithm>
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

// Calls on threads of their own, abandoned ones among them, which the process must outlive.
std::mutex abandonedMutex;
std::condition_variable noneRuns;
int running = 0;

// Counts one of them for as long as it is there.
class Running {
  public:
    Running() : counts_(true) {
        std::lock_guard lock(abandonedMutex);
        ++running;
    }
    Running(Running&& other) noexcept : counts_(std::exchange(other.counts_, false)) {}
    ~Running() {
        if (!counts_) return;
        std::lock_guard lock(abandonedMutex);
        if (--running == 0) noneRuns.notify_all();
    }

  private:
    bool counts_;
};

void raiseSignals() {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

void throwOn(PelError error, const std::string& message) {
    raiseProgressException();
    if (error != PEL_SUCCESS) throw CallError{error, message};
}

// Until version 3.14 CPython ends other threads that ask for the GIL while the interpreter goes, by pthread_exit, which unwinds C++
// and stops the whole process at the first function that may not be left so. Nobody waits for such threads: they stay here, for the
// end of the process.
template <class Take>
auto takeGil(Take&& take) {
    try {
        return take();
    } catch (...) {  // nothing else comes out of CPython
        for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
    }
}
}  // namespace

WithoutGil::~WithoutGil() {
    takeGil([&] { PyEval_RestoreThread(state_); });
}

WithGil::WithGil() : state_(takeGil([] { return PyGILState_Ensure(); })) {}

void call(const std::function<PelError()>& body) {
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
                std::this_thread::sleep_for(
                    std::clamp<Clock::duration>(nap, std::chrono::microseconds(5), std::chrono::milliseconds(2)));
            }
            return error;
        });
        if (!done) raiseSignals();
    }
}

void callInterruptibly(std::function<PelError()> body) {
    struct State {
        std::mutex mutex;
        std::condition_variable changed;
        bool done = false;
        PelError error = PEL_SUCCESS;
        std::string message;
        std::exception_ptr thrown;
    };
    const auto state = std::make_shared<State>();
    std::thread thread([state, body = std::move(body), one = Running()]() mutable {
        PelError error = PEL_SUCCESS;
        std::string message;
        std::exception_ptr thrown;
        try {
            error = body();
            if (error != PEL_SUCCESS) message = pelGetErrorMessage();
        } catch (...) {
            thrown = std::current_exception();
        }
        body = nullptr;  // what it holds goes before the interpreter is told that nothing runs
        {
            std::lock_guard lock(state->mutex);
            state->error = error;
            state->message = std::move(message);
            state->thrown = std::move(thrown);
            state->done = true;
            state->changed.notify_one();
        }
    });
    thread.detach();
    for (bool done = false; !done;) {
        {
            WithoutGil free;
            std::unique_lock lock(state->mutex);
            done = state->changed.wait_for(lock, signalPeriod, [&] { return state->done; });
        }
        if (!done) raiseSignals();
    }
    if (state->thrown) std::rethrow_exception(state->thrown);
    throwOn(state->error, state->message);
}

void waitForAbandoned() {
    WithoutGil free;
    std::unique_lock lock(abandonedMutex);
    noneRuns.wait(lock, [] { return running == 0; });
}

PelImageDesc imageDesc(const ImageView& v) {
    PelImageDesc d = pellucid::imageDesc(std::get<0>(v), PelFormat(std::get<1>(v)), std::get<2>(v), std::get<3>(v),
                                         std::get<4>(v));
    d.pixelStride = std::get<5>(v);
    d.rowStride = std::get<6>(v);
    d.planeStride = std::get<7>(v);
    return d;
}

}  // namespace pel::python
