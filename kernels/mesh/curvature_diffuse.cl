// Smoothing to a radius in length units: the heat equation on the surface, run until a point has spread over
// a standard deviation of the radius (a Gaussian blur where the surface is flat). The result does not depend
// on the density of the mesh.
//
// The Laplacian L is the cotangent one [Pinkall & Polthier 1993] over Voronoi areas. With DIFFUSE_AREA no
// weight is negative, and the sum of value times area (a third of each triangle for each corner) is kept:
// negative cotangents become 0, which spreads too much, and the others are scaled down until the ring's
// second moment, the sum of weight times length^2, is that of all cotangents again: 4 Voronoi areas. Each
// edge takes the mean of its two ends' factors.
//
// The solution after a time, exp(time L), is a sum of Chebyshev polynomials of L [Tal-Ezer, Spectral Methods
// in Time for Parabolic Problems, SIAM J. Numer. Anal. 26, 1989], one per stage. Their number grows with
// radius / edge, not with its square; the truncation error is below 2e-4. Coefficients:
// host/mesh/mesh_smoothing.cpp.
//
// Inputs: position (length) and unit normal of each slot, one-rings (shared/mesh.h); planes as in
// curvature.cl. One work-item: PEL_WIDTH slots (of plane get_global_id(1) in diffuse_stage). Variants:
// PEL_MESH_STRIDE, PEL_MESH_RUNS (lib/mesh/mesh_slots.clh), DIFFUSE_AREA.

#include "lib/mesh/mesh_triangle.clh"

// Writes, for each entry of the rings, weight / area / limit, so that a stage needs nothing else; and the
// slot's rate, the sum of weight / area, 1/length^2. A slot whose rate exceeds the limit is slowed down to
// it, which keeps every stage stable on slivers. With DIFFUSE_AREA weights are not limited here, and
// `rates` is the slot's factor for diffuse_balance. crease2: square of the change of normal at which weights
// fall to 1/e; 0: off.
__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void diffuse_weights(
    uint slots, uint listed, __global const uint* restrict list, __global const uint* restrict slices,
    __global const uint* restrict rings, __global const uint* restrict runs,
    __global const float* restrict positions, uint positionOffset, __global const float* restrict normals,
    uint normalOffset, float limit, float crease2, __global float* weights, __global float* rates) {
    const uint first = meshSlot(get_global_id(0) * PEL_WIDTH, slots, listed, list);
    if (first >= slots) return;
    RingCursor ring = ringBegin(first, slots, slices);
    const uint begin = ring.row;
    positions += positionOffset;
    normals += normalOffset;
    const floatw zero = 0.0f;
    const Vec3w none = vec3(zero, zero, zero);
    Vec3w origin;
    gather3(positions, ring.last, ring.self, &origin.x, &origin.y, &origin.z);

    floatw area = zero, nearest = zero, pending = zero;
    Vec3w start = none, previous = none;
    RingWalk walk = {0, 0};
    uintw startRow = (uintw)(begin);
    for (; ring.row < ring.behind; ++ring.row) {
        const RingStep step = ringStep(&ring, &walk, rings, runs);
        Vec3w current;
        gather3(positions, ring.last, step.entry.slots, &current.x, &current.y, &current.z);
        current = sub3(current, origin);
        // In each triangle, the cotangent at one neighbour belongs to the edge to the other neighbour.
        const Vec3w other = select3(current, start, step.ends);
        const Vec3w between = sub3(previous, other), across = crossExact3(previous, other);
        const floatw doubled2 = dot3(across, across);
        const maskw triangle = step.triangle & finitew(doubled2) &
                               (doubled2 > PEL_TRIANGLE_FLAT * dot3(previous, previous) * dot3(other, other));
        const floatw doubled = sqrt(selectw((floatw)(1.0f), doubled2, triangle));
        const floatw atOther = selectw(zero, -dot3(other, between) / doubled, triangle);
        const floatw atPrevious = selectw(zero, dot3(previous, between) / doubled, triangle);
        const floatw voronoi = cornerArea(previous, other, doubled);
        nearest += selectw(zero, voronoi, triangle & finitew(voronoi));
        area += selectw(zero, doubled / 6.0f, triangle & finitew(doubled));
        if (ring.row > begin) {
            const uint at = (ring.row - 1) * PEL_MESH_LANES + ring.lane;
            storew(selectw(zero, pending + atOther, step.walking), at, weights);
        }
        const maskw closes = step.ends & step.triangle;
        if (anyw(closes)) {
#define ADD_TO_START_(i, s) \
    if (closes s) weights[startRow s * PEL_MESH_LANES + ring.lane + i] += atPrevious s;
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
    usableNormals(&n.x, &n.y, &n.z);
#if !DIFFUSE_AREA
    area = nearest;
#endif
    // An edge of three or more triangles has one weight, that of all its entries, or its ends would disagree.
    for (ring.row = begin; ring.row < ring.end; ++ring.row) {
        if (!anyw((ringEntry(&ring, rings, runs).bits & (uintw)(PEL_MESH_REPEAT)) != 0)) continue;
        for (uint i = 0; i < PEL_WIDTH; ++i) {
            const uint at = ring.row * PEL_MESH_LANES + ring.lane + i;
            uint earlier = begin * PEL_MESH_LANES + ring.lane + i;
            while ((rings[earlier] ^ rings[at]) & PEL_MESH_SLOT) earlier += PEL_MESH_LANES;
            if (earlier == at) continue;
            weights[earlier] += weights[at];
            weights[at] = 0.0f;
        }
    }
    const floatw half_ = selectw(zero, 0.5f / area, area > zero);
    floatw rate = zero, moment = zero;
    for (ring.row = begin; ring.row < ring.end; ++ring.row) {
        const uint at = ring.row * PEL_MESH_LANES + ring.lane;
        floatw weight = loadw(at, weights) * half_;
#if DIFFUSE_AREA
        Vec3w edge;
        gather3(positions, ring.last, ringEntry(&ring, rings, runs).slots, &edge.x, &edge.y, &edge.z);
        edge = sub3(edge, origin);
        weight = fmax(weight, zero);
        const floatw share = weight * dot3(edge, edge);
        moment += selectw(zero, share, finitew(share));
#endif
        if (crease2 > 0.0f) {
            Vec3w m;
            gather3(normals, ring.last, ringEntry(&ring, rings, runs).slots, &m.x, &m.y, &m.z);
            usableNormals(&m.x, &m.y, &m.z);
            const Vec3w turn = sub3(m, n);
            // Values stay within the range of their neighbours only if no weight is negative.
            weight = fmax(weight, zero) * exp(-dot3(turn, turn) / crease2);
        }
        weight = selectw(zero, weight, finitew(weight));
        rate += fabs(weight);
        storew(weight, at, weights);
    }
#if !DIFFUSE_AREA
    const floatw slowed = 1.0f / fmax((floatw)(limit), rate);
    for (uint row = begin; row < ring.end; ++row) {
        const uint at = row * PEL_MESH_LANES + ring.lane;
        const floatw weight = loadw(at, weights);
        storew(selectw(zero, weight * slowed, weight != zero), at, weights);
    }
#else
    rate = selectw(zero, 4.0f * nearest / (area * moment), moment > zero);
    rate = selectw(zero, rate, finitew(rate));
#endif
    storew(rate, first, rates);
}

#if DIFFUSE_AREA
// Multiplies each weight by the mean of the factors of the two ends of its edge. Both ends compute the same
// weight, so the sum of values is conserved. Writes the slot's rate.
__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void diffuse_balance(
    uint slots, uint listed, __global const uint* restrict list, __global const uint* restrict slices,
    __global const uint* restrict rings, __global const uint* restrict runs, __global float* weights,
    __global const float* restrict factors, __global float* rates) {
    const uint first = meshSlot(get_global_id(0) * PEL_WIDTH, slots, listed, list);
    if (first >= slots) return;
    RingCursor ring = ringBegin(first, slots, slices);
    const floatw own = loadw(first, factors);
    floatw rate = 0.0f;
    for (; ring.row < ring.end; ++ring.row) {
        const uint at = ring.row * PEL_MESH_LANES + ring.lane;
        const floatw other = gather1(factors, ringEntry(&ring, rings, runs).slots);
        const floatw weight = loadw(at, weights) * 0.5f * (own + other);
        rate += weight;
        storew(weight, at, weights);
    }
    storew(rate, first, rates);
}

// Scales the weight of an edge down to the stable rate of its faster end. Both ends compute the same
// weight, so the sum of values is conserved.
__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void diffuse_limit(
    uint slots, uint listed, __global const uint* restrict list, __global const uint* restrict slices,
    __global const uint* restrict rings, __global const uint* restrict runs, float limit,
    __global float* weights, __global const float* restrict rates) {
    const uint first = meshSlot(get_global_id(0) * PEL_WIDTH, slots, listed, list);
    if (first >= slots) return;
    RingCursor ring = ringBegin(first, slots, slices);
    const floatw own = fmax((floatw)(limit), loadw(first, rates));
    for (; ring.row < ring.end; ++ring.row) {
        const uint at = ring.row * PEL_MESH_LANES + ring.lane;
        const floatw weight = loadw(at, weights);
        const floatw rate = fmax(own, gather1(rates, ringEntry(&ring, rings, runs).slots));
        storew(selectw((floatw)(0.0f), weight / rate, weight != 0.0f), at, weights);
    }
}
#endif

// next = gain (current + L current / limit) - before, with gain 2. The first stage has gain 1 and no
// `before`. sum += coefficient next; the first stage starts with sum = begin current. `next` and `before`
// may be the same memory.
__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void diffuse_stage(
    uint slots, uint listed, __global const uint* restrict list, __global const uint* restrict slices,
    __global const uint* restrict rings, __global const uint* restrict runs,
    __global const float* restrict weights, uint planeStride, __global const float* restrict current,
    __global const float* before, __global float* next, __global float* sum, int isFirst, float begin,
    float coefficient) {
    const uint first = meshSlot(get_global_id(0) * PEL_WIDTH, slots, listed, list);
    if (first >= slots) return;
    const size_t plane = (size_t)get_global_id(1) * planeStride;
    current += plane, before += plane, next += plane, sum += plane;
    RingCursor ring = ringBegin(first, slots, slices);
    const floatw self = loadw(first, current);
    floatw change = 0.0f;
    for (; ring.row < ring.end; ++ring.row) {
        const floatw difference = gather1(current, ringEntry(&ring, rings, runs).slots) - self;
        const size_t at = (size_t)ring.row * PEL_MESH_LANES + ring.lane;
        const floatw weight = loadw(at, weights);
        PEL_PREFETCH(weights + at + PEL_ROWS_AHEAD * PEL_MESH_LANES);
        // NaN: nothing was measured there. A slot without a measurement keeps its NaN.
        change = selectw(change, fma(weight, difference, change), difference == difference);
    }
    floatw value = self + change, total = begin * self;
    if (!isFirst) {
        // Constant values are not rounded.
        value = fma((floatw)(2.0f), change, self + (self - loadw(first, before)));
        total = loadw(first, sum);
    }
    storew(fma((floatw)(coefficient), value, total), first, sum);
    storew(value, first, next);
}
