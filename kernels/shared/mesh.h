// How meshes lie in device memory; compiled by host and device.
//
// A slot is a vertex of the topology: one vertex of the caller's mesh, or all those that were welded into
// one. Kernels work on slots; only the first and the last pass of an operation know the caller's vertices and
// their strides.
#ifndef PEL_SHARED_MESH
#define PEL_SHARED_MESH

// One-rings lie in slices of PEL_MESH_LANES slots. A slice has as many rows as its longest list; a row holds one
// neighbour of each of its slots side by side, so that a vector of slots, or neighbouring work-items, read
// one contiguous piece. slices[i] is the first row of slice i, slices[count] the number of rows. Shorter
// lists are filled up with the slot itself, which no real list contains; the lanes behind the last slot with
// the last slot.
//
// A list walks round its slot from triangle to triangle: two entries that follow one another are the other
// two corners of a triangle, in the triangle's own order. A walk that comes back to its first entry is closed
// (its last entry and its first are a triangle too); one that ends at a border is open. An ordinary vertex
// has one walk; any other set of triangles falls into several, each triangle in just one of them (an Euler
// trail through the graph whose nodes are the neighbours and whose edges are the triangles). So a list holds
// neighbours and triangles in the memory of the neighbours alone: an edge of two triangles is one entry, an
// edge of one triangle an end of an open walk.
#define PEL_MESH_LANES 8
#define PEL_MESH_SINGLE \
    0x80000000u  // an end of an open walk: stands for one triangle of its edge, others for two
#define PEL_MESH_START 0x40000000u    // the first entry of a walk
#define PEL_MESH_FLIPPED 0x20000000u  // the triangle from this entry to the next has the opposite order
#define PEL_MESH_REPEAT 0x10000000u   // the neighbour stands further up in this list already
#define PEL_MESH_SLOT 0x0fffffffu     // the neighbour

// Rows of large parts of many meshes, of grids nearly all, are runs: PEL_MESH_LANES entries that follow one another, with the same
// flags. runs[row] is the first entry of such a row, or this; meshes with few of them have none.
#define PEL_MESH_NO_RUN 0xffffffffu

#define PEL_MESH_ROUND 0x80000000u  // of a slot's neighbours: they are one closed walk (mesh_links.cl)

// Edges shorter than the root of this (a length squared) are too short to measure: their square is no normal
// float.
#define PEL_MESH_MIN_LENGTH2 1.17549435e-38f

// A normal whose squared length is off by more than this is brought to unit length; nearer ones are taken as
// they are, so that their last bits stay the caller's.
#define PEL_MESH_UNIT_TOLERANCE 1e-3f

#define PEL_MESH_GROUP 64  // work-items in a work-group of every mesh kernel

// Where the caller's vertex data stands, in 4-byte words: element i begins at offset + i * stride.
typedef struct VertexLayout {
    unsigned int count;   // vertices
    unsigned int offset;  // words
    unsigned int stride;  // words
    unsigned int pad;
} VertexLayout;

// What a pass over the data found, beside the results.
typedef struct MeshCounts {
    unsigned int zeroLengthEdges;
    unsigned int nonFinitePositions;  // vertices of the caller
    unsigned int nonFiniteNormals;    // likewise; also zero normals
    unsigned int lowDegreeFits;       // slots; of the quadric estimator
} MeshCounts;

// The triangles are dealt out to this many work-items, on every device, so that their sums come out the same.
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

#endif
