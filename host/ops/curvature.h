// Curvature at the vertices of a mesh: kernels/mesh_rows.cl and kernels/curvature.cl.
#pragma once
#include "core/mesh_topology.h"
#include "core/vertex_view.h"

namespace pel {

void checkCurvatureParams(const PelCurvatureParams& params);
uint32_t quantityFloats(PelCurvatureQuantity quantity);  // per vertex

// `normals` empty: they are made from the positions. Enqueues everything. With `counts`, waits and fills it.
void meshCurvature(MeshTopology& topology, const PelCurvatureParams& params, const VertexView& positions,
                   const VertexView& normals, const VertexView& curvature, MeshCounts* counts);

}  // namespace pel
