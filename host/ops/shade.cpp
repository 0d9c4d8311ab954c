// Commit and execution of a PelShader: programs, scratch memory, launches, stats.
#include "ops/shader.h"

#include <algorithm>
#include <bit>
#include <set>

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
                                   PEL_FEATURE_AMBIENT_CUBE | PEL_FEATURE_SHADOW_CUBE | PEL_FEATURE_SHADOW_CASCADES;
// Those that a material asks for (materialNeeds); the others hold for all of a frame.
constexpr uint32_t materialFeatures = PEL_FEATURE_DIRECT_SCATTER | PEL_FEATURE_SHADOW_LUT | PEL_FEATURE_DEEP_SCATTER |
                                      PEL_FEATURE_THICKNESS_TAPS | PEL_FEATURE_SPECULAR | PEL_FEATURE_GGX |
                                      PEL_FEATURE_AMBIENT_SCATTER;
static_assert(PEL_BIT_GGX == PEL_FEATURE_GGX && PEL_BIT_AMBIENT_SCATTER == PEL_FEATURE_AMBIENT_SCATTER &&
              PEL_BIT_AMBIENT_CUBE == PEL_FEATURE_AMBIENT_CUBE && PEL_BIT_SHADOW_CUBE == PEL_FEATURE_SHADOW_CUBE &&
              PEL_BIT_SHADOW_CASCADES == PEL_FEATURE_SHADOW_CASCADES);
static_assert(PEL_MAP_CUBE == PEL_SHADOW_CUBE && PEL_MAP_CUBE_RADIAL == PEL_SHADOW_CUBE_RADIAL &&
              PEL_CONTENT_MOMENTS == PEL_SHADOW_CONTENT_MOMENTS && PEL_CONTENT_EXPONENTIAL == PEL_SHADOW_CONTENT_EXPONENTIAL);
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

// Tiles that a work-item of the classification takes: runs on a CPU, one each on a GPU, which has thousands of work-items.
uint32_t classifyRun(const Device& device) {
    if (device.info().mathWidth == 1) return 1;
    // Long runs stay in order, which prefetchers follow; a few for each unit keep all of them busy.
    return std::bit_floor(std::clamp(4096 / std::max(device.info().computeUnits, 1u), 64u, 2048u));
}
uint32_t classifyGroup(const Device& device) {
    return device.info().mathWidth > 1 ? 1 : 64;
}

// A caller who listens is asked at least this often whether to go on: some tens of milliseconds on two cores.
constexpr uint64_t pixelsPerPart = 1 << 20;

// Slots that no feature reads are left out: fewer variants, and no input that cannot matter.
bool slotIsRead(const ShaderState& state, int slot, uint32_t features) {
    switch (slot) {
        case PEL_SLOT_POSITION:
            return features & (PEL_BIT_SPECULAR | PEL_BIT_THICKNESS_TAPS | PEL_BIT_POSITIONAL);
        case PEL_SLOT_DEPTH:
            return !state.images[PEL_SLOT_POSITION] && slotIsRead(state, PEL_SLOT_POSITION, features);
        case PEL_SLOT_NORMAL_BLURRED:
            return features & (PEL_BIT_DIRECT_SCATTER | PEL_BIT_AMBIENT | PEL_BIT_DEEP_SCATTER | PEL_BIT_AMBIENT_SCATTER);
        case PEL_SLOT_NORMAL_GEOMETRIC:
            return (!state.images[PEL_SLOT_NORMAL_BLURRED] && slotIsRead(state, PEL_SLOT_NORMAL_BLURRED, features)) ||
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

}  // namespace

cl::ProgramKey shadeKey(const ShaderState& state, uint32_t features, const Device& device) {
    features &= shadeFeatures;
    if (!(features & PEL_BIT_THICKNESS_TAPS)) features &= ~uint32_t(PEL_BIT_SHADOW_CUBE | PEL_BIT_SHADOW_CASCADES);
    if (state.options.accumulate) features |= PEL_BIT_ACCUMULATE;
    if (state.options.disableSkipping) features |= PEL_BIT_NO_SKIPPING;
    if (state.options.countPixels) features |= PEL_BIT_COUNT;
    if (state.options.rotateTaps && features & PEL_BIT_THICKNESS_TAPS) features |= PEL_BIT_ROTATE_TAPS;
    if (features & PEL_BIT_AMBIENT_CUBE && isBlack(state.ambient)) features |= PEL_BIT_CUBE_ALONE;
    uint32_t wide = 0, map = 0, content = 0;
    for (const ShaderLight& light : state.lights) {
        if (light.params.type != PEL_LIGHT_DIRECTIONAL) features |= PEL_BIT_POSITIONAL;
        wide |= formatCode(light.images[PEL_LIGHT_WIDE_SHADOW], device.info().mathWidth);
        if (!light.images[PEL_LIGHT_SHADOW_MAP]) continue;
        map |= mapFormatCode(light);
        content = light.params.shadowContent;
    }
    if (!(features & PEL_BIT_THICKNESS_TAPS)) map = content = 0;
    cl::Defines defines{
        {"PEL_FEATURES", std::to_string(features)},
        {"PEL_SHADE_GROUP", std::to_string(shadeGroup(device))},
        {"PEL_CLASSIFY_GROUP", std::to_string(classifyGroup(device))},
        {"PEL_CLASSIFY_RUN", std::to_string(classifyRun(device))},
        {"PEL_FORMAT_WIDE_SHADOW", std::to_string(wide)},
        {"PEL_FORMAT_SHADOW_MAP", std::to_string(map)},
        {"PEL_SHADOW_CONTENT", std::to_string(content)}};
    for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot) {
        if (!isShadeSlot(slot)) continue;
        const uint32_t code =
            slotIsRead(state, slot, features) ? formatCode(state.images[slot], device.info().mathWidth) : 0;
        defines[formatDefines[slot]] = std::to_string(code);
    }
    cl::ProgramKey key{{"shade.cl"}, defines};
    // In one program: a driver's cost per program is what a first frame waits for.
    if (state.images[PEL_SLOT_MATERIAL]) key.files.push_back("classify_tiles.cl");
    return key;
}

uint32_t shadeGroup(const Device& device) {
    return device.info().mathWidth > 1 ? 1 : 64;
}

uint32_t formatCode(const ImageView& view, uint32_t mathWidth) {
    if (!view) return 0;
    const bool vectors = view.tightlyPacked() && view.width >= mathWidth;
    return uint32_t(view.format) | (vectors ? 0 : PEL_FMT_STRIDED);
}

uint32_t mapFormatCode(const ShaderLight& light) {
    uint32_t code = formatCode(light.images[PEL_LIGHT_SHADOW_MAP], 1);
    for (uint32_t i = 1; i < light.params.shadowCascades; ++i) code |= formatCode(*shadowCascade(light, i).map, 1);
    return code;
}

cl::Range tileRange(const Device& device, uint32_t tiles) {
    const size_t group = shadeGroup(device);
    const size_t groups = std::min<size_t>(tiles, 64 * size_t(device.info().computeUnits));
    return {{groups * group, 1, 1}, {group, 1, 1}};
}

std::vector<uint32_t> variantFeatures(const ShaderState& state, uint32_t features) {
    std::vector<uint32_t> variants{features};
    // What else is written must not depend on the variant; and tests want every term everywhere.
    if (!state.images[PEL_SLOT_MATERIAL] || state.options.tileLists != PEL_TILES_PER_VARIANT || state.options.disableSkipping ||
        features & PEL_FEATURE_OUTPUTS)
        return variants;
    std::set<uint32_t> needed;
    for (const auto& [id, material] : state.materials) needed.insert(materialNeeds(state, material));
    std::vector<uint32_t> partial;
    for (const uint32_t needs : needed) {
        const uint32_t left = (features & ~materialFeatures) | needs;
        // Another variant pays where it spares a term of its own (docs/shading.md, "Tiles").
        if ((features & ~left) & (PEL_FEATURE_DIRECT_SCATTER | PEL_FEATURE_SPECULAR | PEL_FEATURE_DEEP_SCATTER)) partial.push_back(left);
    }
    std::ranges::stable_sort(partial, std::greater{}, [](uint32_t f) { return std::popcount(f); });
    // The cheapest ones.
    const size_t most = PEL_TILE_VARIANTS - 1;
    if (partial.size() > most) partial.erase(partial.begin(), partial.end() - ptrdiff_t(most));
    variants.insert(variants.end(), partial.begin(), partial.end());
    return variants;
}

uint32_t Shader::tileRows() const {
    return tables_.frame().tilesX ? tables_.frame().tiles / tables_.frame().tilesX : 0;
}

void Shader::commit() {
    plan(UINT32_MAX);
}

void Shader::plan(uint32_t mostRows) {
    const uint32_t features = deriveFeatures(state_);
    Device& device = *device_;
    // Old images go before new ones are made: both together would not keep to a budget.
    committed_ = false;
    ShadePasses passes = std::exchange(passes_, ShadePasses());
    ShaderState plan = passes.plan(device_, state_, features, mostRows);
    const std::vector<uint32_t> variants = variantFeatures(plan, features);
    const uint32_t before = device.programs().counts().built;
    std::vector<cl::Program> programs;
    for (const uint32_t variant : variants) programs.push_back(device.programs().get(shadeKey(plan, variant, device)));
    passes.build(device, plan, features);
    cube_.prepare(device, state_.ambientCube);
    programsBuilt_ += device.programs().counts().built - before;
    const ImageView& frame = state_.images[PEL_SLOT_RADIANCE];
    const uint32_t tilesX = (frame.width + PEL_TILE_WIDTH - 1) / PEL_TILE_WIDTH,
                   rows = (frame.height + PEL_TILE_HEIGHT - 1) / PEL_TILE_HEIGHT;
    const uint32_t listTiles = tilesX * std::min(rows, passes.bandRows() + 2 * passes.haloRows());
    bytesUploaded_ += tables_.update(device, plan, variants, listTiles) + passes.upload(device, plan);
    const size_t lists = variants.size() > 1 ? 1 + variants.size() : 1;
    const size_t listBytes =
        state_.images[PEL_SLOT_MATERIAL] ? (PEL_TILE_LISTS + lists * size_t(listTiles)) * sizeof(cl_uint) : 0;
    if (listBytes != tileListBytes_) {
        tileListBytes_ = 0;
        tileLists_ = listBytes ? device.allocate(listBytes) : cl::Memory();
        tileListBytes_ = listBytes;
    }
    if (!counters_ && state_.options.countPixels) counters_ = device.allocate(PEL_COUNTERS * sizeof(cl_uint));
    plan_ = std::move(plan);
    passes_ = std::move(passes);
    variants_ = variants;
    shadePrograms_ = std::move(programs);
    features_ = features;
    committed_ = true;
}

// Less at a time. Returns false when that is not possible.
bool Shader::halveBand() {
    const uint32_t rows = std::min(passes_.bandRows(), tileRows());
    if (!passes_.any() || rows <= 1) return false;
    device_->finish();
    committed_ = false;
    plan_ = passes_.plan(device_, state_, features_, rows / 2);
    bytesUploaded_ += tables_.update(*device_, plan_, variants_, tables_.frame().listTiles) + passes_.upload(*device_, plan_);
    committed_ = true;
    return true;
}

void Shader::execute(bool blocking) {
    if (!committed_)
        fail(PEL_ERROR_INVALID_STATE,
             "something was set after the last pelShaderCommit, or nothing was committed yet");
    events_.clear();
    bands_ = 0;
    if (state_.options.countPixels) device_->fill(counters_.get(), 0, PEL_COUNTERS * sizeof(cl_uint), 0);
    cube_.enqueue(*device_, state_.ambientCube, events_);
    const bool tell = blocking && device_->hasProgress();
    const uint32_t end = tileRows();
    for (uint32_t row = 0; row < end;) {
        const Rows rows{row, row + std::min(passes_.bandRows(), end - row)};
        bool begun = false;
        try {
            shadeRows(rows, tell, begun);
        } catch (const Error& e) {
            // Drivers may find out only now that memory does not suffice. Pixels that are shaded already stay as they are:
            // where radiance lies over an input they could not be shaded again.
            if (e.code() != PEL_ERROR_OUT_OF_MEMORY || begun || !halveBand()) throw;
            continue;
        }
        row = rows.end;
        ++bands_;
    }
    if (tell) device_->progress(1, "shading");
    launches_ = events_.size();
    uploadedBefore_ = std::exchange(bytesUploaded_, 0);
    executed_ = true;
}

void Shader::addPrefillJobs(std::vector<std::function<void()>>& jobs) const {
    const uint32_t features = deriveFeatures(state_);
    const Ref<Device> device = device_;
    const ShaderState plan = ShadePasses().plan(device, state_, features, 1);
    for (const uint32_t variant : variantFeatures(plan, features))
        jobs.push_back([device, key = shadeKey(plan, variant, *device)] { device->programs().get(key); });
    Ref<Shader> shader = make<Shader>(device);
    shader->state_ = state_;
    jobs.push_back([shader] {
        shader->plan(1);
        shader->launchOnNothing();
    });
}

// Every kernel that an execution launches, but in a frame of no tiles.
void Shader::launchOnNothing() {
    events_.clear();
    if (state_.options.countPixels) device_->fill(counters_.get(), 0, PEL_COUNTERS * sizeof(cl_uint), 0);
    const Rows one{0, 1};
    cube_.enqueue(*device_, state_.ambientCube, events_);
    tables_.setBand(*device_, 0, 0, 0);
    enqueueTiles(one);
    passes_.prepare(*device_, plan_, tables_, tileLists_, 1, events_);
    passes_.enqueue(*device_, plan_, tables_, tileLists_, counters_, 1, events_);
    for (uint32_t variant = 0; variant < variants_.size(); ++variant) enqueueShade(variant, one, 0, 1);
    device_->finish();
}

void Shader::setRows(Rows rows, uint32_t scratchRow) {
    const uint32_t tilesX = tables_.frame().tilesX;
    tables_.setBand(*device_, rows.begin * tilesX, (rows.end - rows.begin) * tilesX, scratchRow);
}

// A band: its tiles are listed, the passes make what it needs, and it is shaded. `begun`: pixels may have been written.
void Shader::shadeRows(Rows rows, bool tell, bool& begun) {
    const uint32_t tilesX = tables_.frame().tilesX, end = tileRows(), halo = passes_.haloRows();
    const Rows around{rows.begin - std::min(rows.begin, halo), std::min(rows.end + halo, end)};
    const uint32_t scratchRow = around.begin * PEL_TILE_HEIGHT;
    const bool whole = rows.begin == 0 && rows.end == end;
    passes_.moveScratch(*device_, plan_, tables_, scratchRow);
    setRows(around, scratchRow);
    enqueueTiles(around);
    passes_.prepare(*device_, plan_, tables_, tileLists_, (around.end - around.begin) * tilesX, events_);
    if (around.begin != rows.begin || around.end != rows.end) {
        setRows(rows, scratchRow);
        enqueueTiles(rows);
    }
    if (!whole && tileListBytes_) {
        const size_t bytes = PEL_TILE_LISTS * sizeof(cl_uint);
        if (bandCountBytes_ < end * bytes) {
            bandCounts_ = device_->allocate(end * bytes);
            bandCountBytes_ = end * bytes;
        }
        cl::check(clEnqueueCopyBuffer(device_->queue(), tileLists_.get(), bandCounts_.get(), 0, bands_ * bytes, bytes, 0, nullptr,
                                      nullptr),
                  "clEnqueueCopyBuffer");
    }
    const uint32_t tiles = (rows.end - rows.begin) * tilesX;
    passes_.enqueue(*device_, plan_, tables_, tileLists_, counters_, tiles, events_);
    const uint32_t parts = tell ? uint32_t(1 + uint64_t(tiles) * PEL_TILE_PIXELS / pixelsPerPart) : 1;
    for (uint32_t part = 0; part < parts; ++part) {
        if (tell) {
            device_->finish();
            device_->progress((rows.begin + double(rows.end - rows.begin) * part / parts) / end, "shading");
        }
        for (uint32_t variant = 0; variant < variants_.size(); ++variant) {
            enqueueShade(variant, rows, part, parts);
            begun = true;
        }
    }
    if (tell) device_->finish();
}

void Shader::enqueueTiles(Rows rows) {
    const bool several = variants_.size() > 1, listAll = !several || passes_.any();
    if (!tileListBytes_ || (state_.options.tileLists == PEL_TILES_NO_LIST && !passes_.any())) return;
    device_->fill(tileLists_.get(), 0, PEL_TILE_LISTS * sizeof(cl_uint), 0);
    cl::Launch launch(shadePrograms_[0], "classify_tiles");
    launch.arg(tables_.frameMemory()).arg(tables_.materials()).arg(state_.images[PEL_SLOT_MATERIAL].buffer->memory());
    launch.arg(tileLists_).arg(cl_uint(variants_.size())).arg(cl_uint(listAll));
    const size_t tiles = size_t(rows.end - rows.begin) * tables_.frame().tilesX;
    const size_t run = classifyRun(*device_);
    events_.push_back(device_->launch(launch, {{(tiles + run - 1) / run, 1, 1}, {classifyGroup(*device_), 1, 1}}));
}

void Shader::enqueueShade(uint32_t variant, Rows rows, uint32_t part, uint32_t parts) {
    cl::Launch launch(shadePrograms_[variant], "shade");
    launch.arg(tables_.frameMemory()).arg(tables_.materials()).arg(tables_.lights()).arg(tables_.luts());
    launch.arg(tileLists_).arg(counters_);
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
    const uint32_t list = variants_.size() > 1 ? 1 + variant : 0;
    launch.arg(cl_uint(part)).arg(cl_uint(parts));
    launch.arg(cl_uint(state_.options.tileLists == PEL_TILES_NO_LIST ? PEL_EVERY_TILE : list));
    // Groups take tiles in turn, so that no host waits for their count.
    const uint32_t tiles = (rows.end - rows.begin) * tables_.frame().tilesX;
    events_.push_back(device_->launch(launch, tileRange(*device_, tiles)));
}

PelShaderStats Shader::stats() {
    device_->finish();
    PelShaderStats stats = pelShaderStatsDefaults();
    stats.features = features_;
    stats.programsBuilt = programsBuilt_;
    stats.scratchBytes =
        tables_.scratchBytes() + passes_.scratchBytes() + cube_.scratchBytes() + tileListBytes_ + bandCountBytes_ +
        (counters_ ? PEL_COUNTERS * sizeof(cl_uint) : 0);
    if (!executed_) return stats;
    stats.launches = launches_;
    stats.bytesUploaded = uploadedBefore_;
    stats.tilesTotal = stats.tilesShaded = tables_.frame().tiles;
    stats.pixelsTotal = uint64_t(tables_.frame().width) * tables_.frame().height;
    stats.bands = bands_;
    stats.variants = variants_.size();
    if (tileListBytes_ && committed_ && (state_.options.tileLists != PEL_TILES_NO_LIST || passes_.any())) {
        std::vector<cl_uint> counts(std::max<size_t>(bands_, 1) * PEL_TILE_LISTS);
        device_->read(bands_ > 1 ? bandCounts_.get() : tileLists_.get(), 0, counts.size() * sizeof(cl_uint), counts.data(), true);
        stats.tilesShaded = 0;
        for (size_t i = 0; i < counts.size(); ++i) {
            const size_t list = i % PEL_TILE_LISTS;
            if (variants_.size() > 1 ? list > 0 : list == 0) stats.tilesShaded += counts[i];
            if (list > 1) stats.tilesPartial += counts[i];
        }
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
        stats.pixelsShadowTexels = counts[PEL_COUNT_SHADOW_TEXELS];
    }
    for (const cl::Event& event : events_) stats.deviceMilliseconds += eventMilliseconds(event);
    return stats;
}

}  // namespace pel
