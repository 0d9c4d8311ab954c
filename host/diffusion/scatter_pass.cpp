// The shader's pass of materials that scatter on the screen (PEL_SCATTERING_SCREEN and AUTO): takes
// irradiance from its slot of the plan, and puts what is scattered there.
#include <algorithm>
#include <optional>

#include "diffusion/passes.h"
#include "diffusion/screen_scatter.h"
#include "shading/features.h"
#include "shading/scratch_image.h"

namespace pel {
namespace {

constexpr uint32_t methods = 1u << PEL_SCATTERING_SCREEN | 1u << PEL_SCATTERING_AUTO;

bool scatters(const ShaderMaterial& material) {
    return methods >> material.params.scattering & 1;
}

// By its profile, that of its curvature table, or skin's, stretched to its diffusion radius.
ScreenScatter::Material profileOf(const ShaderMaterial& material) {
    Ref<Profile> profile = material.profile        ? material.profile
                           : material.curvatureLut ? material.curvatureLut->profile()
                                                   : Profile::skin();
    const double radius = profile->radius();
    return {std::move(profile), material.params.diffusionRadius / radius};
}

class ScatterPass final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) {
        return std::ranges::any_of(plan.state.materials, [](const auto& m) { return scatters(m.second); });
    }

    // Neighbours may be as far away as the profile reaches.
    PassScratch scratch(const ShaderPlan&) const override { return {3 * sizeof(float), 0, 0, true}; }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        auto& images = plan.state.images;
        ImageView& slot = images[PEL_SLOT_IRRADIANCE];
        const ImageView& frame = images[PEL_SLOT_RADIANCE];
        resize(out_, device, size_t(frame.width) * frame.height * 3 * sizeof(float));
        images_ = {slot, images[PEL_SLOT_POSITION],
                   images[PEL_SLOT_POSITION] ? ImageView() : images[PEL_SLOT_DEPTH],
                   images[PEL_SLOT_MATERIAL], scratchImage(out_, frame, PEL_FORMAT_PLANAR_RGB32F)};
        slot = images_.out;
        if (!scatter_) scatter_.emplace(device);
        materials_.clear();
        for (const auto& [id, material] : plan.state.materials)
            if (scatters(material) && material.params.diffusionRadius > 0)
                materials_[id] = profileOf(material);
    }
    size_t bytes() const override { return (out_ ? out_->bytes() : 0) + (scatter_ ? scatter_->bytes() : 0); }

    std::vector<cl::ProgramKey> programs(const Device&, const ShaderPlan&) const override {
        return scatter_->programs(images_);
    }

    size_t upload(Device&, ShaderPlan& plan) override {
        ScatterView view;
        std::copy_n(plan.state.camera.inverseViewProjection, 16, view.inverseViewProjection);
        view.tolerance = plan.state.options.targetError;  // light is in units of pi already, as white is
        scatter_->prepare(materials_, images_, view);
        return 0;
    }

    void enqueue(PassWork& work) override { scatter_->enqueue(images_, work.events); }

  private:
    Ref<Buffer> out_;
    ScatterImages images_;
    std::map<uint32_t, ScreenScatter::Material> materials_;
    std::optional<ScreenScatter> scatter_;
};

}  // namespace

constinit const PassKind scatterPass = passKind<ScatterPass>(methods);

}  // namespace pel
