// Gives all triangles of a surface the same orientation.
#pragma once
#include <pellucid/pellucid.h>

#include <cstdint>
#include <vector>

namespace pel {

// desc's indices, with triangles reversed as pelMeshOrient says. `normals`: xyz per vertex, normalStride
// bytes apart, or NULL.
std::vector<uint32_t> orientTriangles(const PelMeshTopologyDesc& desc, const float* normals,
                                      uint32_t normalStride, PelMeshOrientation& found);

}  // namespace pel
