// The shading kernel, in the variants that the materials need: the last pass, which writes the caller's
// images.
#include "shading/image_slots.h"
#include "shading/launch_ranges.h"
#include "shading/passes.h"
#include "shading/scratch_image.h"
#include "shading/shade_variants.h"
#include "shading/shading_constants.h"

namespace pel {
namespace {

// A caller who listens is asked at least this often whether to go on: some tens of milliseconds on two cores.
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
        const ShadingConstants& constants = work.constants;
        cl::Launch launch(program(variant), "shade");
        launch.arg(constants.frameMemory())
            .arg(constants.materials())
            .arg(constants.lights())
            .arg(constants.luts());
        launch.arg(plan.tileLists).arg(plan.counters);
        launch.arg(plan.ambientNodes);
        for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot)
            if (imageSlot(slot).role != SlotRole::PASS) launch.arg(memoryOf(plan.state.images[slot]));
        const auto& lightBuffers = constants.lightBuffers();
        for (size_t i = 0; i < PEL_LIGHT_BUFFERS; ++i)
            launch.arg(i < lightBuffers.size() ? lightBuffers[i] : cl::Memory());
        const uint32_t list = plan.variants.size() > 1 ? 1 + variant : 0;
        launch.arg(cl_uint(part)).arg(cl_uint(parts));
        launch.arg(cl_uint(plan.state.options.tileLists == PEL_TILES_NO_LIST ? PEL_EVERY_TILE : list));
        // Groups take tiles in turn, so that no host waits for their count.
        work.launch(launch, tileRange(work.device, work.tiles()));
    }
};

}  // namespace

constinit const PassKind shadePass = passKind<Shade>();

}  // namespace pel
