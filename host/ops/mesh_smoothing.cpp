#include "ops/mesh_smoothing.h"

#include <algorithm>
#include <cmath>

namespace pel {
namespace {

constexpr uint32_t mostStages = 4000;

// Weights for a diffusion over `time`, length^2; returns the memory that holds them.
const cl::Memory& makeWeights(MeshTopology& topology, const cl::Program& program, const SlotData& data,
                              float time, float limit, float crease2, const cl::Memory& rates) {
    const cl::Memory& weights =
        topology.scratch(MeshTopology::scratchWeights, topology.ringEntries() * sizeof(float));
    cl::Launch launch(program, "diffuse_weights");
    launch.arg(topology.slots()).arg(topology.slices()).arg(topology.rings());
    launch.arg(data.positions.memory).arg(data.positions.layout.offset);
    launch.arg(data.normals.memory).arg(data.normals.layout.offset);
    launch.arg(time).arg(limit).arg(crease2).arg(weights).arg(rates);
    topology.device().launch(launch, overSlots(topology));
    return weights;
}

// The rate that all but the worst percent of the slots stay below: slivers must not set the price for
// everybody.
float measureRate(MeshTopology& topology, const cl::Program& program, const SlotData& data,
                  const cl::Memory& rates) {
    makeWeights(topology, program, data, 0.0f, 0.0f, 0.0f, rates);
    std::vector<float> values(topology.slots());
    topology.device().read(rates.get(), 0, values.size() * sizeof(float), values.data(), true);
    const auto place = values.begin() + std::ptrdiff_t(values.size() / 100 * 99);
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

}  // namespace

void smoothUniform(MeshTopology& topology, const cl::Program& passes, uint32_t count, SlotPlanes& values) {
    for (uint32_t pass = 0; pass < count; ++pass) {
        cl::Launch smooth(passes, "curvature_smooth");
        smooth.arg(topology.slots()).arg(topology.slices()).arg(topology.rings());
        smooth.arg(values.planeStride).arg(values.from).arg(values.to);
        topology.device().launch(smooth, overSlots(topology, values.planes));
        std::swap(values.from, values.to);
    }
}

void smoothToRadius(MeshTopology& topology, const SlotData& data, float radius, float crease, uint32_t stages,
                    SlotPlanes& values) {
    if (topology.ringEntries() == 0) return;
    Device& device = topology.device();
    const cl::Program program = device.programs().get(
        "curvature_diffuse.cl",
        {{"MESH_STRIDE", std::to_string(data.stride)}, {"PEL_WIDTH", std::to_string(width(device))}});
    // A blur of standard deviation r is the heat equation after r^2 / 2; this is the time of one super step.
    const float time = 0.5f * radius * radius / MESH_SUPER_STEPS;
    // `to` is free until the first stage.
    if (stages == 0) {
        if (!(topology.diffusionRate > 0))
            topology.diffusionRate = measureRate(topology, program, data, values.to);
        const double wanted = MESH_SUPER_STEPS * std::sqrt(2.0 * time * topology.diffusionRate);
        if (wanted > mostStages)
            invalidArgument("PelCurvatureParams.smoothingRadius is ", radius, ", which would take ", wanted,
                            " stages on a mesh this fine; at most ", mostStages, " are done");
        stages = uint32_t(std::ceil(wanted));
    }
    stages = std::max(1u, (stages + MESH_SUPER_STEPS - 1) / MESH_SUPER_STEPS);  // of each super step
    // Stable up to rate * time = (s^2 + s) / 2, the rate being half the largest eigenvalue at most.
    const float s = float(stages), span = s * s + s;
    // The normal turns by 2 sin(angle / 2) in length.
    const float turn = 2.0f * std::sin(0.5f * crease);
    const cl::Memory& weights =
        makeWeights(topology, program, data, time, 0.5f * span, turn * turn, values.to);
    for (uint32_t stage = 0; stage < stages * MESH_SUPER_STEPS; ++stage) {
        const uint32_t j = stage % stages + 1;
        const float mu = j == 1 ? 1.0f : float(2 * j - 1) / float(j),
                    nu = j == 1 ? 0.0f : 1.0f / float(j) - 1.0f;
        cl::Launch launch(program, "diffuse_stage");
        launch.arg(topology.slots())
            .arg(topology.slices())
            .arg(topology.rings())
            .arg(weights)
            .arg(values.planeStride);
        launch.arg(values.from).arg(j == 1 ? values.from : values.to).arg(values.to);
        launch.arg(mu).arg(nu).arg(mu * 2.0f / span);
        device.launch(launch, overSlots(topology, values.planes));
        std::swap(values.from, values.to);
    }
}

}  // namespace pel
