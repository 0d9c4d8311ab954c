// Images of three floats per pixel that a pass makes in a slot: planes, with a guard before and after each.
#pragma once
#include "shading/scratch_image.h"
#include "shading/shader_plan.h"
#include "shared/shade_passes.h"

namespace pel {

class ShadingConstants;

constexpr size_t planeGuardBytes = 2 * PEL_PLANE_GUARD * sizeof(float);
// Of one plane of a value per pixel of a band, with its guards.
size_t scratchPlaneBytes(const ShaderPlan& plan);

class ScratchPlanes {
  public:
    explicit ScratchPlanes(PelImageSlot slot) : slot_(slot) {}
    // And puts them into their slot.
    void allocate(const Ref<Device>& device, ShaderPlan& plan);
    // Pass::moveScratch; not if another pass has replaced the slot.
    void move(Device& device, const ShaderPlan& plan, const ShadingConstants& constants, uint32_t row) const;
    const cl::Memory& memory() const { return buffer_->memory(); }
    size_t bytes() const { return buffer_ ? buffer_->bytes() : 0; }

  private:
    PelImageSlot slot_;
    Ref<Buffer> buffer_;
};

}  // namespace pel
