// Triangles of one surface in one order.
#pragma once
#include <pellucid/pellucid.h>

#include <cstdint>
#include <vector>

namespace pel {

// desc's indices, with triangles turned as pelMeshOrient says. `normals`: xyz per vertex, normalStride bytes apart, or NULL.
std::vector<uint32_t> orientTriangles(const PelMeshTopologyDesc& desc, const float* normals,
                                      uint32_t normalStride, PelMeshOrientation& found);

}  // namespace pel
