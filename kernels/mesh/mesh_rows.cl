// Gathers the caller's positions and normals into one packed row per slot, for meshes whose slots are not the
// caller's vertices in their order, or whose data are not packed. Also counts faults of the data on request.
// A row is 8 floats: position x y z 0, normal x y z 0. Unusable values (NaN, Inf, normals without direction)
// become NaN.
//
// Inputs: positions (length), normals (unit), one of each per vertex of the caller.
// One work-item: one slot (mesh_rows), one vertex or slot (mesh_count).
// Variants: PEL_MESH_MAPPED 1: a slot has members, one or several vertices of the caller. Its position is
// that of the first; its normal is the mean direction of theirs. PEL_MESH_LISTED (lib/mesh/mesh_vertex.clh):
// mesh_rows.

#include "lib/mesh/mesh_vertex.clh"
#include "lib/width.clh"

#define MEMBERS_AHEAD 64

__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void mesh_rows(
    uint slots, uint listed, __global const uint* restrict list, __global const uint* restrict memberOffsets,
    __global const uint* restrict members, __global const float* restrict positions,
    VertexLayout positionLayout, __global const float* restrict normals, VertexLayout normalLayout,
    __global float* rows) {
    const uint slot = meshSlot(get_global_id(0), slots, listed, list);
    if (slot >= slots) return;
#if PEL_MESH_MAPPED
    const uint begin = memberOffsets[slot], end = memberOffsets[slot + 1], vertex = members[begin];
    // Members may be anywhere in the caller's memory, so prefetching does not help.
    const uint ahead = members[min(begin + MEMBERS_AHEAD, positionLayout.count - 1)];
    PEL_PREFETCH(positions + positionLayout.offset + (size_t)ahead * positionLayout.stride);
    PEL_PREFETCH(normals + normalLayout.offset + (size_t)ahead * normalLayout.stride);
#else
    const uint vertex = slot;
#endif
    const float3 position = vertexLoad3(positions, positionLayout, vertex);
    float3 normal = meshUsableNormal(vertexLoad3(normals, normalLayout, vertex));
#if PEL_MESH_MAPPED
    if (end - begin > 1) {
        float3 sum = (float3)(0.0f);
        for (uint m = begin; m < end; ++m) {
            const float3 n = meshUsableNormal(vertexLoad3(normals, normalLayout, members[m]));
            if (n.x == n.x) sum += n;
        }
        normal = dot(sum, sum) > 1e-6f ? sum / sqrt(dot(sum, sum)) : meshNan3();
    }
#endif
    vstore8((float8)(meshUsablePosition(position), 0.0f, normal, 0.0f), slot, rows);
}

// Integers only, so that the order of additions does not matter.
__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void mesh_count(
    uint vertices, __global const float* restrict positions, VertexLayout positionLayout,
    __global const float* restrict normals, VertexLayout normalLayout, uint slots,
    __global const uint* restrict slices, __global const uint* restrict rings,
    __global const float* restrict slotPositions, VertexLayout slotLayout, __global MeshCounts* counts) {
    const uint i = get_global_id(0);
    if (i < vertices) {
        const float3 p = meshUsablePosition(vertexLoad3(positions, positionLayout, i));
        const float3 n = meshUsableNormal(vertexLoad3(normals, normalLayout, i));
        if (p.x != p.x) atomic_inc(&counts->nonFinitePositions);
        if (n.x != n.x) atomic_inc(&counts->nonFiniteNormals);
    }
    if (i < slots) {
        const float3 self = meshUsablePosition(vertexLoad3(slotPositions, slotLayout, i));
        uint found = 0;
        for (uint row = slices[i / PEL_MESH_LANES]; row < slices[i / PEL_MESH_LANES + 1]; ++row) {
            const uint entry = rings[(size_t)row * PEL_MESH_LANES + i % PEL_MESH_LANES];
            const uint other = entry & PEL_MESH_SLOT;
            if (other <= i || (entry & PEL_MESH_REPEAT))
                continue;  // each edge once, from its smaller end; no fillers
            const float3 d = meshUsablePosition(vertexLoad3(slotPositions, slotLayout, other)) - self;
            if (dot(d, d) < PEL_MESH_MIN_LENGTH2) ++found;
        }
        if (found) atomic_add(&counts->zeroLengthEdges, found);
    }
}
