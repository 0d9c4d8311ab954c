// Commit and execution of a PelShader, and its statistics.
#include "shading/shader.h"

#include "core/image_substitutes.h"
#include "core/sized_memory.h"
#include "shading/background_build.h"
#include "shading/capture.h"
#include "shading/features.h"
#include "shading/image_slots.h"
#include "shading/shade_variants.h"
#include "shading/tap_cells.h"

namespace pel {
namespace {

void countTiles(ShaderPlan& plan) {
    const ImageView& frame = plan.state.images[PEL_SLOT_RADIANCE];
    plan.tilesX = (frame.width + PEL_TILE_WIDTH - 1) / PEL_TILE_WIDTH;
    plan.tileRows = (frame.height + PEL_TILE_HEIGHT - 1) / PEL_TILE_HEIGHT;
}

// `tooMany`: see chooseMethods(); `pixels`: keepToBudget().
ShaderPlan planOf(const ShaderState& given, uint32_t methods, uint64_t tooMany, const Ref<Device>& device,
                  uint64_t& pixels, ProfileTables& tables) {
    ShaderPlan plan;
    plan.state = inRegion(given);
    plan.warnings = chooseMethods(plan.state, methods, tooMany);
    if (given.options.timeBudget > 0)
        plan.taken = keepToBudget(plan.state, methods, *device, pixels, plan.warnings);
    withTables(plan.state, device, tables);
    const ShaderState& state = plan.state;
    plan.features = deriveFeatures(state);
    plan.variants = variantFeatures(state, plan.features);
    countTiles(plan);
    for (uint32_t i = 0; i < state.lights.size(); ++i)
        if (filtersShadow(state, state.lights[i])) plan.filteredLights.push_back(i);
    return plan;
}

// The plan of a frame with the same programs, on images of the library's own.
ShaderPlan onSubstitutes(ShaderPlan plan, const Ref<Device>& device) {
    ShaderState& state = plan.state;
    if (!mapCells(state).empty())  // coarse enough for a small frame
        for (auto& [id, material] : state.materials)
            material.params.thicknessFilterRadius = std::max(material.params.thicknessFilterRadius, 1.0f);
    ImageSubstitutes images;
    for (ImageView& view : state.images) images.add(view);
    for (ImageView* view : {&state.ambientCube, &state.reflectionCube, &state.environment}) images.add(*view);
    for (ShaderLight& light : state.lights)
        for (ImageView& view : light.images) images.add(view);
    for (auto& [id, material] : state.materials) {
        for (ImageView& level : material.normalMap) images.add(level);
        images.add(material.scatteredTexture);
        if (material.eye) images.add(material.eye->iris);
    }
    images.place(device);
    countTiles(plan);
    return plan;
}

}  // namespace

Shader::Shader(Ref<Device> device, std::span<const PassKind> passes)
    : Object(kind), device_(std::move(device)), passKinds_(passes) {}

Shader::~Shader() = default;

void Shader::commit() {
    uint64_t autoPixels = 0;
    const unsigned builders = buildersFor(*device_, 0);
    if (!state_.options.buildInBackground || builders < 2) background_.reset();
    if (background_ && !background_->done()) return commitStandIn();
    if (const auto build = std::move(background_)) {
        profileTables_ = build->built().profileTables_;
        adoptEyes(state_.materials, build->built().state_.materials);
    }
    if (!state_.options.buildInBackground || builders < 2) {
        prepareEyes(device_, state_.materials);
        return commitState(state_, autoPixels);
    }
    try {
        const cl::ReadyScope ready;
        prepareEyes(device_, state_.materials);
        return commitState(state_, autoPixels);
    } catch (const cl::NotBuilt&) {
    }
    // The programs of the stand-in first: the caller waits for them.
    const auto helpers = std::make_shared<cl::BuildHelpers>(device_->id(), builders);
    const Ref<Shader> standIn = copy(standInOf(state_));
    BuildJobs jobs;
    standIn->addBuildJobs(jobs);
    runJobs(*device_, jobs, builders, *helpers, [](size_t) {});
    commitStandIn();
    background_ = std::make_unique<BackgroundBuild>(copy(state_), autoPixels, helpers, builders);
}

// Commits substitutes whose programs build quickly, while helpers build those of the state.
void Shader::commitStandIn() {
    uint64_t autoPixels = 0;
    commitState(standInOf(state_), autoPixels);
    standsIn_ = true;
    warnings_ = text("materials shade by \"none\" while the programs of their methods are built",
                     warnings_.empty() ? "" : "\n", warnings_);
}

void Shader::commitState(const ShaderState& state, uint64_t& autoPixels) {
    standsIn_ = false;
    const KeepsLarger keeps(state.options.regionWidth > 0);
    allocate(plan(state, autoPixels), UINT32_MAX);
    finishPlan();
}

Ref<Shader> Shader::copy(const ShaderState& state) const {
    Ref<Shader> shader = make<Shader>(device_, passKinds_);
    shader->state_ = state;
    shader->profileTables_ = profileTables_;
    return shader;
}

ShaderPlan Shader::plan(const ShaderState& given, uint64_t& autoPixels) {
    ShaderPlan plan = planOf(given, methods(), 0, device_, autoPixels, profileTables_);
    // Scattering on the screen that auto chose must fit into the budget.
    const uint64_t budget = given.options.scratchBudget,
                   bytes = budget ? PassList(passKinds_).bytesOfWholeFrame(plan) : 0;
    if (bytes > budget) plan = planOf(given, methods(), bytes, device_, autoPixels, profileTables_);
    checkMethods(plan.state);
    checkScattering(plan.state);
    return plan;
}

// Makes the memory of the plan's passes, in bands of at most this many rows of tiles.
void Shader::allocate(ShaderPlan plan, uint32_t mostRows) {
    // Old images are released before new ones are made: both together could exceed the budget. After a
    // failure nothing is held.
    committed_ = executed_ = false;
    plan_ = ShaderPlan();
    PassList passes = std::exchange(passes_, PassList());
    if (passes.empty()) passes = PassList(passKinds_);
    passes.allocate(device_, plan, mostRows);
    if (!plan.counters) {
        if (!counters_) counters_ = device_->allocate(PEL_COUNTERS * sizeof(cl_uint));
        plan.counters = counters_;
    }
    plan_ = std::move(plan);
    passes_ = std::move(passes);
}

// Bits of the methods that this build has.
uint32_t Shader::methods() const {
    uint32_t methods = 1u << PEL_SCATTERING_NONE | 1u << PEL_SCATTERING_PREINTEGRATED;
    for (const PassKind& kind : passKinds_) methods |= kind.methods;
    return methods;
}

// Each method of scattering that a material names has a pass.
void Shader::checkMethods(const ShaderState& state) const {
    for (const auto& [id, material] : state.materials)
        if (!(methods() >> material.params.scattering & 1))
            fail(PEL_ERROR_UNSUPPORTED, "PelMaterial.scattering of material ", id, " is ",
                 scatteringName(material.params.scattering),
                 ", which this build of the library does not have");
}

void Shader::finishPlan() {
    const uint32_t before = device_->programs().counts().built;
    passes_.each([&](Pass& pass) { pass.build(*device_, plan_); });
    programsBuilt_ += device_->programs().counts().built - before;
    send();
    warnings_ = plan_.warnings;
    if (const std::string more = warningsOf(state_, plan_.state, plan_.features); !more.empty())
        warnings_ += (warnings_.empty() ? "" : "\n") + more;
    committed_ = true;
}

// Sends the plan's constants.
void Shader::send() {
    if (scratchRow_ != 0u) scratchRow_.reset();
    bytesUploaded_ +=
        constants_.update(*device_, plan_.state, plan_.variants, plan_.tilesX * plan_.listRows());
    passes_.each([&](Pass& pass) { bytesUploaded_ += pass.upload(*device_, plan_); });
}

// Halves the band. False if that is not possible.
bool Shader::halveBand(bool blocking) {
    const uint32_t rows = std::min(plan_.bandRows, plan_.tileRows);
    if (!plan_.scratch || plan_.wholeFrame || rows <= 1) return false;
    if (blocking) device_->finish();  // then queued work releases its memory
    committed_ = false;
    passes_.allocate(device_, plan_, rows / 2);
    send();
    committed_ = true;
    return true;
}

PassWork Shader::beginWork(bool codeAlone) {
    while (frames_.size() > 1 && hasFinished(frames_[1])) frames_.pop_front();
    frames_.push_back({++executions_, {}, {}});
    bands_ = 0;
    const size_t counters = PEL_COUNTERS + (plan_.tileLists ? PEL_TILE_LISTS : 0);
    device_->fill(plan_.counters.get(), 0, counters * sizeof(cl_uint), 0);
    PassWork work{*device_, plan_, constants_, frames_.back().events};
    work.codeAlone = codeAlone;
    runPasses(work, &Pass::enqueueFrame);
    return work;
}

void Shader::runPasses(PassWork& work, void (Pass::*part)(PassWork&)) {
    for (size_t i = 0; i < passKinds_.size(); ++i)
        if (Pass* const pass = passes_.at(i)) {
            frames_.back().parts.push_back({i, work.events.size(), work.tiles()});
            (pass->*part)(work);
        }
}

void Shader::execute(bool blocking) {
    if (!committed_)
        fail(PEL_ERROR_INVALID_STATE,
             "something was set after the last pelShaderCommit, or nothing was committed yet");
    if (standsIn_ && (!background_ || background_->done())) commit();
    copyTextures(false);
    if (!standsIn_)
        if (const char* folder = captureFolder(captureAsked_))
            captureFrame(*device_, inRegion(state_), folder);
    PassWork work = beginWork(false);
    work.interruptible = blocking && device_->hasProgress();
    for (uint32_t row = 0; row < plan_.tileRows;) {
        work.rows = {row, row + std::min(plan_.bandRows, plan_.tileRows - row)};
        work.band = bands_;
        work.written = false;
        try {
            runBand(work);
        } catch (const Error& e) {
            // Drivers may notice only now that memory does not suffice. Pixels that are shaded already are
            // kept: if radiance overwrites an input they could not be shaded again.
            if (e.code() != PEL_ERROR_OUT_OF_MEMORY || work.written || !halveBand(blocking)) throw;
            continue;
        }
        row = work.rows.end;
        ++bands_;
    }
    copyTextures(true);
    if (work.interruptible) device_->progress(1, "shading");
    launches_ = work.events.size();
    uploadedBefore_ = std::exchange(bytesUploaded_, 0);
    executed_ = true;
}

// Copies from the textures of all images, or back to those of written images.
void Shader::copyTextures(bool back) const {
    std::vector<ImageView> all;
    for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot)
        if (!back || slot == PEL_SLOT_RADIANCE || isOutput(slot)) all.push_back(state_.images[slot]);
    if (back) return pel::copyTextures(all, true);
    const auto add = [&](const ImageView& view) { all.push_back(view); };
    add(state_.ambientCube), add(state_.reflectionCube), add(state_.environment);
    for (const ShaderLight& light : state_.lights)
        for (int slot = 0; slot < PEL_LIGHT_SLOT_COUNT; ++slot)
            if (const ImageView& view = light.images[slot];
                view &&
                (slot == PEL_LIGHT_WIDE_SHADOW || !view.buffer->hasVersion(light.params.shadowMapVersion)))
                add(view);
    for (const auto& [id, material] : state_.materials) {
        add(material.scatteredTexture);
        std::ranges::for_each(material.normalMap, add);
        if (material.eye) add(material.eye->iris);
    }
    pel::copyTextures(all, false);
}

void Shader::setRows(const PassWork& work, TileRows rows) {
    constants_.setBand(*device_, rows.begin * plan_.tilesX, (rows.end - rows.begin) * plan_.tilesX,
                       work.around.begin * PEL_TILE_HEIGHT);
}

// Runs one band: passes make their images in it and around it; the last pass shades it.
void Shader::runBand(PassWork& work) {
    const TileRows rows = work.rows;
    work.around = {rows.begin - std::min(rows.begin, plan_.haloRows),
                   std::min(rows.end + plan_.haloRows, plan_.tileRows)};
    const uint32_t scratchRow = work.around.begin * PEL_TILE_HEIGHT;
    if (plan_.scratch && scratchRow_ != scratchRow) {
        scratchRow_.reset();
        passes_.each([&](Pass& pass) { pass.moveScratch(*device_, plan_, constants_, scratchRow); });
        scratchRow_ = scratchRow;
    }
    setRows(work, work.around);
    work.rows = work.around;
    runPasses(work, &Pass::enqueueAround);
    work.rows = rows;
    if (!work.alone()) setRows(work, rows);
    runPasses(work, &Pass::enqueue);
}

void Shader::addBuildJobs(BuildJobs& jobs, uint64_t autoPixels) {
    const Ref<Shader> self(this), shader = copy(state_);
    if (pretendEyes(device_, shader->state_.materials))
        jobs.push_back([self] { prepareEyes(self->device_, self->state_.materials); });
    ShaderPlan plan = shader->plan(shader->state_, autoPixels);
    profileTables_ = shader->profileTables_;
    shader->allocate(onSubstitutes(std::move(plan), device_), 1);
    std::vector<cl::ProgramKey> keys;
    shader->passes_.each([&](const Pass& pass) {
        std::ranges::move(pass.programs(*device_, shader->plan_), std::back_inserter(keys));
    });
    addProgramJobs(device_, std::move(keys), jobs);
    // One job per pass, because drivers compile kernels at their first launch. Whichever job runs next
    // launches the next pass: passes read the results of earlier ones.
    struct Launches {
        std::mutex alone;
        std::vector<Pass*> passes;
        size_t next = 0;
    };
    const auto launches = std::make_shared<Launches>();
    shader->passes_.each([&](Pass& pass) { launches->passes.push_back(&pass); });
    for (size_t i = 0; i < launches->passes.size(); ++i)
        jobs.push_back([shader, launches] {
            const std::lock_guard alone(launches->alone);
            if (launches->next == 0) shader->beginOnNothing();
            shader->launchOnNothing(*launches->passes[launches->next++]);
        });
}

// A frame without tiles: an execution launches every kernel, and none does anything.
void Shader::beginOnNothing() {
    finishPlan();
    PassWork work = beginWork(true);
    constants_.setBand(*device_, 0, 0, 0);
    work.rows = work.around = {0, 1};
    runPasses(work, &Pass::enqueueAround);
    device_->finish();
}

void Shader::launchOnNothing(Pass& pass) {
    PassWork work{*device_, plan_, constants_, frames_.back().events};
    work.rows = work.around = {0, 1};
    pass.enqueue(work);
    device_->finish();
}

PelShaderStats Shader::stats() {
    device_->finish();
    PelShaderStats stats = pelShaderStatsDefaults();
    stats.features = plan_.features;
    stats.programsBuilt = programsBuilt_;
    stats.standsIn = standsIn_;
    stats.takenTargetError = plan_.taken.targetError;
    stats.expectedMilliseconds = plan_.taken.milliseconds;
    stats.expectedError = plan_.taken.error;
    stats.tuned = plan_.taken.own;
    stats.takenHalfRate = plan_.taken.halfRate;
    stats.scratchBytes = ownBytes() + passes_.bytes();
    if (!executed_) return stats;
    stats.launches = launches_;
    stats.bytesUploaded = uploadedBefore_;
    stats.tilesTotal = stats.tilesShaded = constants_.frame().tiles;
    if (plan_.features & PEL_FEATURE_EYE) stats.tilesEye = stats.tilesTotal;  // unless there are lists
    stats.pixelsTotal = uint64_t(constants_.frame().width) * constants_.frame().height;
    stats.bands = bands_;
    stats.variants = plan_.variants.size();
    if (committed_) {
        cl_uint counts[PEL_COUNTERS];
        device_->read(plan_.counters.get(), 0, sizeof counts, counts, true);
        stats.pixelsShaded = counts[PEL_COUNT_SHADED];
        stats.pixelsShadowLut = counts[PEL_COUNT_SHADOW_LUT];
        stats.pixelsThickness = counts[PEL_COUNT_THICKNESS];
        stats.pixelsSpecular = counts[PEL_COUNT_SPECULAR];
        stats.pixelsInvalid = counts[PEL_COUNT_INVALID];
        stats.pixelsWideShadow = counts[PEL_COUNT_WIDE_SHADOW];
        stats.pixelsShadowTexels = counts[PEL_COUNT_SHADOW_TEXELS];
        stats.pixelsIrradiance = counts[PEL_COUNT_IRRADIANCE];
        stats.pixelsEye = counts[PEL_COUNT_EYE];
        stats.pixelsIris = counts[PEL_COUNT_IRIS];
        stats.pixelsCaustic = counts[PEL_COUNT_CAUSTIC];
        static_assert(std::size(decltype(stats.pixelsByScattering){}) == PEL_SCATTERS);
        for (int i = 0; i < PEL_SCATTERS; ++i) {
            stats.pixelsByScattering[i] = counts[PEL_COUNT_SCATTERING + i];
            stats.pixelsByChoice[i] = counts[PEL_COUNT_CHOICE + i];
        }
    }
    if (committed_) passes_.each([&](const Pass& pass) { pass.addStats(*device_, plan_, bands_, stats); });
    for (const cl::Event& event : frames_.back().events) stats.deviceMilliseconds += eventMilliseconds(event);
    return stats;
}

// Device memory besides that of the passes.
uint64_t Shader::ownBytes() const {
    return constants_.scratchBytes() + (counters_ ? PEL_COUNTERS * sizeof(cl_uint) : 0);
}

std::vector<PelPassMemory> Shader::memory() {
    prepareEyes(device_, state_.materials);
    uint64_t autoPixels = 0;
    plan(state_, autoPixels);  // makes the tables
    const Ref<Shader> planned = copy(state_);
    {
        const CountedRun counted;
        planned->allocate(planned->plan(state_, autoPixels), UINT32_MAX);
        planned->send();
    }
    std::vector<PelPassMemory> all;
    const auto add = [&](std::string_view name, uint64_t held, uint64_t needed) {
        if (!held && !needed) return;
        PelPassMemory& pass = all.emplace_back(pelPassMemoryDefaults());
        name.copy(pass.name, sizeof pass.name - 1);
        pass.held = held, pass.needed = needed;
    };
    const auto bytes = [](const Pass* pass) { return pass ? pass->bytes() : 0; };
    for (size_t i = 0; i < passKinds_.size(); ++i)
        add(passKinds_[i].name, bytes(passes_.at(i)), bytes(planned->passes_.at(i)));
    add("constants", ownBytes(), planned->ownBytes());
    return all;
}

// The queue is in order, so the last launch finishes last.
bool Shader::hasFinished(const Frame& frame) const {
    for (size_t i = frame.events.size(); i-- > 0;)
        if (const cl::Event& last = frame.events[i])
            return cl::info<cl_int>(last.get(), CL_EVENT_COMMAND_EXECUTION_STATUS) <= CL_COMPLETE;
    return true;
}

std::vector<PelPassStats> Shader::passStats() {
    std::vector<PelPassStats> stats;
    while (frames_.size() > 1 && hasFinished(frames_[1])) frames_.pop_front();
    if (frames_.empty() || !hasFinished(frames_[0])) return stats;
    const Frame& frame = frames_[0];
    for (size_t kind = 0; kind < passKinds_.size(); ++kind) {
        PelPassStats pass = pelPassStatsDefaults();
        for (size_t i = 0; i < frame.parts.size(); ++i) {
            const auto& [which, begin, tiles] = frame.parts[i];
            const size_t end = i + 1 < frame.parts.size() ? frame.parts[i + 1].begin : frame.events.size();
            if (which != kind || begin == end) continue;
            pass.launches += uint32_t(end - begin);
            pass.tiles += tiles;
            for (size_t e = begin; e < end; ++e) pass.milliseconds += eventMilliseconds(frame.events[e]);
        }
        if (!pass.launches) continue;
        passKinds_[kind].name.copy(pass.name, sizeof pass.name - 1);
        pass.execution = frame.number;
        if (const Pass* held = passes_.at(kind)) pass.bytes = held->bytes();
        stats.push_back(pass);
    }
    return stats;
}

}  // namespace pel
