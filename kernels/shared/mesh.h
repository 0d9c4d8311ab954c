// How meshes lie in device memory; compiled by host and device.
//
// A slot is a vertex of the topology: one vertex of the caller's mesh, or all those that were welded into
// one. Kernels work on slots; only the first and the last pass of an operation know the caller's vertices and
// their strides.
#pragma once

// One-rings are in slices of PEL_MESH_LANES slots. A slice has as many rows as its longest list. A row holds
// one neighbour of each of its slots side by side, so that a vector of slots, or neighbouring work-items,
// read one contiguous piece. slices[i] is the first row of slice i, slices[count] the number of rows. Shorter
// lists are filled up with the slot itself, which no real list contains; lanes after the last slot are filled
// with the last slot.
//
// A list goes round its slot from triangle to triangle: two successive entries are the other two corners of a
// triangle, in the triangle's own order. A walk that returns to its first entry is closed (its last and first
// entries are a triangle too). A walk that ends at a border is open. An ordinary vertex has one walk. Any
// other set of triangles is split into several, each triangle in exactly one of them (an Euler trail through
// the graph whose nodes are the neighbours and whose edges are the triangles). So a list holds neighbours and
// triangles in the memory of the neighbours alone: an edge of two triangles is one entry, an edge of one
// triangle is an end of an open walk.
#define PEL_MESH_LANES 8
#define PEL_MESH_SINGLE \
    0x80000000u  // an end of an open walk: its edge has one triangle, edges of others have two
#define PEL_MESH_START 0x40000000u    // the first entry of a walk
#define PEL_MESH_FLIPPED 0x20000000u  // the triangle from this entry to the next has the opposite order
#define PEL_MESH_REPEAT 0x10000000u   // the neighbour occurs earlier in this list
#define PEL_MESH_SLOT 0x0fffffffu     // the neighbour

// Large parts of many meshes, and nearly all of grids, have rows that are runs: PEL_MESH_LANES successive
// entries with the same flags. runs[row] is the first entry of such a row, or this. Meshes with few runs have
// none.
#define PEL_MESH_NO_RUN 0xffffffffu

// The quadric estimator reads the two-ring of a slot as a list of points: its neighbours, then theirs
// (docs/mathematics.md, section 5, says which, and how often). The lists lie as those of the one-rings do,
// with slices of PEL_POINT_LANES slots and no flags: starts[i] is the first row of slice i. rounds[slot]: the
// number of neighbours, and flags.
#define PEL_POINT_LANES 16
#define PEL_MESH_ROUND 0x80000000u   // the neighbours are one closed walk of more than two
#define PEL_MESH_BORDER 0x40000000u  // an edge at the slot has one triangle
#define PEL_MESH_LENGTH 0x0fffffffu
// The stages of making them (two_ring.cl).
#define PEL_TWO_RING_LINK 0
#define PEL_TWO_RING_COUNT 1
#define PEL_TWO_RING_LIST 2

// Edges whose squared length is below this are too short to measure: their square is not a normal float.
#define PEL_MESH_MIN_LENGTH2 1.17549435e-38f

// A normal whose squared length is off by more than this is brought to unit length. Others are used
// unchanged, so that their last bits stay the caller's.
#define PEL_MESH_UNIT_TOLERANCE 1e-3f

#define PEL_MESH_GROUP 64  // work-items in a work-group of every mesh kernel

// Where the caller's vertex data are, in 4-byte words: element i begins at offset + i * stride.
typedef struct VertexLayout {
    unsigned int count;   // vertices
    unsigned int offset;  // words
    unsigned int stride;  // words
    unsigned int pad;
} VertexLayout;

// Counts of faults that a pass found in the data, beside the results.
typedef struct MeshCounts {
    unsigned int zeroLengthEdges;
    unsigned int nonFinitePositions;  // vertices of the caller
    unsigned int nonFiniteNormals;    // also zero normals; vertices of the caller
    unsigned int lowDegreeFits;       // slots; of the quadric estimator
} MeshCounts;

// The triangles are divided among this many work-items on every device, so that their sums are the same.
#define PEL_UV_SCALE_ITEMS 4096

// The sum over a share of the triangles of log2(longest edge^2 / longest UV edge^2), in two parts.
typedef struct UvScaleShare {
    float mantissas;
    int exponents;
    unsigned int triangles;  // that were counted
    unsigned int pad;
} UvScaleShare;

#ifdef __cplusplus
static_assert(sizeof(VertexLayout) == 16 && sizeof(MeshCounts) == 16 && sizeof(UvScaleShare) == 16);
#endif
