#include "ops/curvature.h"

#include <cmath>

#include "ops/mesh_normals.h"
#include "ops/mesh_smoothing.h"

namespace pel {
namespace {

// Planes that the passes carry (kernels/lib/principal.clh).
uint32_t planesOf(PelCurvatureQuantity quantity) {
    switch (quantity) {
        case PEL_QUANTITY_ABSOLUTE:
        case PEL_QUANTITY_MEAN:
            return 1;
        case PEL_QUANTITY_FRAME:
            return 8;
        default:
            return 2;
    }
}

const char* estimatorKernel(PelCurvatureEstimator estimator) {
    return estimator == PEL_CURVATURE_EDGE     ? "curvature_edge"
           : estimator == PEL_CURVATURE_TENSOR ? "curvature_tensor"
                                               : "curvature_quadric";
}

cl::Program estimatorProgram(const MeshTopology& topology, const char* kernel, uint32_t stride,
                             uint32_t planes) {
    return topology.device().programs().get(std::string(kernel) + ".cl",
                                            {{"MESH_STRIDE", std::to_string(stride)},
                                             {"MESH_PLANES", std::to_string(planes)},
                                             {"PEL_WIDTH", std::to_string(width(topology.device()))}});
}

MeshCounts countFaults(MeshTopology& topology, const VertexView& positions, const VertexView& given,
                       const SlotData& data) {
    const VertexView& normals = given.memory ? given : positions;
    Device& device = topology.device();
    const MeshCounts none{};
    const cl::Memory memory = device.allocate(sizeof none, &none);
    cl::Launch count(device.programs().get("mesh_rows.cl", mapping(topology)), "mesh_count");
    count.arg(topology.vertices());
    count.arg(positions.memory).arg(positions.layout).arg(normals.memory).arg(normals.layout);
    count.arg(topology.slots()).arg(topology.slices()).arg(topology.rings());
    count.arg(data.positions.memory).arg(data.positions.layout).arg(memory);
    device.launch(count, over(topology.vertices()));
    MeshCounts counts;
    device.read(memory.get(), 0, sizeof counts, &counts, true);
    if (!given.memory) counts.nonFiniteNormals = 0;  // they are made, and what they lack is in the positions
    return counts;
}

}  // namespace

uint32_t quantityFloats(PelCurvatureQuantity quantity) {
    return quantity == PEL_QUANTITY_PRINCIPAL ? 2 : quantity == PEL_QUANTITY_FRAME ? 8 : 1;
}

void checkCurvatureParams(const PelCurvatureParams& params) {
    if (params.estimator < PEL_CURVATURE_EDGE || params.estimator > PEL_CURVATURE_QUADRIC)
        invalidArgument("PelCurvatureParams.estimator is ", int(params.estimator),
                        ", which is no PelCurvatureEstimator");
    if (params.quantity < PEL_QUANTITY_ABSOLUTE || params.quantity > PEL_QUANTITY_FRAME)
        invalidArgument("PelCurvatureParams.quantity is ", int(params.quantity),
                        ", which is no PelCurvatureQuantity");
    if (params.estimator == PEL_CURVATURE_EDGE && params.quantity != PEL_QUANTITY_ABSOLUTE)
        invalidArgument("the edge estimator measures PEL_QUANTITY_ABSOLUTE only, not quantity ",
                        int(params.quantity), ": take the tensor or the quadric estimator");
    if (params.smoothingPasses > 1000)
        invalidArgument("PelCurvatureParams.smoothingPasses is ", params.smoothingPasses,
                        "; 0 to 1000 are allowed, typical is 2");
    if (!std::isfinite(params.smoothingRadius) || params.smoothingRadius < 0)
        invalidArgument("PelCurvatureParams.smoothingRadius is ", params.smoothingRadius,
                        "; a finite length of at least 0 is needed");
    if (!(params.smoothingCrease >= 0 && params.smoothingCrease <= 3.14159265f))
        invalidArgument("PelCurvatureParams.smoothingCrease is ", params.smoothingCrease,
                        "; an angle from 0 to pi is needed");
    if (params.smoothingStages > 4000)
        invalidArgument("PelCurvatureParams.smoothingStages is ", params.smoothingStages,
                        "; 0 (chosen from the mesh) to 4000 are allowed");
    if (!std::isfinite(params.scale) || params.scale < 0)
        invalidArgument("PelCurvatureParams.scale is ", params.scale,
                        "; a finite number of at least 0 is needed");
}

void meshCurvature(MeshTopology& topology, const PelCurvatureParams& params, const VertexView& positions,
                   const VertexView& normals, const VertexView& curvature, MeshCounts* counts) {
    if (counts) *counts = {};
    if (topology.vertices() == 0) return;
    Device& device = topology.device();
    const uint32_t slots = topology.slots(), planes = planesOf(params.quantity);
    // Whole slices are written.
    const uint32_t planeStride = (slots + MESH_LANES - 1) / MESH_LANES * MESH_LANES;
    const size_t planeBytes = planeStride * sizeof(float);
    const auto lock = topology.lock();
    const SlotData data = gatherBySlot(topology, positions, normals);
    const cl::Memory estimated = topology.scratch(MeshTopology::scratchFrom, planeBytes * planes);
    const cl::Defines defines = {{"MESH_MAPPED", topology.mapped() ? "1" : "0"},
                                 {"MESH_STRIDE", std::to_string(data.stride)},
                                 {"MESH_PLANES", std::to_string(planes)},
                                 {"MESH_QUANTITY", std::to_string(params.quantity)},
                                 {"PEL_WIDTH", std::to_string(width(device))}};
    const cl::Program passes = device.programs().get("curvature.cl", defines);

    const char* kernel = estimatorKernel(params.estimator);
    const bool edge = params.estimator == PEL_CURVATURE_EDGE;
    cl::Launch estimate(edge ? passes : estimatorProgram(topology, kernel, data.stride, planes), kernel);
    estimate.arg(slots).arg(topology.slices()).arg(topology.rings());
    estimate.arg(data.positions.memory).arg(data.positions.layout.offset);
    estimate.arg(data.normals.memory).arg(data.normals.layout.offset).arg(planeStride).arg(estimated);
    device.launch(estimate, overSlots(topology));

    SlotPlanes values{std::min(planes, 2u), planeStride, estimated, {}};
    if (params.smoothingPasses > 0 || params.smoothingRadius > 0)
        values.to = topology.scratch(MeshTopology::scratchTo, planeBytes * values.planes);
    smoothUniform(topology, passes, params.smoothingPasses, values);
    if (params.smoothingRadius > 0)
        smoothToRadius(topology, data, params.smoothingRadius, params.smoothingCrease, params.smoothingStages,
                       values);
    cl::Launch store(passes, "curvature_store");
    store.arg(topology.slotOf()).arg(planeStride).arg(values.from).arg(estimated);
    store.arg(params.scale).arg(curvature.memory).arg(curvature.layout);
    device.launch(store, over(topology.vertices()));
    if (counts) *counts = countFaults(topology, positions, normals, data);
}

}  // namespace pel
