// One-ring lists of a triangle mesh from raw index arrays: any connectivity, manifold or not.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/large_vector.h"
#include "mesh/mesh_corners.h"

namespace pel {

struct MeshAdjacency {
    LargeVector<uint32_t> offsets;     // slots + 1
    LargeVector<uint32_t> neighbours;  // entries as in shared/mesh.h
    uint32_t edges = 0;
    uint32_t borderEdges = 0;
    uint32_t nonManifoldEdges = 0;
    uint32_t inconsistentEdges = 0;  // edges whose two triangles run along them in the same direction
};

// No list depends on the order of a slot's corners.
MeshAdjacency buildAdjacency(const CornerTable& table);

// The same of a scattered table whose slots get new numbers first, so that neighbours get close ones.
// `numbers`: of each slot. They do not depend on the order of the triangles.
MeshAdjacency buildRenumbered(const CornerTable& table, std::vector<uint32_t>& numbers);

// The lists in the layout that shared/mesh.h describes.
struct MeshSlices {
    std::vector<uint32_t> slices;
    LargeVector<uint32_t> rows;
};
MeshSlices sliceAdjacency(const MeshAdjacency& adjacency);

// The runs among the rows (shared/mesh.h); empty if fewer than half of the rows are runs.
std::vector<uint32_t> findRuns(std::span<const uint32_t> rows);

}  // namespace pel
