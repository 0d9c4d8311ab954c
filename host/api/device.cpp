#include "api/entry.h"
#include "cl/platform.h"
#include "core/buffer.h"
#include "core/submission.h"

using namespace pel;

const char* pelErrorName(PelError error) {
    switch (error) {
#define NAME(error) \
    case error:     \
        return #error;
        NAME(PEL_SUCCESS)
        NAME(PEL_ERROR_INVALID_ARGUMENT)
        NAME(PEL_ERROR_INVALID_STATE)
        NAME(PEL_ERROR_NO_DEVICE)
        NAME(PEL_ERROR_OUT_OF_MEMORY)
        NAME(PEL_ERROR_DEVICE)
        NAME(PEL_ERROR_UNSUPPORTED)
        NAME(PEL_ERROR_CANCELLED)
        NAME(PEL_ERROR_UNKNOWN)
#undef NAME
    }
    return "PEL_ERROR_UNKNOWN";
}

const char* pelGetErrorMessage(void) {
    return lastErrorMessage();
}

void pelSetErrorCallback(PelErrorCallback callback, void* user) {
    setErrorCallback(callback, user);
}

void pelSetLogCallback(PelLogCallback callback, void* user) {
    setLogCallback(callback, user);
}

PelError pelSetName(void* object, const char* name) {
    return entry([&] { nameHandle(object, name); });
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
            invalidArgument("there is no device ", index, "; this machine has ", devices.size());
        writeStruct(info, cl::describe(devices[index], index));
    });
}

PelError pelDeviceCreate(const char* selector, PelDevice* device) {
    PelDeviceDesc desc = pelDeviceDescDefaults();
    desc.selector = selector;
    return pelDeviceCreateWith(&desc, device);
}

PelError pelDeviceCreateWith(const PelDeviceDesc* desc, PelDevice* device) {
    return create(device, "device",
                  [&] { return Device::create(readStruct(desc, pelDeviceDescDefaults())); });
}

PelError pelDeviceCreateFromCl(void* clContext, void* clDeviceId, void* clCommandQueue, PelDevice* device) {
    return create(device, "device", [&] {
        return Device::createFromCl(cl_context(clContext), cl_device_id(clDeviceId),
                                    cl_command_queue(clCommandQueue));
    });
}

PEL_COUNTED(Device)

PelError pelDeviceGetInfo(PelDevice device, PelDeviceInfo* info) {
    return entry([&] { writeStruct(info, fromHandle<Device>(device)->info()); });
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
    return entry([&] { writeStruct(stats, fromHandle<Device>(device)->stats()); });
}

PelError pelDeviceSetProgress(PelDevice device, PelProgressCallback callback, void* user) {
    return entry([&] { fromHandle<Device>(device)->setProgress(callback, user); });
}

PelError pelEventCreateFromCl(PelDevice device, void* clEvent, PelEvent* event) {
    return create(event, "event", [&] {
        const Ref<Device> d = fromHandle<Device>(device);
        if (!clEvent) invalidArgument("a cl_event is needed, not NULL");
        return make<Event>(d, cl::Event::retained(cl_event(clEvent)));
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

PEL_COUNTED(Event)

PelError pelBufferCreate(PelDevice device, size_t bytes, const void* initial, PelBuffer* buffer) {
    return create(buffer, "buffer",
                  [&] { return Buffer::create(fromHandle<Device>(device), bytes, initial); });
}

PelError pelBufferCreateFromHost(PelDevice device, void* memory, size_t bytes, PelBuffer* buffer) {
    return create(buffer, "buffer",
                  [&] { return Buffer::createFromHost(fromHandle<Device>(device), memory, bytes); });
}

PelError pelBufferCreateFromCl(PelDevice device, void* clMem, PelBuffer* buffer) {
    return create(buffer, "buffer",
                  [&] { return Buffer::createFromCl(fromHandle<Device>(device), cl_mem(clMem)); });
}

PEL_COUNTED(Buffer)

PelError pelBufferGetSize(PelBuffer buffer, size_t* bytes) {
    return entry([&] { output(bytes, "bytes") = fromHandle<Buffer>(buffer)->bytes(); });
}

PelError pelBufferGetCl(PelBuffer buffer, void** clMem) {
    return entry([&] { output(clMem, "clMem") = fromHandle<Buffer>(buffer)->memory().get(); });
}

PelError pelBufferRead(PelBuffer buffer, size_t offset, size_t bytes, void* destination,
                       const PelSubmit* submit) {
    return entry([&] {
        const Ref<Buffer> b = fromHandle<Buffer>(buffer);
        b->checkRange(offset, bytes, "the read");
        if (bytes > 0) output(static_cast<char*>(destination), "destination");
        submitted(b->device(), submit, [&](bool blocking) {
            if (bytes > 0) b->device().read(b->memory().get(), offset, bytes, destination, blocking);
        });
    });
}

PelError pelBufferWrite(PelBuffer buffer, size_t offset, size_t bytes, const void* source,
                        const PelSubmit* submit) {
    return entry([&] {
        const Ref<Buffer> b = fromHandle<Buffer>(buffer);
        b->checkRange(offset, bytes, "the write");
        if (bytes > 0 && !source) invalidArgument("source is NULL but ", bytes, " bytes are to be written");
        submitted(b->device(), submit, [&](bool blocking) {
            if (bytes > 0) b->device().write(b->memory().get(), offset, bytes, source, blocking);
        });
    });
}

PelError pelBufferMap(PelBuffer buffer, void** memory) {
    return entry([&] {
        void*& at = output(memory, "memory");
        at = fromHandle<Buffer>(buffer)->map();
    });
}

PelError pelBufferUnmap(PelBuffer buffer) {
    return entry([&] { fromHandle<Buffer>(buffer)->unmap(); });
}
