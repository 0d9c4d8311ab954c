// A device whose queue waits for an event that the test has yet to set.
#pragma once
#include <CL/cl.h>

#include "cl/cl_spy.h"
#include "test.h"

#include <future>

namespace fixture {

class HeldQueue {
  public:
    explicit HeldQueue(const pellucid::Device& device) : device_(device) {
        void *context = nullptr, *id = nullptr, *queue = nullptr;
        pellucid::check(pelDeviceGetCl(device.get(), &context, &id, &queue));
        cl_int code = CL_SUCCESS;
        event_ = clCreateUserEvent(cl_context(context), &code);
        pellucid::check(pelEventCreateFromCl(device.get(), event_, &wait_));
        const pellucid::Buffer nothing(device, 16);
        nothing.read(nullptr, 0, 0, submit());
    }
    HeldQueue(const HeldQueue&) = delete;
    HeldQueue& operator=(const HeldQueue&) = delete;
    ~HeldQueue() {
        release();
        pelEventRelease(wait_);
        clReleaseEvent(event_);
    }
    const PelSubmit* submit() const { return &submit_; }
    void release() {
        if (!released_) clSetUserEventStatus(event_, CL_COMPLETE);
        released_ = true;
        device_.finish();
    }

  private:
    pellucid::Device device_;
    cl_event event_ = nullptr;
    PelEvent wait_ = nullptr;
    PelSubmit submit_{&wait_, 1, nullptr};
    bool released_ = false;
};

// Whether the call ends. A call that hangs uses no processor time, which distinguishes it from a slow or busy
// machine.
inline bool ends(const std::future<void>& running) {
    std::clock_t used = std::clock();
    for (int still = 0; still < 20; ++still) {
        if (running.wait_for(std::chrono::seconds(1)) == std::future_status::ready) return true;
        const std::clock_t now = std::clock();
        if (now - used > CLOCKS_PER_SEC / 200) still = 0;
        used = now;
    }
    return false;
}

// `call` gets a PelSubmit that waits for the event, and must return before the event is set. Kernels stay
// until their launches have run: NVIDIA's driver (580) uses them. Everything has run at the end.
template <class Call>
void expectReturns(const pellucid::Device& device, const char* what, const Call& call) {
    device.stats();  // forgets finished launches
    const spy::Counts before = spy::counts();
    HeldQueue held(device);
    std::future<void> running = std::async(std::launch::async, [&] { call(held.submit()); });
    EXPECT_TRUE(ends(running)) << what << " waits for an event that is set later";
    const spy::Counts now = spy::counts();
    EXPECT_GE(now.kernels - before.kernels, int64_t(now.launches - before.launches)) << what;
    held.release();
    running.get();
    device.stats();
    EXPECT_EQ(spy::counts().kernels, 0) << what << " leaves kernels";
    device.finish();
}

}  // namespace fixture
