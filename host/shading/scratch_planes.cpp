#include "shading/scratch_planes.h"

#include <cstddef>

#include "shading/shading_constants.h"

namespace pel {

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
