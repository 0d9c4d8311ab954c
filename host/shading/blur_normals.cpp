// Blurred normals on screen, if the caller gave none.
#include <cstddef>

#include "shading/launch_ranges.h"
#include "shading/pass.h"
#include "shading/shading_constants.h"

namespace pel {
namespace {

class BlurNormals final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return plan.features & PEL_FEATURE_BLUR_NORMALS; }

    PassScratch scratch(const ShaderPlan&) const override {
        return {10 * sizeof(float), 10 * planeGuardBytes,
                PEL_BLUR_TAPS * PEL_BLUR_STEP_MAX / PEL_TILE_HEIGHT};
    }
    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        const size_t plane = scratchPlaneBytes(plan);
        normals_.allocate(device, plan);
        resize(positions_, device, 3 * plane);
        resize(between_, device, 3 * plane);
        resize(tags_, device, plane);
    }
    size_t bytes() const override {
        size_t bytes = normals_.bytes();
        for (const Ref<Buffer>& buffer : {positions_, between_, tags_})
            if (buffer) bytes += buffer->bytes();
        return bytes;
    }

    std::vector<cl::ProgramKey> programs(const Device& device, const ShaderPlan& plan) const override {
        const uint32_t lanes = device.info().mathWidth;
        cl::Defines defines = surfaceDefines(device, plan.state, lanes);
        defines["PEL_FEATURES"] = 0;
        defines["PEL_FORMAT_NORMAL_SHADING"] = formatCode(plan.state.images[PEL_SLOT_NORMAL_SHADING], lanes);
        return {{{"shading/blur_normals.cl"}, defines}};
    }

    void moveScratch(Device& device, const ShaderPlan& plan, const ShadingConstants& constants,
                     uint32_t row) override {
        normals_.move(device, plan, constants, row);
    }

    void enqueueAround(PassWork& work) override {
        const auto& images = work.plan.state.images;
        cl::Launch launch(program(), "prepare_normals", work.constants.frameMemory(), work.plan.tileLists);
        for (PelImageSlot slot :
             {PEL_SLOT_MATERIAL, PEL_SLOT_NORMAL_SHADING, PEL_SLOT_POSITION, PEL_SLOT_DEPTH})
            launch.arg(images[slot]);
        launch.args(normals_.memory(), positions_->memory(), tags_->memory(),
                    cl_uint(work.plan.scratchPlane));
        work.launch(launch, tileRange(work.device, work.tiles()));
        blur(work, false);
    }
    void enqueue(PassWork& work) override { blur(work, true); }

  private:
    void blur(PassWork& work, bool alongY) const {
        const cl::Memory &from = alongY ? between_->memory() : normals_.memory(),
                         &to = alongY ? normals_.memory() : between_->memory();
        cl::Launch launch(program(), "blur_normals", work.constants.frameMemory(), work.constants.materials(),
                          work.plan.tileLists, work.plan.state.images[PEL_SLOT_MATERIAL], from,
                          positions_->memory(), tags_->memory(), to, cl_uint(work.plan.scratchPlane),
                          cl_uint(alongY));
        work.launch(launch, tileRange(work.device, work.tiles()));
    }

    ScratchPlanes normals_{PEL_SLOT_NORMAL_BLURRED};
    Ref<Buffer> positions_, between_, tags_;
};

}  // namespace

constinit const PassKind blurNormalsPass = passKind<BlurNormals>("blur_normals");

}  // namespace pel
