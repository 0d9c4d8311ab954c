#include "core/submission.h"

#include "core/handle_table.h"

namespace pel {

Event::Event(Ref<Device> device, cl::Event event)
    : Object(kind), device_(std::move(device)), event_(std::move(event)) {}

void Event::wait() const {
    cl_event event = event_.get();
    cl::check(clWaitForEvents(1, &event), "clWaitForEvents");
    isDone();  // NVIDIA's driver does not report that an event failed
}

cl_int Event::status() const {
    return cl::info<cl_int>(event_.get(), CL_EVENT_COMMAND_EXECUTION_STATUS);
}

bool Event::isDone() const {
    const cl_int now = status();
    if (now < 0) cl::check(now, "the submitted work");
    return now == CL_COMPLETE;
}

Submission::Submission(Device& device, const PelSubmit* submit) : device_(device), submit_(submit) {
    if (!submit || submit->numWaits == 0) return;
    if (!submit->waits) invalidArgument("PelSubmit.numWaits is ", submit->numWaits, " but waits is NULL");
    std::vector<Ref<Event>> events;
    std::vector<cl_event> waits;
    for (uint32_t i = 0; i < submit->numWaits; ++i) {
        events.push_back(fromHandle<Event>(submit->waits[i]));
        cl_context context = nullptr;
        cl::check(
            clGetEventInfo(events.back()->cl().get(), CL_EVENT_CONTEXT, sizeof context, &context, nullptr),
            "clGetEventInfo");
        if (context != device.context())
            invalidArgument("PelSubmit.waits[", i, "] is an event of another device");
        // PoCL ends the process when a command waits for an event that failed.
        if (const cl_int status = events.back()->status(); status < 0)
            cl::check(status, text("PelSubmit.waits[", i, "]").c_str());
        waits.push_back(events.back()->cl().get());
    }
    cl::check(clEnqueueBarrierWithWaitList(device.queue(), cl_uint(waits.size()), waits.data(), nullptr),
              "clEnqueueBarrierWithWaitList");
}

void Submission::finish() {
    if (!submit_) {
        device_.finish();
        return;
    }
    if (submit_->done) {
        cl_event event = nullptr;
        cl::check(clEnqueueMarkerWithWaitList(device_.queue(), 0, nullptr, &event),
                  "clEnqueueMarkerWithWaitList");
        *submit_->done = toHandle<PelEvent>(make<Event>(Ref<Device>(&device_), cl::Event(event)));
    }
    cl::check(clFlush(device_.queue()), "clFlush");
}

}  // namespace pel
