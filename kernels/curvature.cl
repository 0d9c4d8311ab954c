// Curvature at the vertices of a mesh and its uniform smoothing (mathematics, section 5).
//
// Inputs: rows of position (length) and unit normal, the one-ring of each slot (shared/mesh.h).
// Results between passes: one float per slot, 1/length; NaN where nothing could be measured. Such a slot
// stays out of its neighbours' means, and the last pass writes 0 for it, so that no NaN ever spreads or
// leaves. One work-item: one slot; curvature_store: one vertex of the caller. Variants: MESH_WELDED 1:
// vertices find their slot in slotOf.

#include "lib/mesh_vertex.clh"

// (min + max) / 2 of |dn| / |dp| over the edges of a slot [FaceWorks 1.0].
__kernel __attribute__((reqd_work_group_size(MESH_GROUP, 1, 1))) void curvature_edge(
    uint slots, __global const uint* offsets, __global const uint* neighbours, __global const float* rows,
    __global float* curvature) {
    const uint slot = get_global_id(0);
    if (slot >= slots) return;
    const float8 self = vload8(slot, rows);
    // Squares order as their roots do: two roots at the end instead of two per edge.
    float low = INFINITY, high = -1.0f;
    const uint end = offsets[slot + 1];
    for (uint e = offsets[slot]; e < end; ++e) {
        const float8 d = vload8(neighbours[e] & MESH_SLOT, rows) - self;
        const float length2 = dot(d.lo, d.lo);
        const float ratio = dot(d.hi, d.hi) / length2;
        // Both fail for NaN, that is for neighbours without a usable position or normal.
        if (length2 >= MESH_MIN_LENGTH2 && ratio < INFINITY) {
            low = fmin(low, ratio);
            high = fmax(high, ratio);
        }
    }
    curvature[slot] = high >= 0.0f ? 0.5f * (sqrt(low) + sqrt(high)) : NAN;
}

// The mean over a slot's triangles of their other two slots' values, itself not included.
__kernel __attribute__((reqd_work_group_size(MESH_GROUP, 1, 1))) void curvature_smooth(
    uint slots, __global const uint* offsets, __global const uint* neighbours, __global const float* from,
    __global float* to) {
    const uint slot = get_global_id(0);
    if (slot >= slots) return;
    const float self = from[slot];
    float sum = 0.0f, weight = 0.0f;
    const uint end = offsets[slot + 1];
    for (uint e = offsets[slot]; e < end; ++e) {
        const uint neighbour = neighbours[e];
        const float value = from[neighbour & MESH_SLOT];
        const float w = value == value ? (float)(2 - (neighbour >> 31)) : 0.0f;
        sum += w > 0.0f ? w * value : 0.0f;
        weight += w;
    }
    to[slot] = self == self && weight > 0.0f ? sum / weight : self;
}

__kernel __attribute__((reqd_work_group_size(MESH_GROUP, 1, 1))) void curvature_store(
    __global const uint* slotOf, __global const float* curvature, float scale, __global float* result,
    VertexLayout layout) {
    const uint vertex = get_global_id(0);
    if (vertex >= layout.count) return;
#if MESH_WELDED
    const float value = curvature[slotOf[vertex]] * scale;
#else
    const float value = curvature[vertex] * scale;
#endif
    result[layout.offset + (size_t)vertex * layout.stride] = isfinite(value) ? value : 0.0f;
}
