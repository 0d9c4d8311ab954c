// The shader's pass that measures mean curvature for the gain of curved bodies
// (kernels/diffusion/mean_curvature.cl), where the caller brings none.
#include "diffusion/mean_curvature.h"
#include "diffusion/passes.h"
#include "shading/features.h"
#include "shading/shading_constants.h"

namespace pel {
namespace {

// Whether the shading kernel multiplies the material's diffuse light by a gain.
bool hasGain(const ShaderMaterial& material) {
    return material.gainWindow > 0 && material.params.curvatureGain > 0 &&
           material.params.scattering != PEL_SCATTERING_NONE;
}

class CurvaturePass final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) {
        const auto& images = plan.state.images;
        return !images[PEL_SLOT_MEAN_CURVATURE] && (images[PEL_SLOT_POSITION] || images[PEL_SLOT_DEPTH]) &&
               anyMaterial(plan.state, hasGain);
    }

    PassScratch scratch(const ShaderPlan&) const override { return {sizeof(float), 0, 0, false}; }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        auto& images = plan.state.images;
        const ImageView& frame = images[PEL_SLOT_RADIANCE];
        ImageView& slot = images[PEL_SLOT_MEAN_CURVATURE];
        slot = ImageView();
        resize(out_, device, size_t(frame.width) * plan.scratchRows() * sizeof(float));
        slot = scratchImage(out_, frame, PEL_FORMAT_R32F);
        curvature_.setImages(
            {images[images[PEL_SLOT_NORMAL_GEOMETRIC] ? PEL_SLOT_NORMAL_GEOMETRIC : PEL_SLOT_NORMAL_SHADING],
             images[PEL_SLOT_POSITION], images[PEL_SLOT_POSITION] ? ImageView() : images[PEL_SLOT_DEPTH],
             images[PEL_SLOT_MATERIAL], slot});
    }
    size_t bytes() const override { return out_ ? out_->bytes() : 0; }

    std::vector<cl::ProgramKey> programs(const Device& device, const ShaderPlan&) const override {
        return {curvature_.program(device)};
    }

    size_t upload(Device& device, ShaderPlan& plan) override {
        std::map<uint32_t, float> windows;
        for (const auto& [id, material] : plan.state.materials)
            if (hasGain(material)) windows[id] = material.gainWindow;
        outRow_ = 0;
        return curvature_.send(device, plan.state.images[PEL_SLOT_RADIANCE].height,
                               plan.state.camera.inverseViewProjection, windows);
    }

    void moveScratch(Device& device, const ShaderPlan& plan, const ShadingConstants& constants,
                     uint32_t row) override {
        moveImage(device, constants.frameMemory().get(),
                  offsetof(PelShadeFrame, images) + PEL_SLOT_MEAN_CURVATURE * sizeof(PelShadeImage),
                  plan.state.images[PEL_SLOT_MEAN_CURVATURE], row);
        outRow_ = row;
    }

    void enqueue(PassWork& work) override {
        const uint32_t rows = (work.rows.end - work.rows.begin) * PEL_TILE_HEIGHT;
        curvature_.enqueue(work.device, program(), work.events, work.rows.begin * PEL_TILE_HEIGHT, rows,
                           outRow_);
    }

  private:
    Ref<Buffer> out_;
    MeanCurvature curvature_;
    uint32_t outRow_ = 0;  // of the frame, where the scratch image begins
};

}  // namespace

constinit const PassKind curvaturePass = passKind<CurvaturePass>("mean_curvature");

}  // namespace pel
