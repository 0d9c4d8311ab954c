// Beside kernels/curvature_lut.cl and kernels/shadow_lut.cl.
#include "ops/luts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/profile.h"
#include "ops/lut_check.h"
#include "shared/lut_integral.h"

namespace pel {
namespace {

// Nodes of a curvature row and Gauss points between two of them. 64 and 2 leave about 1e-7 (docs/luts.md).
constexpr int meshNodes = 64;
constexpr int meshPoints = 2;

// Row values (1/length, times the diffusion radius) are kept inside of what float arithmetic on their squares
// bears; beyond, tables are at their limits anyway.
constexpr double smallestRow = 1e-9, largestRow = 1e9;

double rowLimit(double length, double diffusionRadius) {
    return std::clamp(diffusionRadius / length, smallestRow, largestRow);
}

// Lengths in units of the profile's radius. A Gaussian narrower than 1e-8 of that and of the table's smallest
// radius changes no texel by more: it is kept from 0, where its density has no value.
std::vector<LutGaussian> deviceTerms(const GaussianSum& profile, double steepestRow) {
    std::vector<LutGaussian> terms;
    for (const GaussianTerm& term : profile.terms) {
        const double sigma =
            std::max(std::sqrt(term.variance) / profile.radius, 1e-8 / std::max(1.0, steepestRow));
        terms.push_back({float(sigma), float(term.weight[0]), float(term.weight[1]), float(term.weight[2])});
    }
    return terms;
}

double nodeAngle(int j) {
    const double q = double(j) / meshNodes;
    return std::numbers::pi / 2 * q * q * q * q;
}

std::vector<LutNode> meshOfNodes() {
    std::vector<LutNode> nodes;
    for (int j = 0; j <= meshNodes; ++j) {
        const double angle = nodeAngle(j), s = std::sin(angle / 2);
        nodes.push_back({float(angle), float(std::sin(angle)), float(std::cos(angle)), float(2 * s * s)});
    }
    return nodes;
}

// Cubic Hermite interpolation between nodes, for each column of the unlit half.
std::vector<LutColumn> columnsOf(uint32_t width) {
    std::vector<LutColumn> columns;
    for (uint32_t x = 0; x < (width + 1) / 2; ++x) {
        const double elevation = 1 - (x + 0.5) * 2 / width;  // = -u
        const double angle = std::asin(elevation);
        int j = int(meshNodes * std::pow(angle / (std::numbers::pi / 2), 0.25));
        while (j > 0 && nodeAngle(j) > angle) --j;
        j = std::min(j, meshNodes - 1);
        const double step = nodeAngle(j + 1) - nodeAngle(j), t = (angle - nodeAngle(j)) / step;
        columns.push_back({float((1 + 2 * t) * (1 - t) * (1 - t)), float(-step * t * (1 - t) * (1 - t)),
                           float(t * t * (3 - 2 * t)), float(step * t * t * (1 - t)), float(elevation), j});
    }
    return columns;
}

template <class T>
cl::Memory upload(Device& device, const std::vector<T>& values) {
    return device.allocate(values.size() * sizeof(T), values.data());
}

}  // namespace

Ref<Lut> integrateCurvatureLut(Ref<Device> device, const PelCurvatureLutDesc& desc) {
    checkCurvatureDesc(desc);
    PelLutInfo info = pelLutInfoDefaults();
    info.kind = PEL_LUT_CURVATURE;
    info.curvature = desc;
    Ref<Lut> lut = make<Lut>(device, info);

    const GaussianSum& profile = skinProfile();
    const double curvatureMin = rowLimit(desc.radiusMax, desc.diffusionRadius);
    const double curvatureMax = rowLimit(desc.radiusMin, desc.diffusionRadius);
    const std::vector<LutGaussian> terms = deviceTerms(profile, curvatureMax);
    const CurvatureParams params{desc.width,
                                 desc.height,
                                 cl_uint(terms.size()),
                                 float(curvatureMin),
                                 float((curvatureMax - curvatureMin) / desc.height),
                                 float(10 / 2.7)};

    const uint32_t lanes = device->info().mathWidth;
    const bool wide = lanes > 1;  // a CPU: long work-items; otherwise many
    const size_t group = wide ? 1 : 64, columnsPerItem = wide ? 256 : 1;
    const cl::Program program =
        device->programs().get("curvature_lut.cl", {{"PEL_GROUP", std::to_string(group)},
                                                    {"PEL_NODES", std::to_string(meshNodes)},
                                                    {"PEL_POINTS", std::to_string(meshPoints)},
                                                    {"PEL_COLUMNS", std::to_string(columnsPerItem)}});
    const cl::Memory gaussians = upload(*device, terms), nodes = upload(*device, meshOfNodes());
    const std::vector<LutColumn> columnWeights = columnsOf(desc.width);
    const cl::Memory columns = upload(*device, columnWeights);
    const size_t record = 2 * meshNodes + 4;
    const cl::Memory rows = device->allocate(record * desc.height * sizeof(cl_float4));

    cl::Launch rowLaunch(program, "curvatureRows");
    rowLaunch.arg(params).arg(gaussians).arg(nodes).arg(rows);
    device->launch(rowLaunch, {{(desc.height + lanes - 1) / lanes, 1, 1}, {group, 1, 1}});

    cl::Launch texelLaunch(program, "curvatureTexels");
    texelLaunch.arg(params).arg(rows).arg(columns).arg(lut->texels());
    const size_t items = (columnWeights.size() + columnsPerItem - 1) / columnsPerItem;
    device->launch(texelLaunch, {{items, desc.height + 1, 1}, {group, 1, 1}});
    return lut;
}

Ref<Lut> integrateShadowLut(Ref<Device> device, const PelShadowLutDesc& desc) {
    checkShadowDesc(desc);
    PelLutInfo info = pelLutInfoDefaults();
    info.kind = PEL_LUT_SHADOW;
    info.shadow = desc;
    Ref<Lut> lut = make<Lut>(device, info);

    const GaussianSum& profile = skinProfile();
    const double reciprocalMin = rowLimit(desc.widthMax, desc.diffusionRadius);
    const double reciprocalMax = rowLimit(desc.widthMin, desc.diffusionRadius);
    const std::vector<LutGaussian> terms = deviceTerms(profile, reciprocalMax);
    // The integral ends at 10 mm of the skin profile, whose radius is 2.7 mm.
    const double cut = 10 / 2.7;
    ShadowParams params{desc.width,
                        desc.height,
                        cl_uint(terms.size()),
                        float(reciprocalMin),
                        float((reciprocalMax - reciprocalMin) / desc.height),
                        desc.sharpening,
                        float(cut),
                        {}};
    for (int channel = 0; channel < 3; ++channel) {
        double mass = 0;
        for (const GaussianTerm& term : profile.terms)
            mass += term.weight[channel] * std::erf(cut * profile.radius / std::sqrt(2 * term.variance));
        params.mass[channel] = float(mass);
    }

    const uint32_t lanes = device->info().mathWidth;
    const size_t group = lanes > 1 ? 1 : 64, columnsPerItem = lanes > 1 ? 256 : 1;
    const cl::Program program = device->programs().get(
        "shadow_lut.cl",
        {{"PEL_GROUP", std::to_string(group)}, {"PEL_COLUMNS", std::to_string(columnsPerItem)}});
    const cl::Memory gaussians = upload(*device, terms);
    cl::Launch launch(program, "shadowTexels");
    launch.arg(params).arg(gaussians).arg(lut->texels());
    const size_t half = desc.width - desc.width / 2;
    device->launch(launch,
                   {{(half + columnsPerItem - 1) / columnsPerItem, desc.height + 1, 1}, {group, 1, 1}});
    return lut;
}

}  // namespace pel
