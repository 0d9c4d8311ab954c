// UV scale of a mesh: kernels/uv_scale.cl.
#pragma once
#include "core/mesh_topology.h"
#include "core/vertex_view.h"

namespace pel {

// Length per UV unit. Waits for the result.
float meshUvScale(MeshTopology& topology, const VertexView& positions, const VertexView& uvs);

}  // namespace pel
