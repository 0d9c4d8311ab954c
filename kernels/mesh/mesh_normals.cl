// Unit normals from positions: the normals of the triangles round a slot, weighted by their angles there
// [Thuermer & Wuethrich 1998], so that the triangulation of a flat face does not matter.
//
// Inputs: position (length) of each slot, one-rings (shared/mesh.h). Output: normal of each slot; 0 where all
// triangles are degenerate.
//
// One work-item: PEL_WIDTH slots (mesh_normals), one vertex of the caller (mesh_normals_store).
//
// Variants: PEL_MESH_STRIDE (also of the output), PEL_MESH_RUNS (lib/mesh/mesh_slots.clh); PEL_MESH_MAPPED
// 1: vertices find their slot in slotOf.

#include "lib/mesh/mesh_triangle.clh"

__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void mesh_normals(
    uint slots, uint listed, __global const uint* restrict list, __global const uint* restrict slices,
    __global const uint* restrict rings, __global const uint* restrict runs,
    __global const float* restrict positions, uint positionOffset, __global float* normals,
    uint normalOffset) {
    const uint first = meshSlot(get_global_id(0) * PEL_WIDTH, slots, listed, list);
    if (first >= slots) return;
    RingCursor ring = ringBegin(first, slots, slices);
    positions += positionOffset;
    normals += normalOffset;
    const floatw zero = 0.0f;
    const Vec3w none = vec3(zero, zero, zero);
    Vec3w origin;
    gather3(positions, ring.last, ring.self, &origin.x, &origin.y, &origin.z);

    Vec3w sum = none, start = none, previous = none;
    RingWalk walk = {0, 0};
    maskw flipped = 0;
    for (; ring.row < ring.behind; ++ring.row) {
        const RingStep step = ringStep(&ring, &walk, rings, runs);
        Vec3w current;
        gather3(positions, ring.last, step.entry.slots, &current.x, &current.y, &current.z);
        current = sub3(current, origin);
        // Scaled to a length of 1 to 2, so that no product leaves the range of float. An edge without length
        // stays 0.
        const floatw length2 = dot3(current, current);
        const maskw long_ = (length2 >= PEL_MESH_MIN_LENGTH2) & finitew(length2);
        current = select3(none, scale3(current, exactScalew(length2)), long_);
        const Vec3w other = select3(current, start, step.ends);
        const Vec3w across = crossExact3(previous, other);
        const floatw doubled2 = dot3(across, across);
        const maskw plane =
            step.triangle & (doubled2 > PEL_TRIANGLE_FLAT * dot3(previous, previous) * dot3(other, other));
        const floatw doubled = sqrt(selectw((floatw)(1.0f), doubled2, plane));
        floatw weight = atan2(doubled, dot3(previous, other)) / doubled;
        weight = selectw(weight, -weight, flipped);
        sum = select3(sum, add3(sum, scale3(across, weight)), plane);
        start = select3(start, current, step.starts);
        flipped = (step.entry.bits & (uintw)(PEL_MESH_FLIPPED)) != 0;
        previous = current;
    }
    const floatw length2 = dot3(sum, sum);
    const Vec3w n = select3(none, scale3(sum, inverseRootw(length2)), length2 > 1e-12f);
#define STORE_(i, s)       \
    if (first + i < slots) \
        vstore3((float3)(n.x s, n.y s, n.z s), 0, normals + (size_t)(first + i) * PEL_MESH_STRIDE);
    PEL_EACH_LANE(STORE_)
#undef STORE_
}

__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void mesh_normals_store(
    __global const uint* restrict slotOf, __global const float* restrict normals, uint normalOffset,
    __global float* result, VertexLayout layout) {
    const uint vertex = get_global_id(0);
    if (vertex >= layout.count) return;
#if PEL_MESH_MAPPED
    const uint slot = slotOf[vertex];
#else
    const uint slot = vertex;
#endif
    vstore3(vload3(0, normals + normalOffset + (size_t)slot * PEL_MESH_STRIDE), 0,
            result + layout.offset + (size_t)vertex * layout.stride);
}
