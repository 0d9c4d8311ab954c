#include "shading/scratch_image.h"

#include <cstddef>

#include "core/sized_memory.h"
#include "shading/shading_constants.h"

namespace pel {

void resize(Ref<Buffer>& buffer, const Ref<Device>& device, size_t bytes) {
    if (KeepsLarger::fits(buffer ? buffer->bytes() : 0, bytes)) return;
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

size_t CachedUpload::update(Device& device, const void* bytes, size_t count) {
    const auto* from = static_cast<const unsigned char*>(bytes);
    if (memory_ && bytes_.size() == count && std::equal(from, from + count, bytes_.begin())) return 0;
    const bool fits = memory_ && bytes_.size() == count;
    bytes_.clear();
    std::vector<unsigned char> padded(from, from + count);
    padded.resize(std::max<size_t>(count, 16));
    // Executions that are still queued read the old values first.
    if (fits)
        device.writeLater(memory_.get(), std::move(padded));
    else
        memory_ = device.allocate(padded.size(), padded.data());
    bytes_.assign(from, from + count);
    return count;
}

size_t scratchPlaneBytes(const ShaderPlan& plan) {
    return size_t(plan.state.images[PEL_SLOT_RADIANCE].width) * plan.scratchRows() * sizeof(float) +
           planeGuardBytes;
}

void ScratchPlanes::allocate(const Ref<Device>& device, ShaderPlan& plan) {
    const size_t plane = scratchPlaneBytes(plan);
    ImageView& image = plan.state.images[slot_];
    image = ImageView();
    resize(buffer_, device, 3 * plane);
    image = scratchImage(buffer_, plan.state.images[PEL_SLOT_RADIANCE], PEL_FORMAT_PLANAR_RGB32F,
                         PEL_PLANE_GUARD * sizeof(float));
    image.planeStride = plane;
    plan.scratchPlane = uint32_t(plane / sizeof(float));
}

void ScratchPlanes::move(Device& device, const ShaderPlan& plan, const ShadingConstants& constants,
                         uint32_t row) const {
    if (plan.state.images[slot_].buffer.get() != buffer_.get()) return;
    moveImage(device, constants.frameMemory().get(),
              offsetof(PelShadeFrame, images) + slot_ * sizeof(PelShadeImage), plan.state.images[slot_], row);
}

}  // namespace pel
