// The steps before and after the scattering methods (kernels/diffusion/blend_scatter.cl).
#pragma once
#include "shading/scratch_image.h"
#include "shared/blend.h"

namespace pel {

// Images of one size; images that are not set are empty.
struct BlendImages {
    ImageView irradiance, scattered, ids, back, weight, albedo, out;
    ImageView curvature{};  // mean, 1/length
};

class BlendScatter {
  public:
    explicit BlendScatter(Ref<Device> device) : device_(std::move(device)) {}
    // `other`: for ids without a material.
    void prepare(const std::map<uint32_t, PelBlendMaterial>& materials, const PelBlendMaterial& other,
                 const BlendImages& images, bool accumulate);
    std::vector<cl::ProgramKey> programs(const BlendImages& images) const;
    void enqueuePreparation(const BlendImages& images, std::vector<cl::Event>& events);
    void enqueueFinish(const BlendImages& images, std::vector<cl::Event>& events);

  private:
    Ref<Device> device_;
    CachedUpload frame_, materials_;
};

// The share of light that a sheet transmits; `thickness` in the unit of positions, `scale`: of the profile.
Rgb throughSheet(const Profile& profile, double scale, double thickness);

}  // namespace pel
