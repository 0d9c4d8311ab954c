// Curvature at the vertices of a mesh and its uniform smoothing (mathematics, section 5).
//
// Inputs: position (length) and unit normal of each slot, one-rings (shared/mesh.h).
// Results between passes: one float per slot, 1/length; NaN where nothing could be measured. Such a slot
// stays out of its neighbours' means, and the last pass writes 0 for it, so that no NaN ever spreads or
// leaves. One work-item: PEL_WIDTH slots; curvature_store: one vertex of the caller. Variants: MESH_MAPPED 1:
// vertices find their slot in slotOf.

#include "lib/mesh_ring.clh"

// Unit normals as they are, others brought to unit length, NaN for those that have no direction. The common
// case is one comparison for all lanes.
inline void usable_normals(floatw* x, floatw* y, floatw* z) {
    const maskw odd = !(fabs(fma(*x, *x, fma(*y, *y, *z * *z)) - 1.0f) <= MESH_UNIT_TOLERANCE);
    if (!anyw(odd)) return;
    const floatw largest = fmax(fabs(*x), fmax(fabs(*y), fabs(*z)));
    const floatw sx = *x / largest, sy = *y / largest, sz = *z / largest;
    const floatw length = sqrt(fma(sx, sx, fma(sy, sy, sz * sz)));
    *x = selectw(*x, sx / length, odd);
    *y = selectw(*y, sy / length, odd);
    *z = selectw(*z, sz / length, odd);
}

// (min + max) / 2 of |dn| / |dp| over the edges of a slot [FaceWorks 1.0].
__kernel __attribute__((reqd_work_group_size(MESH_GROUP, 1, 1))) void curvature_edge(
    uint slots, __global const uint* slices, __global const uint* rings, __global const float* positions,
    uint positionOffset, __global const float* normals, uint normalOffset, __global float* curvature) {
    const uint first = get_global_id(0) * PEL_WIDTH;
    if (first >= slots) return;
    RingCursor ring = ring_begin(first, slots, slices);
    floatw px, py, pz, nx, ny, nz;
    positions += positionOffset;
    normals += normalOffset;
    gather3(positions, ring.self, &px, &py, &pz);
    gather3(normals, ring.self, &nx, &ny, &nz);
    usable_normals(&nx, &ny, &nz);
    // Squares order as their roots do: two roots at the end instead of two per edge.
    floatw low = INFINITY, high = -1.0f;
    for (; ring.row < ring.end; ++ring.row) {
        const uintw other = RING_SLOT(ring_entry(&ring, rings));
        floatw dx, dy, dz, mx, my, mz;
        gather3(positions, other, &dx, &dy, &dz);
        gather3(normals, other, &mx, &my, &mz);
        usable_normals(&mx, &my, &mz);
        dx -= px, dy -= py, dz -= pz;
        mx -= nx, my -= ny, mz -= nz;
        const floatw length2 = fma(dx, dx, fma(dy, dy, dz * dz));
        const floatw ratio = fma(mx, mx, fma(my, my, mz * mz)) / length2;
        // Fails for edges without length (fillers among them) and for whatever is not finite at either end.
        const maskw usable = (length2 >= MESH_MIN_LENGTH2) & (length2 < INFINITY) & (ratio < INFINITY);
        low = selectw(low, fmin(low, ratio), usable);
        high = selectw(high, fmax(high, ratio), usable);
    }
    storew(selectw((floatw)(NAN), 0.5f * (sqrt(low) + sqrt(high)), high >= 0.0f), first, curvature);
}

// The mean over a slot's triangles of their other two slots' values, itself not included.
__kernel __attribute__((reqd_work_group_size(MESH_GROUP, 1, 1))) void curvature_smooth(
    uint slots, __global const uint* slices, __global const uint* rings, __global const float* from,
    __global float* to) {
    const uint first = get_global_id(0) * PEL_WIDTH;
    if (first >= slots) return;
    RingCursor ring = ring_begin(first, slots, slices);
    const floatw self = loadw(first, from);
    floatw sum = 0.0f, weight = 0.0f;
    for (; ring.row < ring.end; ++ring.row) {
        const uintw entry = ring_entry(&ring, rings);
        const uintw other = RING_SLOT(entry);
        const floatw value = gather1(from, other);
        const maskw counts = (value == value) & (other != ring.self);
        sum = selectw(sum, fma(selectw((floatw)(2.0f), (floatw)(1.0f), as_intw(entry) < 0), value, sum),
                      counts);
        weight =
            selectw(weight, weight + selectw((floatw)(2.0f), (floatw)(1.0f), as_intw(entry) < 0), counts);
    }
    storew(selectw(self, sum / weight, (self == self) & (weight > 0.0f)), first, to);
}

__kernel __attribute__((reqd_work_group_size(MESH_GROUP, 1, 1))) void curvature_store(
    __global const uint* slotOf, __global const float* curvature, float scale, __global float* result,
    VertexLayout layout) {
    const uint vertex = get_global_id(0);
    if (vertex >= layout.count) return;
#if MESH_MAPPED
    const float value = curvature[slotOf[vertex]] * scale;
#else
    const float value = curvature[vertex] * scale;
#endif
    result[layout.offset + (size_t)vertex * layout.stride] = isfinite(value) ? value : 0.0f;
}
