// Commit and execution of a PelShader, and its statistics.
#include "shading/shader.h"

#include <algorithm>
#include <mutex>

#include "cl/launch.h"
#include "shading/features.h"
#include "shading/image_slots.h"
#include "shading/shade_variants.h"

namespace pel {
namespace {

// `tooMany`: see chooseMethods().
ShaderPlan planOf(const ShaderState& given, uint32_t methods, uint64_t tooMany, const Ref<Device>& device,
                  ProfileTables& tables) {
    ShaderPlan plan;
    plan.state = given;
    plan.warnings = chooseMethods(plan.state, methods, tooMany);
    withTables(plan.state, device, tables);
    const ShaderState& state = plan.state;
    plan.features = deriveFeatures(state);
    plan.variants = variantFeatures(state, plan.features);
    const ImageView& frame = state.images[PEL_SLOT_RADIANCE];
    plan.tilesX = (frame.width + PEL_TILE_WIDTH - 1) / PEL_TILE_WIDTH;
    plan.tileRows = (frame.height + PEL_TILE_HEIGHT - 1) / PEL_TILE_HEIGHT;
    for (uint32_t i = 0; i < state.lights.size(); ++i)
        if (filtersShadow(state, state.lights[i])) plan.filteredLights.push_back({i, cl::Memory()});
    return plan;
}

}  // namespace

Shader::Shader(Ref<Device> device, std::span<const PassKind> passes)
    : Object(kind), device_(std::move(device)), passKinds_(passes) {}

void Shader::commit() {
    allocate(UINT32_MAX);
    finishPlan();
}

// Makes a plan and the memory of its passes, in bands of at most this many rows of tiles.
void Shader::allocate(uint32_t mostRows) {
    prepareEyes(device_, state_.materials);
    ShaderPlan plan = planOf(state_, methods(), 0, device_, profileTables_);
    // What scatters on the screen because it was chosen to must fit.
    const uint64_t budget = state_.options.scratchBudget,
                   bytes = budget ? PassList(passKinds_).bytesOfWholeFrame(plan) : 0;
    if (bytes > budget) plan = planOf(state_, methods(), bytes, device_, profileTables_);
    checkMethods(plan.state);
    checkScattering(plan.state);
    // Old images go before new ones are made: both together would not keep to a budget. After a failure
    // nothing is held.
    committed_ = false;
    plan_ = ShaderPlan();
    PassList passes = std::exchange(passes_, PassList());
    if (passes.empty()) passes = PassList(passKinds_);
    passes.allocate(device_, plan, mostRows);
    if (!counters_) counters_ = device_->allocate(PEL_COUNTERS * sizeof(cl_uint));
    plan.counters = counters_;
    plan_ = std::move(plan);
    passes_ = std::move(passes);
}

// Those that this build has.
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
    scratchRow_.reset();
    bytesUploaded_ +=
        constants_.update(*device_, plan_.state, plan_.variants, plan_.tilesX * plan_.listRows());
    passes_.each([&](Pass& pass) { bytesUploaded_ += pass.upload(*device_, plan_); });
}

// Halves the band. False if that is not possible.
bool Shader::halveBand(bool blocking) {
    const uint32_t rows = std::min(plan_.bandRows, plan_.tileRows);
    if (!plan_.scratch || plan_.wholeFrame || rows <= 1) return false;
    if (blocking) device_->finish();  // then what is queued gives its memory back
    committed_ = false;
    passes_.allocate(device_, plan_, rows / 2);
    send();
    committed_ = true;
    return true;
}

PassWork Shader::beginWork(bool codeAlone) {
    events_.clear();
    bands_ = 0;
    device_->fill(counters_.get(), 0, PEL_COUNTERS * sizeof(cl_uint), 0);
    PassWork work{*device_, plan_, constants_, events_};
    work.codeAlone = codeAlone;
    passes_.each([&](Pass& pass) { pass.enqueueFrame(work); });
    return work;
}

void Shader::execute(bool blocking) {
    if (!committed_)
        fail(PEL_ERROR_INVALID_STATE,
             "something was set after the last pelShaderCommit, or nothing was committed yet");
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
    if (work.interruptible) device_->progress(1, "shading");
    launches_ = events_.size();
    uploadedBefore_ = std::exchange(bytesUploaded_, 0);
    executed_ = true;
}

void Shader::setRows(const PassWork& work, TileRows rows) {
    constants_.setBand(*device_, rows.begin * plan_.tilesX, (rows.end - rows.begin) * plan_.tilesX,
                       work.around.begin * PEL_TILE_HEIGHT);
}

// Runs one band: passes make what they need in it and around it; the last pass shades it.
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
    passes_.each([&](Pass& pass) { pass.enqueueAround(work); });
    work.rows = rows;
    if (!work.alone()) setRows(work, rows);
    passes_.each([&](Pass& pass) { pass.enqueue(work); });
}

void Shader::addWarmUpJobs(std::vector<std::function<void()>>& jobs) {
    Ref<Shader> shader = make<Shader>(device_, passKinds_);
    {
        // The other process makes the tables of eyes, which nothing here looks at.
        const cl::BuildScope scope(cl::helpsToBuild() ? cl::BuildScope::none : cl::BuildScope::all);
        prepareEyes(device_, state_.materials);
    }
    const cl::BuildScope zeroes(cl::BuildScope::all);
    shader->state_ = state_;
    shader->profileTables_ = profileTables_;
    shader->allocate(1);
    profileTables_ = shader->profileTables_;
    std::vector<cl::ProgramKey> keys;  // each once
    shader->passes_.each([&](const Pass& pass) {
        for (cl::ProgramKey& key : pass.programs(*device_, shader->plan_))
            if (std::ranges::find(keys, key) == keys.end()) keys.push_back(std::move(key));
    });
    for (const cl::ProgramKey& key : keys)
        jobs.push_back([device = device_, key] {
            if (cl::claimBuild(device->programs().name(key))) device->programs().get(key);
        });
    // A job for each pass, for drivers compile kernels when they are launched first. Whichever job comes next
    // launches the next pass: passes read what those before them made.
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
    const cl::BuildScope scope(cl::BuildScope::claimed);
    finishPlan();
    PassWork work = beginWork(true);
    constants_.setBand(*device_, 0, 0, 0);
    work.rows = work.around = {0, 1};
    passes_.each([&](Pass& pass) { pass.enqueueAround(work); });
    device_->finish();
}

void Shader::launchOnNothing(Pass& pass) {
    const cl::BuildScope scope(cl::BuildScope::claimed);
    PassWork work{*device_, plan_, constants_, events_};
    work.rows = work.around = {0, 1};
    pass.enqueue(work);
    device_->finish();
}

PelShaderStats Shader::stats() {
    device_->finish();
    PelShaderStats stats = pelShaderStatsDefaults();
    stats.features = plan_.features;
    stats.programsBuilt = programsBuilt_;
    stats.scratchBytes =
        constants_.scratchBytes() + passes_.bytes() + (counters_ ? PEL_COUNTERS * sizeof(cl_uint) : 0);
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
        device_->read(counters_.get(), 0, sizeof counts, counts, true);
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
    for (const cl::Event& event : events_) stats.deviceMilliseconds += eventMilliseconds(event);
    return stats;
}

}  // namespace pel
