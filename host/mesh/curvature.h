// Curvature at the vertices of a mesh: kernels/mesh/mesh_rows.cl and kernels/mesh/curvature.cl.
#pragma once
#include "mesh/mesh_passes.h"

namespace pel {

void checkCurvatureParams(const PelCurvatureParams& params);
uint32_t quantityFloats(PelCurvatureQuantity quantity);  // per vertex
uint32_t planesOf(PelCurvatureQuantity quantity);  // that the passes carry (kernels/lib/mesh/mesh_frame.clh)
uint32_t planeStrideOf(const MeshTopology& topology);  // floats

// The steps of a curvature, for callers that take only some of them (mesh/live_mesh.cpp). `counts`: a
// MeshCounts, or empty.
cl::Defines passDefines(const MeshTopology& topology, const PelCurvatureParams& params, uint32_t stride);
void estimateCurvature(MeshTopology& topology, const PelCurvatureParams& params, const SlotData& data,
                       const cl::Memory& planes, const Rows& rows, const cl::Memory& counts = {});
void storeQuantity(MeshTopology& topology, const PelCurvatureParams& params, uint32_t stride,
                   const cl::Memory& smoothed, const cl::Memory& estimated, const VertexView& curvature,
                   Rows::Work* work);

// If `normals` is empty they are made from the positions. Enqueues everything. With `counts`, waits and fills
// it. `blocks`: the caller waits, so that the mesh may be measured for its smoothing.
void meshCurvature(MeshTopology& topology, const PelCurvatureParams& params, const VertexView& positions,
                   const VertexView& normals, const VertexView& curvature, MeshCounts* counts, bool blocks);

}  // namespace pel
