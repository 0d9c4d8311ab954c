// Curvature at the vertices of a mesh and its uniform smoothing (mathematics, section 5).
//
// Inputs: position (length) and unit normal of each slot, one-rings (shared/mesh.h). Results between
// passes: planes of one float per slot, 1/length (lib/mesh/mesh_frame.clh), NaN if nothing could be
// measured. Such a slot is left out of its neighbours' means, and the last pass writes 0 for it, so no NaN
// spreads or is returned.
//
// One work-item: PEL_WIDTH slots (of plane get_global_id(1)); curvature_store: one vertex of the caller.
//
// Variants: PEL_MESH_MAPPED 1: vertices find their slot in slotOf. PEL_MESH_STRIDE, PEL_MESH_RUNS:
// lib/mesh/mesh_slots.clh. PEL_MESH_LISTED: lib/mesh/mesh_vertex.clh. PEL_MESH_PLANES, PEL_MESH_QUANTITY (a
// PelCurvatureQuantity): what curvature_store reads and writes.

#include "lib/mesh/mesh_ring.clh"

// (min + max) / 2 of |dn| / |dp| over the edges of a slot [FaceWorks 1.0].
__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void curvature_edge(
    uint slots, uint listed, __global const uint* restrict list, __global const uint* restrict slices,
    __global const uint* restrict rings, __global const uint* restrict runs,
    __global const float* restrict positions, uint positionOffset, __global const float* restrict normals,
    uint normalOffset, uint planeStride, __global float* curvature) {
    const uint first = meshSlot(get_global_id(0) * PEL_WIDTH, slots, listed, list);
    if (first >= slots) return;
    RingCursor ring = ringBegin(first, slots, slices);
    floatw px, py, pz, nx, ny, nz;
    positions += positionOffset;
    normals += normalOffset;
    gather3(positions, ring.last, ring.self, &px, &py, &pz);
    gather3(normals, ring.last, ring.self, &nx, &ny, &nz);
    usableNormals(&nx, &ny, &nz);
    // Squares order as their roots do: two roots at the end instead of two per edge.
    floatw low = INFINITY, high = -1.0f;
    for (; ring.row < ring.end; ++ring.row) {
        const Slots other = ringEntry(&ring, rings, runs).slots;
        floatw dx, dy, dz, mx, my, mz;
        gather3(positions, ring.last, other, &dx, &dy, &dz);
        gather3(normals, ring.last, other, &mx, &my, &mz);
        usableNormals(&mx, &my, &mz);
        dx -= px, dy -= py, dz -= pz;
        mx -= nx, my -= ny, mz -= nz;
        const floatw length2 = fma(dx, dx, fma(dy, dy, dz * dz));
        const floatw ratio = fma(mx, mx, fma(my, my, mz * mz)) / length2;
        // False for edges without length, such as fillers, and for values that are not finite at either end.
        const maskw usable = (length2 >= PEL_MESH_MIN_LENGTH2) & (length2 < INFINITY) & (ratio < INFINITY);
        low = selectw(low, ratio, usable & (ratio < low));
        high = selectw(high, ratio, usable & (ratio > high));
    }
    storew(selectw((floatw)(NAN), 0.5f * (sqrt(low) + sqrt(high)), high >= 0.0f), first, curvature);
}

// The mean of the values at the other two corners of a slot's triangles.
__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void curvature_smooth(
    uint slots, uint listed, __global const uint* restrict list, __global const uint* restrict slices,
    __global const uint* restrict rings, __global const uint* restrict runs, uint planeStride,
    __global const float* restrict from, __global float* to) {
    const uint first = meshSlot(get_global_id(0) * PEL_WIDTH, slots, listed, list);
    if (first >= slots) return;
    from += (size_t)get_global_id(1) * planeStride;
    to += (size_t)get_global_id(1) * planeStride;
    RingCursor ring = ringBegin(first, slots, slices);
    const floatw self = loadw(first, from);
    floatw sum = 0.0f, weight = 0.0f;
    for (; ring.row < ring.end; ++ring.row) {
        const RingEntry entry = ringEntry(&ring, rings, runs);
        const floatw value = gather1(from, entry.slots);
        const floatw triangles = selectw((floatw)(2.0f), (floatw)(1.0f), as_intw(entry.bits) < 0);
        const maskw counts = (value == value) & (entry.slots.each != ring.self.each);
        sum = selectw(sum, fma(triangles, value, sum), counts);
        weight = selectw(weight, weight + triangles, counts);
    }
    storew(selectw(self, sum / weight, (self == self) & (weight > 0.0f)), first, to);
}

static inline float finiteOrZero(float value) {
    return isfinite(value) ? value : 0.0f;
}

// `planes` after smoothing, `estimated` as the estimator left them (for the directions).
static inline void storeQuantity(uint slot, uint planeStride, __global const float* planes,
                                 __global const float* estimated, float scale, __global float* result) {
    const float first = planes[slot] * scale;
#if PEL_MESH_PLANES > 1
    const float second = planes[(size_t)planeStride + slot] * scale;
#endif
#if PEL_MESH_QUANTITY == PEL_QUANTITY_ABSOLUTE
    *result = finiteOrZero(fabs(first));
#elif PEL_MESH_QUANTITY == PEL_QUANTITY_ABSOLUTE_MAX
    *result = finiteOrZero(fmax(fabs(first), fabs(second)));
#elif PEL_MESH_QUANTITY == PEL_QUANTITY_CURVEDNESS
    *result = finiteOrZero(hypot(first, second) * 0.70710678f);
#elif PEL_MESH_QUANTITY == PEL_QUANTITY_MEAN || PEL_MESH_QUANTITY == PEL_QUANTITY_FIRST
    *result = finiteOrZero(first);
#elif PEL_MESH_QUANTITY == PEL_QUANTITY_GAUSSIAN
    *result = finiteOrZero(first * second);
#elif PEL_MESH_QUANTITY == PEL_QUANTITY_SECOND
    *result = finiteOrZero(second);
#else
    result[0] = finiteOrZero(first);
    result[1] = finiteOrZero(second);
#if PEL_MESH_QUANTITY == PEL_QUANTITY_FRAME
    for (uint plane = 2; plane < 8; ++plane) result[plane] = estimated[(size_t)plane * planeStride + slot];
#endif
#endif
}

__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void curvature_store(
    __global const uint* restrict slotOf, uint planeStride, __global const float* restrict planes,
    __global const float* restrict estimated, float scale, __global float* result, VertexLayout layout) {
    const uint vertex = get_global_id(0);
    if (vertex >= layout.count) return;
#if PEL_MESH_MAPPED
    const uint slot = slotOf[vertex];
#else
    const uint slot = vertex;
#endif
    storeQuantity(slot, planeStride, planes, estimated, scale,
                  result + layout.offset + (size_t)vertex * layout.stride);
}

// The same for the vertices of some slots: those of the listed slices whose bit is set in lanes[].
__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void curvature_store_listed(
    uint slots, uint listed, __global const uint* restrict list, __global const uint* restrict lanes,
    __global const uint* restrict memberOffsets, __global const uint* restrict members, uint planeStride,
    __global const float* restrict planes, __global const float* restrict estimated, float scale,
    __global float* result, VertexLayout layout) {
    const uint item = get_global_id(0), slot = meshSlot(item, slots, listed, list);
    if (slot >= slots || !(lanes[item / PEL_MESH_LANES] >> (item % PEL_MESH_LANES) & 1)) return;
    result += layout.offset;
#if PEL_MESH_MAPPED
    for (uint m = memberOffsets[slot]; m < memberOffsets[slot + 1]; ++m)
        storeQuantity(slot, planeStride, planes, estimated, scale,
                      result + (size_t)members[m] * layout.stride);
#else
    storeQuantity(slot, planeStride, planes, estimated, scale, result + (size_t)slot * layout.stride);
#endif
}
