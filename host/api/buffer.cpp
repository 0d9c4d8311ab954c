#include "core/buffer.h"

#include "api/entry.h"
#include "core/submission.h"

using namespace pel;

PelError pelBufferCreate(PelDevice device, size_t bytes, const void* initial, PelBuffer* buffer) {
    return entry([&] {
        handOut(buffer, "buffer", [&] { return Buffer::create(fromHandle<Device>(device), bytes, initial); });
    });
}

PelError pelBufferCreateFromHost(PelDevice device, void* memory, size_t bytes, PelBuffer* buffer) {
    return entry([&] {
        handOut(buffer, "buffer",
                [&] { return Buffer::createFromHost(fromHandle<Device>(device), memory, bytes); });
    });
}

PelError pelBufferCreateFromCl(PelDevice device, void* clMem, PelBuffer* buffer) {
    return entry([&] {
        handOut(buffer, "buffer",
                [&] { return Buffer::createFromCl(fromHandle<Device>(device), cl_mem(clMem)); });
    });
}

void pelBufferRetain(PelBuffer buffer) {
    retainEntry<Buffer>(buffer);
}
void pelBufferRelease(PelBuffer buffer) {
    releaseEntry<Buffer>(buffer);
}

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
        Submission submission(b->device(), submit);
        if (bytes > 0) b->device().read(b->memory().get(), offset, bytes, destination, submission.blocking());
        submission.finish();
    });
}

PelError pelBufferWrite(PelBuffer buffer, size_t offset, size_t bytes, const void* source,
                        const PelSubmit* submit) {
    return entry([&] {
        const Ref<Buffer> b = fromHandle<Buffer>(buffer);
        b->checkRange(offset, bytes, "the write");
        if (bytes > 0 && !source) invalidArgument("source is NULL but ", bytes, " bytes are to be written");
        Submission submission(b->device(), submit);
        if (bytes > 0) b->device().write(b->memory().get(), offset, bytes, source, submission.blocking());
        submission.finish();
    });
}

PelError pelBufferMap(PelBuffer buffer, void** memory) {
    return entry([&] { output(memory, "memory") = fromHandle<Buffer>(buffer)->map(); });
}

PelError pelBufferUnmap(PelBuffer buffer) {
    return entry([&] { fromHandle<Buffer>(buffer)->unmap(); });
}
