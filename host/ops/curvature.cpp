#include "ops/curvature.h"

#include <cmath>

namespace pel {
namespace {

cl::Range over(size_t items) {
    return {{items, 1, 1}, {MESH_GROUP, 1, 1}};
}

// Mesh passes take a slice of slots at a time where wide arithmetic pays, else one slot.
uint32_t width(const Device& device) {
    return device.info().mathWidth > 1 ? MESH_LANES : 1;
}

cl::Program program(const MeshTopology& topology, uint32_t stride) {
    return topology.device().programs().get("curvature.cl",
                                            {{"MESH_MAPPED", topology.mapped() ? "1" : "0"},
                                             {"MESH_STRIDE", std::to_string(stride)},
                                             {"PEL_WIDTH", std::to_string(width(topology.device()))}});
}

cl::Program rowsProgram(const MeshTopology& topology) {
    return topology.device().programs().get("mesh_rows.cl", {{"MESH_MAPPED", topology.mapped() ? "1" : "0"}});
}

cl::Range overSlots(const MeshTopology& topology) {
    const uint32_t lanes = width(topology.device());
    return over((topology.slots() + lanes - 1) / lanes);
}

// Positions and normals by slot, both `stride` words apart: the caller's own memory, or rows gathered from
// it.
struct SlotData {
    VertexView positions, normals;
    uint32_t stride;
};

SlotData bySlot(MeshTopology& topology, const VertexView& positions, const VertexView& normals) {
    if (!topology.mapped() && positions.layout.stride == 3 && normals.layout.stride == 3)
        return {positions, normals, 3};
    Device& device = topology.device();
    const uint32_t slots = topology.slots();
    const cl::Memory& rows = topology.scratch(MeshTopology::scratchRows, slots * 32ull);
    cl::Launch gather(rowsProgram(topology), "mesh_rows");
    gather.arg(slots).arg(topology.memberOffsets()).arg(topology.members());
    gather.arg(positions.memory).arg(positions.layout).arg(normals.memory).arg(normals.layout).arg(rows);
    device.launch(gather, over(slots));
    return {{rows, {slots, 0, 8, 0}}, {rows, {slots, 4, 8, 0}}, 8};
}

MeshCounts countFaults(MeshTopology& topology, const VertexView& positions, const VertexView& normals,
                       const SlotData& data) {
    Device& device = topology.device();
    const MeshCounts none{};
    const cl::Memory memory = device.allocate(sizeof none, &none);
    cl::Launch count(rowsProgram(topology), "mesh_count");
    count.arg(topology.vertices());
    count.arg(positions.memory).arg(positions.layout).arg(normals.memory).arg(normals.layout);
    count.arg(topology.slots()).arg(topology.slices()).arg(topology.rings());
    count.arg(data.positions.memory).arg(data.positions.layout).arg(memory);
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
    const uint32_t slots = topology.slots();
    // Whole slices are written.
    const size_t bytes = (size_t(slots) + MESH_LANES - 1) / MESH_LANES * MESH_LANES * sizeof(float);
    const auto lock = topology.lock();
    const SlotData data = bySlot(topology, positions, normals);
    const cl::Program passes = program(topology, data.stride);
    cl::Memory from = topology.scratch(MeshTopology::scratchFrom, bytes);
    cl::Memory to = params.smoothingPasses ? topology.scratch(MeshTopology::scratchTo, bytes) : cl::Memory();

    cl::Launch edge(passes, "curvature_edge");
    edge.arg(slots).arg(topology.slices()).arg(topology.rings());
    edge.arg(data.positions.memory).arg(data.positions.layout.offset);
    edge.arg(data.normals.memory).arg(data.normals.layout.offset).arg(from);
    device.launch(edge, overSlots(topology));
    for (uint32_t pass = 0; pass < params.smoothingPasses; ++pass) {
        cl::Launch smooth(passes, "curvature_smooth");
        smooth.arg(slots).arg(topology.slices()).arg(topology.rings()).arg(from).arg(to);
        device.launch(smooth, overSlots(topology));
        std::swap(from, to);
    }
    cl::Launch store(passes, "curvature_store");
    store.arg(topology.slotOf()).arg(from).arg(params.scale).arg(curvature.memory).arg(curvature.layout);
    device.launch(store, over(topology.vertices()));
    if (counts) *counts = countFaults(topology, positions, normals, data);
}

}  // namespace pel
