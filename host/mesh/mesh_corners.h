// The corners of triangles, sorted by the slot that they are at.
#pragma once
#include <cstdint>
#include <vector>

#include "mesh/large_vector.h"
#include "mesh/mesh_ring.h"

namespace pel {

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

}  // namespace pel
