// Irradiance per pixel for the materials that need it, if the caller gave none. The pass that scatters it
// runs between this pass and the shading kernel: it reads PEL_SLOT_IRRADIANCE, and puts its result into that
// slot of the plan.
#include "shading/features.h"
#include "shading/launch_ranges.h"
#include "shading/scratch_image.h"
#include "shading/shade_variants.h"

namespace pel {
namespace {

class Irradiance final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return plan.features & PEL_FEATURE_MAKE_IRRADIANCE; }

    PassScratch scratch(const ShaderPlan&) const override { return {3 * sizeof(float), 3 * planeGuardBytes}; }
    void allocate(const Ref<Device>& device, ShaderPlan& plan) override { planes_.allocate(device, plan); }
    size_t bytes() const override { return planes_.bytes(); }

    std::vector<cl::ProgramKey> programs(const Device& device, const ShaderPlan& plan) const override {
        cl::Defines defines = sceneDefines(
            device, plan.state,
            plan.features & (PEL_FEATURE_SHADOW | PEL_FEATURE_AMBIENT | PEL_FEATURE_AMBIENT_CUBE));
        defines["PEL_THIN"] = int(makesLightFromBehind(plan.state, plan.features));
        if (anyMaterial(plan.state, [](const ShaderMaterial& m) { return m.gain[0] > 0; }))
            defines["PEL_FORMAT_THICKNESS"] =
                formatCode(plan.state.images[PEL_SLOT_THICKNESS], device.info().mathWidth);
        defines["PEL_PASS_GROUP"] = tileGroup(device);
        return {{{"shading/irradiance.cl"}, defines}};
    }

    void moveScratch(Device& device, const ShaderPlan& plan, const ShadingConstants& constants,
                     uint32_t row) override {
        planes_.move(device, plan, constants, row);
    }

    void enqueue(PassWork& work) override {
        cl::Launch launch(program(), "make_irradiance");
        sceneArguments(launch, work);
        launch.args(planes_.memory(), cl_uint(work.plan.scratchPlane));
        work.launch(launch, tileRange(work.device, work.tiles()));
    }

  private:
    ScratchPlanes planes_{PEL_SLOT_IRRADIANCE};
};

}  // namespace

constinit const PassKind irradiancePass = passKind<Irradiance>("irradiance");

}  // namespace pel
