#include "ops/curvature.h"

#include <cmath>

namespace pel {
namespace {

cl::Range over(size_t items) {
    return {{items, 1, 1}, {MESH_GROUP, 1, 1}};
}

cl::Defines variant(const MeshTopology& topology) {
    return {{"MESH_WELDED", topology.welded() ? "1" : "0"}};
}

// One row of position and normal per slot.
const cl::Memory& gatherRows(MeshTopology& topology, const VertexView& positions, const VertexView& normals) {
    Device& device = topology.device();
    const cl::Memory& rows = topology.scratch(MeshTopology::scratchRows, topology.slots() * 32ull);
    cl::Launch gather(device.programs().get("mesh_rows.cl", variant(topology)), "mesh_rows");
    gather.arg(topology.slots()).arg(topology.memberOffsets()).arg(topology.members());
    gather.arg(positions.memory).arg(positions.layout).arg(normals.memory).arg(normals.layout).arg(rows);
    device.launch(gather, over(topology.slots()));
    return rows;
}

MeshCounts countFaults(MeshTopology& topology, const VertexView& positions, const VertexView& normals,
                       const cl::Memory& rows) {
    Device& device = topology.device();
    const MeshCounts none{};
    const cl::Memory memory = device.allocate(sizeof none, &none);
    cl::Launch count(device.programs().get("mesh_rows.cl", variant(topology)), "mesh_count");
    count.arg(topology.vertices());
    count.arg(positions.memory).arg(positions.layout).arg(normals.memory).arg(normals.layout);
    count.arg(topology.slots()).arg(topology.offsets()).arg(topology.neighbours()).arg(rows).arg(memory);
    device.launch(count, over(topology.vertices()));
    MeshCounts counts;
    device.read(memory.get(), 0, sizeof counts, &counts, true);
    return counts;
}

}  // namespace

void checkCurvatureParams(const PelCurvatureParams& params) {
    if (params.estimator != PEL_CURVATURE_EDGE)
        invalidArgument("PelCurvatureParams.estimator is ", int(params.estimator),
                        ", which is no PelCurvatureEstimator");
    if (params.smoothingPasses > 1000)
        invalidArgument("PelCurvatureParams.smoothingPasses is ", params.smoothingPasses,
                        "; 0 to 1000 are allowed, typical is 2");
    if (!std::isfinite(params.scale) || params.scale < 0)
        invalidArgument("PelCurvatureParams.scale is ", params.scale,
                        "; a finite number of at least 0 is needed");
}

void meshCurvature(MeshTopology& topology, const PelCurvatureParams& params, const VertexView& positions,
                   const VertexView& normals, const VertexView& curvature, MeshCounts* counts) {
    if (counts) *counts = {};
    if (topology.vertices() == 0) return;
    Device& device = topology.device();
    const cl::Program program = device.programs().get("curvature.cl", variant(topology));
    const uint32_t slots = topology.slots();
    const auto lock = topology.lock();
    const cl::Memory& rows = gatherRows(topology, positions, normals);
    cl::Memory from = topology.scratch(MeshTopology::scratchFrom, slots * 4ull);
    cl::Memory to =
        params.smoothingPasses ? topology.scratch(MeshTopology::scratchTo, slots * 4ull) : cl::Memory();

    cl::Launch edge(program, "curvature_edge");
    edge.arg(slots).arg(topology.offsets()).arg(topology.neighbours()).arg(rows).arg(from);
    device.launch(edge, over(slots));
    for (uint32_t pass = 0; pass < params.smoothingPasses; ++pass) {
        cl::Launch smooth(program, "curvature_smooth");
        smooth.arg(slots).arg(topology.offsets()).arg(topology.neighbours()).arg(from).arg(to);
        device.launch(smooth, over(slots));
        std::swap(from, to);
    }
    cl::Launch store(program, "curvature_store");
    store.arg(topology.slotOf()).arg(from).arg(params.scale).arg(curvature.memory).arg(curvature.layout);
    device.launch(store, over(topology.vertices()));
    if (counts) *counts = countFaults(topology, positions, normals, rows);
}

}  // namespace pel
