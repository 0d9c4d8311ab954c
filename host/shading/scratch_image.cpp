#include "shading/scratch_image.h"

namespace pel {

const cl::Memory& memoryOf(const ImageView& view) {
    static const cl::Memory none;
    return view ? view.buffer->memory() : none;
}

void resize(Ref<Buffer>& buffer, const Ref<Device>& device, size_t bytes) {
    if ((buffer ? buffer->bytes() : 0) == bytes) return;
    buffer = Ref<Buffer>();
    if (bytes) buffer = Buffer::create(device, bytes, nullptr);
}

ImageView scratchImage(const Ref<Buffer>& buffer, const ImageView& frame, PelFormat format, uint64_t offset) {
    ImageView view;
    view.buffer = buffer;
    view.format = format;
    view.width = frame.width;
    view.height = frame.height;
    view.byteOffset = offset;
    view.pixelStride = view.info().pixelBytes;
    view.rowStride = view.width * view.pixelStride;
    view.planeStride = view.height * view.rowStride;
    return view;
}

void moveImage(Device& device, cl_mem memory, size_t at, const ImageView& view, uint32_t row) {
    // may wrap round, as addresses do
    const uint64_t offset = view.byteOffset - uint64_t(row) * view.rowStride;
    device.fill(memory, at, 4, uint32_t(offset));
    device.fill(memory, at + 4, 4, uint32_t(offset >> 32));
}

}  // namespace pel
