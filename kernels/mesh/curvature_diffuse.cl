// Smoothing to a radius in length units: the heat equation on the surface, run until a point has spread over
// a standard deviation of the radius (a Gaussian blur where the surface is flat). Twice the triangles give
// the same answer.
//
// The Laplacian is the cotangent one [Pinkall & Polthier 1993] over Voronoi areas; or, with DIFFUSE_AREA, each edge has
// the area of its triangles over the square of its length, and the slot the sum of those areas over 4: the ring's
// second moment, the sum of weight times length^2, is then that of the Laplacian, 4, and no weight is negative. Time runs in
// MESH_SUPER_STEPS super steps of Runge-Kutta-Legendre of first order [Meyer, Balsara & Aslam, JCP 2014],
// whose number of stages grows with radius / edge, not with its square. A wave that the exact blur leaves
// exp(-x) of is left J0(2 sqrt(x / 4))^4 of: 1.6 % less where it matters most, x = 1/2, and below 3 % of all
// that is short.
//
// Inputs: position (length) and unit normal of each slot, one-rings (shared/mesh.h); planes as in
// curvature.cl. One work-item: PEL_WIDTH slots (of plane get_global_id(1) in diffuse_stage). Variants:
// MESH_STRIDE, MESH_RUNS (lib/mesh/mesh_slots.clh), DIFFUSE_AREA.

#include "lib/mesh/mesh_triangle.clh"

// Writes, for each entry of the rings, time * weight / area, so that a stage needs nothing else; and the
// slot's rate, the sum of weight / area, 1/length^2. limit: a slot whose rate * time exceeds it is slowed
// down to it, which keeps every stage stable on slivers. crease2: square of the change of normal at which
// weights fall to 1/e; 0: none do.
__kernel __attribute__((reqd_work_group_size(MESH_GROUP, 1, 1))) void diffuse_weights(
    uint slots, uint listed, __global const uint* list, __global const uint* slices, __global const uint* rings,
    __global const uint* runs, __global const float* positions,
    uint positionOffset, __global const float* normals, uint normalOffset, float time, float limit,
    float crease2, __global float* weights, __global float* rates) {
    const uint first = mesh_slot(get_global_id(0) * PEL_WIDTH, slots, listed, list);
    if (first >= slots) return;
    RingCursor ring = ring_begin(first, slots, slices);
    const uint begin = ring.row;
    positions += positionOffset;
    normals += normalOffset;
    const floatw zero = 0.0f;
    const Vec3w none = vec3(zero, zero, zero);
    Vec3w origin;
    gather3(positions, ring.last, ring.self, &origin.x, &origin.y, &origin.z);

    floatw area = zero, pending = zero;
    Vec3w start = none, previous = none;
    RingWalk walk = {0, 0};
    uintw startRow = (uintw)(begin);
    for (; ring.row < ring.behind; ++ring.row) {
        const RingStep step = ring_step(&ring, &walk, rings, runs);
        Vec3w current;
        gather3(positions, ring.last, step.entry.slots, &current.x, &current.y, &current.z);
        current = sub3(current, origin);
        // Each triangle gives the cotangent at either neighbour to the edge to the other one.
        const Vec3w other = select3(current, start, step.ends);
        const Vec3w between = sub3(previous, other), across = crossExact3(previous, other);
        const floatw doubled2 = dot3(across, across);
        const maskw triangle = step.triangle & finitew(doubled2) &
                               (doubled2 > TRIANGLE_FLAT * dot3(previous, previous) * dot3(other, other));
        const floatw doubled = sqrt(selectw((floatw)(1.0f), doubled2, triangle));
#if DIFFUSE_AREA
        // What stands at a neighbour belongs to the edge to the other one, as the cotangents do.
        const floatw atOther = selectw(zero, 4.0f * doubled / dot3(previous, previous), triangle);
        const floatw atPrevious = selectw(zero, 4.0f * doubled / dot3(other, other), triangle);
        const floatw part = doubled;  // the triangle at both of its edges
#else
        const floatw atOther = selectw(zero, -dot3(other, between) / doubled, triangle);
        const floatw atPrevious = selectw(zero, dot3(previous, between) / doubled, triangle);
        const floatw part = corner_area(previous, other, doubled);
#endif
        area += selectw(zero, part, triangle & finitew(part));
        if (ring.row > begin) {
            const uint at = (ring.row - 1) * MESH_LANES + ring.lane;
            storew(selectw(zero, pending + atOther, step.walking), at, weights);
        }
        const maskw closes = step.ends & step.triangle;
        if (anyw(closes)) {
#define ADD_TO_START_(i, s) \
    if (closes s) weights[startRow s * MESH_LANES + ring.lane + i] += atPrevious s;
            PEL_EACH_LANE(ADD_TO_START_)
#undef ADD_TO_START_
        }
        pending = selectw(atPrevious, zero, step.starts);
        start = select3(start, current, step.starts);
        startRow = selectw(startRow, (uintw)(ring.row), step.starts);
        previous = current;
    }

    Vec3w n;
    gather3(normals, ring.last, ring.self, &n.x, &n.y, &n.z);
    usable_normals(&n.x, &n.y, &n.z);
    const floatw half_ = selectw(zero, 0.5f / area, area > zero);
    floatw rate = zero;
    for (ring.row = begin; ring.row < ring.end; ++ring.row) {
        const uint at = ring.row * MESH_LANES + ring.lane;
        floatw weight = loadw(at, weights) * half_;
        if (crease2 > 0.0f) {
            Vec3w m;
            gather3(normals, ring.last, ring_entry(&ring, rings, runs).slots, &m.x, &m.y, &m.z);
            usable_normals(&m.x, &m.y, &m.z);
            const Vec3w turn = sub3(m, n);
            // Uneven weights bound values by their neighbours' only where none is negative.
            weight = fmax(weight, zero) * exp(-dot3(turn, turn) / crease2);
        }
        weight = selectw(zero, weight, finitew(weight));
        rate += fabs(weight);
        storew(weight, at, weights);
    }
    const floatw slowed = fmin((floatw)(time), limit / rate);  // limit / 0 is Inf
    for (uint row = begin; row < ring.end; ++row) {
        const uint at = row * MESH_LANES + ring.lane;
        const floatw weight = loadw(at, weights);
        storew(selectw(zero, weight * slowed, weight != zero), at, weights);
    }
    storew(rate, first, rates);
}

// next = mu * current + nu * before + step * Laplacian(current); next may be before.
__kernel __attribute__((reqd_work_group_size(MESH_GROUP, 1, 1))) void diffuse_stage(
    uint slots, uint listed, __global const uint* list, __global const uint* slices, __global const uint* rings,
    __global const uint* runs, __global const float* weights,
    uint planeStride, __global const float* current, __global const float* before, __global float* next,
    float mu, float nu, float step) {
    const uint first = mesh_slot(get_global_id(0) * PEL_WIDTH, slots, listed, list);
    if (first >= slots) return;
    const size_t plane = (size_t)get_global_id(1) * planeStride;
    current += plane, before += plane, next += plane;
    RingCursor ring = ring_begin(first, slots, slices);
    const floatw self = loadw(first, current);
    floatw change = 0.0f;
    for (; ring.row < ring.end; ++ring.row) {
        const floatw difference = gather1(current, ring_entry(&ring, rings, runs).slots) - self;
        const size_t at = (size_t)ring.row * MESH_LANES + ring.lane;
        const floatw weight = loadw(at, weights);
        PEL_PREFETCH(weights + at + ROWS_AHEAD * MESH_LANES);
        // NaN: nothing was measured there. A slot that has none itself keeps its NaN.
        change = selectw(change, fma(weight, difference, change), difference == difference);
    }
    storew(fma((floatw)(mu), self, fma((floatw)(nu), loadw(first, before), step * change)), first, next);
}
