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

void beginSubmission(Device& device, const PelSubmit* submit) {
    if (!submit || submit->numWaits == 0) return;
    if (!submit->waits) invalidArgument("PelSubmit.numWaits is ", submit->numWaits, " but waits is NULL");
    std::vector<Ref<Event>> events;
    std::vector<cl_event> waits;
    for (uint32_t i = 0; i < submit->numWaits; ++i) {
        events.push_back(fromHandle<Event>(submit->waits[i]));
        waits.push_back(events.back()->cl().get());
        if (cl::info<cl_context>(waits.back(), CL_EVENT_CONTEXT) != device.context())
            invalidArgument("PelSubmit.waits[", i, "] is an event of another device");
        // PoCL ends the process when a command waits for an event that failed.
        if (const cl_int status = events.back()->status(); status < 0)
            cl::check(status, text("PelSubmit.waits[", i, "]").c_str());
    }
    cl::check(clEnqueueBarrierWithWaitList(device.queue(), cl_uint(waits.size()), waits.data(), nullptr),
              "clEnqueueBarrierWithWaitList");
}

void endSubmission(Device& device, const PelSubmit* submit) {
    if (!submit) return device.finish();
    if (submit->done) {
        cl_event event = nullptr;
        cl::check(clEnqueueMarkerWithWaitList(device.queue(), 0, nullptr, &event),
                  "clEnqueueMarkerWithWaitList");
        *submit->done = toHandle<PelEvent>(make<Event>(Ref<Device>(&device), cl::Event(event)));
    }
    cl::check(clFlush(device.queue()), "clFlush");
}

}  // namespace pel
