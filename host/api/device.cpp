#include "core/device.h"

#include "api/entry.h"
#include "cl/platform.h"
#include "core/submission.h"

using namespace pel;

const char* pelErrorName(PelError error) {
    switch (error) {
        case PEL_SUCCESS:
            return "PEL_SUCCESS";
        case PEL_ERROR_INVALID_ARGUMENT:
            return "PEL_ERROR_INVALID_ARGUMENT";
        case PEL_ERROR_INVALID_STATE:
            return "PEL_ERROR_INVALID_STATE";
        case PEL_ERROR_NO_DEVICE:
            return "PEL_ERROR_NO_DEVICE";
        case PEL_ERROR_OUT_OF_MEMORY:
            return "PEL_ERROR_OUT_OF_MEMORY";
        case PEL_ERROR_DEVICE:
            return "PEL_ERROR_DEVICE";
        case PEL_ERROR_UNSUPPORTED:
            return "PEL_ERROR_UNSUPPORTED";
        case PEL_ERROR_CANCELLED:
            return "PEL_ERROR_CANCELLED";
        case PEL_ERROR_UNKNOWN:
            break;
    }
    return "PEL_ERROR_UNKNOWN";
}

const char* pelGetErrorMessage(void) {
    return lastErrorMessage();
}

void pelSetErrorCallback(PelErrorCallback callback, void* user) {
    setErrorCallback(callback, user);
}

uint32_t pelVersion(void) {
    return PEL_VERSION_MAJOR * 10000 + PEL_VERSION_MINOR * 100 + PEL_VERSION_PATCH;
}

PelError pelDeviceCount(uint32_t* count) {
    return entry([&] { output(count, "count") = uint32_t(cl::allDevices().size()); });
}

PelError pelDeviceEnumerate(uint32_t index, PelDeviceInfo* info) {
    return entry([&] {
        const auto devices = cl::allDevices();
        if (index >= devices.size())
            invalidArgument("device ", index, " of ", devices.size(), " was asked for");
        writeStruct(info, cl::describe(devices[index], index), "PelDeviceInfo");
    });
}

PelError pelDeviceCreate(const char* selector, PelDevice* device) {
    return entry([&] { handOut(device, "device", [&] { return Device::create(selector); }); });
}

PelError pelDeviceCreateFromCl(void* clContext, void* clDeviceId, void* clCommandQueue, PelDevice* device) {
    return entry([&] {
        handOut(device, "device", [&] {
            return Device::createFromCl(cl_context(clContext), cl_device_id(clDeviceId),
                                        cl_command_queue(clCommandQueue));
        });
    });
}

void pelDeviceRetain(PelDevice device) {
    retainEntry<Device>(device);
}
void pelDeviceRelease(PelDevice device) {
    releaseEntry<Device>(device);
}

PelError pelDeviceGetInfo(PelDevice device, PelDeviceInfo* info) {
    return entry([&] { writeStruct(info, fromHandle<Device>(device)->info(), "PelDeviceInfo"); });
}

PelError pelDeviceGetCl(PelDevice device, void** clContext, void** clDeviceId, void** clCommandQueue) {
    return entry([&] {
        const Ref<Device> d = fromHandle<Device>(device);
        if (clContext) *clContext = d->context();
        if (clDeviceId) *clDeviceId = d->id();
        if (clCommandQueue) *clCommandQueue = d->queue();
    });
}

PelError pelDeviceFinish(PelDevice device) {
    return entry([&] { fromHandle<Device>(device)->finish(); });
}

PelError pelDeviceGetStats(PelDevice device, PelDeviceStats* stats) {
    return entry([&] { writeStruct(stats, fromHandle<Device>(device)->stats(), "PelDeviceStats"); });
}

PelError pelDeviceSetProgress(PelDevice device, PelProgressCallback callback, void* user) {
    return entry([&] { fromHandle<Device>(device)->setProgress(callback, user); });
}

PelError pelEventCreateFromCl(PelDevice device, void* clEvent, PelEvent* event) {
    return entry([&] {
        const Ref<Device> d = fromHandle<Device>(device);
        if (!clEvent) invalidArgument("a cl_event is needed, not NULL");
        handOut(event, "event", [&] { return make<Event>(d, cl::Event::retained(cl_event(clEvent))); });
    });
}

PelError pelEventGetCl(PelEvent event, void** clEvent) {
    return entry([&] { output(clEvent, "clEvent") = fromHandle<Event>(event)->cl().get(); });
}

PelError pelEventWait(PelEvent event) {
    return entry([&] { fromHandle<Event>(event)->wait(); });
}

PelError pelEventIsDone(PelEvent event, int* done) {
    return entry([&] { output(done, "done") = fromHandle<Event>(event)->isDone(); });
}

void pelEventRetain(PelEvent event) {
    retainEntry<Event>(event);
}
void pelEventRelease(PelEvent event) {
    releaseEntry<Event>(event);
}
