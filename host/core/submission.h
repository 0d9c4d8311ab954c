// PelEvent, and the steps of calls that do work: wait, then enqueue, then block or return an event.
#pragma once
#include "core/device.h"

namespace pel {

class Event final : public Object {
  public:
    static constexpr Kind kind = Kind::event;
    Event(Ref<Device> device, cl::Event event);
    const cl::Event& cl() const { return event_; }
    void wait() const;
    bool isDone() const;
    cl_int status() const;  // CL_COMPLETE, a state before it, or the negative code of a failure

  private:
    ~Event() override = default;
    Ref<Device> device_;
    cl::Event event_;
};

// Construct it before the first command of a call, and call finish() after the last. The queue is in order,
// so commands between them need no event lists of their own.
class Submission {
  public:
    Submission(Device& device, const PelSubmit* submit);
    bool blocking() const { return submit_ == nullptr; }
    void finish();

  private:
    Device& device_;
    const PelSubmit* submit_;
};

// A call whose commands are those of work(blocking).
template <class Work>
void submitted(Device& device, const PelSubmit* submit, Work&& work) {
    Submission submission(device, submit);
    work(submission.blocking());
    submission.finish();
}

}  // namespace pel
