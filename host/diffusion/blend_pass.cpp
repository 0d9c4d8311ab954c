// The shader's passes before and after the scattering methods. They read irradiance from its slot of the
// plan and replace it by their result.
#include "diffusion/blend_scatter.h"
#include "diffusion/passes.h"
#include "diffusion/scatter_material.h"

namespace pel {
namespace {

constexpr size_t pixelBytes = 3 * sizeof(float);

// True if a later pass applies the per-pixel weights.
bool weighsLater(const ShaderMaterial& material) {
    return scattersIrradiance(material) && !scattersByTaps(material);
}

bool weighsLater(const ShaderPlan& plan) {
    return plan.state.images[PEL_SLOT_SCATTER_WEIGHT] &&
           anyMaterial(plan.state, [](const ShaderMaterial& m) { return weighsLater(m); });
}

bool changes(const ShaderPlan& plan, const ShaderMaterial& material) {
    const PelMaterial& m = material.params;
    return (scattersIrradiance(material) && m.albedoBefore > 0) ||
           (readsIrradiance(material) && m.thinThickness > 0 && plan.state.images[PEL_SLOT_IRRADIANCE_BACK]);
}

bool changes(const ShaderPlan& plan) {
    return anyMaterial(plan.state, [&](const ShaderMaterial& m) { return changes(plan, m); });
}

std::map<uint32_t, PelBlendMaterial> blendMaterials(const ShaderPlan& plan) {
    std::map<uint32_t, PelBlendMaterial> materials;
    for (const auto& [id, material] : plan.state.materials) {
        if (!readsIrradiance(material)) continue;
        const PelMaterial& m = material.params;
        PelBlendMaterial blend{};
        std::copy_n(m.albedo, 3, blend.albedo);
        blend.before = scattersIrradiance(material) ? m.albedoBefore : 0;
        std::copy_n(material.through, 3, blend.through);
        blend.weighs = weighsLater(material);
        materials[id] = blend;
    }
    return materials;
}

class PreparePass final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return changes(plan) || weighsLater(plan); }

    PassScratch scratch(const ShaderPlan& plan) const override {
        return {changes(plan) ? pixelBytes : 0, 0, 0, changes(plan)};
    }
    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        auto& images = plan.state.images;
        ImageView& slot = images[PEL_SLOT_IRRADIANCE];
        const ImageView& frame = images[PEL_SLOT_RADIANCE];
        changes_ = changes(plan);
        resize(out_, device, changes_ ? size_t(frame.width) * frame.height * pixelBytes : 0);
        if (changes_) {
            images_ = {slot,
                       {},
                       images[PEL_SLOT_MATERIAL],
                       images[PEL_SLOT_IRRADIANCE_BACK],
                       {},
                       images[PEL_SLOT_ALBEDO],
                       scratchImage(out_, frame, PEL_FORMAT_PLANAR_RGB32F)};
            if (!blend_) blend_.emplace(device);
            slot = images_.out;
        }
        plan.arriving = slot;
    }
    size_t bytes() const override { return out_ ? out_->bytes() : 0; }
    std::vector<cl::ProgramKey> programs(const Device&, const ShaderPlan&) const override {
        return changes_ ? blend_->programs(images_) : std::vector<cl::ProgramKey>();
    }
    size_t upload(Device&, ShaderPlan& plan) override {
        if (changes_) blend_->prepare(blendMaterials(plan), PelBlendMaterial{}, images_, false);
        return 0;
    }
    void enqueue(PassWork& work) override {
        if (changes_) blend_->enqueuePreparation(images_, work.events);
    }

  private:
    bool changes_ = false;
    Ref<Buffer> out_;
    BlendImages images_;
    std::optional<BlendScatter> blend_;
};

class WeighPass final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return weighsLater(plan); }

    // Overwrites the scattered light.
    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        const auto& images = plan.state.images;
        const ImageView& slot = images[PEL_SLOT_IRRADIANCE];
        images_ = {plan.arriving, slot, images[PEL_SLOT_MATERIAL], {}, images[PEL_SLOT_SCATTER_WEIGHT], {},
                   slot};
        if (!blend_) blend_.emplace(device);
    }
    std::vector<cl::ProgramKey> programs(const Device&, const ShaderPlan&) const override {
        return blend_->programs(images_);
    }
    size_t upload(Device&, ShaderPlan& plan) override {
        blend_->prepare(blendMaterials(plan), PelBlendMaterial{}, images_, false);
        return 0;
    }
    void enqueue(PassWork& work) override { blend_->enqueueFinish(images_, work.events); }

  private:
    BlendImages images_;
    std::optional<BlendScatter> blend_;
};

}  // namespace

constinit const PassKind prepareScatterPass = passKind<PreparePass>("prepare_scatter");
constinit const PassKind weighScatterPass = passKind<WeighPass>("weigh_scatter");

}  // namespace pel
