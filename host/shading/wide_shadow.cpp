// Wide shadows from shadow maps, for lights whose wide shadow the caller did not give.
#include <algorithm>
#include <cstddef>

#include "core/launch_policy.h"
#include "shading/features.h"
#include "shading/launch_ranges.h"
#include "shading/passes.h"
#include "shading/scratch_image.h"
#include "shading/shading_constants.h"
#include "shading/wide_shadow_constants.h"
#include "shading/wide_shadow_program.h"
#include "shared/features.h"

namespace pel {

cl::ProgramKey wideShadowKey(const Device& device, const ShaderPlan& plan) {
    const uint32_t lanes = device.info().mathWidth;
    const PelImageSlot normal = geometricNormalSlot(plan.state);
    uint32_t bits = (plan.state.options.countPixels ? PEL_BIT_COUNT : 0) |
                    (plan.state.options.disableSkipping ? PEL_BIT_NO_SKIPPING : 0);
    uint32_t map = 0, content = 0;
    for (const FilteredLight& filtered : plan.filteredLights) {
        const ShaderLight& light = plan.state.lights[filtered.index];
        map |= mapFormatCode(light);
        content = light.params.shadowContent;
        bits |= formFeatures(light.params) & (PEL_BIT_SHADOW_CUBE | PEL_BIT_SHADOW_CASCADES);
    }
    cl::Defines defines = surfaceDefines(device, plan.state, lanes);
    defines["PEL_FEATURES"] = text(bits);
    defines["PEL_FORMAT_NORMAL"] = text(formatCode(plan.state.images[normal], lanes));
    defines["PEL_NORMAL_SLOT"] = text(int(normal));
    defines["PEL_FORMAT_SHADOW_MAP"] = text(map);
    defines["PEL_SHADOW_CONTENT"] = text(content);
    defines["PEL_BOUNDS"] = text(int(!plan.boundedMaps.empty()));
    defines["PEL_THIN"] = text(int(makesLightFromBehind(plan.state, plan.features)));
    cl::ProgramKey key{{"shading/wide_shadow.cl"}, defines};
    if (!plan.boundedMaps.empty()) {
        key.files.push_back("shading/shadow_bounds.cl");
        key.defines["PEL_BOUNDS_GROUP"] = text(launchPolicy(device).texels);
    }
    return key;
}

namespace {

class WideShadow final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return plan.features & PEL_FEATURE_FILTER_SHADOW; }

    PassScratch scratch(const ShaderPlan& plan) const override {
        const bool between = std::ranges::any_of(
            plan.filteredLights, [&](const FilteredLight& f) { return interpolates(plan, f); });
        return {plan.filteredLights.size() * sizeof(float), 0, between ? PEL_BETWEEN_ROWS : 0u};
    }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        const ImageView& frame = plan.state.images[PEL_SLOT_RADIANCE];
        const size_t lightBytes = size_t(frame.width) * plan.scratchRows() * sizeof(float);
        const auto slot = [&](size_t k) -> ImageView& {
            return plan.state.lights[plan.filteredLights[k].index].images[PEL_LIGHT_WIDE_SHADOW];
        };
        const size_t lights = plan.filteredLights.size();
        for (size_t k = 0; k < lights; ++k) slot(k) = ImageView();
        resize(images_, device, lights * lightBytes);
        for (size_t k = 0; k < lights; ++k)
            slot(k) = scratchImage(images_, frame, PEL_FORMAT_R32F, k * lightBytes);
    }
    size_t bytes() const override {
        size_t bytes = images_ ? images_->bytes() : 0;
        for (const CachedUpload& one : constants_) bytes += one.bytes();
        return bytes;
    }

    std::vector<cl::ProgramKey> programs(const Device& device, const ShaderPlan& plan) const override {
        return {wideShadowKey(device, plan)};
    }

    size_t upload(Device& device, ShaderPlan& plan) override {
        constants_.resize(plan.filteredLights.size());
        size_t bytes = 0;
        for (size_t k = 0; k < constants_.size(); ++k) {
            FilteredLight& filtered = plan.filteredLights[k];
            const ShaderLight& light = plan.state.lights[filtered.index];
            std::vector<PelWideShadow> maps;
            for (uint32_t i = 0; i < cascadesOf(light); ++i)
                maps.push_back(describeWideShadow(light, filtered.index, i));
            for (const BoundedMap& map : plan.boundedMaps)
                if (map.filtered == k) maps[map.cascade].bounds = map.offset;
            bytes += constants_[k].update(device, maps.data(), maps.size() * sizeof maps[0]);
            filtered.constants = constants_[k].memory();
        }
        return bytes;
    }
    void moveScratch(Device& device, const ShaderPlan& plan, const ShadingConstants& constants,
                     uint32_t row) override {
        for (const FilteredLight& filtered : plan.filteredLights) {
            const ImageView& view = plan.state.lights[filtered.index].images[PEL_LIGHT_WIDE_SHADOW];
            moveImage(device, constants.lights().get(),
                      filtered.index * sizeof(PelShadeLight) + offsetof(PelShadeLight, wide), view, row);
            moveImage(device, filtered.constants.get(), offsetof(PelWideShadow, out), view, row);
        }
    }

    void enqueueAround(PassWork& work) override {
        for (const FilteredLight& light : work.plan.filteredLights)
            if (interpolates(work.plan, light)) filter(work, light, PEL_PIXELS_SECOND);
    }
    void enqueue(PassWork& work) override {
        for (const FilteredLight& light : work.plan.filteredLights)
            filter(work, light, interpolates(work.plan, light) ? PEL_PIXELS_BETWEEN : PEL_PIXELS_ALL);
    }

  private:
    // Sharp shadows are not interpolated.
    static bool interpolates(const ShaderPlan& plan, const FilteredLight& light) {
        return plan.interpolates() && filtersWide(plan.state, plan.state.lights[light.index]);
    }

    void filter(PassWork& work, const FilteredLight& filtered, cl_uint pixels) const {
        const ShaderPlan& plan = work.plan;
        const ShaderLight& light = plan.state.lights[filtered.index];
        cl::Launch launch(program(), "wide_shadow");
        launch.arg(work.constants.frameMemory()).arg(work.constants.materials()).arg(work.constants.lights());
        launch.arg(plan.tileLists).arg(plan.counters);
        for (PelImageSlot slot :
             {PEL_SLOT_MATERIAL, geometricNormalSlot(plan.state), PEL_SLOT_POSITION, PEL_SLOT_DEPTH})
            launch.arg(memoryOf(plan.state.images[slot]));
        launch.arg(filtered.constants).arg(cl_uint(filtered.index));
        for (uint32_t i = 0; i < PEL_CASCADES; ++i)
            launch.arg(i < cascadesOf(light) ? memoryOf(*shadowCascade(light, i).map) : cl::Memory());
        launch.arg(plan.bounds).arg(images_->memory()).arg(pixels);
        work.launch(launch, tileRange(work.device, work.tiles()));
    }

    Ref<Buffer> images_;  // of one light after another
    std::vector<CachedUpload> constants_;
};

}  // namespace

constinit const PassKind wideShadowPass = passKind<WideShadow>();

}  // namespace pel
