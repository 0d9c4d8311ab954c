#include "diffusion/screen_scatter.h"

#include <cstring>

#include "core/launch_policy.h"
#include "shading/launch_ranges.h"
#include "shading/material.h"

namespace pel {
namespace {

// Samples of sums by levels are nearer than the light that they represent, so their gain is smaller.
constexpr double nearerByLevels = 0.925;

enum ScreenProgram { PYRAMIDS, SUMS, CLASSIFY };

// The point that a perspective matrix maps to infinite depth.
bool eyeOf(const float inverse[16], float eye[3]) {
    const float w = inverse[14];
    if (!(std::abs(w) > 1e-20f)) return false;
    for (int k = 0; k < 3; ++k) eye[k] = inverse[4 * k + 2] / w;
    return std::isfinite(eye[0]) && std::isfinite(eye[1]) && std::isfinite(eye[2]);
}

bool isKnown(const float position[3]) {
    return position[0] != 0 || position[1] != 0 || position[2] != 0;
}

// Positions relative to a camera at more than this many reaches of the profile would be too coarse.
constexpr double farthestCamera = 1e4;

// As seen from a point that is not 0, which far away counts as a direction.
Sight seenFrom(const float position[3], double reach) {
    Sight sight;
    const double distance = std::hypot(position[0], position[1], position[2]);
    if (distance < farthestCamera * reach) {
        sight.view = PEL_VIEW_POINT;
        std::copy_n(position, 3, sight.origin);
    } else {
        sight.view = PEL_VIEW_DIRECTION;
        for (int k = 0; k < 3; ++k) sight.direction[k] = float(-position[k] / distance);
        sight.away = true;
    }
    return sight;
}

}  // namespace

Sight sightOf(const ScatterView& view) {
    const float* inverse = view.inverseViewProjection;
    Sight sight;
    if (eyeOf(inverse, sight.origin)) {
        sight.view = PEL_VIEW_POINT;
        return sight;
    }
    std::fill_n(sight.origin, 3, 0.0f);
    const double x = inverse[2], y = inverse[6], z = inverse[10], length = std::sqrt(x * x + y * y + z * z);
    if (inverse[14] != 0 || !(length > 0) || !std::isfinite(length)) return sight;
    sight.view = PEL_VIEW_DIRECTION;
    double ahead = 0;  // of the middle of the picture at half depth
    for (int k = 0; k < 3; ++k) {
        sight.direction[k] = float(inverse[4 * k + 2] / length);
        const double middle = (0.5 * inverse[4 * k + 2] + inverse[4 * k + 3]) / inverse[15];
        ahead += sight.direction[k] * (middle - view.position[k]);
    }
    sight.away = isKnown(view.position) && std::abs(ahead) > 0;
    if (sight.away && ahead < 0)
        for (float& d : sight.direction) d = -d;
    return sight;
}

bool samePixels(const ImageView& a, const ImageView& b) {
    return a.buffer->memory().get() == b.buffer->memory().get() && a.byteOffset == b.byteOffset &&
           a.format == b.format && a.pixelStride == b.pixelStride && a.rowStride == b.rowStride &&
           a.planeStride == b.planeStride;
}

void ScreenScatter::sendTables(const std::map<uint32_t, Material>& materials) {
    const std::vector<Material> distinct = distinctOf(materials, frame_.tableOf);
    frame_.tables = uint32_t(distinct.size());
    const bool hasSides = frame_.view != PEL_VIEW_UNKNOWN && frame_.curvature.rowStride;
    if (materials == materials_ && hasSides == hasSides_ && lights_.alone == byTexels_ && tables_) return;
    tables_ = cl::Memory();  // until all are sent
    narrowest_ = widest_ = 0;
    std::vector<PelProfileTable> tables;
    std::vector<float> values;
    for (const Material& material : distinct) {
        // Without sides, the outward direction is unknown.
        Rgb path{};
        for (int c = 0; hasSides && c < 3; ++c) path[c] = meanFreePath(*material.profile, c) * material.scale;
        const double strength = path[0] > 0 ? material.gain[0] / path[0] : 0;
        ProfileNodes nodes = profileNodes(material.profile->shape(), material.scale, path, strength);
        nodes.table.offset = uint32_t(values.size() / 4);
        for (int c = 0; c < 3; ++c)
            nodes.table.perCurvature[c] = float(nodes.table.directed / 2 * nodes.meanDistance[c] *
                                                (lights_.alone ? 1 : nearerByLevels));
        for (int c = 0; c < 3; ++c) {
            nodes.table.path[c] = material.sheet ? 0 : material.gain[size_t(c)];
            nodes.table.absorption[c] = float(mediumAbsorption(*material.profile, c));
        }
        tables.push_back(nodes.table);
        narrowest_ = narrowest_ > 0 ? std::min(narrowest_, double(nodes.table.reach)) : nodes.table.reach;
        widest_ = std::max(widest_, double(nodes.table.reach));
        values.insert(values.end(), nodes.values.begin(), nodes.values.end());
    }
    if (tables.empty()) tables.emplace_back(), values.resize(12);
    nodes_ = device_->upload(values);
    tables_ = device_->upload(tables);
    nodeBytes_ = tables.size() * sizeof tables[0] + values.size() * sizeof(float);
    materials_ = materials;
    hasSides_ = hasSides, byTexels_ = lights_.alone;
}

static uint32_t planesOf(bool radii) {
    return PEL_PYRAMID_PLANES + (radii ? 1 : 0);
}

// Returns the number of floats of all levels.
static uint64_t layOutLevels(uint32_t width, uint32_t height, bool radii,
                             PelPyramidLevel (&levels)[PEL_PYRAMID_LEVELS]) {
    uint64_t floats = 0;
    for (PelPyramidLevel& level : levels) {
        const uint32_t stride = (width + 15) / 16 * 16 + 3 * PEL_PYRAMID_GUARD;
        if (floats > UINT32_MAX)
            fail(PEL_ERROR_OUT_OF_MEMORY, "a picture of ", levels[0].width, " x ", levels[0].height,
                 " is too large to scatter");
        level = {uint32_t(floats), stride, width, height};
        floats += uint64_t(height + 2 * PEL_PYRAMID_ROWS) * planesOf(radii) * stride;
        width = (width + 1) / 2, height = (height + 1) / 2;
    }
    return floats + 2 * PEL_PYRAMID_GUARD;
}

// Floats of the sums of level 1 and on.
static uint64_t sumFloats(const PelPyramidLevel (&levels)[PEL_PYRAMID_LEVELS], bool radii, uint64_t floats) {
    return (floats - 2 * PEL_PYRAMID_GUARD - levels[1].offset) / planesOf(radii) * PEL_SUM_PLANES +
           2 * PEL_PYRAMID_GUARD;
}

uint64_t ScreenScatter::bytesFor(uint32_t width, uint32_t height, bool radii) {
    PelPyramidLevel levels[PEL_PYRAMID_LEVELS];
    const uint64_t floats = layOutLevels(width, height, radii, levels);
    return (floats + sumFloats(levels, radii, floats)) * sizeof(float) +
           uint64_t((width + PEL_DIFFUSION_TILE - 1) / PEL_DIFFUSION_TILE) *
               ((height + PEL_DIFFUSION_TILE - 1) / PEL_DIFFUSION_TILE) * sizeof(cl_uint);
}

void ScreenScatter::describeLevels(uint32_t width, uint32_t height, bool radii) {
    const auto before = std::to_array(frame_.level);
    const uint64_t floats = layOutLevels(width, height, radii, frame_.level);
    if (pyramid_.bytes() && sums_.bytes() && !std::memcmp(frame_.level, before.data(), sizeof frame_.level))
        return;
    pyramid_.forget(), sums_.forget();
    pyramid_.resize(*device_, floats * sizeof(float), true);  // no area outside of the picture
    // Zeros, because vectors read beyond the values that are written.
    sums_.resize(*device_, sumFloats(frame_.level, radii, floats) * sizeof(float), true);
}

void ScreenScatter::announce(const ScatterLights& lights) {
    lights_ = lights;
    light_.announce(lights.lights, !lights.alone, lights.half);
}

ScreenMemory ScreenScatter::memory(const cl::Program& program) const {
    return {program,
            constants_.memory(),
            pyramid_.memory(),
            tables_,
            nodes_,
            tiles_.memory(),
            sums_.memory(),
            counters_,
            frame_.width,
            frame_.height,
            size_t(frame_.tilesX) * frame_.tilesY};
}

void ScreenScatter::prepare(const std::map<uint32_t, Material>& materials, const ScatterImages& images,
                            const ScatterView& view) {
    frame_.levels = PEL_PYRAMID_LEVELS;
    frame_.everyTile = view.everywhere;
    Sight sight = sightOf(view);
    if (images.positions && isKnown(view.position) &&
        std::ranges::equal(view.inverseViewProjection, pelCameraDefaults().inverseViewProjection)) {
        // No matrix was set, which positions do not need.
        double reach = 0;
        for (const auto& [id, material] : materials)
            reach = std::max(reach, material.profile->reach() * material.scale);
        sight = seenFrom(view.position, reach);
    }
    describePicture(images, view, sight, frame_);
    frame_.view = sight.view == PEL_VIEW_DIRECTION && !sight.away ? PEL_VIEW_UNKNOWN : sight.view;
    frame_.tolerance = view.tolerance;
    frame_.curvature = describeImage(images.curvature);
    frame_.thickness = describeImage(images.thickness);
    sendTables(materials);
    describeLevels(frame_.width, frame_.height, bool(images.radii));
    const PelPyramidLevel& pairs = frame_.level[1];
    light_.prepare(lights_.lights, frame_.origin, narrowest_, widest_, size_t(frame_.tilesX) * frame_.tilesY,
                   size_t(pairs.height + 2 * PEL_PYRAMID_ROWS) * PEL_HIDDEN_PLANES * pairs.stride +
                       2 * PEL_PYRAMID_GUARD);
    tiles_.resize(*device_, size_t(frame_.tilesX) * frame_.tilesY * sizeof(cl_uint));
    if (!counters_) counters_ = device_->allocate(PEL_LIGHT_WORDS * sizeof(cl_uint));
    constants_.update(*device_, frame_);
}

std::vector<cl::ProgramKey> ScreenScatter::programs(const ScatterImages& images) const {
    const uint32_t lanes = device_->info().mathWidth;
    const auto code = [&](const ImageView& view) { return formatCode(view, lanes); };
    // Two that take about as long to build, so that two processes share the work.
    cl::ProgramKey pyramids{{"diffusion/surface.cl", "diffusion/reduce.cl"},
                            {{"PEL_FORMAT_IRRADIANCE", code(images.irradiance)},
                             {"PEL_FORMAT_POSITION", code(images.positions)},
                             {"PEL_FORMAT_DEPTH", images.positions ? 0 : code(images.depth)},
                             {"PEL_FORMAT_MATERIAL", code(images.ids)},
                             {"PEL_FORMAT_OUT", code(images.out)},
                             {"PEL_FORMAT_MEAN_CURVATURE", code(images.curvature)},
                             {"PEL_HIDDEN", int(fillsHidden())}}};
    cl::ProgramKey classify{{"diffusion/classify_scatter.cl"},
                            {{"PEL_WIDTH", 1}, {"PEL_TILE_IS_GROUP", lanes == 1}}};
    if (images.radii) {
        pyramids.defines["PEL_FORMAT_RADIUS"] = code(images.radii);
        pyramids.defines["PEL_RADIUS_COMPONENT"] = images.radiusComponent;
        for (cl::ProgramKey* key : {&pyramids, &classify}) key->defines["PEL_RADII"] = 1;
    }
    cl::ProgramKey sums{{"diffusion/scatter_level.cl", "diffusion/scatter_screen.cl"}, pyramids.defines};
    pyramids.defines["PEL_FORMAT_THICKNESS"] = code(images.thickness);
    if (!light_.empty()) light_.addFiles(pyramids);
    return {std::move(pyramids), std::move(sums), std::move(classify)};
}

void ScreenScatter::enqueue(const ScatterImages& images, std::vector<cl::Event>& events) {
    std::vector<cl::Program> programs;
    for (const cl::ProgramKey& key : this->programs(images)) programs.push_back(device_->programs().get(key));
    const ScreenMemory screen = memory(programs[PYRAMIDS]);
    const auto launch = [&](ScreenProgram program, const char* kernel, const cl::Range& range,
                            const auto&... values) {
        device_->launch(events, programs[program], kernel, range, constants_, values...);
    };
    device_->fill(counters_.get(), 0, PEL_LIGHT_WORDS * sizeof(cl_uint), 0);
    const cl::Range pixels = vectorRange(*device_, frame_.width, frame_.height);
    launch(PYRAMIDS, "surface_points", pixels, images.irradiance,
           images.positions ? images.positions : images.depth, images.ids, images.curvature, images.radii,
           pyramid_, counters_);
    launch(PYRAMIDS, "surface_areas", pixels, pyramid_);
    for (uint32_t k = 1, count; k < frame_.levels; k += count) {
        count = levelsPerLaunch(*device_, frame_.levels - k);
        launch(PYRAMIDS, "reduce_surface",
               blockRange(*device_, frame_.level[k].width, frame_.level[k].height, count), pyramid_, k,
               count);
    }
    const bool byLevels = device_->info().mathWidth > 1;  // a launch each
    size_t blocks = 0;
    for (uint32_t k = 1; k < frame_.levels; ++k)
        blocks += size_t(frame_.level[k].width) * frame_.level[k].height;
    if (!byLevels) launch(PYRAMIDS, "surface_differences", itemRange(*device_, blocks), pyramid_);
    const size_t tiles = size_t(frame_.tilesX) * frame_.tilesY;
    launch(CLASSIFY, "classify_scatter", byLevels ? itemRange(*device_, tiles) : groupRange(*device_, tiles),
           pyramid_, tables_, nodes_, tiles_, counters_);
    if (!light_.empty()) light_.enqueuePyramids(images, screen, events);
    // With the texels only, the screen's last step just copies.
    const bool alone = !light_.empty() && lights_.alone;
    if (alone) device_->fill(tiles_.memory().get(), 0, tiles_.bytes(), 0);
    if (!alone && !byLevels) {
        launch(SUMS, "scatter_bands", itemRange(*device_, blocks), pyramid_, tables_, nodes_, tiles_, sums_,
               counters_);
        constexpr uint32_t side = 16;  // blocks of level 1 along that of a group's
        launch(SUMS, "scatter_sums",
               groupRange(*device_, size_t((frame_.level[1].width + side - 1) / side) *
                                        ((frame_.level[1].height + side - 1) / side)),
               pyramid_, tiles_, sums_);
    }
    for (uint32_t k = frame_.levels - 1; k > 0 && !alone && byLevels; --k)
        launch(SUMS, "scatter_level", vectorRange(*device_, frame_.level[k].width, frame_.level[k].height),
               pyramid_, tables_, nodes_, tiles_, k, sums_, counters_);
    if (fillsHidden()) light_.enqueueHidden(screen, events);
    launch(SUMS, "scatter_screen", groupRange(*device_, groupsFor(*device_, tiles)), pyramid_, tables_,
           nodes_, tiles_, sums_, fillsHidden() ? light_.hidden() : cl::Memory(), images.irradiance,
           images.out, counters_);
    if (alone) light_.enqueueSums(images, screen, events);
}

ScatterCounts ScreenScatter::counts(LightCounts* light) {
    struct {
        ScatterCounts screen;
        uint32_t pixels, texels, tiles;
        uint32_t regions[PEL_LIGHT_MAPS][4];
    } counts{};
    static_assert(sizeof counts == PEL_LIGHT_WORDS * sizeof(cl_uint));
    if (counters_) device_->read(counters_.get(), 0, sizeof counts, &counts, true);
    if (light) *light = {counts.pixels, counts.texels, counts.tiles, light_.texelsOf(counts.regions)};
    return counts.screen;
}

}  // namespace pel
