// Positions and normals by slot, and normals made from positions: kernels/mesh_rows.cl,
// kernels/mesh_normals.cl.
#pragma once
#include "ops/mesh_passes.h"

namespace pel {

// `normals` empty: they are made from the positions.
SlotData gatherBySlot(MeshTopology& topology, const VertexView& positions, const VertexView& normals);

// Unit normals of the caller's vertices from their positions. Enqueues everything.
void meshNormals(MeshTopology& topology, const VertexView& positions, const VertexView& normals);

}  // namespace pel
