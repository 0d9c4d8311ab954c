// Commit and execution of a PelShader: scratch memory, launches, stats.
#include "shading/shader.h"

#include <algorithm>

#include "shared/features.h"

namespace pel {

// A caller who listens is asked at least this often whether to go on: some tens of milliseconds on two cores.
static constexpr uint64_t pixelsPerPart = 1 << 20;

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
    events_.push_back(device_->launch(launch, classifyRange(*device_, tiles)));
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
