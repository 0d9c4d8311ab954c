#include <algorithm>
#include <chrono>
#include <condition_variable>
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

void raiseSignals() {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

void throwOn(PelError error, const std::string& message) {
    raiseProgressException();
    if (error != PEL_SUCCESS) throw CallError{error, message};
}
}  // namespace

void call(const std::function<PelError()>& body) {
    PelError error;
    std::string message;
    {
        py::gil_scoped_release release;
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
    };
    const auto state = std::make_shared<State>();
    {
        std::lock_guard lock(abandonedMutex);
        ++running;
    }
    std::thread([state, body = std::move(body)]() mutable {
        const PelError error = body();
        const std::string message = error == PEL_SUCCESS ? "" : pelGetErrorMessage();
        body = nullptr;  // what it holds goes before the interpreter is told that nothing runs
        {
            std::lock_guard lock(state->mutex);
            state->error = error;
            state->message = message;
            state->done = true;
            state->changed.notify_one();
        }
        std::lock_guard lock(abandonedMutex);
        if (--running == 0) noneRuns.notify_all();
    }).detach();
    for (bool done = false; !done;) {
        {
            py::gil_scoped_release release;
            std::unique_lock lock(state->mutex);
            done = state->changed.wait_for(lock, signalPeriod, [&] { return state->done; });
        }
        if (!done) raiseSignals();
    }
    throwOn(state->error, state->message);
}

void waitForAbandoned() {
    py::gil_scoped_release release;
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
