// The shader's passes of materials that scatter by taps: on a disk (PEL_SCATTERING_SCREEN with
// scatterTaps), and separably (PEL_SCATTERING_SEPARABLE). They read irradiance from its slot of the plan
// and replace it by the scattered light.
#include "diffusion/gather_scatter.h"
#include "diffusion/passes.h"
#include "diffusion/scatter_material.h"

namespace pel {
namespace {

using Form = GatherScatter::Form;

template <Form form>
class GatherPass final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return anyMaterial(plan.state, takes); }

    // Neighbours may be as far away as the profile reaches.
    PassScratch scratch(const ShaderPlan& plan) const override {
        const PelShaderOptions& o = plan.state.options;
        const bool history = o.historyWeight > 0;
        return {(overwrites(plan) ? 0 : 3 * sizeof(float)) + (history ? 4 * sizeof(float) : 0) +
                    GatherScatter::pixelBytes(form, o.halfRate != 0, history),
                0, 0, true};
    }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        const PelShaderOptions& o = plan.state.options;
        images_ = {takeIrradiance(plan, device, out_, overwrites(plan)),
                   plan.state.images[PEL_SLOT_SCATTER_WEIGHT], o.halfRate != 0};
        const ImageView scattered = images_.of.out;
        resize(fresh_, device,
               o.historyWeight > 0 ? size_t(scattered.width) * scattered.height * 4 * sizeof(float) : 0);
        if (o.historyWeight > 0) {
            images_.of.out = scratchImage(fresh_, scattered, PEL_FORMAT_RGBA32F);
            images_.history = {o.historyWeight, o.historyCut, plan.state.images[PEL_SLOT_MOTION], scattered};
        }
        addRadii(plan, images_.of);
        if (!scatter_) scatter_.emplace(device, form);
        materials_.clear();
        sources_.reset();
        for (const auto& [id, material] : plan.state.materials) {
            if (scattersIrradiance(material)) sources_.set(id);
            if (!takes(material) || !(material.params.diffusionRadius > 0)) continue;
            const PelMaterial& m = material.params;
            const ScreenScatter::Material profile = profileOf(material);
            materials_[id] = {profile.profile, profile.scale, scatterTapsOf(m.scattering, m.scatterTaps),
                              std::to_array(m.borderColor)};
        }
    }
    size_t bytes() const override {
        return (out_ ? out_->bytes() : 0) + (fresh_ ? fresh_->bytes() : 0) +
               (scatter_ ? scatter_->bytes() : 0);
    }

    std::vector<cl::ProgramKey> programs(const Device&, const ShaderPlan&) const override {
        return scatter_->programs(images_);
    }

    size_t upload(Device&, ShaderPlan& plan) override {
        const PelCamera& camera = plan.state.camera;
        const PelShaderOptions& options = plan.state.options;
        scatter_->prepare(materials_, sources_, images_,
                          {camera.inverseViewProjection, camera.position, 0, options.disableSkipping != 0},
                          options.frameIndex);
        return 0;
    }

    void enqueue(PassWork& work) override { scatter_->enqueue(images_, work.events); }

    void addStats(Device&, const ShaderPlan& plan, uint64_t, PelShaderStats& stats) const override {
        const ScatterCounts counts = scatter_->counts();
        addScatterCounts(counts, form == Form::disk ? PEL_SCATTERING_SCREEN : PEL_SCATTERING_SEPARABLE,
                         stats);
        if (!anyMaterial(plan.state, [](const ShaderMaterial& m) {
                return takes(m) && m.given.scattering != PEL_SCATTERING_AUTO;
            }))
            addKeptChoices(counts, stats);
    }

  private:
    static bool takes(const ShaderMaterial& material) {
        return form == Form::disk ? scattersOnDisk(material)
                                  : material.params.scattering == PEL_SCATTERING_SEPARABLE;
    }

    // With a history the pixels that are gathered go to another image, and leave the irradiance free.
    static bool overwrites(const ShaderPlan& plan) {
        return plan.state.options.historyWeight > 0 && ownsIrradiance(plan);
    }

    Ref<Buffer> out_, fresh_;
    GatherImages images_;
    std::map<uint32_t, GatherScatter::Material> materials_;
    GatherScatter::Ids sources_;
    mutable std::optional<GatherScatter> scatter_;
};

}  // namespace

constinit const PassKind diskPass =
    passKind<GatherPass<Form::disk>>("scatter_disk", 1u << PEL_SCATTERING_SCREEN);
constinit const PassKind separablePass =
    passKind<GatherPass<Form::lines>>("scatter_separable", 1u << PEL_SCATTERING_SEPARABLE);

}  // namespace pel
