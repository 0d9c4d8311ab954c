#include "diffusion/screen_scatter.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/launch_policy.h"
#include "shading/launch_ranges.h"
#include "shading/shading_constants.h"

namespace pel {

bool eyeOf(const float inverse[16], float eye[3]) {
    const float w = inverse[14];
    if (!(std::abs(w) > 1e-20f)) return false;
    for (int k = 0; k < 3; ++k) eye[k] = inverse[4 * k + 2] / w;
    return std::isfinite(eye[0]) && std::isfinite(eye[1]) && std::isfinite(eye[2]);
}

bool samePixels(const ImageView& a, const ImageView& b) {
    return a.buffer->memory().get() == b.buffer->memory().get() && a.byteOffset == b.byteOffset &&
           a.format == b.format && a.pixelStride == b.pixelStride && a.rowStride == b.rowStride &&
           a.planeStride == b.planeStride;
}

namespace {
// The factor 1 + k t of R (docs/mathematics.md, section 12) has the k with which even light on a sphere gains
// this, times mean free path and curvature, to first order: k = 0.92 at a reflectance of 0.8. Samples of sums
// by levels are nearer than the light that they stand for, so that they gain less.
constexpr double gainPerCurvature = 1.06, nearerByLevels = 0.925;

enum Program { PIXELS, CLASSIFY };
}  // namespace

void ScreenScatter::sendTables(const std::map<uint32_t, Material>& materials) {
    std::fill_n(frame_.tableOf, PEL_DIFFUSION_IDS, 0);
    std::vector<Material> distinct;
    for (const auto& [id, material] : materials) {
        auto found = std::find(distinct.begin(), distinct.end(), material);
        if (found == distinct.end()) found = distinct.insert(found, material);
        frame_.tableOf[id] = uint32_t(found - distinct.begin()) + 1;
    }
    frame_.tables = uint32_t(distinct.size());
    const bool hasSides = frame_.facing && frame_.curvature.rowStride;
    if (materials == materials_ && hasSides == hasSides_ && tables_) return;
    narrowest_ = 0;
    std::vector<PelProfileTable> tables;
    std::vector<float> values;
    for (const Material& material : distinct) {
        ProfileNodes nodes = profileNodes(material.profile->shape(), material.scale);
        nodes.table.offset = uint32_t(values.size() / 4);
        if (hasSides) {  // otherwise surfaces have no outer side
            const auto sum = [](const auto& v) { return v[0] + v[1] + v[2]; };
            const double k = 2 * gainPerCurvature * sum(material.gain) / sum(nodes.meanDistance);
            nodes.table.directed = float(k);
            for (int c = 0; c < 3; ++c)
                nodes.table.perCurvature[c] =
                    float(k / 2 * nodes.meanDistance[c] * (lights_.alone ? 1 : nearerByLevels));
        }
        tables.push_back(nodes.table);
        narrowest_ = narrowest_ > 0 ? std::min(narrowest_, double(nodes.table.reach)) : nodes.table.reach;
        values.insert(values.end(), nodes.values.begin(), nodes.values.end());
    }
    if (tables.empty()) tables.emplace_back(), values.resize(12);
    tables_ = device_->allocate(tables.size() * sizeof tables[0], tables.data());
    nodes_ = device_->allocate(values.size() * sizeof(float), values.data());
    nodeBytes_ = tables.size() * sizeof tables[0] + values.size() * sizeof(float);
    materials_ = materials;
    hasSides_ = hasSides;
}

// Returns the number of floats of all levels.
static uint64_t layOutLevels(uint32_t width, uint32_t height, PelPyramidLevel (&levels)[PEL_PYRAMID_LEVELS]) {
    uint64_t floats = 0;
    for (PelPyramidLevel& level : levels) {
        const uint32_t stride = (width + 15) / 16 * 16 + 3 * PEL_PYRAMID_GUARD;
        if (floats > UINT32_MAX)
            fail(PEL_ERROR_OUT_OF_MEMORY, "a picture of ", levels[0].width, " x ", levels[0].height,
                 " is too large to scatter");
        level = {uint32_t(floats), stride, width, height};
        floats += uint64_t(height + 2 * PEL_PYRAMID_ROWS) * PEL_PYRAMID_PLANES * stride;
        width = (width + 1) / 2, height = (height + 1) / 2;
    }
    return floats + 2 * PEL_PYRAMID_GUARD;
}

// Floats of the sums of level 1 and on.
static uint64_t sumFloats(const PelPyramidLevel (&levels)[PEL_PYRAMID_LEVELS], uint64_t floats) {
    return (floats - 2 * PEL_PYRAMID_GUARD - levels[1].offset) / PEL_PYRAMID_PLANES * PEL_SUM_PLANES +
           2 * PEL_PYRAMID_GUARD;
}

// Floats of the sums of levels before `level`.
static size_t sumFloatsBelow(const PelPyramidLevel (&levels)[PEL_PYRAMID_LEVELS], uint32_t level) {
    return size_t(levels[level].offset - levels[1].offset) / PEL_PYRAMID_PLANES * PEL_SUM_PLANES;
}

uint64_t ScreenScatter::bytesFor(uint32_t width, uint32_t height) {
    PelPyramidLevel levels[PEL_PYRAMID_LEVELS];
    const uint64_t floats = layOutLevels(width, height, levels);
    return (floats + sumFloats(levels, floats)) * sizeof(float) +
           uint64_t((width + PEL_DIFFUSION_TILE - 1) / PEL_DIFFUSION_TILE) *
               ((height + PEL_DIFFUSION_TILE - 1) / PEL_DIFFUSION_TILE) * sizeof(cl_uint);
}

void ScreenScatter::describeLevels(uint32_t width, uint32_t height) {
    const size_t bytes = layOutLevels(width, height, frame_.level) * sizeof(float);
    if (bytes == pyramidBytes_ && !std::memcmp(frame_.level, constants_.sent().level, sizeof frame_.level))
        return;
    pyramid_ = sums_ = cl::Memory();
    pyramidBytes_ = sumBytes_ = 0;
    pyramid_ = device_->allocateZeros(bytes);  // no area outside of the picture
    pyramidBytes_ = bytes;
    const size_t sumBytes = sumFloats(frame_.level, bytes / sizeof(float)) * sizeof(float);
    sums_ = device_->allocateZeros(sumBytes);  // vectors read beyond what is set
    sumBytes_ = sumBytes;
}

void ScreenScatter::announce(const ScatterLights& lights) {
    lights_ = lights;
    light_.announce(lights.lights, !lights.alone);
}

ScreenMemory ScreenScatter::memory(const cl::Program& program) const {
    return {program,       constants_.memory(),
            pyramid_,      tables_,
            nodes_,        tiles_,
            sums_,         frame_.width,
            frame_.height, size_t(frame_.tilesX) * frame_.tilesY};
}

void ScreenScatter::prepare(const std::map<uint32_t, Material>& materials, const ScatterImages& images,
                            const ScatterView& view) {
    frame_.width = images.irradiance.width, frame_.height = images.irradiance.height;
    frame_.tilesX = (frame_.width + PEL_DIFFUSION_TILE - 1) / PEL_DIFFUSION_TILE;
    frame_.tilesY = (frame_.height + PEL_DIFFUSION_TILE - 1) / PEL_DIFFUSION_TILE;
    frame_.levels = PEL_PYRAMID_LEVELS;
    frame_.everyTile = view.everywhere;
    frame_.inPlace = samePixels(images.irradiance, images.out);
    frame_.facing = eyeOf(view.inverseViewProjection, frame_.origin);
    if (!frame_.facing) std::fill_n(frame_.origin, 3, 0.0f);
    frame_.tolerance = view.tolerance;
    std::copy_n(view.inverseViewProjection, 16, frame_.inverseViewProjection);
    frame_.irradiance = describeImage(images.irradiance);
    frame_.position = describeImage(images.positions ? images.positions : images.depth);
    frame_.ids = images.ids ? describeImage(images.ids) : PelShadeImage{};
    frame_.out = describeImage(images.out);
    frame_.curvature = images.curvature ? describeImage(images.curvature) : PelShadeImage{};
    sendTables(materials);
    describeLevels(frame_.width, frame_.height);
    const PelPyramidLevel& pairs = frame_.level[1];
    light_.prepare(lights_.lights, frame_.origin, narrowest_, size_t(frame_.tilesX) * frame_.tilesY,
                   size_t(pairs.height + 2 * PEL_PYRAMID_ROWS) * PEL_HIDDEN_PLANES * pairs.stride +
                       2 * PEL_PYRAMID_GUARD);
    const size_t tileBytes = size_t(frame_.tilesX) * frame_.tilesY * sizeof(cl_uint);
    if (tileBytes != tileBytes_) tiles_ = device_->allocate(tileBytes), tileBytes_ = tileBytes;
    if (!counters_) counters_ = device_->allocate(PEL_DIFFUSION_COUNTERS * sizeof(cl_uint));
    constants_.send(*device_, frame_);
}

std::vector<cl::ProgramKey> ScreenScatter::programs(const ScatterImages& images) const {
    const uint32_t lanes = device_->info().mathWidth;
    const auto code = [&](const ImageView& view) { return text(formatCode(view, lanes)); };
    cl::ProgramKey pixels{{"diffusion/surface.cl", "diffusion/reduce.cl", "diffusion/scatter_level.cl",
                           "diffusion/scatter_screen.cl"},
                          {{"PEL_FORMAT_IRRADIANCE", code(images.irradiance)},
                           {"PEL_FORMAT_POSITION", code(images.positions)},
                           {"PEL_FORMAT_DEPTH", images.positions ? text(0) : code(images.depth)},
                           {"PEL_FORMAT_MATERIAL", code(images.ids)},
                           {"PEL_FORMAT_OUT", code(images.out)},
                           {"PEL_FORMAT_MEAN_CURVATURE", code(images.curvature)},
                           {"PEL_HIDDEN", text(int(fillsHidden()))}}};
    if (!light_.empty()) light_.addFiles(pixels);
    return {std::move(pixels), {{"diffusion/classify_scatter.cl"}, {{"PEL_WIDTH", text(1)}}}};
}

// Work-items, of a vector of pixels each.
cl::Range ScreenScatter::rows(uint32_t width, uint32_t height) const {
    const uint32_t lanes = device_->info().mathWidth;
    return itemRange(*device_, size_t((width + lanes - 1) / lanes) * height);
}

void ScreenScatter::enqueue(const ScatterImages& images, std::vector<cl::Event>& events) {
    std::vector<cl::Program> programs;
    for (const cl::ProgramKey& key : this->programs(images)) programs.push_back(device_->programs().get(key));
    const ScreenMemory screen = this->memory(programs[PIXELS]);
    const auto memory = [](const ImageView& view) { return view ? view.buffer->memory() : cl::Memory(); };
    const auto launch = [&](cl::Launch& launch, const cl::Range& range) {
        events.push_back(device_->launch(launch, range));
    };
    device_->fill(counters_.get(), 0, PEL_DIFFUSION_COUNTERS * sizeof(cl_uint), 0);
    {
        cl::Launch points(programs[PIXELS], "surface_points");
        points.arg(constants_.memory())
            .arg(memory(images.irradiance))
            .arg(memory(images.positions ? images.positions : images.depth));
        points.arg(memory(images.ids)).arg(memory(images.curvature)).arg(pyramid_).arg(counters_);
        launch(points, rows(frame_.width, frame_.height));
        cl::Launch areas(programs[PIXELS], "surface_areas");
        areas.arg(constants_.memory()).arg(pyramid_);
        launch(areas, rows(frame_.width, frame_.height));
    }
    for (uint32_t k = 1; k < frame_.levels; ++k) {
        cl::Launch reduce(programs[PIXELS], "reduce_surface");
        reduce.arg(constants_.memory()).arg(pyramid_).arg(cl_uint(k));
        launch(reduce, rows(frame_.level[k].width, frame_.level[k].height));
    }
    const size_t tiles = size_t(frame_.tilesX) * frame_.tilesY;
    cl::Launch classify(programs[CLASSIFY], "classify_scatter");
    classify.arg(constants_.memory()).arg(pyramid_).arg(tables_).arg(nodes_).arg(tiles_).arg(counters_);
    launch(classify, itemRange(*device_, tiles));
    if (!light_.empty()) light_.enqueuePyramids(images, screen, events);
    // With the texels only, the screen's last step just copies.
    const bool alone = !light_.empty() && lights_.alone;
    if (alone) device_->fill(tiles_.get(), 0, tileBytes_, 0);
    // Interpolation also reads blocks that no tile needs, so sums of an earlier picture must not remain
    // there. All tiles that scatter need PEL_MIN_LEVELS.
    const size_t always = sumFloatsBelow(frame_.level, PEL_MIN_LEVELS) * sizeof(float);
    if (!alone) device_->fill(sums_.get(), always, sumBytes_ - always, 0);
    for (uint32_t k = frame_.levels - 1; k > 0 && !alone; --k) {
        cl::Launch level(programs[PIXELS], "scatter_level");
        level.arg(constants_.memory()).arg(pyramid_).arg(tables_).arg(nodes_).arg(tiles_);
        level.arg(cl_uint(k)).arg(sums_).arg(counters_);
        launch(level, rows(frame_.level[k].width, frame_.level[k].height));
    }
    if (fillsHidden()) light_.enqueueHidden(screen, events);
    cl::Launch scatter(programs[PIXELS], "scatter_screen");
    scatter.arg(constants_.memory()).arg(pyramid_).arg(tables_).arg(nodes_).arg(tiles_);
    scatter.arg(sums_).arg(fillsHidden() ? light_.hidden() : cl::Memory());
    scatter.arg(memory(images.irradiance)).arg(memory(images.out)).arg(counters_);
    launch(scatter, groupRange(*device_, groupsFor(*device_, tiles)));
    if (alone) light_.enqueueSums(images, screen, events);
}

ScatterCounts ScreenScatter::counts() {
    ScatterCounts counts{};
    if (counters_) device_->read(counters_.get(), 0, sizeof counts, &counts, true);
    return counts;
}

}  // namespace pel
