#include "mesh/mesh_smoothing.h"

#include <algorithm>
#include <cmath>

namespace pel {
namespace {

constexpr uint32_t mostStages = 4000;

cl::Program program(const MeshTopology& topology, const SlotData& data, const Rows& rows,
                    PelSmoothingWeights weights = PEL_SMOOTHING_COTANGENT) {
    return topology.device().programs().get("mesh/curvature_diffuse.cl",
                                            {{"MESH_STRIDE", std::to_string(data.stride)},
                                             {"MESH_LISTED", listed(rows)},
                                             {"DIFFUSE_AREA", std::to_string(weights == PEL_SMOOTHING_AREA)},
                                             {"MESH_RUNS", haveRuns(topology)},
                                             {"PEL_WIDTH", std::to_string(width(topology.device()))}});
}

// Weights for a diffusion over `time`, length^2; returns the memory that holds them.
const cl::Memory& makeWeights(MeshTopology& topology, const SlotData& data, PelSmoothingWeights kind, float time,
                              float limit, float crease2, const Scratch& scratch, const cl::Memory& rates,
                              const Rows& rows) {
    const cl::Memory& weights = scratch(MeshTopology::scratchWeights, topology.ringEntries() * sizeof(float));
    cl::Launch launch(program(topology, data, rows, kind), "diffuse_weights");
    ringArguments(topology, launch, rows);
    launch.arg(data.positions.memory).arg(data.positions.layout.offset);
    launch.arg(data.normals.memory).arg(data.normals.layout.offset);
    launch.arg(time).arg(limit).arg(crease2).arg(weights).arg(rates);
    launchRows(topology, launch, rows, width(topology.device()));
    return weights;
}

// The rate that all but the worst percent of the slots stay below: slivers must not set the price for
// everybody.
float measureRate(MeshTopology& topology, const SlotData& data, PelSmoothingWeights kind, const Scratch& scratch,
                  const cl::Memory& rates) {
    makeWeights(topology, data, kind, 0.0f, 0.0f, 0.0f, scratch, rates, {});
    std::vector<float> values(topology.slots());
    topology.device().read(rates.get(), 0, values.size() * sizeof(float), values.data(), true);
    const auto place = values.begin() + std::ptrdiff_t(values.size() / 100 * 99);
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

// Stable up to rate * time = (s^2 + s) / 2 in s stages, the rate being half the largest eigenvalue at most.
float spanOf(uint32_t stages) {
    const float s = float(stages);
    return s * s + s;
}

}  // namespace

void smoothUniform(MeshTopology& topology, const cl::Defines& defines, uint32_t count, SlotPlanes& values,
                   const RowsOfPass& rows) {
    for (uint32_t pass = 0; pass < count; ++pass) {
        const Rows here = rows ? rows(pass) : Rows{};
        cl::Defines variant = defines;
        variant["MESH_LISTED"] = listed(here);
        cl::Launch smooth(topology.device().programs().get("mesh/curvature.cl", variant), "curvature_smooth");
        ringArguments(topology, smooth, here);
        smooth.arg(values.planeStride).arg(values.from).arg(values.to);
        launchRows(topology, smooth, here, width(topology.device()), values.planes);
        values.advance();
    }
}

Diffusion planDiffusion(MeshTopology& topology, const SlotData& data, const PelCurvatureParams& params,
                        const Scratch& scratch, const cl::Memory& rates) {
    Diffusion diffusion;
    diffusion.weights = params.smoothingWeights;
    const float radius = params.smoothingRadius;
    if (!(radius > 0) || topology.ringEntries() == 0) return diffusion;
    // A blur of standard deviation r is the heat equation after r^2 / 2; this is the time of one super step.
    diffusion.time = 0.5f * radius * radius / MESH_SUPER_STEPS;
    uint32_t stages = params.smoothingStages;
    if (stages == 0) {
        float& rate = topology.diffusionRate[params.smoothingWeights];
        if (!(rate > 0)) rate = measureRate(topology, data, params.smoothingWeights, scratch, rates);
        const double wanted = MESH_SUPER_STEPS * std::sqrt(2.0 * diffusion.time * rate);
        if (wanted > mostStages)
            invalidArgument("PelCurvatureParams.smoothingRadius is ", radius, ", which would take ", wanted,
                            " stages on a mesh this fine; at most ", mostStages, " are done");
        stages = uint32_t(std::ceil(wanted));
    }
    diffusion.stages = std::max(1u, (stages + MESH_SUPER_STEPS - 1) / MESH_SUPER_STEPS);
    // The normal turns by 2 sin(angle / 2) in length.
    const float turn = 2.0f * std::sin(0.5f * params.smoothingCrease);
    diffusion.turn2 = turn * turn;
    return diffusion;
}

void smoothToRadius(MeshTopology& topology, const SlotData& data, const Diffusion& diffusion,
                    SlotPlanes& values, const Scratch& scratch, const Rows& weighed, const RowsOfPass& rows) {
    const float span = spanOf(diffusion.stages);
    // `to` is free until the first stage.
    const cl::Memory& weights = makeWeights(topology, data, diffusion.weights, diffusion.time, 0.5f * span, diffusion.turn2,
                                            scratch, values.to, weighed);
    for (uint32_t stage = 0; stage < diffusion.passes(); ++stage) {
        const uint32_t j = stage % diffusion.stages + 1;
        const float mu = j == 1 ? 1.0f : float(2 * j - 1) / float(j),
                    nu = j == 1 ? 0.0f : 1.0f / float(j) - 1.0f;
        const Rows here = rows ? rows(stage) : Rows{};
        cl::Launch launch(program(topology, data, here), "diffuse_stage");
        ringArguments(topology, launch, here);
        launch.arg(weights).arg(values.planeStride);
        launch.arg(values.from).arg(j == 1 ? values.from : values.before).arg(values.to);
        launch.arg(mu).arg(nu).arg(mu * 2.0f / span);
        launchRows(topology, launch, here, width(topology.device()), values.planes);
        values.advance();
    }
}

}  // namespace pel
