#include "mesh/mesh_topology.h"

#include "mesh/mesh_adjacency.h"

namespace pel {

void checkTopologyDesc(const PelMeshTopologyDesc& desc) {
    if (desc.weld != PEL_WELD_NONE && desc.weld != PEL_WELD_EXACT && desc.weld != PEL_WELD_TOLERANCE)
        invalidArgument("PelMeshTopologyDesc.weld is ", int(desc.weld), ", which is not a value of PelWeld");
    if (desc.numVertices > PEL_MESH_SLOT)
        fail(PEL_ERROR_UNSUPPORTED, desc.numVertices, " vertices are more than a topology holds (",
             PEL_MESH_SLOT, "): split the mesh");
    if (desc.numIndices % 3 != 0)
        invalidArgument("PelMeshTopologyDesc.numIndices is ", desc.numIndices,
                        "; three indices make a triangle, ", desc.numIndices % 3, " are left over");
    if (desc.numIndices / 3 > UINT32_MAX)
        fail(PEL_ERROR_UNSUPPORTED, desc.numIndices / 3,
             " triangles are more than a topology holds: split the mesh");
    if (desc.numIndices > 0 && !desc.indices)
        invalidArgument("PelMeshTopologyDesc.indices is NULL, but numIndices is ", desc.numIndices);
    for (uint64_t i = 0; i < desc.numIndices; ++i)
        if (desc.indices[i] >= desc.numVertices)
            invalidArgument("triangle ", i / 3, ", corner ", i % 3, " has vertex ", desc.indices[i],
                            "; the mesh has ", desc.numVertices, " vertices, numbered from 0");
}

cl::Memory MeshTopology::upload(Words values) {
    if (values.empty()) return {};
    return device_->allocate(values.size_bytes(), values.data());
}

void MeshTopology::uploadLists(Words slotOf, Words memberOffsets, Words members, Words slices, Words rings) {
    slotOf_ = upload(slotOf);
    memberOffsets_ = upload(memberOffsets);
    members_ = upload(members);
    slices_ = upload(slices);
    rings_ = upload(rings);
    runs_ = upload(findRuns(rings));
    ringEntries_ = rings.size();
}

Ref<MeshTopology> MeshTopology::create(Ref<Device> device, const PelMeshTopologyDesc& desc,
                                       PelMeshReport& report, const std::function<void(double)>& progress) {
    progress(0.0);
    checkTopologyDesc(desc);
    MeshWeld weld = weldVertices(desc, [&](double fraction) { progress(0.2 * fraction); });
    progress(0.2);

    report = pelMeshReportDefaults();
    report.vertices = desc.numVertices;
    report.triangles = uint32_t(desc.numIndices / 3);
    report.uniquePositions = weld.slots;
    CornerTable corners =
        sortCorners({desc.indices, desc.numIndices / 3, weld.slotOf, desc.numVertices, weld.slots});
    report.degenerateTriangles = corners.degenerate;
    report.unreferencedVertices = corners.unreferenced;
    progress(0.5);
    if (corners.scattered) {
        // Passes then work in an order of their own. Only the first and the last pass use the caller's order.
        std::vector<uint32_t> numbers;
        corners = renumbered(corners, numbers);
        renumberSlots(weld, std::move(numbers));
    }
    const MeshAdjacency adjacency = buildAdjacency(corners);
    progress(0.9);
    report.edges = adjacency.edges;
    report.borderEdges = adjacency.borderEdges;
    report.nonManifoldEdges = adjacency.nonManifoldEdges;
    report.inconsistentEdges = adjacency.inconsistentEdges;

    Ref<MeshTopology> topology = make<MeshTopology>(device);
    topology->report_ = report;
    if (desc.numIndices > 0)
        topology->indices_ = device->allocate(desc.numIndices * sizeof(uint32_t), desc.indices);
    const MeshSlices rings = sliceAdjacency(adjacency);
    topology->uploadLists(weld.slotOf, weld.memberOffsets, weld.members, rings.slices, rings.rows);
    progress(1.0);
    return topology;
}

}  // namespace pel
