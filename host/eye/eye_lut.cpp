#include "eye/eye.h"

#include <cstring>
#include <numbers>

#include "core/launch_policy.h"
#include "lut/lut_terms.h"

namespace pel {
namespace {

constexpr double cellsPerTexel = 2.2;  // along each axis, for light along the gaze
constexpr double maxCells = 1 << 27,
                 maxProducts = 1ull << 34;  // of one table; either takes about two seconds on two cores
constexpr double cellsPerStep = 1 << 23, productsPerStep = 1 << 30;
constexpr double maxCount = 4294967295.0;
constexpr double maxFlux = 1.6;  // through the cornea, relative to the flux through the disk of the limbus
constexpr int fineSubTexels = 8, coarseSubTexels = 2, fineReach = 16;  // see texelWeight
constexpr const char* step = "integrating a caustic table";

double columnsOf(const PelEyeLutDesc& desc, const EyeShape& shape) {
    return std::ceil(cellsPerTexel * shape.limbus / shape.iris * desc.width);
}
double rowsOf(const PelEyeLutDesc& desc, const EyeShape& shape) {
    return std::ceil(cellsPerTexel * shape.limbus / shape.iris * desc.height * std::numbers::pi / 2);
}

PelEyeLutGrid gridOf(const PelEyeLutDesc& desc, const EyeShape& shape) {
    PelEyeLutGrid grid{};
    grid.width = desc.width;
    grid.height = desc.height;
    grid.depth = desc.depth;
    grid.columns = uint32_t(columnsOf(desc, shape));
    grid.rows = uint32_t(rowsOf(desc, shape));
    grid.anglePerSlice = float(shape.largestAngle / (desc.depth - 1));
    // Small enough that all light on one texel does not overflow its sum. A power of two is exact.
    const double limbus = shape.limbus / shape.iris,
                 texels = maxFlux * std::numbers::pi / 2 * limbus * limbus * desc.width / 2 * desc.height;
    grid.perTexel = float(std::exp2(std::floor(std::log2(maxCount / texels))));
    return grid;
}

// Share of the light entering at the centre of texel (0, 0) that leaves from texel (i, j), whose sides are dx
// and dy. The profile is sampled more finely where it is steep within a texel.
Rgb texelWeight(const ProfileShape& profile, int i, int j, double dx, double dy) {
    const int n = std::max(i, j) <= fineReach ? fineSubTexels : coarseSubTexels;
    Rgb share{};
    for (int v = 0; v < n; ++v)
        for (int u = 0; u < n; ++u) {
            const double x = (i + (u + 0.5) / n - 0.5) * dx, y = (j + (v + 0.5) / n - 0.5) * dy;
            share += dy * (dx * profile.radial(std::hypot(x, y))) / (n * n);
        }
    return share;
}

// Share of light for each texel within reach; all shares add up to 1.
struct Weights {
    int reachX, reachY;
    std::vector<cl_float4> values;

    Weights(const PelEyeLutDesc& desc, const EyeShape& shape, const Profile& profile) {
        // Size of a texel in the unit of the profile.
        const double radius = desc.millimetresPerUnit * shape.iris, dx = 2 * radius / desc.width,
                     dy = radius / desc.height;
        reachX = int(std::min<double>(std::ceil(profile.reach() / dx), desc.width));
        reachY = int(std::min<double>(std::ceil(profile.reach() / dy), 2 * desc.height));
        const double window =
            std::min(2.0 * reachX, 1.0 * desc.width) * std::min(2.0 * reachY, 2.0 * desc.height);
        products = window * desc.width * desc.height * desc.depth;
        if (products > maxProducts)
            invalidArgument("the profile reaches over ", reachX, " x ", reachY, " texels of a table of ",
                            desc.width, "x", desc.height, "x", desc.depth, ": ", products,
                            " products, at most ", maxProducts,
                            "; a smaller table or a larger PelEyeLutDesc.millimetresPerUnit is needed");
        values.resize(size_t(2 * reachX + 1) * size_t(2 * reachY + 1));
        Rgb others{};
        for (int j = 0; j <= reachY; ++j)
            for (int i = 0; i <= reachX; ++i) {
                const Rgb share = texelWeight(profile.shape(), i, j, dx, dy);
                const int mirrors = (i ? 2 : 1) * (j ? 2 : 1);
                if (i || j) others += mirrors * share;
                for (const int x : {-i, i})
                    for (const int y : {-j, j})
                        at(x, y) = {{float(share[0]), float(share[1]), float(share[2]), 0}};
            }
        // The centre takes the rest: the profile may be singular there.
        for (int c = 0; c < 3; ++c) at(0, 0).s[c] = float(std::max(0.0, 1 - others[c]));
    }
    cl_float4& at(int i, int j) { return values[size_t((j + reachY) * (2 * reachX + 1) + i + reachX)]; }

    double products;  // in the whole table
};

// Calls launch(first, count) for all of `total` parts, in steps of limited work if the caller may cancel.
template <class Launch>
void inSteps(Device& device, uint32_t total, double steps, bool interruptible, Launch&& launch) {
    const uint32_t count = interruptible ? std::max(uint32_t(total / std::max(steps, 1.0)), 1u) : total;
    for (uint32_t first = 0; first < total; first += count) {
        if (first > 0) {
            device.finish();
            device.progress(double(first) / total, step);
        }
        launch(first, std::min(count, total - first));
    }
}

}  // namespace

void checkEyeLutWork(const PelEyeLutDesc& desc, const char* structure) {
    const EyeShape shape(desc, structure);
    const double cells = columnsOf(desc, shape) * rowsOf(desc, shape) * desc.depth;
    if (cells > maxCells)
        invalidArgument(structure, ".irisRadius is ", shape.iris, " and limbusRadius ", shape.limbus,
                        ": a table of ", desc.width, "x", desc.height, "x", desc.depth, " texels would take ",
                        cells, " cells of light, at most ", maxCells,
                        "; a larger iris or a smaller table is needed");
}

Ref<Lut> integrateEyeLut(Ref<Device> device, const PelEyeLutDesc& desc, bool interruptible) {
    checkEyeLutDesc(desc);
    const EyeShape shape(desc, "PelEyeLutDesc");
    PelLutInfo info = pelLutInfoDefaults();
    info.kind = PEL_LUT_EYE;
    info.eye = desc;
    if (!desc.profile) std::strncpy(info.profile, "none", sizeof info.profile);
    Ref<Lut> lut = make<Lut>(device, info);
    std::optional<Weights> weights;
    if (desc.profile) weights.emplace(desc, shape, *lut->profile());

    PelEyeLutGrid grid = gridOf(desc, shape);
    const PelEyeShape unit = describeShape(shape, desc, 1 / shape.iris);
    const size_t group = launchPolicy(*device).texels, lanes = device->info().mathWidth;
    const cl::Memory sums =
        device->allocateZeros(size_t(desc.width) * desc.height * desc.depth * sizeof(cl_uint));
    const cl::Program& program =
        device->programs().get("eye/eye_lut.cl", {{"PEL_EYE_SCATTERS", weights.has_value()}});
    inSteps(
        *device, desc.depth, double(grid.columns) * grid.rows * desc.depth / cellsPerStep, interruptible,
        [&](uint32_t first, uint32_t count) {
            grid.firstSlice = first;
            cl::Launch splat(program, "eye_lut", unit, grid, sums);
            device->launch(splat, {{(grid.columns + lanes - 1) / lanes, grid.rows, count}, {group, 1, 1}});
        });

    const uint32_t rows = lut->height() + 1;
    if (!weights) {
        cl::Launch finish(program, "finish_eye_lut", unit, grid, lut->layout(), sums, lut->texels());
        device->launch(finish, {{lut->layout().rowTexels, rows, 1}, {group, 1, 1}});
        return lut;
    }
    const uint32_t border = uint32_t(weights->reachX), stride = desc.width + 2 * border + uint32_t(lanes);
    const cl::Memory plain = device->allocate(size_t(stride) * lut->height() * sizeof(float)),
                     shares = device->upload(weights->values);
    cl::Launch spread(program, "plain_eye_lut", unit, grid, stride, border, sums, plain);
    device->launch(spread, {{stride, lut->height(), 1}, {group, 1, 1}});
    const double steps = weights->products / productsPerStep;
    inSteps(*device, rows, steps, interruptible, [&](uint32_t first, uint32_t count) {
        cl::Launch scatter(program, "scatter_eye_lut", grid, lut->layout(), plain, stride, shares,
                           cl_int(weights->reachX), cl_int(weights->reachY), first, lut->texels());
        device->launch(scatter, {{(desc.width + lanes - 1) / lanes, count, 1}, {group, 1, 1}});
    });
    return lut;
}

}  // namespace pel
