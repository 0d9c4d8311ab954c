// The shading kernel, in the variants that the materials need: the last pass, which writes the caller's
// images.
#include "shading/launch_ranges.h"
#include "shading/shade_variants.h"

namespace pel {
namespace {

// A progress callback is called at least this often: every few tens of milliseconds on two cores.
constexpr uint64_t pixelsPerPart = 1 << 20;

class Shade final : public Pass {
  public:
    static bool needed(const ShaderPlan&) { return true; }

    std::vector<cl::ProgramKey> programs(const Device& device, const ShaderPlan& plan) const override {
        std::vector<cl::ProgramKey> keys;
        for (const uint32_t features : plan.variants) keys.push_back(shadeKey(device, plan.state, features));
        return keys;
    }

    void enqueue(PassWork& work) override {
        const uint32_t parts =
            work.interruptible ? uint32_t(1 + uint64_t(work.tiles()) * PEL_TILE_PIXELS / pixelsPerPart) : 1;
        for (uint32_t part = 0; part < parts; ++part) {
            if (work.interruptible) {
                work.device.finish();
                const double rows = work.rows.begin + double(work.rows.end - work.rows.begin) * part / parts;
                work.device.progress(rows / work.plan.tileRows, "shading");
            }
            for (uint32_t variant = 0; variant < work.plan.variants.size(); ++variant) {
                enqueueVariant(work, variant, part, parts);
                work.written = true;
            }
        }
        if (work.interruptible) work.device.finish();
    }

  private:
    void enqueueVariant(PassWork& work, uint32_t variant, uint32_t part, uint32_t parts) const {
        const ShaderPlan& plan = work.plan;
        cl::Launch launch(program(variant), "shade");
        sceneArguments(launch, work);
        const uint32_t list = plan.variants.size() > 1 ? 1 + variant : 0;
        launch.args(cl_uint(part), cl_uint(parts),
                    cl_uint(plan.state.options.tileLists == PEL_TILES_NO_LIST ? PEL_EVERY_TILE : list));
        // Groups take tiles in turn, so the host need not know their number.
        work.launch(launch, tileRange(work.device, work.tiles()));
    }
};

}  // namespace

constinit const PassKind shadePass = passKind<Shade>("shade");

}  // namespace pel
