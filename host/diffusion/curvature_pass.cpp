// The shader's pass that measures mean curvature for the gain of curved bodies
// (kernels/diffusion/mean_curvature.cl), where the caller brings none.
#include "core/launch_policy.h"
#include "diffusion/passes.h"
#include "diffusion/sent_constants.h"
#include "shading/features.h"
#include "shading/launch_ranges.h"
#include "shading/shading_constants.h"
#include "shared/mean_curvature.h"

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
               std::ranges::any_of(plan.state.materials, [](const auto& m) { return hasGain(m.second); });
    }

    PassScratch scratch(const ShaderPlan&) const override { return {sizeof(float), 0, 0, false}; }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        auto& images = plan.state.images;
        const ImageView& frame = images[PEL_SLOT_RADIANCE];
        ImageView& slot = images[PEL_SLOT_MEAN_CURVATURE];
        slot = ImageView();
        resize(out_, device, size_t(frame.width) * plan.scratchRows() * sizeof(float));
        slot = scratchImage(out_, frame, PEL_FORMAT_R32F);
        normals_ =
            images[images[PEL_SLOT_NORMAL_GEOMETRIC] ? PEL_SLOT_NORMAL_GEOMETRIC : PEL_SLOT_NORMAL_SHADING];
        positions_ = images[PEL_SLOT_POSITION];
        depth_ = positions_ ? ImageView() : images[PEL_SLOT_DEPTH];
        ids_ = images[PEL_SLOT_MATERIAL];
    }
    size_t bytes() const override { return out_ ? out_->bytes() : 0; }

    std::vector<cl::ProgramKey> programs(const Device& device, const ShaderPlan& plan) const override {
        const auto code = [&](const ImageView& view) { return formatCode(view, device.info().mathWidth); };
        return {{{"diffusion/mean_curvature.cl"},
                 {{"PEL_FORMAT_NORMAL", code(normals_)},
                  {"PEL_FORMAT_POSITION", code(positions_)},
                  {"PEL_FORMAT_DEPTH", code(depth_)},
                  {"PEL_FORMAT_MATERIAL", code(ids_)},
                  {"PEL_FORMAT_OUT", code(plan.state.images[PEL_SLOT_MEAN_CURVATURE])}}}};
    }

    size_t upload(Device& device, ShaderPlan& plan) override {
        PelMeanCurvature frame{};
        const ImageView& out = plan.state.images[PEL_SLOT_MEAN_CURVATURE];
        frame.width = out.width, frame.height = plan.state.images[PEL_SLOT_RADIANCE].height;
        std::copy_n(plan.state.camera.inverseViewProjection, 16, frame.inverseViewProjection);
        frame.normal = describeImage(normals_);
        frame.position = describeImage(positions_ ? positions_ : depth_);
        frame.ids = describeImage(ids_);
        frame.out = describeImage(out);
        for (const auto& [id, material] : plan.state.materials)
            if (hasGain(material)) frame.window[id] = material.gainWindow;
        constants_.send(device, frame);
        outRow_ = 0;
        return sizeof frame;
    }

    void moveScratch(Device& device, const ShaderPlan& plan, const ShadingConstants& constants,
                     uint32_t row) override {
        moveImage(device, constants.frameMemory().get(),
                  offsetof(PelShadeFrame, images) + PEL_SLOT_MEAN_CURVATURE * sizeof(PelShadeImage),
                  plan.state.images[PEL_SLOT_MEAN_CURVATURE], row);
        outRow_ = row;
    }

    void enqueue(PassWork& work) override {
        const uint32_t width = work.plan.state.images[PEL_SLOT_RADIANCE].width,
                       rows = (work.rows.end - work.rows.begin) * PEL_TILE_HEIGHT;
        work.launch(program(), "mean_curvature", vectorRange(work.device, width, rows), constants_, normals_,
                    positions_ ? positions_ : depth_, ids_, *out_, cl_uint(work.rows.begin * PEL_TILE_HEIGHT),
                    cl_uint(rows), cl_uint(outRow_));
    }

  private:
    Ref<Buffer> out_;
    ImageView normals_, positions_, depth_, ids_;
    SentConstants<PelMeanCurvature> constants_;
    uint32_t outRow_ = 0;  // of the frame, where the scratch image begins
};

}  // namespace

constinit const PassKind curvaturePass = passKind<CurvaturePass>("mean_curvature");

}  // namespace pel
