#include "eye/eye_lut.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "eye/eye_constants.h"
#include "lut/eye_shape.h"
#include "lut/lut_check.h"

namespace pel {
namespace {

constexpr size_t group = 8;
constexpr double cellsPerTexel = 2.2;  // along each axis, where light falls in along the gaze
constexpr double counts = 4294967295.0;
constexpr double mostFlux = 1.6;  // through a cornea, of that through the limbus' disc
constexpr int subTexels = 8;      // points along a side of a texel, for means of the profile

PelEyeLutGrid gridOf(const PelEyeLutDesc& desc, const EyeShape& shape) {
    PelEyeLutGrid grid{};
    grid.width = desc.width;
    grid.height = desc.height;
    grid.depth = desc.depth;
    const double limbus = shape.limbus / shape.iris;
    grid.columns = uint32_t(std::ceil(cellsPerTexel * limbus * desc.width));
    grid.rows = uint32_t(std::ceil(cellsPerTexel * limbus * desc.height * std::numbers::pi / 2));
    grid.anglePerSlice = float(shape.largestAngle / (desc.depth - 1));
    // Even if all light fell on one texel, its sum would not overflow. A power of two loses nothing.
    const double texels = mostFlux * std::numbers::pi / 2 * limbus * limbus * desc.width / 2 * desc.height;
    grid.perTexel = float(std::exp2(std::floor(std::log2(counts / texels))));
    return grid;
}

// The profile's light on each texel, of light that comes from a texel's middle; together 1. What lies too near the middle for the points is
// the middle's.
struct Weights {
    int reachX = 0, reachY = 0;
    std::vector<cl_float4> values;
};

Weights weightsOf(const PelEyeLutDesc& desc, const EyeShape& shape, const Profile& profile) {
    // Texels, in the profile's unit.
    const double mm = desc.millimetresPerUnit * shape.iris, dx = 2 * mm / desc.width, dy = mm / desc.height;
    Weights w;
    w.reachX = std::min(int(std::ceil(profile.reach() / dx)), int(desc.width));
    w.reachY = std::min(int(std::ceil(profile.reach() / dy)), 2 * int(desc.height));
    Rgb others{};
    for (int j = -w.reachY; j <= w.reachY; ++j)
        for (int i = -w.reachX; i <= w.reachX; ++i) {
            Rgb share{};
            for (int v = 0; v < subTexels; ++v)
                for (int u = 0; u < subTexels; ++u) {
                    const double d = std::hypot((i + (u + 0.5) / subTexels - 0.5) * dx,
                                                (j + (v + 0.5) / subTexels - 0.5) * dy);
                    const Rgb r = profile.shape().radial(d);
                    for (int c = 0; c < 3; ++c) share[c] += r[c] * dx * dy / (subTexels * subTexels);
                }
            if (i || j)
                for (int c = 0; c < 3; ++c) others[c] += share[c];
            w.values.push_back({{float(share[0]), float(share[1]), float(share[2]), 0}});
        }
    cl_float4& middle = w.values[w.values.size() / 2];
    for (int c = 0; c < 3; ++c) middle.s[c] = float(std::max(0.0, 1 - others[c]));
    return w;
}

}  // namespace

Ref<Lut> integrateEyeLut(Ref<Device> device, const PelEyeLutDesc& desc) {
    checkEyeDesc(desc);
    const EyeShape shape(desc, "PelEyeLutDesc");
    PelLutInfo info = pelLutInfoDefaults();
    info.kind = PEL_LUT_EYE;
    info.eye = desc;
    if (!desc.profile) std::strncpy(info.profile, "none", sizeof info.profile);
    Ref<Lut> lut = make<Lut>(device, info);
    const PelEyeLutGrid grid = gridOf(desc, shape);
    const PelEyeShape unit = describeShape(shape, desc, 1 / shape.iris);
    const size_t sumBytes = size_t(desc.width) * desc.height * desc.depth * sizeof(cl_uint);
    const cl::Memory sums = device->allocateZeros(sumBytes);
    const cl::Program& program =
        device->programs().get({{"eye/eye_lut.cl"}, {{"PEL_GROUP", std::to_string(group)}}});
    const size_t lanes = device->info().mathWidth;
    cl::Launch splat(program, "eye_lut");
    splat.arg(unit).arg(grid).arg(sums);
    device->launch(splat, {{(grid.columns + lanes - 1) / lanes, grid.rows, grid.depth}, {group, 1, 1}});
    const cl::Range texels{{lut->layout().rowTexels, lut->height() + size_t(1), 1}, {group, 1, 1}};
    const bool scatters = desc.profile != nullptr;
    const cl::Memory plain =
        scatters ? device->allocate(size_t(lut->layout().rowTexels) * (lut->height() + 1) * sizeof(cl_float4))
                 : lut->texels();
    cl::Launch finish(program, "finish_eye_lut");
    finish.arg(unit).arg(grid).arg(lut->layout()).arg(sums).arg(plain);
    device->launch(finish, texels);
    if (scatters) {
        const Weights w = weightsOf(lut->info().eye, shape, *lut->profile());
        const cl::Memory weights = device->allocate(w.values.size() * sizeof(cl_float4), w.values.data());
        cl::Launch scatter(program, "scatter_eye_lut");
        scatter.arg(grid).arg(lut->layout()).arg(plain).arg(weights);
        scatter.arg(cl_int(w.reachX)).arg(cl_int(w.reachY)).arg(lut->texels());
        device->launch(scatter, texels);
    }
    return lut;
}

}  // namespace pel
