// PelLut: texels in device memory, and the description they were made from.
#pragma once
#include "core/device.h"
#include "lut/profile.h"
#include "shared/lut.h"

namespace pel {

class Lut final : public Object {
  public:
    static constexpr Kind kind = Kind::lut;

    // Allocates the texels, uninitialised, except for a table of a stack, whose texels are elsewhere. `info`
    // must be valid (see below). Its profile is retained, and its defaults (no profile, radius 0) are filled
    // in.
    Lut(Ref<Device> device, const PelLutInfo& info, bool ofStack = false);

    Device& device() const { return *device_; }
    const PelLutInfo& info() const { return info_; }
    // Never null. Without meaning for specular tables.
    const Ref<Profile>& profile() const { return profile_; }
    // Sizes, row axis and radius, as kernels take them by value.
    const LutLayout& layout() const { return layout_; }
    // float4 texels, arranged as shared/lut.h says.
    const cl::Memory& texels() const { return texels_; }
    size_t texelBytes() const { return size_t(layout_.rowTexels) * (layout_.height + 1) * sizeof(cl_float4); }
    uint32_t width() const { return layout_.width; }
    uint32_t height() const { return layout_.height; }
    float diffusionRadius() const { return layout_.radius; }
    // Whether the description has no diffusion radius: then it is the profile's own, in the profile's unit.
    bool hasOwnRadius() const { return ownRadius_; }

  private:
    ~Lut() override = default;
    Ref<Device> device_;
    Ref<Profile> profile_;
    PelLutInfo info_;
    bool ownRadius_;
    LutLayout layout_;
    cl::Memory texels_;
};

// Checks a LUT description. Throws PEL_ERROR_INVALID_ARGUMENT with the field, its value and what would be
// right.
void checkCurvatureDesc(const PelCurvatureLutDesc& desc);
void checkShadowDesc(const PelShadowLutDesc& desc);
void checkSpecularDesc(const PelSpecularLutDesc& desc);

}  // namespace pel
