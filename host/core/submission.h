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

// Before the first command of a call, and after its last. The queue is in order, so commands between them
// need no event lists of their own.
void beginSubmission(Device& device, const PelSubmit* submit);
void endSubmission(Device& device, const PelSubmit* submit);

// A call whose commands are those of work(blocking).
template <class Work>
void submitted(Device& device, const PelSubmit* submit, Work&& work) {
    beginSubmission(device, submit);
    work(submit == nullptr);
    endSubmission(device, submit);
}

}  // namespace pel
