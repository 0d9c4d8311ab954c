#include "mesh/mesh_passes.h"

namespace pel {
namespace {

// Rows of 8 floats per slot, position and normal, from the caller's vertices.
SlotData gatherRows(MeshTopology& topology, const VertexView& positions, const VertexView& normals,
                    const cl::Memory& memory, const Rows& rows) {
    cl::Defines defines = mapping(topology);
    defines["PEL_MESH_LISTED"] = listed(rows);
    defines["PEL_WIDTH"] = width(topology.device());  // whether to fetch ahead
    cl::Launch gather(topology.device().programs().get("mesh/mesh_rows.cl", defines), "mesh_rows");
    rowArguments(topology, gather, rows);
    gather.args(topology.memberOffsets(), topology.members(), positions, normals, memory);
    launchRows(topology, gather, rows, 1);
    const uint32_t slots = topology.slots();
    return {{memory, {slots, 0, 8, 0}}, {memory, {slots, 4, 8, 0}}, 8};
}

cl::Program program(const MeshTopology& topology, uint32_t stride, const Rows& rows) {
    cl::Defines defines = mapping(topology);
    defines["PEL_MESH_STRIDE"] = stride;
    defines["PEL_MESH_LISTED"] = listed(rows);
    defines["PEL_MESH_RUNS"] = haveRuns(topology);
    defines["PEL_WIDTH"] = width(topology.device());
    return topology.device().programs().get("mesh/mesh_normals.cl", defines);
}

}  // namespace

SlotData gatherBySlot(MeshTopology& topology, const VertexView& positions, const VertexView& normals,
                      const Scratch& scratch, const Rows& moved, const Rows& turned) {
    const bool direct = !topology.mapped() && positions.layout.stride == 3;
    const uint32_t slots = topology.slots();
    if (normals.memory && direct && normals.layout.stride == 3) return {positions, normals, 3};
    SlotData data;
    if (direct && !normals.memory)
        data = {positions, {scratch(MeshTopology::scratchNormals, slots * 12ull), {slots, 0, 3, 0}}, 3};
    else  // without normals the second half of each row is overwritten
        data = gatherRows(topology, positions, normals.memory ? normals : positions,
                          scratch(MeshTopology::scratchRows, slots * 32ull), moved);
    if (!normals.memory)
        launchRings(topology, program(topology, data.stride, turned), "mesh_normals", turned, 1,
                    data.positions.memory, data.positions.layout.offset, data.normals.memory,
                    data.normals.layout.offset);
    return data;
}

void meshNormals(MeshTopology& topology, const VertexView& positions, const VertexView& normals) {
    if (topology.vertices() == 0) return;
    const auto lock = topology.lock();
    const SlotData data = gatherBySlot(topology, positions, {}, scratchOf(topology));
    cl::Launch store(program(topology, data.stride, {}), "mesh_normals_store", topology.slotOf(),
                     data.normals.memory, data.normals.layout.offset, normals);
    topology.device().launch(store, over(topology.vertices()));
}

}  // namespace pel
