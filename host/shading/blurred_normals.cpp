#include "shading/blurred_normals.h"

#include <cstddef>

#include "shading/shading_constants.h"

namespace pel {

size_t normalPlaneBytes(const ShaderPlan& plan) {
    return size_t(plan.state.images[PEL_SLOT_RADIANCE].width) * plan.scratchRows() * sizeof(float) +
           planeGuardBytes;
}

void BlurredNormals::allocate(const Ref<Device>& device, ShaderPlan& plan) {
    const size_t plane = normalPlaneBytes(plan);
    ImageView& image = plan.state.images[PEL_SLOT_NORMAL_BLURRED];
    image = ImageView();
    resize(buffer_, device, 3 * plane);
    image = scratchImage(buffer_, plan.state.images[PEL_SLOT_RADIANCE], PEL_FORMAT_PLANAR_RGB32F,
                         PEL_PLANE_GUARD * sizeof(float));
    image.planeStride = plane;
    plan.normalPlane = uint32_t(plane / sizeof(float));
}

void BlurredNormals::move(Device& device, const ShaderPlan& plan, const ShadingConstants& constants,
                          uint32_t row) const {
    moveImage(device, constants.frameMemory().get(),
              offsetof(PelShadeFrame, images) + PEL_SLOT_NORMAL_BLURRED * sizeof(PelShadeImage),
              plan.state.images[PEL_SLOT_NORMAL_BLURRED], row);
}

}  // namespace pel
