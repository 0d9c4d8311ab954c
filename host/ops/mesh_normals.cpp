#include "ops/mesh_normals.h"

namespace pel {
namespace {

// Rows of 8 floats per slot, position and normal, from the caller's vertices.
SlotData gatherRows(MeshTopology& topology, const VertexView& positions, const VertexView& normals) {
    const uint32_t slots = topology.slots();
    const cl::Memory& rows = topology.scratch(MeshTopology::scratchRows, slots * 32ull);
    cl::Launch gather(topology.device().programs().get("mesh_rows.cl", mapping(topology)), "mesh_rows");
    gather.arg(slots).arg(topology.memberOffsets()).arg(topology.members());
    gather.arg(positions.memory).arg(positions.layout).arg(normals.memory).arg(normals.layout).arg(rows);
    topology.device().launch(gather, over(slots));
    return {{rows, {slots, 0, 8, 0}}, {rows, {slots, 4, 8, 0}}, 8};
}

cl::Program program(const MeshTopology& topology, uint32_t stride) {
    cl::Defines defines = mapping(topology);
    defines["MESH_STRIDE"] = std::to_string(stride);
    defines["PEL_WIDTH"] = std::to_string(width(topology.device()));
    return topology.device().programs().get("mesh_normals.cl", defines);
}

void makeNormals(MeshTopology& topology, const SlotData& data) {
    cl::Launch make(program(topology, data.stride), "mesh_normals");
    make.arg(topology.slots()).arg(topology.slices()).arg(topology.rings());
    make.arg(data.positions.memory).arg(data.positions.layout.offset);
    make.arg(data.normals.memory).arg(data.normals.layout.offset);
    topology.device().launch(make, overSlots(topology));
}

}  // namespace

SlotData gatherBySlot(MeshTopology& topology, const VertexView& positions, const VertexView& normals) {
    const bool direct = !topology.mapped() && positions.layout.stride == 3;
    if (normals.memory) {
        if (direct && normals.layout.stride == 3) return {positions, normals, 3};
        return gatherRows(topology, positions, normals);
    }
    SlotData data;
    if (direct) {
        const uint32_t slots = topology.slots();
        data = {
            positions, {topology.scratch(MeshTopology::scratchNormals, slots * 12ull), {slots, 0, 3, 0}}, 3};
    } else {
        data = gatherRows(topology, positions, positions);  // the second half of each row is overwritten
    }
    makeNormals(topology, data);
    return data;
}

void meshNormals(MeshTopology& topology, const VertexView& positions, const VertexView& normals) {
    if (topology.vertices() == 0) return;
    const auto lock = topology.lock();
    const SlotData data = gatherBySlot(topology, positions, {});
    cl::Launch store(program(topology, data.stride), "mesh_normals_store");
    store.arg(topology.slotOf()).arg(data.normals.memory).arg(data.normals.layout.offset);
    store.arg(normals.memory).arg(normals.layout);
    topology.device().launch(store, over(topology.vertices()));
}

}  // namespace pel
