// The shader's passes of materials that scatter on the screen (PEL_SCATTERING_SCREEN and AUTO) or from
// shadow maps (PEL_SCATTERING_LIGHT). They read irradiance from its slot of the plan and replace it by the
// scattered light.
#include "diffusion/passes.h"
#include "diffusion/scatter_material.h"

namespace pel {
namespace {

constexpr uint32_t onScreen = 1u << PEL_SCATTERING_SCREEN | 1u << PEL_SCATTERING_AUTO,
                   inLight = 1u << PEL_SCATTERING_LIGHT;

// Without maps for all light, materials of PEL_SCATTERING_LIGHT scatter on the screen.
bool scatters(const ShaderState& state, const ShaderMaterial& material, bool alone) {
    const bool mapped = lightIsMapped(state);
    const uint32_t methods = alone ? (mapped ? inLight : 0) : mapped ? onScreen : onScreen | inLight;
    return methods >> material.params.scattering & 1 && !scattersOnDisk(material);
}

bool halfRate(const ShaderPlan& plan) {
    return plan.state.options.halfRate || plan.taken.halfRate;
}

// `alone`: the far part is the sum over texels only.
template <bool alone>
class ScatterPass final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) {
        return anyMaterial(plan.state,
                           [&](const ShaderMaterial& m) { return scatters(plan.state, m, alone); });
    }

    // Neighbours may be as far away as the profile reaches.
    PassScratch scratch(const ShaderPlan& plan) const override {
        const ImageView& frame = plan.state.images[PEL_SLOT_RADIANCE];
        return {
            (ownsIrradiance(plan) ? 0 : 3 * sizeof(float)) + (alone && halfRate(plan) ? sizeof(float) : 0),
            ScreenScatter::bytesFor(frame.width, frame.height, hasRadii(plan)) +
                LightSpace::bytesFor(plan.state.lights, !alone),
            0, true};
    }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        images_ = takeIrradiance(plan, device, out_, ownsIrradiance(plan));
        addRadii(plan, images_);
        if (!scatter_) scatter_.emplace(device);
        scatter_->announce({plan.state.lights, alone, halfRate(plan)});
        materials_.clear();
        for (const auto& [id, material] : plan.state.materials)
            if (scatters(plan.state, material, alone) && material.params.diffusionRadius > 0) {
                materials_[id] = profileOf(material);
                if (!(material.gain[0] > 0)) continue;
                images_.curvature = plan.state.images[PEL_SLOT_MEAN_CURVATURE];
                if (alone && plan.features & PEL_FEATURE_MAKE_IRRADIANCE)
                    images_.thickness = plan.state.images[PEL_SLOT_THICKNESS];
            }
    }
    size_t bytes() const override { return (out_ ? out_->bytes() : 0) + (scatter_ ? scatter_->bytes() : 0); }

    std::vector<cl::ProgramKey> programs(const Device&, const ShaderPlan&) const override {
        return scatter_->programs(images_);
    }

    size_t upload(Device&, ShaderPlan& plan) override {
        const PelCamera& camera = plan.state.camera;
        // Light is in units of pi already, as white is.
        scatter_->prepare(materials_, images_,
                          {camera.inverseViewProjection, camera.position, plan.state.options.targetError});
        return 0;
    }

    void enqueue(PassWork& work) override { scatter_->enqueue(images_, work.events); }

    void addStats(Device&, const ShaderPlan& plan, uint64_t, PelShaderStats& stats) const override {
        LightCounts light;
        ScatterCounts counts = scatter_->counts(&light);
        counts.taps += light.texels;
        stats.texelsReached += light.reached;
        if (alone) counts.tilesTapped = light.tiles, counts.pixelsTapped = light.pixels;
        addScatterCounts(counts, alone ? PEL_SCATTERING_LIGHT : PEL_SCATTERING_SCREEN, stats);
        if constexpr (!alone) {
            stats.tilesByScattering[PEL_SCATTERING_LIGHT] += light.tiles;
            // Pixels kept by auto can be told from others only if all materials of this pass are auto.
            if (!anyMaterial(plan.state, [&](const ShaderMaterial& m) {
                    return scatters(plan.state, m, alone) && m.given.scattering != PEL_SCATTERING_AUTO;
                }))
                addKeptChoices(counts, stats);
        }
    }

  private:
    Ref<Buffer> out_;
    ScatterImages images_;
    std::map<uint32_t, ScreenScatter::Material> materials_;
    mutable std::optional<ScreenScatter> scatter_;
};

}  // namespace

constinit const PassKind scatterPass = passKind<ScatterPass<false>>("scatter_screen", onScreen);
constinit const PassKind lightScatterPass = passKind<ScatterPass<true>>("scatter_light", inLight);

}  // namespace pel
