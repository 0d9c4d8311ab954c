#include "shading/tap_cells.h"

#include "core/launch_policy.h"
#include "shading/features.h"
#include "shading/kept_maps.h"
#include "shading/shade_variants.h"
#include "shading/shading_constants.h"

namespace pel {
namespace {

// A node costs a third of a pixel that takes taps, as a twentieth to a fifth of the pixels in a frame of a
// head do.
constexpr uint64_t pixelsPerNode = 8;
// Limit of all grids together, per pixel of the frame: lights with several maps and materials with several
// disks would take much memory.
constexpr uint64_t floatsPerPixel = 16;

bool hasDisk(const ShaderState& state, const ShaderMaterial& material) {
    constexpr uint32_t both = PEL_FEATURE_DEEP_SCATTER | PEL_FEATURE_THICKNESS_TAPS;
    return (materialNeeds(state, material) & both) == both;
}

uint64_t samplesAlong(uint32_t nodes) {
    return PEL_TAP_SAMPLES(uint64_t(nodes));
}

bool mayBeSampled(const ShaderLight& light) {
    return light.images[PEL_LIGHT_SHADOW_MAP] && !isCube(light.params);
}

class TapCells final : public Pass {
  public:
    static bool needed(const ShaderPlan& plan) {
        return plan.features & PEL_FEATURE_THICKNESS_TAPS && !mapCells(plan.state).empty();
    }

    void allocate(const Ref<Device>& device, ShaderPlan& plan) override {
        maps_ = mapCells(plan.state);
        plan.tapCells = cl::Memory();
        MapsKey key("tap_cells");
        for (const MapCells& map : maps_) {
            key.addMap(plan.state.lights[map.light], map.cascade);
            key.add(&map.cells, sizeof map.cells);
        }
        cells_.allocate(device, std::move(key),
                        (maps_.back().cells.samples + maps_.back().samples()) * sizeof(float));
        plan.tapCells = cells_.memory();
    }
    size_t bytes() const override { return cells_.bytes(); }

    std::vector<cl::ProgramKey> programs(const Device& device, const ShaderPlan& plan) const override {
        return {shadeKey(device, plan.state, plan.variants[0])};
    }

    void enqueueAround(PassWork& work) override {
        const ShaderPlan& plan = work.plan;
        if (cells_.made()) return;
        const bool lists =
            (plan.state.options.tileLists != PEL_TILES_NO_LIST || plan.scratch) && !cells_.isShared();
        const uint32_t lanes = work.device.info().mathWidth;
        for (const MapCells& map : maps_) {
            const ShaderLight& light = plan.state.lights[map.light];
            const auto launch = [&](const char* kernel, bool readsMap, uint64_t items) {
                cl::Launch one(program(), kernel, work.constants.frameMemory(), work.constants.lights(),
                               lists ? plan.tileLists : cl::Memory(), cl_uint(map.light),
                               cl_uint(map.cascade), cl_uint(map.disk));
                if (readsMap) one.arg(*shadowCascade(light, map.cascade).map);
                one.arg(cells_.memory());
                work.launch(one, {{size_t(items), 1, 1}, {launchPolicy(work.device).texels, 1, 1}});
            };
            launch("tap_samples", true,
                   (samplesAlong(map.cells.columns) + lanes - 1) / lanes * samplesAlong(map.cells.rows));
            const uint32_t run = cellsRun(work.device);
            launch("tap_cells", false, uint64_t(map.cells.columns + run - 1) / run * map.cells.rows);
        }
        cells_.setMade(work);
    }

  private:
    KeptMaps cells_;
    std::vector<MapCells> maps_;
};

}  // namespace

uint64_t MapCells::samples() const {
    constexpr uint64_t lanes = 16;  // max lanes of a vector
    return (samplesAlong(cells.columns) + lanes - 1) / lanes * lanes * samplesAlong(cells.rows);
}

uint32_t cellsRun(const Device& device) {
    return device.info().mathWidth == 1 ? 1 : 32;
}

std::vector<float> tapDisks(const ShaderState& state) {
    std::vector<float> disks;
    for (const auto& [id, material] : state.materials) {
        if (disks.size() == PEL_TAP_DISKS || !hasDisk(state, material)) continue;
        if (std::ranges::find(disks, material.params.thicknessFilterRadius) == disks.end())
            disks.push_back(material.params.thicknessFilterRadius);
    }
    return disks;
}

uint32_t tapDiskOf(const std::vector<float>& disks, const ShaderState& state,
                   const ShaderMaterial& material) {
    if (!hasDisk(state, material)) return PEL_TAP_DISKS;
    const auto found = std::ranges::find(disks, material.params.thicknessFilterRadius);
    return found == disks.end() ? PEL_TAP_DISKS : uint32_t(found - disks.begin());
}

float tapScale(const ShaderLight& light, uint32_t cascade, int axis) {
    if (cascade == 0) return 1;
    return float(uvPerLength(*shadowCascade(light, cascade).worldToShadow, axis) /
                 uvPerLength(light.params.worldToShadow, axis));
}

bool mayHaveCells(const ShaderState& state) {
    if (state.options.everyPixel || state.options.rotateTaps || state.images[PEL_SLOT_THICKNESS])
        return false;
    return !tapDisks(state).empty() && std::ranges::any_of(state.lights, mayBeSampled);
}

std::vector<MapCells> mapCells(const ShaderState& state) {
    std::vector<MapCells> maps;
    if (!mayHaveCells(state)) return maps;
    const ImageView& frame = state.images[PEL_SLOT_RADIANCE];
    const uint64_t pixels = uint64_t(frame.width) * frame.height, most = pixels / pixelsPerNode;
    const std::vector<float> disks = tapDisks(state);
    uint64_t floats = 0;
    for (uint32_t i = 0; i < state.lights.size(); ++i) {
        const ShaderLight& light = state.lights[i];
        if (!mayBeSampled(light)) continue;
        for (uint32_t k = 0; k < cascadesOf(light); ++k)
            for (uint32_t d = 0; d < disks.size(); ++d) {
                PelTapCells cells{};
                uint32_t nodes[2];
                for (int axis = 0; axis < 2; ++axis) {
                    const double perUv = PEL_CELLS_PER_RADIUS / (double(disks[d]) * tapScale(light, k, axis));
                    cells.perUv[axis] = float(perUv);
                    // A radius on either side of the map, and one node more.
                    const double along = std::ceil(perUv + 2 * PEL_CELLS_PER_RADIUS) + 1;
                    nodes[axis] = along <= double(most) ? uint32_t(along) : 0;
                }
                cells.columns = nodes[0];
                cells.rows = nodes[1];
                cells.offset = uint32_t(floats);
                const uint64_t count = uint64_t(nodes[0]) * nodes[1], size = count * PEL_NODE_TAPS;
                if (count == 0 || count > most ||
                    floats + size > std::min<uint64_t>(UINT32_MAX, floatsPerPixel * pixels))
                    continue;
                cells.samples = uint32_t(floats + size);
                maps.push_back({i, k, d, cells});
                floats += size + maps.back().samples();
            }
    }
    return maps;
}

constinit const PassKind tapCellsPass = passKind<TapCells>("tap_cells");

}  // namespace pel
