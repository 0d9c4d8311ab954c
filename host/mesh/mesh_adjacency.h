// One-ring lists of a triangle mesh from raw index arrays: any connectivity, manifold or not.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

namespace pel {

struct MeshAdjacency {
    std::vector<uint32_t> offsets;     // slots + 1
    std::vector<uint32_t> neighbours;  // entries as in shared/mesh.h
    uint32_t edges = 0;
    uint32_t borderEdges = 0;
    uint32_t nonManifoldEdges = 0;
    uint32_t inconsistentEdges = 0;  // edges whose two triangles run along them in the same direction
};

// `triangles`: three slots each, all different and < slots. `progress` gets a fraction in [0, 1].
MeshAdjacency buildAdjacency(const std::vector<uint32_t>& triangles, uint32_t slots,
                             const std::function<void(double)>& progress);

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
