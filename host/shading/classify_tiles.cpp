// Lists of the tiles with a material, and of the tiles of each variant of the shading kernel.
#include <bit>

#include "core/launch_policy.h"
#include "shading/features.h"
#include "shading/launch_ranges.h"
#include "shading/pass.h"
#include "shading/shading_constants.h"

namespace pel {
namespace {

// Tiles that a work-item classifies on a device of several lanes. On others a work-group classifies one tile.
uint32_t classifyRun(const Device& device) {
    // Long runs keep their order, which prefetchers follow; a few for each unit keep all units busy.
    return std::bit_floor(std::clamp(4096 / std::max(device.info().computeUnits, 1u), 64u, 2048u));
}
uint32_t classifyGroup(const Device& device) {
    return uint32_t(launchPolicy(device).group);
}

constexpr size_t countBytes = PEL_TILE_LISTS * sizeof(cl_uint),
                 countsAt = PEL_TILE_COUNT(0) * sizeof(cl_uint);

class ClassifyTiles final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return bool(plan.state.images[PEL_SLOT_MATERIAL]); }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        const size_t lists = plan.variants.size() > 1 ? 1 + plan.variants.size() : 1;
        const size_t tiles = lists * plan.listRows() * plan.tilesX;
        resize(lists_, device, countsAt + countBytes + tiles * sizeof(cl_uint));
        resize(bandCounts_, device, plan.bandRows < plan.tileRows ? plan.tileRows * countBytes : 0);
        plan.counters = plan.tileLists = lists_->memory();
    }
    size_t bytes() const override {
        return (lists_ ? lists_->bytes() : 0) + (bandCounts_ ? bandCounts_->bytes() : 0);
    }

    std::vector<cl::ProgramKey> programs(const Device& device, const ShaderPlan& plan) const override {
        if (!listsTiles(plan)) return {};
        // A separate program, since all shaders with ids of this format share it.
        const ShaderState& state = plan.state;
        return {
            {{"shading/classify_tiles.cl"},
             {{"PEL_FORMAT_MATERIAL", formatCode(state.images[PEL_SLOT_MATERIAL], device.info().mathWidth)},
              {"PEL_FEATURES", state.options.disableSkipping ? PEL_BIT_NO_SKIPPING : 0},
              {"PEL_CLASSIFY_GROUP", classifyGroup(device)},
              {"PEL_CLASSIFY_RUN", classifyRun(device)}}}};
    }

    void enqueueFrame(PassWork&) override { cleared_ = true; }
    void enqueueAround(PassWork& work) override { classify(work); }

    void enqueue(PassWork& work) override {
        if (!work.alone()) classify(work);
        if (work.plan.bandRows < work.plan.tileRows)  // the next band starts counting again
            work.device.copy(lists_->memory().get(), countsAt, bandCounts_->memory().get(),
                             work.band * countBytes, countBytes);
    }

    void addStats(Device& device, const ShaderPlan& plan, uint64_t bands,
                  PelShaderStats& stats) const override {
        if (!listsTiles(plan)) return;
        std::vector<cl_uint> counts(std::max<size_t>(bands, 1) * PEL_TILE_LISTS);
        device.read((bands > 1 ? bandCounts_ : lists_)->memory().get(), bands > 1 ? 0 : countsAt,
                    counts.size() * sizeof(cl_uint), counts.data(), true);
        stats.tilesShaded = stats.tilesEye = 0;
        for (size_t i = 0; i < counts.size(); ++i) {
            const size_t list = i % PEL_TILE_LISTS;
            const bool counted = plan.variants.size() > 1 ? list > 0 : list == 0;
            if (counted) stats.tilesShaded += counts[i];
            if (list > 1) stats.tilesPartial += counts[i];
            if (counted && plan.variants[list ? list - 1 : 0] & PEL_FEATURE_EYE) stats.tilesEye += counts[i];
        }
    }

  private:
    static bool listsTiles(const ShaderPlan& plan) {
        return plan.state.options.tileLists != PEL_TILES_NO_LIST || plan.scratch;
    }

    void classify(PassWork& work) {
        const ShaderPlan& plan = work.plan;
        if (!listsTiles(plan)) return;
        const bool listAll = plan.variants.size() == 1 || plan.scratch;
        if (!std::exchange(cleared_, false))
            work.device.fill(lists_->memory().get(), countsAt, countBytes, 0);
        cl::Launch launch(program(), "classify_tiles", work.constants.frameMemory(),
                          work.constants.materials(), plan.state.images[PEL_SLOT_MATERIAL].buffer->memory(),
                          lists_->memory(), cl_uint(plan.variants.size()), cl_uint(listAll));
        const size_t group = classifyGroup(work.device), run = classifyRun(work.device), tiles = work.tiles();
        const size_t items = work.device.info().mathWidth == 1 ? tiles * group : (tiles + run - 1) / run;
        work.launch(launch, {{items, 1, 1}, {group, 1, 1}});
    }

    Ref<Buffer> lists_, bandCounts_;  // bandCounts_: the counts of the lists, one band after another
    bool cleared_ = false;            // the counts, with the frame's counters
};

}  // namespace

constinit const PassKind classifyTilesPass = passKind<ClassifyTiles>("classify_tiles");

}  // namespace pel
