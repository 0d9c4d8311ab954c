// One-ring lists of a triangle mesh from raw index arrays: any connectivity, manifold or not.
#pragma once
#include <cstdint>
#include <vector>

#include "mesh/mesh_ring.h"

namespace pel {

struct MeshAdjacency {
    std::vector<uint32_t> offsets;     // slots + 1
    std::vector<uint32_t> neighbours;  // entries as in shared/mesh.h
    uint32_t edges = 0;
    uint32_t borderEdges = 0;
    uint32_t nonManifoldEdges = 0;
    uint32_t inconsistentEdges = 0;  // edges whose two triangles run along them in the same direction
};

// The corners of all triangles, sorted by the slot that they are at: those of a slot from begins[slot] to before begins[slot + 1].
struct CornerTable {
    std::vector<uint32_t> begins;  // slots + 1
    std::vector<Corner> corners;
};

// `triangles`: three slots each, all different and < slots.
CornerTable sortCorners(const std::vector<uint32_t>& triangles, uint32_t slots);

// Changes the order of the corners of a slot, on which no ring depends.
MeshAdjacency buildAdjacency(CornerTable& table);

// The same triangles where slot s has become numbers[s].
CornerTable renumberCorners(const CornerTable& table, const std::vector<uint32_t>& numbers);

// Whether neighbours are so far apart in memory that every access misses the caches.
bool isScattered(const std::vector<uint32_t>& triangles, uint32_t slots);

// A new number for each slot, so that neighbours get close numbers: breadth first from the first slot of each
// part.
std::vector<uint32_t> breadthFirstNumbers(const MeshAdjacency& adjacency);

// The lists in the layout that shared/mesh.h describes.
struct MeshSlices {
    std::vector<uint32_t> slices;
    std::vector<uint32_t> rows;
};
MeshSlices sliceAdjacency(const MeshAdjacency& adjacency);

// The runs among the rows (shared/mesh.h); empty if fewer than half of the rows are runs.
std::vector<uint32_t> findRuns(const std::vector<uint32_t>& rows);

}  // namespace pel
