#include "diffusion/light_space.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/launch_policy.h"
#include "shading/features.h"
#include "shading/launch_ranges.h"
#include "shading/shading_constants.h"

namespace pel {
namespace {

// Texels are combined up to this fraction of the reach of the profile.
constexpr double texelsPerReach = 16;

uint32_t pointsOf(uint32_t level) {
    return level ? 2 : 1;
}

}  // namespace

// Returns the number of floats of all levels, and counts texels and cells.
uint64_t LightSpace::layOutLevels(std::vector<LightMap>& maps, bool hidden, uint64_t& seen, uint64_t& cells) {
    uint64_t floats = 0;
    cells = 0;
    seen = PEL_PYRAMID_GUARD;  // vectors read before and after what is set
    for (LightMap& map : maps) {
        PelLightMap& m = map.constants;
        uint32_t width = m.level[0].width, height = m.level[0].height;
        m.seen = uint32_t(seen);
        seen += uint64_t(width) * height;
        m.cells = uint32_t(cells);
        cells += uint64_t((width + PEL_LIGHT_CELL - 1) / PEL_LIGHT_CELL) *
                 ((height + PEL_LIGHT_CELL - 1) / PEL_LIGHT_CELL);
        m.levels = 0;
        for (PelPyramidLevel& level : m.level) {
            const uint32_t stride = (width + 15) / 16 * 16 + 3 * PEL_PYRAMID_GUARD;
            level = {uint32_t(floats), stride, width, height};
            floats += uint64_t(height + 2 * PEL_PYRAMID_ROWS) * PEL_LIGHT_PLANES(hidden) *
                      pointsOf(m.levels) * stride;
            ++m.levels;
            if (floats > UINT32_MAX || seen > UINT32_MAX)
                fail(PEL_ERROR_OUT_OF_MEMORY,
                     "the shadow maps of all lights are too large to sum light over");
            if (width == 1 && height == 1) break;
            width = (width + 1) / 2, height = (height + 1) / 2;
        }
    }
    seen += PEL_PYRAMID_GUARD;
    return floats + 2 * PEL_PYRAMID_GUARD;
}

uint64_t LightSpace::bytesFor(const std::vector<ShaderLight>& lights, bool hidden) {
    const float origin[3] = {};
    std::vector<LightMap> maps = lightMaps(lights, origin);
    uint64_t seen = 0, cells = 0;
    const uint64_t floats = maps.empty() ? 0 : layOutLevels(maps, hidden, seen, cells);
    return maps.empty() ? 0 : floats * sizeof(float) + (seen + 3) / 4 * 4 + 2 * cells;
}

void LightSpace::describeLevels() {
    uint64_t seen = 0, cells = 0;
    const size_t bytes = layOutLevels(maps_, hidden_, seen, cells) * sizeof(float);
    std::vector<PelLightMap> now;
    for (const LightMap& map : maps_) now.push_back(map.constants);
    const auto sameLevels = [](const PelLightMap& a, const PelLightMap& b) {
        return !std::memcmp(a.level, b.level, sizeof a.level);
    };
    if (bytes != pyramidBytes_ ||
        !std::equal(now.begin(), now.end(), sent_.begin(), sent_.end(), sameLevels)) {
        pyramid_ = cl::Memory();
        pyramidBytes_ = 0;
        pyramid_ = device_->allocateZeros(bytes);  // no light outside of the maps
        pyramidBytes_ = bytes;
    }
    const size_t cellBytes = (size_t(cells) + 3) / 4 * 4;
    if (cellBytes != cellBytes_) {
        for (cl::Memory& marks : cells_) marks = device_->allocate(cellBytes);
        cellBytes_ = cellBytes;
        cellsKnown_ = false;
    }
    const size_t seenBytes = (size_t(seen) + 3) / 4 * 4;
    if (seenBytes != seenBytes_) seen_ = device_->allocate(seenBytes), seenBytes_ = seenBytes;
    mapUpload_.update(*device_, now.data(), now.size() * sizeof now[0]);
    sent_ = std::move(now);
}

void LightSpace::announce(const std::vector<ShaderLight>& lights, bool hidden) {
    hidden_ = hidden;
    empty_ = true;
    mapFormat_ = content_ = 0;
    for (const ShaderLight& light : lights) {
        if (!shines(light)) continue;
        empty_ = false;
        mapFormat_ |= mapFormatCode(light);
        content_ = light.params.shadowContent;
    }
}

void LightSpace::prepare(const std::vector<ShaderLight>& lights, const float origin[3], double narrowest,
                         size_t tileCount, size_t blocks) {
    maps_ = lightMaps(lights, origin, hidden_ ? narrowest / texelsPerReach : 0);
    if (empty_) return;
    describeLevels();
    const size_t hiddenBytes = hidden_ ? blocks * sizeof(float) : 0;
    if (hiddenBytes != hiddenBytes_) {
        hiddenMemory_ = cl::Memory();
        if (hiddenBytes) hiddenMemory_ = device_->allocateZeros(hiddenBytes);
        hiddenBytes_ = hiddenBytes;
    }
    const size_t bytes = tileCount * sizeof(cl_uint);
    if (bytes != partBytes_) parts_ = device_->allocate(bytes), partBytes_ = bytes;
    if (!counters_) counters_ = device_->allocate(PEL_LIGHT_COUNTERS * sizeof(cl_uint));
}

void LightSpace::addFiles(cl::ProgramKey& program) const {
    for (const char* file : {"light_seen", "light_texels", "light_reduce", "light_classify"})
        program.files.push_back(text("diffusion/", file, ".cl"));
    program.files.push_back(hidden_ ? "diffusion/light_hidden.cl" : "diffusion/scatter_light.cl");
    program.defines["PEL_HIDDEN"] = text(int(hidden_));
    program.defines["PEL_FORMAT_SHADOW_MAP"] = text(mapFormat_);
    program.defines["PEL_SHADOW_CONTENT"] = text(content_);
}

// Work-items, of a vector of texels each.
cl::Range LightSpace::rows(const PelPyramidLevel& level) const {
    const uint32_t lanes = device_->info().mathWidth;
    return itemRange(*device_, size_t((level.width + lanes - 1) / lanes) * level.height);
}

void LightSpace::enqueuePyramids(const ScatterImages& images, const ScreenMemory& screen,
                                 std::vector<cl::Event>& events) {
    const auto memory = [](const ImageView& view) { return view ? view.buffer->memory() : cl::Memory(); };
    const auto launch = [&](cl::Launch& launch, const cl::Range& range) {
        events.push_back(device_->launch(launch, range));
    };
    device_->fill(counters_.get(), 0, PEL_LIGHT_COUNTERS * sizeof(cl_uint), 0);
    device_->fill(seen_.get(), 0, seenBytes_, 0);
    if (!cellsKnown_) device_->fill(cells_[0].get(), 0, cellBytes_, ~0u);
    cellsKnown_ = false;
    device_->fill(cells_[1].get(), 0, cellBytes_, 0);
    const uint32_t lanes = device_->info().mathWidth;
    for (uint32_t k = 0; k < maps_.size(); ++k) {
        cl::Launch seen(screen.program, "light_seen");
        seen.arg(screen.frame).arg(memory(images.positions ? images.positions : images.depth));
        seen.arg(memory(images.ids)).arg(mapUpload_.memory()).arg(cl_uint(k)).arg(memory(maps_[k].image));
        seen.arg(screen.pyramid).arg(seen_);
        launch(seen,
               itemRange(*device_, size_t((screen.width + lanes - 1) / lanes) * ((screen.height + 1) / 2)));
    }
    for (uint32_t k = 0; k < maps_.size(); ++k) {
        const PelLightMap& map = maps_[k].constants;
        cl::Launch texels(screen.program, "light_texels");
        texels.arg(mapUpload_.memory()).arg(cl_uint(k)).arg(memory(maps_[k].image)).arg(seen_);
        texels.arg(cells_[0]).arg(cells_[1]).arg(pyramid_);
        launch(texels, rows(map.level[0]));
        for (uint32_t level = 1; level < map.levels; ++level) {
            cl::Launch reduce(screen.program, "light_reduce");
            reduce.arg(mapUpload_.memory()).arg(cl_uint(k)).arg(cl_uint(level));
            reduce.arg(cells_[0]).arg(cells_[1]).arg(pyramid_);
            launch(reduce, rows(map.level[level]));
        }
    }
    std::swap(cells_[0], cells_[1]);
    cellsKnown_ = true;
    cl::Launch classify(screen.program, "light_classify");
    classify.arg(screen.frame).arg(screen.pyramid).arg(screen.tables).arg(screen.nodes).arg(screen.tiles);
    classify.arg(mapUpload_.memory()).arg(cl_uint(maps_.size())).arg(pyramid_).arg(parts_).arg(counters_);
    launch(classify, itemRange(*device_, screen.tileCount));
}

void LightSpace::enqueueHidden(const ScreenMemory& screen, std::vector<cl::Event>& events) {
    cl::Launch hidden(screen.program, "light_hidden");
    hidden.arg(screen.frame)
        .arg(screen.pyramid)
        .arg(screen.tables)
        .arg(screen.nodes)
        .arg(screen.tiles)
        .arg(screen.sums);
    hidden.arg(parts_)
        .arg(mapUpload_.memory())
        .arg(cl_uint(maps_.size()))
        .arg(pyramid_)
        .arg(hiddenMemory_)
        .arg(counters_);
    events.push_back(device_->launch(hidden, groupRange(*device_, groupsFor(*device_, screen.tileCount))));
}

void LightSpace::enqueueSums(const ScatterImages& images, const ScreenMemory& screen,
                             std::vector<cl::Event>& events) {
    cl::Launch scatter(screen.program, "scatter_light");
    scatter.arg(screen.frame).arg(screen.pyramid).arg(screen.tables).arg(screen.nodes).arg(parts_);
    scatter.arg(mapUpload_.memory())
        .arg(cl_uint(maps_.size()))
        .arg(pyramid_)
        .arg(images.out.buffer->memory())
        .arg(counters_);
    events.push_back(device_->launch(scatter, groupRange(*device_, groupsFor(*device_, screen.tileCount))));
}

LightCounts LightSpace::counts() {
    LightCounts counts{};
    if (counters_ && !maps_.empty()) device_->read(counters_.get(), 0, sizeof counts, &counts, true);
    return counts;
}

}  // namespace pel
