// Bounds of the blocks of shadow maps, which decide most wide shadows without reading texels.
#include <algorithm>

#include "core/launch_policy.h"
#include "shading/features.h"
#include "shading/passes.h"
#include "shading/scratch_image.h"
#include "shading/shading_constants.h"
#include "shading/wide_shadow_program.h"
#include "shared/shade_passes.h"

namespace pel {
namespace {

// How many of the size of PEL_BOUNDS_BLOCK.
uint32_t blocks(uint32_t texels) {
    return (texels + PEL_BOUNDS_BLOCK - 1) / PEL_BOUNDS_BLOCK;
}

class ShadowBounds final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) {
        return std::ranges::any_of(plan.filteredLights, [&](const FilteredLight& f) {
            return isBounded(plan, plan.state.lights[f.index]);
        });
    }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        plan.boundedMaps.clear();
        uint64_t floats = 0;
        for (size_t k = 0; k < plan.filteredLights.size(); ++k) {
            const ShaderLight& light = plan.state.lights[plan.filteredLights[k].index];
            if (!isBounded(plan, light)) continue;
            for (uint32_t i = 0; i < cascadesOf(light); ++i) {
                const ImageView& map = *shadowCascade(light, i).map;
                const uint32_t columns = blocks(map.width), rows = blocks(map.height);
                plan.boundedMaps.push_back({uint32_t(k), i, (columns + 1) / 2 * rows, uint32_t(floats)});
                floats += 4 * uint64_t(columns) * rows;
            }
        }
        if (floats > UINT32_MAX)  // kernels count them with 32 bits
            fail(PEL_ERROR_UNSUPPORTED, "the shadow maps that are filtered are ", plan.filteredLights.size(),
                 " lights' and too large together: ", floats, " bounds of their depths; ", UINT32_MAX,
                 " are the most");
        plan.bounds = cl::Memory();
        // One vector more, since the last row's vectors reach beyond its end.
        resize(bounds_, device, (floats + device->info().mathWidth) * sizeof(float));
        plan.bounds = bounds_->memory();
    }
    size_t bytes() const override { return bounds_ ? bounds_->bytes() : 0; }

    std::vector<cl::ProgramKey> programs(const Device& device, const ShaderPlan& plan) const override {
        return {wideShadowKey(device, plan)};
    }

    void enqueueAround(PassWork& work) override {
        for (const BoundedMap& map : work.plan.boundedMaps) {
            const FilteredLight& filtered = work.plan.filteredLights[map.filtered];
            const ShaderLight& light = work.plan.state.lights[filtered.index];
            cl::Launch launch(program(), "shadow_bounds");
            launch.arg(work.constants.frameMemory())
                .arg(work.plan.tileLists)
                .arg(filtered.constants)
                .arg(cl_uint(map.cascade));
            launch.arg(memoryOf(*shadowCascade(light, map.cascade).map)).arg(bounds_->memory());
            work.launch(launch, {{map.pairs, 1, 1}, {launchPolicy(work.device).texels, 1, 1}});
        }
    }

  private:
    static bool isBounded(const ShaderPlan& plan, const ShaderLight& light) {
        return !plan.state.options.disableSkipping && !isCube(light.params) && filtersWide(plan.state, light);
    }

    Ref<Buffer> bounds_;
};

}  // namespace

constinit const PassKind shadowBoundsPass = passKind<ShadowBounds>();

}  // namespace pel
