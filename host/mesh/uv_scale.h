// UV scale of a mesh: kernels/mesh/uv_scale.cl.
#pragma once
#include "mesh/mesh_topology.h"
#include "mesh/vertex_view.h"

namespace pel {

// Length per UV unit. Waits for the result.
float meshUvScale(MeshTopology& topology, const VertexView& positions, const VertexView& uvs);

}  // namespace pel
