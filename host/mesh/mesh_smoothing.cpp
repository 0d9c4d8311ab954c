#include "mesh/mesh_passes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pel {
namespace {

cl::Program program(const MeshTopology& topology, const SlotData& data, const Rows& rows,
                    PelSmoothingWeights weights = PEL_SMOOTHING_COTANGENT) {
    return topology.device().programs().get("mesh/curvature_diffuse.cl",
                                            {{"PEL_MESH_STRIDE", data.stride},
                                             {"PEL_MESH_LISTED", listed(rows)},
                                             {"DIFFUSE_AREA", weights == PEL_SMOOTHING_AREA},
                                             {"PEL_MESH_RUNS", haveRuns(topology)},
                                             {"PEL_WIDTH", width(topology.device())}});
}

// Weights, limited to a largest rate (0: no limit). Returns the memory that holds them.
const cl::Memory& makeWeights(MeshTopology& topology, const SlotData& data, PelSmoothingWeights kind,
                              float limit, float crease2, const Scratch& scratch, const Rows& rows) {
    const cl::Memory& weights = scratch(MeshTopology::scratchWeights, topology.ringEntries() * sizeof(float));
    const size_t slotBytes = (topology.slots() + PEL_MESH_LANES) * sizeof(float);
    const cl::Memory rates = scratch(MeshTopology::scratchRates, slotBytes);
    const bool area = kind == PEL_SMOOTHING_AREA;
    const cl::Memory factors = area ? scratch(MeshTopology::scratchFactors, slotBytes) : rates;
    const cl::Program kernels = program(topology, data, rows, kind);
    launchRings(topology, kernels, "diffuse_weights", rows, 1, data.positions.memory,
                data.positions.layout.offset, data.normals.memory, data.normals.layout.offset, limit, crease2,
                weights, factors);
    if (area) launchRings(topology, kernels, "diffuse_balance", rows, 1, weights, factors, rates);
    if (area && limit > 0) launchRings(topology, kernels, "diffuse_limit", rows, 1, limit, weights, rates);
    return weights;
}

// The largest rate that is used, and the median rate. The limit keeps slivers from setting the number of
// stages for the whole mesh. Cotangent weights are limited for the worst percent of the slots, which only
// makes those slots slower. Area weights would conduct less, so hardly any are limited. Both are taken from
// some 65,536 slots at most, which give the place of the 99th percent to 0.04 percent.
DiffusionRates measureRates(MeshTopology& topology, const SlotData& data, PelSmoothingWeights kind,
                            const Scratch& scratch) {
    makeWeights(topology, data, kind, 0.0f, 0.0f, scratch, {});
    std::vector<float> values(topology.slots());
    topology.device().read(scratch(MeshTopology::scratchRates, 0).get(), 0, values.size() * sizeof(float),
                           values.data(), true);
    std::erase_if(values, [](float rate) { return !(rate > 0); });  // vertices without neighbours
    if (values.empty()) return {};
    std::vector<float> sample;
    for (size_t i = 0, step = 1 + values.size() / 65536; i < values.size(); i += step)
        sample.push_back(values[i]);
    const auto place = [&](size_t percent) {
        const auto at = sample.begin() + std::ptrdiff_t(sample.size() * percent / 100);
        std::nth_element(sample.begin(), at, sample.end());
        return *at;
    };
    const float middle = place(50), most = place(99);
    if (kind == PEL_SMOOTHING_COTANGENT) return {most, middle};
    return {std::min(16 * most, *std::max_element(values.begin(), values.end())), middle};
}

}  // namespace

void smoothUniform(MeshTopology& topology, const cl::Defines& defines, uint32_t count, SlotPlanes& values,
                   const RowsOfPass& rows) {
    for (uint32_t pass = 0; pass < count; ++pass) {
        const Rows here = rows ? rows(pass) : Rows{};
        cl::Defines variant = defines;
        variant["PEL_MESH_LISTED"] = listed(here);
        launchRings(topology, topology.device().programs().get("mesh/curvature.cl", variant),
                    "curvature_smooth", here, values.planes, values.planeStride, values.from, values.to);
        values.advance();
    }
}

Diffusion planDiffusion(MeshTopology& topology, const SlotData& data, const PelCurvatureParams& params,
                        const Scratch& scratch, DiffusionRates& rates, bool measure) {
    Diffusion diffusion;
    diffusion.weights = params.smoothingWeights;
    const double radius = params.smoothingRadius, time = 0.5 * radius * radius;
    if (!(radius > 0) || topology.ringEntries() == 0) return diffusion;
    if (params.smoothingStages > 0) {
        diffusion.limit = float(spanOfStages(params.smoothingStages) / time);
        diffusion.coefficients = heatCoefficients(params.smoothingStages, time * diffusion.limit, 0);
    } else {
        if (measure || !(rates.most > 0))
            rates = measureRates(topology, data, params.smoothingWeights, scratch);
        const double span = time * rates.most, wanted = stagesOfSpan(span);
        if (!(wanted <= mostStages))
            invalidArgument("PelCurvatureParams.smoothingRadius is ", radius, ", which would take ", wanted,
                            " stages on a mesh this fine; at most ", mostStages, " are done");
        if (!(span > 0)) return diffusion;
        diffusion.limit = rates.most;
        // Vertices with the median rate are sqrt(4 / rate) apart.
        diffusion.coefficients = heatCoefficients(uint32_t(wanted), span, 0.25 * rates.most / rates.middle);
    }
    // A normal that turns by `angle` changes by a vector of length 2 sin(angle / 2).
    const float turn = 2.0f * std::sin(0.5f * params.smoothingCrease);
    diffusion.turn2 = turn * turn;
    return diffusion;
}

void smoothToRadius(MeshTopology& topology, const SlotData& data, const Diffusion& diffusion,
                    SlotPlanes& values, const Scratch& scratch, const Rows& weighed, const RowsOfPass& rows) {
    const cl::Memory& weights =
        makeWeights(topology, data, diffusion.weights, diffusion.limit, diffusion.turn2, scratch, weighed);
    const cl::Memory& sum =
        scratch(MeshTopology::scratchSum, size_t(values.planeStride) * values.planes * sizeof(float));
    for (uint32_t stage = 0; stage < diffusion.passes(); ++stage) {
        const Rows here = rows ? rows(stage) : Rows{};
        launchRings(topology, program(topology, data, here), "diffuse_stage", here, values.planes, weights,
                    values.planeStride, values.from, stage == 0 ? values.from : values.before, values.to, sum,
                    int(stage == 0), diffusion.coefficients[0], diffusion.coefficients[stage + 1]);
        values.advance();
    }
    values.from = sum;
}

// erfc of this is 2e-4.
constexpr double reach = 2.63;

double stagesOfSpan(double span) {
    return std::ceil(1 + reach * std::sqrt(2 * span));
}

double spanOfStages(uint32_t stages) {
    const double wide = (stages > 1 ? stages - 1.0 : 0.5) / reach;
    return 0.5 * wide * wide;
}

std::vector<float> heatCoefficients(uint32_t stages, double span, double correction) {
    // Cosine sums over Chebyshev points, twice as many as there are terms. The aliasing error is then far
    // below the truncation error.
    const size_t points = 2 * (size_t(stages) + 8);
    std::vector<double> cosines(4 * points), terms(stages + 1);
    for (size_t i = 0; i < cosines.size(); ++i)
        cosines[i] = std::cos(std::numbers::pi * double(i) / double(2 * points));
    for (size_t j = 0; j < points; ++j) {
        const double x = 1 - cosines[2 * j + 1],
                     value = std::exp(-span * (x + correction * x * x)) / double(points);
        for (size_t k = 0; k <= stages; ++k)
            terms[k] += (k ? 2 : 1) * value * cosines[(2 * j + 1) * k % cosines.size()];
    }
    double total = 0;
    for (double term : terms) total += term;
    std::vector<float> coefficients;
    for (double term : terms) coefficients.push_back(float(term / total));
    return coefficients;
}

}  // namespace pel
