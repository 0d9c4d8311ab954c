// Commit and execution of a PelShader: programs, scratch memory, launches, stats.
#include "ops/shader.h"

#include <algorithm>

#include "shared/features.h"

namespace pel {
namespace {

static_assert(PEL_BIT_DIRECT_SCATTER == PEL_FEATURE_DIRECT_SCATTER && PEL_BIT_SHADOW == PEL_FEATURE_SHADOW &&
              PEL_BIT_SHADOW_LUT == PEL_FEATURE_SHADOW_LUT && PEL_BIT_AMBIENT == PEL_FEATURE_AMBIENT &&
              PEL_BIT_DEEP_SCATTER == PEL_FEATURE_DEEP_SCATTER &&
              PEL_BIT_THICKNESS_TAPS == PEL_FEATURE_THICKNESS_TAPS &&
              PEL_BIT_SPECULAR == PEL_FEATURE_SPECULAR);
// What the passes before it do does not make another variant of the shading kernel.
constexpr uint32_t shadeFeatures = (PEL_FEATURE_SPECULAR * 2 - 1) | PEL_FEATURE_GGX | PEL_FEATURE_AMBIENT_SCATTER |
                                   PEL_FEATURE_AMBIENT_CUBE;
static_assert(PEL_BIT_GGX == PEL_FEATURE_GGX && PEL_BIT_AMBIENT_SCATTER == PEL_FEATURE_AMBIENT_SCATTER &&
              PEL_BIT_AMBIENT_CUBE == PEL_FEATURE_AMBIENT_CUBE);
static_assert(PEL_IMAGE_OUT_DIFFUSE == PEL_SLOT_OUT_DIFFUSE && PEL_IMAGE_OUT_DEEP_SCATTER == PEL_SLOT_OUT_DEEP_SCATTER &&
              PEL_IMAGE_OUT_SPECULAR == PEL_SLOT_OUT_SPECULAR && PEL_IMAGE_OUT_THICKNESS == PEL_SLOT_OUT_THICKNESS);

// Whether the shading kernel itself reads or writes a slot.
bool isShadeSlot(int slot) {
    return slot < PEL_SHADE_SLOTS || slot >= PEL_SLOT_OUT_DIFFUSE;
}
static_assert(PEL_FMT_R32F == PEL_FORMAT_R32F && PEL_FMT_RGBA16F == PEL_FORMAT_RGBA16F &&
              PEL_FMT_R8_UNORM == PEL_FORMAT_R8_UNORM && PEL_FMT_RGBA8_SRGB == PEL_FORMAT_RGBA8_SRGB &&
              PEL_FMT_OCT16X2_SNORM == PEL_FORMAT_OCT16X2_SNORM && PEL_FMT_R8_UINT == PEL_FORMAT_R8_UINT &&
              PEL_FMT_PLANAR_RGB32F == PEL_FORMAT_PLANAR_RGB32F);
static_assert(PEL_IMAGE_RADIANCE == PEL_SLOT_RADIANCE && PEL_IMAGE_MATERIAL == PEL_SLOT_MATERIAL &&
              PEL_IMAGE_POSITION == PEL_SLOT_POSITION && PEL_IMAGE_DEPTH == PEL_SLOT_DEPTH &&
              PEL_IMAGE_NORMAL_GEOMETRIC == PEL_SLOT_NORMAL_GEOMETRIC &&
              PEL_IMAGE_NORMAL_SHADING == PEL_SLOT_NORMAL_SHADING &&
              PEL_IMAGE_NORMAL_BLURRED == PEL_SLOT_NORMAL_BLURRED &&
              PEL_IMAGE_CURVATURE == PEL_SLOT_CURVATURE && PEL_IMAGE_ALBEDO == PEL_SLOT_ALBEDO &&
              PEL_IMAGE_AMBIENT_OCCLUSION == PEL_SLOT_AMBIENT_OCCLUSION &&
              PEL_IMAGE_THICKNESS == PEL_SLOT_THICKNESS && PEL_IMAGE_ROUGHNESS == PEL_SLOT_ROUGHNESS &&
              PEL_IMAGE_SPECULAR == PEL_SLOT_SPECULAR && PEL_IMAGE_UV == PEL_SLOT_UV &&
              PEL_IMAGE_UV_GRADIENT == PEL_SLOT_UV_GRADIENT && PEL_IMAGE_TANGENT == PEL_SLOT_TANGENT &&
              PEL_IMAGE_SLOTS == PEL_SLOT_COUNT);

constexpr const char* formatDefines[PEL_SLOT_COUNT] = {
    "PEL_FORMAT_RADIANCE",         "PEL_FORMAT_MATERIAL",
    "PEL_FORMAT_POSITION",         "PEL_FORMAT_DEPTH",
    "PEL_FORMAT_NORMAL_GEOMETRIC", "PEL_FORMAT_NORMAL_SHADING",
    "PEL_FORMAT_NORMAL_BLURRED",   "PEL_FORMAT_CURVATURE",
    "PEL_FORMAT_ALBEDO",           "PEL_FORMAT_AMBIENT_OCCLUSION",
    "PEL_FORMAT_THICKNESS",        "PEL_FORMAT_ROUGHNESS",
    "PEL_FORMAT_SPECULAR",         "PEL_FORMAT_UV",
    "PEL_FORMAT_UV_GRADIENT",      "PEL_FORMAT_TANGENT",
    "PEL_FORMAT_OUT_DIFFUSE",      "PEL_FORMAT_OUT_DEEP_SCATTER",
    "PEL_FORMAT_OUT_SPECULAR",     "PEL_FORMAT_OUT_THICKNESS"};

constexpr uint32_t classifyGroup = 16;

// A caller who listens is asked at least this often whether to go on: some tens of milliseconds on two cores.
constexpr uint64_t pixelsPerPart = 1 << 20;

// Slots that no feature reads are left out: fewer variants, and no input that cannot matter.
bool slotIsRead(const ShaderState& state, int slot, uint32_t features) {
    switch (slot) {
        case PEL_SLOT_POSITION:
            return features & (PEL_BIT_SPECULAR | PEL_BIT_THICKNESS_TAPS | PEL_BIT_POSITIONAL);
        case PEL_SLOT_DEPTH:
            return !state.images[PEL_SLOT_POSITION] && slotIsRead(state, PEL_SLOT_POSITION, features);
        case PEL_SLOT_NORMAL_GEOMETRIC:
            return !state.images[PEL_SLOT_NORMAL_BLURRED] ||
                   features & (PEL_BIT_SHADOW_LUT | PEL_BIT_THICKNESS_TAPS);
        case PEL_SLOT_CURVATURE:
            return features & PEL_BIT_DIRECT_SCATTER;
        case PEL_SLOT_AMBIENT_OCCLUSION:
            return features & PEL_BIT_AMBIENT;
        case PEL_SLOT_THICKNESS:
            return features & (PEL_BIT_DEEP_SCATTER | PEL_BIT_AMBIENT_SCATTER);
        case PEL_SLOT_ROUGHNESS:
        case PEL_SLOT_SPECULAR:
            return features & PEL_BIT_SPECULAR;
        default:
            return true;
    }
}

cl::Defines variant(const ShaderState& state, uint32_t features, const Device& device) {
    features &= shadeFeatures;
    if (state.options.accumulate) features |= PEL_BIT_ACCUMULATE;
    if (state.options.disableSkipping) features |= PEL_BIT_NO_SKIPPING;
    if (state.options.countPixels) features |= PEL_BIT_COUNT;
    if (state.options.rotateTaps && features & PEL_BIT_THICKNESS_TAPS) features |= PEL_BIT_ROTATE_TAPS;
    if (features & PEL_BIT_AMBIENT_CUBE && isBlack(state.ambient)) features |= PEL_BIT_CUBE_ALONE;
    uint32_t wide = 0, map = 0;
    for (const ShaderLight& light : state.lights) {
        if (light.params.type != PEL_LIGHT_DIRECTIONAL) features |= PEL_BIT_POSITIONAL;
        wide |= formatCode(light.images[PEL_LIGHT_WIDE_SHADOW], device.info().mathWidth);
        map |= formatCode(light.images[PEL_LIGHT_SHADOW_MAP], 1);
    }
    cl::Defines defines{
        {"PEL_FEATURES", std::to_string(features)},
        {"PEL_SHADE_GROUP", std::to_string(shadeGroup(device))},
        {"PEL_CLASSIFY_GROUP", std::to_string(classifyGroup)},
        {"PEL_FORMAT_WIDE_SHADOW", std::to_string(wide)},
        {"PEL_FORMAT_SHADOW_MAP", std::to_string(features & PEL_BIT_THICKNESS_TAPS ? map : 0)}};
    for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot) {
        if (!isShadeSlot(slot)) continue;
        const uint32_t code =
            slotIsRead(state, slot, features) ? formatCode(state.images[slot], device.info().mathWidth) : 0;
        defines[formatDefines[slot]] = std::to_string(code);
    }
    return defines;
}

}  // namespace

uint32_t shadeGroup(const Device& device) {
    return device.info().mathWidth > 1 ? 1 : 64;
}

uint32_t formatCode(const ImageView& view, uint32_t mathWidth) {
    if (!view) return 0;
    const bool vectors = view.tightlyPacked() && view.width >= mathWidth;
    return uint32_t(view.format) | (vectors ? 0 : PEL_FMT_STRIDED);
}

cl::Range tileRange(const Device& device, uint32_t tiles) {
    const size_t group = shadeGroup(device);
    const size_t groups = std::min<size_t>(tiles, 64 * size_t(device.info().computeUnits));
    return {{groups * group, 1, 1}, {group, 1, 1}};
}

void Shader::commit() {
    const uint32_t features = deriveFeatures(state_);
    Device& device = *device_;
    ShadePasses passes = passes_;
    ShaderState plan = passes.plan(device_, state_, features);
    const cl::Defines defines = variant(plan, features, device);
    const uint32_t before = device.programs().built();
    cl::Program shade = device.programs().get("shade.cl", defines), classify;
    if (state_.images[PEL_SLOT_MATERIAL])
        classify = device.programs().get(
            "classify_tiles.cl",
            {{"PEL_FORMAT_MATERIAL", defines.at("PEL_FORMAT_MATERIAL")},
             {"PEL_FEATURES", state_.options.disableSkipping ? text(PEL_BIT_NO_SKIPPING) : "0"},
             {"PEL_CLASSIFY_GROUP", text(classifyGroup)}});
    passes.build(device, plan, features);
    cube_.prepare(device, state_.ambientCube);
    programsBuilt_ += device.programs().built() - before;
    bytesUploaded_ += tables_.update(device, plan) + passes.upload(device, plan);
    const size_t listBytes = classify ? (1 + size_t(tables_.frame().tiles)) * sizeof(cl_uint) : 0;
    if (listBytes != tileListBytes_) {
        tileListBytes_ = 0;
        tileList_ = listBytes ? device.allocate(listBytes) : cl::Memory();
        tileListBytes_ = listBytes;
    }
    if (!counters_ && state_.options.countPixels) counters_ = device.allocate(PEL_COUNTERS * sizeof(cl_uint));
    plan_ = std::move(plan);
    passes_ = std::move(passes);
    shadeProgram_ = shade;
    classifyProgram_ = classify;
    features_ = features;
    committed_ = true;
}

void Shader::execute(bool blocking) {
    if (!committed_)
        fail(PEL_ERROR_INVALID_STATE,
             "something was set after the last pelShaderCommit, or nothing was committed yet");
    events_.clear();
    const cl_uint zero = 0;
    const auto clear = [&](const cl::Memory& memory, size_t bytes) {
        cl::check(clEnqueueFillBuffer(device_->queue(), memory.get(), &zero, sizeof zero, 0, bytes, 0,
                                      nullptr, nullptr),
                  "clEnqueueFillBuffer");
    };
    if (classifyProgram_) {
        clear(tileList_, sizeof zero);
        enqueueTiles();
    }
    if (state_.options.countPixels) clear(counters_, PEL_COUNTERS * sizeof zero);
    cube_.enqueue(*device_, state_.ambientCube, events_);
    passes_.enqueue(*device_, plan_, tables_, tileList_, counters_, events_);
    const uint64_t pixels = uint64_t(tables_.frame().width) * tables_.frame().height;
    const bool tell = blocking && device_->hasProgress();
    const uint32_t parts = tell ? uint32_t(1 + pixels / pixelsPerPart) : 1;
    for (uint32_t part = 0; part < parts; ++part) {
        if (tell) {
            device_->finish();
            device_->progress(double(part) / parts, "shading");
        }
        enqueueShade(part, parts);
    }
    if (tell) {
        device_->finish();
        device_->progress(1, "shading");
    }
    launches_ = events_.size();
    uploadedBefore_ = std::exchange(bytesUploaded_, 0);
    executed_ = true;
}

void Shader::enqueueTiles() {
    cl::Launch launch(classifyProgram_, "classify_tiles");
    launch.arg(tables_.frameMemory()).arg(state_.images[PEL_SLOT_MATERIAL].buffer->memory()).arg(tileList_);
    events_.push_back(device_->launch(launch, {{tables_.frame().tiles, 1, 1}, {classifyGroup, 1, 1}}));
}

void Shader::enqueueShade(uint32_t part, uint32_t parts) {
    cl::Launch launch(shadeProgram_, "shade");
    launch.arg(tables_.frameMemory()).arg(tables_.materials()).arg(tables_.lights()).arg(tables_.luts());
    launch.arg(tileList_).arg(counters_);
    for (int slot = 0; slot < PEL_SHADE_SLOTS; ++slot) {
        const ImageView& view = plan_.images[slot];
        launch.arg(view ? view.buffer->memory() : cl::Memory());
    }
    const auto& lightBuffers = tables_.lightBuffers();
    for (size_t i = 0; i < PEL_LIGHT_BUFFERS; ++i)
        launch.arg(i < lightBuffers.size() ? lightBuffers[i] : cl::Memory());
    for (int slot = PEL_SLOT_OUT_DIFFUSE; slot < PEL_SLOT_COUNT; ++slot) {
        const ImageView& view = plan_.images[slot];
        launch.arg(view ? view.buffer->memory() : cl::Memory());
    }
    launch.arg(cube_.nodes());
    launch.arg(cl_uint(part)).arg(cl_uint(parts));
    // Groups take tiles in turn, so that no host waits for their count.
    events_.push_back(device_->launch(launch, tileRange(*device_, tables_.frame().tiles)));
}

PelShaderStats Shader::stats() {
    device_->finish();
    PelShaderStats stats = pelShaderStatsDefaults();
    stats.features = features_;
    stats.programsBuilt = programsBuilt_;
    stats.scratchBytes =
        tables_.scratchBytes() + passes_.scratchBytes() + cube_.scratchBytes() + tileListBytes_ + (counters_ ? PEL_COUNTERS * sizeof(cl_uint) : 0);
    if (!executed_) return stats;
    stats.launches = launches_;
    stats.bytesUploaded = uploadedBefore_;
    stats.tilesTotal = stats.tilesShaded = tables_.frame().tiles;
    stats.pixelsTotal = uint64_t(tables_.frame().width) * tables_.frame().height;
    if (classifyProgram_ && committed_) {
        cl_uint shaded = 0;
        device_->read(tileList_.get(), 0, sizeof shaded, &shaded, true);
        stats.tilesShaded = shaded;
    }
    if (state_.options.countPixels && committed_) {
        cl_uint counts[PEL_COUNTERS];
        device_->read(counters_.get(), 0, sizeof counts, counts, true);
        stats.pixelsShaded = counts[PEL_COUNT_SHADED];
        stats.pixelsShadowLut = counts[PEL_COUNT_SHADOW_LUT];
        stats.pixelsThickness = counts[PEL_COUNT_THICKNESS];
        stats.pixelsSpecular = counts[PEL_COUNT_SPECULAR];
        stats.pixelsInvalid = counts[PEL_COUNT_INVALID];
        stats.pixelsWideShadow = counts[PEL_COUNT_WIDE_SHADOW];
    }
    for (const cl::Event& event : events_) stats.deviceMilliseconds += eventMilliseconds(event);
    return stats;
}

}  // namespace pel
