#include "diffusion/light_space.h"

#include <cstring>

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
    seen = PEL_PYRAMID_GUARD;  // margins, which vectors read
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
    if (!std::equal(now.begin(), now.end(), sent_.begin(), sent_.end(), sameLevels)) pyramid_.forget();
    pyramid_.resize(*device_, bytes, true);  // no light outside of the maps
    for (SizedMemory& marks : cells_) known_ &= !marks.resize(*device_, (size_t(cells) + 3) / 4 * 4);
    known_ &= !seen_.resize(*device_, (size_t(seen) + 3) / 4 * 4);
    mapUpload_.update(*device_, now.data(), now.size() * sizeof now[0]);
    sent_ = std::move(now);
}

void LightSpace::announce(const std::vector<ShaderLight>& lights, bool hidden, bool half) {
    hidden_ = hidden, half_ = half && !hidden;
    empty_ = true;
    mapFormat_ = content_ = 0;
    area_ = false;
    for (const ShaderLight& light : lights) {
        if (!shines(light)) continue;
        empty_ = false;
        mapFormat_ |= mapFormatCode(light);
        content_ = light.params.shadowContent;
        area_ |= isArea(light.params);
    }
}

void LightSpace::prepare(const std::vector<ShaderLight>& lights, const float origin[3], double narrowest,
                         double widest, size_t tileCount, size_t blocks) {
    maps_ = lightMaps(lights, origin, hidden_ ? narrowest / texelsPerReach : 0);
    if (empty_) return;
    images_.clear();
    for (LightMap& map : maps_) {
        map.constants.reach = float(widest);
        const cl::Memory& memory = map.image.buffer->memory();
        const auto found =
            std::ranges::find_if(images_, [&](const cl::Memory& m) { return m.get() == memory.get(); });
        map.constants.buffer = uint32_t(found - images_.begin());
        if (found == images_.end()) images_.push_back(memory);
    }
    if (images_.size() > PEL_LIGHT_BUFFERS)
        fail(PEL_ERROR_UNSUPPORTED, "the shadow maps of the lights lie in more than ", PEL_LIGHT_BUFFERS,
             " buffers: put several of them into one, with byteOffset");
    describeLevels();
    hiddenSums_.resize(*device_, hidden_ ? blocks * sizeof(float) : 0, true);
    parts_.resize(*device_, tileCount * sizeof(cl_uint));
    constexpr size_t samplesOfTile = size_t(PEL_DIFFUSION_TILE) * PEL_DIFFUSION_TILE / 4;
    samples_.resize(*device_, half_ ? tileCount * samplesOfTile * 4 * sizeof(float) : 0);
}

void LightSpace::addFiles(cl::ProgramKey& program) const {
    for (const char* file : {"light_seen", "light_texels", "light_reduce", "light_classify"})
        program.files.push_back(text("diffusion/", file, ".cl"));
    program.files.push_back(hidden_ ? "diffusion/light_hidden.cl" : "diffusion/scatter_light.cl");
    program.defines["PEL_SUM_GROUP"] = summingGroup(*device_);
    program.defines["PEL_HIDDEN"] = int(hidden_);
    program.defines["PEL_AREA_LIGHTS"] = int(area_);
    program.defines["PEL_HALF"] = int(half_);
    program.defines["PEL_FORMAT_SHADOW_MAP"] = mapFormat_;
    program.defines["PEL_SHADOW_CONTENT"] = content_;
}

void LightSpace::enqueuePyramids(const ScatterImages& images, const ScreenMemory& screen,
                                 std::vector<cl::Event>& events) {
    const auto launch = [&](cl::Launch& launch, const cl::Range& range) {
        events.push_back(device_->launch(launch, range));
    };
    ++frameNumber_;
    if (!known_) {
        for (const SizedMemory& marks : cells_)
            device_->fill(marks.memory().get(), 0, marks.bytes(), 0x01010101u * ((frameNumber_ - 1) & 255u));
        device_->fill(seen_.memory().get(), 0, seen_.bytes(), 0);
    }
    known_ = false;
    // An item for each vector of the largest map, and each map.
    uint32_t width = 0, height = 0, levels = 0;
    for (const LightMap& map : maps_) {
        width = std::max(width, map.constants.level[0].width);
        height = std::max(height, map.constants.level[0].height);
        levels = std::max(levels, map.constants.levels);
    }
    const auto forMaps = [&](cl::Range range) {
        range.items[2] = maps_.size();
        return range;
    };
    cl::Launch seen(screen.program, "light_seen", screen.frame,
                    images.positions ? images.positions : images.depth, images.ids, mapUpload_,
                    screen.pyramid, seen_, screen.counters);
    lightBufferArguments(seen, images_);
    const uint32_t across = device_->info().mathWidth == 1 ? (screen.width + 1) / 2 : screen.width;
    launch(seen, forMaps(vectorRange(*device_, across, (screen.height + 1) / 2)));
    cl::Launch texels(screen.program, "light_texels", mapUpload_, seen_, screen.counters, cells_[0],
                      cells_[1], frameNumber_, pyramid_);
    lightBufferArguments(texels, images_);
    launch(texels, forMaps(vectorRange(*device_, width, height)));
    for (uint32_t level = 1, count; level < levels; level += count) {
        count = levelsPerLaunch(*device_, levels - level);
        device_->launch(
            events, screen.program, "light_reduce",
            forMaps(blockRange(*device_, ((width - 1) >> level) + 1, ((height - 1) >> level) + 1, count)),
            mapUpload_, level, count, cells_[0], cells_[1], frameNumber_, seen_, pyramid_);
    }
    std::swap(cells_[0], cells_[1]);
    known_ = std::ranges::all_of(maps_, [](const LightMap& map) { return map.constants.levels > 1; });
    device_->launch(events, screen.program, "light_classify", summingRange(*device_, screen.tileCount),
                    screen.frame, screen.pyramid, screen.tables, screen.nodes, screen.tiles, mapUpload_,
                    cl_uint(maps_.size()), pyramid_, parts_, screen.counters);
}

uint64_t LightSpace::texelsOf(const uint32_t (&regions)[PEL_LIGHT_MAPS][4]) const {
    uint64_t texels = 0;
    for (size_t k = 0; k < maps_.size(); ++k) {
        const PelPyramidLevel& map = maps_[k].constants.level[0];
        const auto& r = regions[k];
        if (r[0]) texels += uint64_t(r[0] + r[1] - map.width) * (r[2] + r[3] - map.height);
    }
    return texels;
}

void LightSpace::enqueueHidden(const ScreenMemory& screen, std::vector<cl::Event>& events) {
    device_->launch(events, screen.program, "light_hidden",
                    groupRange(*device_, groupsFor(*device_, screen.tileCount)), screen.frame, screen.pyramid,
                    screen.tables, screen.nodes, screen.tiles, screen.sums, parts_, mapUpload_,
                    cl_uint(maps_.size()), pyramid_, hiddenSums_, screen.counters);
}

void LightSpace::enqueueSums(const ScatterImages& images, const ScreenMemory& screen,
                             std::vector<cl::Event>& events) {
    const size_t pixels = screen.tileCount * PEL_DIFFUSION_TILE * PEL_DIFFUSION_TILE,
                 group = launchPolicy(*device_).texels;
    constexpr size_t partsOfTile =
        (PEL_DIFFUSION_TILE >> PEL_PART_LEVEL) * (PEL_DIFFUSION_TILE >> PEL_PART_LEVEL);
    const auto launch = [&](const char* kernel, size_t items, const auto&... out) {
        // EACH of the kernels: with several lanes a work-item takes a part.
        const size_t each = device_->info().mathWidth == 1 ? 1 : items / (screen.tileCount * partsOfTile);
        device_->launch(events, screen.program, kernel,
                        groupRange(*device_, groupsFor(*device_, (items / each - 1) / group + 1)),
                        screen.frame, screen.pyramid, screen.tables, screen.nodes, parts_, mapUpload_,
                        cl_uint(maps_.size()), pyramid_, images.thickness, out..., screen.counters);
    };
    if (half_) launch("sample_light", pixels / 4, samples_);
    launch("scatter_light", pixels, samples_, images.out);
}

}  // namespace pel
