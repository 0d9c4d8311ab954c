// One-ring lists of a triangle mesh from raw index arrays: any connectivity, manifold or not.
#pragma once
#include <cstdint>
#include <span>

#include "mesh/large_vector.h"

namespace pel {

// The other two corners of a triangle at a slot, in the order of the triangle.
struct Corner {
    uint32_t from, to;
};

// Makes the walks round one vertex (shared/mesh.h) of the triangles that meet there.
class RingBuilder {
  public:
    struct Edges {
        uint32_t all = 0, border = 0, nonManifold = 0;  // to slots above `slot`
        uint32_t inconsistent = 0;  // edges whose two triangles run along them in the same direction
        Edges& operator+=(const Edges& b) {
            all += b.all, border += b.border, nonManifold += b.nonManifold, inconsistent += b.inconsistent;
            return *this;
        }
    };
    // Appends the list of `slot` to `out`. The first `readAhead` elements of `corners` are read even if
    // `count` is smaller.
    static constexpr uint32_t readAhead = 8;
    Edges build(uint32_t slot, const Corner* corners, uint32_t count, LargeVector<uint32_t>& out);

  private:
    bool buildFan(const Corner* corners, uint32_t count, LargeVector<uint32_t>& out);
    void buildTrails(const Corner* corners, uint32_t count, LargeVector<uint32_t>& out);

    // One end of the edge that is opposite to the slot in a triangle.
    struct End {
        uint32_t node, backward, other, triangle;
        bool operator<(const End& b) const;
    };
    struct Node {
        uint32_t slot, next, end;  // ends that may still be free: next to end
        uint32_t free;             // how many of them are
        bool visited;
    };
    Node& node(uint32_t slot);
    void walk(Node& start, LargeVector<uint32_t>& out);

    std::vector<End> ends_;
    std::vector<Node> nodes_;
    std::vector<char> used_;  // per triangle
};

// The triangles of a mesh between slots.
struct Triangles {
    const uint32_t* indices;  // three vertices for each of `count`
    uint64_t count;
    const std::vector<uint32_t>& slotOf;  // by vertex; empty: vertices are the slots
    uint32_t vertices, slots;

    // The slots of a triangle; false if two of them are the same.
    bool slotsOf(uint64_t triangle, uint32_t (&v)[3]) const {
        for (uint64_t c = 0; c < 3; ++c) {
            const uint32_t vertex = indices[3 * triangle + c];
            v[c] = slotOf.empty() ? vertex : slotOf[vertex];
        }
        return v[0] != v[1] && v[1] != v[2] && v[2] != v[0];
    }
};

// The corners of all triangles but degenerate ones, sorted by the slot that they are at.
struct CornerTable {
    LargeVector<uint32_t>
        begins;  // slots + 1: those of a slot are from begins[slot] to before begins[slot + 1]
    LargeVector<Corner> corners;  // and RingBuilder::readAhead more
    uint32_t degenerate = 0;
    uint32_t unreferenced = 0;  // vertices without a triangle
    // Whether neighbours are so far apart in memory that every access misses the caches. If so, the corners
    // of a slot are sorted by `from`.
    bool scattered = false;
};
CornerTable sortCorners(const Triangles& triangles);

// The corners of a scattered table, whose slots get new numbers, so that neighbours get close ones: breadth
// first from the first slot of each part of the mesh. `numbers`: of each slot. They do not depend on the
// order of the triangles.
CornerTable renumbered(const CornerTable& table, std::vector<uint32_t>& numbers);

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

// The lists in the layout that shared/mesh.h describes.
struct MeshSlices {
    std::vector<uint32_t> slices;
    LargeVector<uint32_t> rows;
};
MeshSlices sliceAdjacency(const MeshAdjacency& adjacency);

// The runs among the rows (shared/mesh.h); empty if fewer than half of the rows are runs.
std::vector<uint32_t> findRuns(std::span<const uint32_t> rows);

}  // namespace pel
