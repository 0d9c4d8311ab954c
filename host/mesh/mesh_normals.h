// Positions and normals by slot, and normals made from positions: kernels/mesh/mesh_rows.cl,
// kernels/mesh/mesh_normals.cl.
#pragma once
#include "mesh/mesh_passes.h"

namespace pel {

// If `normals` is empty they are made from the positions. `moved`: slots whose vertices are gathered.
// `turned`: slots whose normals are made, including the neighbours of moved ones. Other rows of the scratch
// memory keep their values.
SlotData gatherBySlot(MeshTopology& topology, const VertexView& positions, const VertexView& normals,
                      const Scratch& scratch, const Rows& moved = {}, const Rows& turned = {});

// Unit normals of the caller's vertices from their positions. Enqueues everything.
void meshNormals(MeshTopology& topology, const VertexView& positions, const VertexView& normals);

}  // namespace pel
