// Wide shadows from shadow maps, for lights whose wide shadow the caller did not give.
#include <cstddef>

#include "core/launch_policy.h"
#include "shading/features.h"
#include "shading/kept_maps.h"
#include "shading/launch_ranges.h"
#include "shading/shading_constants.h"

namespace pel {
namespace {

// The one program of wide shadows and of their maps' bounds, because the first frame waits for the driver's
// cost per program.
cl::ProgramKey wideShadowKey(const Device& device, const ShaderPlan& plan) {
    const uint32_t lanes = device.info().mathWidth;
    const PelImageSlot normal = geometricNormalSlot(plan.state);
    uint32_t bits = (plan.state.options.countPixels ? PEL_BIT_COUNT : 0) |
                    (plan.state.options.disableSkipping ? PEL_BIT_NO_SKIPPING : 0);
    uint32_t map = 0, content = 0;
    for (const uint32_t index : plan.filteredLights) {
        const ShaderLight& light = plan.state.lights[index];
        map |= mapFormatCode(light);
        content = light.params.shadowContent;
        bits |= formFeatures(light.params) & (PEL_BIT_SHADOW_CUBE | PEL_BIT_SHADOW_CASCADES);
    }
    cl::Defines defines = surfaceDefines(device, plan.state, lanes);
    defines["PEL_FEATURES"] = bits;
    defines["PEL_FORMAT_NORMAL"] = formatCode(plan.state.images[normal], lanes);
    defines["PEL_NORMAL_SLOT"] = int(normal);
    defines["PEL_FORMAT_SHADOW_MAP"] = map;
    defines["PEL_SHADOW_CONTENT"] = content;
    defines["PEL_AREA_LIGHTS"] = int(hasAreaLight(plan.state));
    defines["PEL_BOUNDS"] = int(!plan.boundedMaps.empty());
    defines["PEL_THIN"] = int(makesLightFromBehind(plan.state, plan.features));
    defines["PEL_FILTERS_WIDE"] = int(std::ranges::any_of(plan.filteredLights, [&](uint32_t light) {
        return filtersWide(plan.state, plan.state.lights[light]);
    }));
    cl::ProgramKey key{{"shading/wide_shadow.cl"}, defines};
    if (!plan.boundedMaps.empty()) key.files.push_back("shading/shadow_bounds.cl");
    return key;
}

// The constants of a light's map, or of its cascade-th one. Throws if its matrix does not distinguish across
// from along.
PelWideShadow describeWideShadow(const ShaderLight& light, uint32_t index, uint32_t cascade) {
    const PelLight& l = light.params;
    const ShadowCascade from = shadowCascade(light, cascade);
    const float(&matrix)[16] = *from.worldToShadow;
    PelWideShadow to{};
    to.light = index;
    std::copy_n(matrix, 16, to.worldToShadow);
    to.projection = l.shadowProjection;
    to.depthA = l.shadowDepthA;
    to.depthB = l.shadowDepthB;
    to.depthRange = from.depthRange;
    to.exponent = float(l.shadowExponent / std::log(2.0));
    if (l.shadowExponent != 0) to.perExponent = float(std::log(2.0) / l.shadowExponent);
    to.minDeviation = l.shadowMinDeviation;
    to.bleeding = l.shadowBleeding;
    to.bias = l.shadowBias;
    to.softness = l.shadowSoftness;
    to.coneSlope = l.shadowConeSlope;
    to.maxTexels = float(l.shadowFilterTexels);
    to.cascades = l.shadowCascades;
    to.map = describeImage(*from.map);
    to.out = describeImage(light.images[PEL_LIGHT_WIDE_SHADOW]);
    if (isCube(l)) return to;
    const auto row = [&](int r) { return threeAt(matrix + 4 * r); };
    const bool perspective = l.shadowProjection == PEL_SHADOW_PERSPECTIVE;
    const double w = perspective ? length(row(3)) : matrix[15];
    // Along a ray of the light u and v do not change; across it they grow by 1 / extent per length.
    Three forward = perspective ? 1 / w * row(3) : cross(row(0), row(1));
    if (!perspective) {
        const double sign = dot(row(2), forward) * w * from.depthRange < 0 ? -1 : 1;
        forward = sign / length(forward) * forward;
        to.zPerLength = float(dot(row(2), forward) / w);
    }
    const Three right = row(0) - dot(row(0), forward) * forward,
                down = row(1) - dot(row(1), forward) * forward;
    const double u = length(right), v = length(down), skew = dot(right, down) / (u * v);
    if (!(u > 0 && v > 0 && std::isfinite(length(forward)) && std::abs(skew) < 0.999 &&
          (perspective || to.zPerLength != 0)))
        invalidArgument("PelLight ", index,
                        cascade ? text(".cascadeToShadow[", cascade - 1, "]") : ".worldToShadow",
                        " is singular: a wide shadow cannot be filtered from its shadow map");
    std::ranges::copy(1 / u * right, to.right);
    std::ranges::copy(1 / v * down, to.down);
    std::ranges::copy(forward, to.forward);
    to.extent[0] = float(std::abs(w) / u);
    to.extent[1] = float(std::abs(w) / v);
    to.centre[0] = float(dot(row(0), forward) / w);
    to.centre[1] = float(dot(row(1), forward) / w);
    return to;
}

class WideShadow final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) { return plan.features & PEL_FEATURE_FILTER_SHADOW; }

    PassScratch scratch(const ShaderPlan& plan) const override {
        const bool between = std::ranges::any_of(plan.filteredLights,
                                                 [&](uint32_t light) { return interpolates(plan, light); });
        return {plan.filteredLights.size() * sizeof(float), 0, between ? PEL_BETWEEN_ROWS : 0u};
    }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        const ImageView& frame = plan.state.images[PEL_SLOT_RADIANCE];
        const size_t lightBytes = size_t(frame.width) * plan.scratchRows() * sizeof(float);
        const auto slot = [&](size_t k) -> ImageView& {
            return plan.state.lights[plan.filteredLights[k]].images[PEL_LIGHT_WIDE_SHADOW];
        };
        const size_t lights = plan.filteredLights.size();
        for (size_t k = 0; k < lights; ++k) slot(k) = ImageView();
        resize(images_, device, lights * lightBytes);
        for (size_t k = 0; k < lights; ++k)
            slot(k) = scratchImage(images_, frame, PEL_FORMAT_R32F, k * lightBytes);
    }
    size_t bytes() const override { return (images_ ? images_->bytes() : 0) + constants_.bytes(); }

    std::vector<cl::ProgramKey> programs(const Device& device, const ShaderPlan& plan) const override {
        return {wideShadowKey(device, plan)};
    }

    size_t upload(Device& device, ShaderPlan& plan) override {
        std::vector<PelWideShadow> maps(plan.filteredLights.size() * PEL_CASCADES);
        for (size_t k = 0; k < plan.filteredLights.size(); ++k) {
            const uint32_t index = plan.filteredLights[k];
            const ShaderLight& light = plan.state.lights[index];
            for (uint32_t i = 0; i < cascadesOf(light); ++i)
                maps[k * PEL_CASCADES + i] = describeWideShadow(light, index, i);
        }
        for (const BoundedMap& map : plan.boundedMaps) maps[map.index()].bounds = map.offset;
        const size_t bytes = constants_.update(device, maps);
        plan.wideShadows = constants_.memory();
        return bytes;
    }
    void moveScratch(Device& device, const ShaderPlan& plan, const ShadingConstants& constants,
                     uint32_t row) override {
        for (size_t k = 0; k < plan.filteredLights.size(); ++k) {
            const uint32_t index = plan.filteredLights[k];
            const ImageView& view = plan.state.lights[index].images[PEL_LIGHT_WIDE_SHADOW];
            moveImage(device, constants.lights().get(),
                      index * sizeof(PelShadeLight) + offsetof(PelShadeLight, wide), view, row);
            moveImage(device, constants_.memory().get(),
                      k * PEL_CASCADES * sizeof(PelWideShadow) + offsetof(PelWideShadow, out), view, row);
        }
    }

    void enqueueAround(PassWork& work) override { filter(work, true, PEL_PIXELS_SECOND); }
    void enqueue(PassWork& work) override {
        filter(work, true, PEL_PIXELS_BETWEEN);
        filter(work, false, PEL_PIXELS_ALL);
    }

  private:
    // Sharp shadows are not interpolated.
    static bool interpolates(const ShaderPlan& plan, uint32_t light) {
        return plan.interpolates() && filtersWide(plan.state, plan.state.lights[light]);
    }

    // Filters the lights that interpolate, or the others: one launch for consecutive lights.
    void filter(PassWork& work, bool interpolating, cl_uint pixels) const {
        const ShaderPlan& plan = work.plan;
        const auto takes = [&](size_t k) {
            return interpolates(plan, plan.filteredLights[k]) == interpolating;
        };
        const size_t lights = plan.filteredLights.size();
        for (size_t first = 0, end; first < lights; first = end + 1) {
            for (end = first; end < lights && takes(end);) ++end;
            if (end == first) continue;
            cl::Launch launch(program(), "wide_shadow", work.constants.frameMemory(),
                              work.constants.materials(), work.constants.lights(), plan.tileLists,
                              plan.counters);
            for (PelImageSlot slot :
                 {PEL_SLOT_MATERIAL, geometricNormalSlot(plan.state), PEL_SLOT_POSITION, PEL_SLOT_DEPTH})
                launch.arg(plan.state.images[slot]);
            launch.args(constants_.memory(), cl_uint(first), plan.bounds, images_->memory(), pixels);
            lightBufferArguments(launch, work.constants.lightBuffers());
            cl::Range range = tileRange(work.device, work.tiles());
            range.items[2] = end - first;
            work.launch(launch, range);
        }
    }

    Ref<Buffer> images_;  // of one light after another
    CachedUpload constants_;
};

// Number of blocks of PEL_BOUNDS_BLOCK texels.
uint32_t blocks(uint32_t texels) {
    return (texels + PEL_BOUNDS_BLOCK - 1) / PEL_BOUNDS_BLOCK;
}

// Bounds of the blocks of shadow maps, which decide most wide shadows without reading texels.
class ShadowBounds final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) {
        return std::ranges::any_of(plan.filteredLights,
                                   [&](uint32_t light) { return isBounded(plan, plan.state.lights[light]); });
    }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        plan.boundedMaps.clear();
        uint64_t floats = 0;
        for (size_t k = 0; k < plan.filteredLights.size(); ++k) {
            const ShaderLight& light = plan.state.lights[plan.filteredLights[k]];
            if (!isBounded(plan, light)) continue;
            for (uint32_t i = 0; i < cascadesOf(light); ++i) {
                const ImageView& map = *shadowCascade(light, i).map;
                const uint32_t columns = blocks(map.width), rows = blocks(map.height);
                plan.boundedMaps.push_back({uint32_t(k), i, (columns + 1) / 2 * rows, uint32_t(floats)});
                floats += 4 * uint64_t(columns) * rows;
            }
        }
        if (floats > UINT32_MAX)  // kernels count them with 32 bits
            fail(PEL_ERROR_UNSUPPORTED, "the filtered shadow maps of ", plan.filteredLights.size(),
                 " lights are too large together: they have ", floats, " bounds of depths, at most ",
                 UINT32_MAX, " are supported");
        plan.bounds = cl::Memory();
        MapsKey key("shadow_bounds");
        for (const BoundedMap& map : plan.boundedMaps)
            key.addMap(plan.state.lights[plan.filteredLights[map.filtered]], map.cascade);
        // One vector more, since the last row's vectors reach beyond its end.
        bounds_.allocate(device, std::move(key), (floats + device->info().mathWidth) * sizeof(float));
        plan.bounds = bounds_.memory();
    }
    size_t bytes() const override { return bounds_.bytes(); }

    std::vector<cl::ProgramKey> programs(const Device& device, const ShaderPlan& plan) const override {
        return {wideShadowKey(device, plan)};
    }

    void enqueueAround(PassWork& work) override {
        if (bounds_.made()) return;
        for (const BoundedMap& map : work.plan.boundedMaps) {
            const ShaderLight& light = work.plan.state.lights[work.plan.filteredLights[map.filtered]];
            cl::Launch launch(program(), "shadow_bounds", work.constants.frameMemory(), work.plan.tileLists,
                              work.plan.wideShadows, cl_uint(map.index()),
                              *shadowCascade(light, map.cascade).map, bounds_.memory(),
                              cl_uint(bounds_.isShared()));
            work.launch(launch, {{map.pairs, 1, 1}, {launchPolicy(work.device).texels, 1, 1}});
        }
        bounds_.setMade(work);
    }

  private:
    static bool isBounded(const ShaderPlan& plan, const ShaderLight& light) {
        return !plan.state.options.disableSkipping && !isCube(light.params) && filtersWide(plan.state, light);
    }

    KeptMaps bounds_;
};

}  // namespace

constinit const PassKind wideShadowPass = passKind<WideShadow>("wide_shadow");
constinit const PassKind shadowBoundsPass = passKind<ShadowBounds>("shadow_bounds");

}  // namespace pel
