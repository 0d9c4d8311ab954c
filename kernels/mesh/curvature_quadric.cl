// Curvature by a local polynomial through the two-ring of each slot (mathematics, section 5): heights over the tangent
// plane of the given normal, fitted by least squares with slope, quadratic and cubic terms. The slope
// corrects the normal. The cubic terms absorb what would otherwise disturb the quadratic ones on irregular
// meshes, and are not used further. Only positions are measured: the normal says which direction is up. A
// normal that is far off the normals of its ring, as where noise folded a sliver over, is replaced by their
// mean.
//
// Heights are bent first: q becomes q r^2 / (r^2 + q^2), r being the distance along the plane. A circle
// through the slot that touches the plane, q = k (r^2 + q^2) / 2, then becomes exactly the parabola k r^2 /
// 2. So spheres and cylinders leave no terms of fourth order, which a fit of third order would take for
// quadratic ones, the more, the longer the cells are. The plane must touch the surface for that: the slope of
// the ring, unless it is small, is taken off first, and the bending fades out where the ring is still steep.
//
// The two-ring is walked as the rings of the ring. Where those are closed, their walks begin after the slot's
// own neighbours and leave out the last vertex, with which the next walk begins, so each vertex of the
// two-ring counts once. Some count several times: at borders; where triangles are not consistently oriented;
// and the one vertex behind a neighbour with four neighbours, which is kept although the next walk begins
// with it (on meshes of four and eight neighbours that takes up to a sixth off the error).
//
// Where a ring is small among larger triangles, or thinner than the two-ring, most of that lies outside of what the ring says
// is near, and what is left does not tell nine numbers. Such slots are fitted once more, to all of the two-ring in
// coordinates that its own moments give. Positions are known to float rounding only, and where points stand so that H would
// be off by more than that allows, the fit is done again too; if that does not help, to the rings of all these points.
//
// Of a ring with many neighbours (the hub of a fan, seen from its rim) only the nearest on either side are
// walked.
//
// What the points leave open (fewer than nine, all on a line) a ridge decides, towards a quadric and then a plane; a
// term whose pivot is lost to rounding is dropped. The result is always finite. Such slots are counted.
//
// Inputs: position (length) and unit normal of each slot, one-rings (shared/mesh.h), links and rounds (mesh_links.cl).
// Output: lib/mesh/principal.clh; counts->lowDegreeFits, where counts is not NULL.
//
// One work-item: PEL_WIDTH slots.
//
// Variants: PEL_MESH_STRIDE, PEL_MESH_RUNS (lib/mesh/mesh_slots.clh), PEL_MESH_PLANES (lib/mesh/principal.clh).

#include "mesh/quadric_walk.clh"

// From the moments of points to coordinates in which these are WIDE_SPREAD2 away in the mean, of the lanes in `wanted`; those that
// have such.
inline maskw widenChart(Chart* chart, const Moments* m, maskw wanted) {
    const floatw spread2 = (m->uu + m->vv) / m->weight;
    wanted &= finitew(spread2) & (spread2 > 0.0f);
    const floatw unit2 = WIDE_SPREAD2 / selectw((floatw)(1.0f), spread2, wanted), part = unit2 / m->weight;
    Chart other = *chart;
    shapeChart(&other, m->uu * part, m->uv * part, m->vv * part,
               selectw((floatw)(0.0f), m->nn * part, chart->replaced), WIDE_SIZE);
    chart->xx = selectw(chart->xx, other.xx, wanted), chart->xy = selectw(chart->xy, other.xy, wanted);
    chart->yy = selectw(chart->yy, other.yy, wanted), chart->round = selectw(chart->round, other.round, wanted);
    chart->scale = selectw(chart->scale, chart->scale * sqrt(unit2), wanted);
    chart->farthest2 = WIDE_FARTHEST2;
    return wanted;
}

// Whether rounding of positions moves H by too much.
inline maskw isNoisy(const Fit* fit, const Chart* chart) {
    const floatw x = chart->n.x * chart->origin.x, y = chart->n.y * chart->origin.y,
                 z = chart->n.z * chart->origin.z;
    const floatw unit = chart->reach * chart->scale, amplified = fit->noise * unit * unit;
    const floatw noise = amplified * ROUNDING * sqrt(fma(x, x, fma(y, y, z * z))) / chart->reach;
    const floatw fxx = fit->right[2], fxy = fit->right[3], fyy = fit->right[4];
    const floatw uu = chart->xx * fma(chart->xx, fxx, 2.0f * chart->xy * fxy) + chart->xy * chart->xy * fyy;
    const floatw uv = chart->yy * fma(chart->xx, fxy, chart->xy * fyy), vv = chart->yy * chart->yy * fyy;
    const floatw bent = unit * sqrt(0.5f * fma(uu, uu, fma(2.0f * uv, uv, vv * vv)));
    return (noise > NOISE_LEAST) & (noise > NOISE_SHARE * bent) & (amplified > NOISE_REGULAR);
}

// How many lanes of the `slots` that begin at `first` are set.
inline uint countLanes(maskw mask, uint first, uint slots) {
    const uintw one = selectw((uintw)(0), (uintw)(1), mask & ((uintw)(first) + as_uintw(lanesw()) < slots));
#if PEL_WIDTH == 1
    return one;
#else
    const uint4 four = one.lo + one.hi;
    const uint2 two = four.lo + four.hi;
    return two.x + two.y;
#endif
}

__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void curvature_quadric(
    uint slots, uint listed, __global const uint* list, __global const uint* slices,
    __global const uint* rings, __global const uint* runs, __global const float* positions, uint positionOffset,
    __global const float* normals, uint normalOffset, uint planeStride, __global float* planes,
    __global const uint* links, __global const uint* rounds, __global MeshCounts* counts) {
    const uint first = meshSlot(get_global_id(0) * PEL_WIDTH, slots, listed, list);
    if (first >= slots) return;
    RingCursor ring = ringBegin(first, slots, slices);
    positions += positionOffset;
    normals += normalOffset;
    Chart chart;
    chart.last = ring.last;
    chart.replaced = 0;
    const SlotFrame frame = slotFrame(&ring, positions, normals);
    chart.origin = frame.origin, chart.n = frame.n, chart.u = frame.u, chart.v = frame.v;
    maskw spread = scaleChart(&chart, ring, rings, runs, positions) & frame.sound;
    const maskw doubtful = spread & chart.doubtful;
    if (anyw(doubtful)) {
        const Vec3w mean = ringNormal(ring, rings, runs, normals);
        const maskw wrong = doubtful & (dot3(mean, chart.n) < WRONG_NORMAL);
        if (anyw(wrong)) {
            chart.replaced = wrong;
            orientChart(&chart, select3(chart.n, mean, wrong));
            spread = scaleChart(&chart, ring, rings, runs, positions) & frame.sound;
        }
    }

    Fit fit;
    Moments moments;
    const Walk intoFit = {slices, rings, runs, links, rounds, positions, &chart, &fit, 0, 0};
    floatw best[5];
    maskw poor = spread, low = spread, moved = spread;
    for (int attempt = 0; attempt < 3; ++attempt) {
#pragma unroll
        for (int i = 0; i < MONOMIALS; ++i) fit.moments[i] = 0.0f;
#pragma unroll
        for (int i = 0; i < TERMS; ++i) fit.right[i] = 0.0f;
        fit.weight = fit.weight2 = fit.ones[0] = fit.ones[1] = 0.0f;
        if (attempt < 2)
            walkPoints(&intoFit, ring, poor);
        else
            walkFurther(&intoFit, ring, poor);
        assemble(&fit);
        const maskw unsure = solve(&fit, &chart);
#pragma unroll
        for (int i = 0; i < 5; ++i) best[i] = attempt ? selectw(best[i], fit.right[i], poor) : fit.right[i];
        low = selectw(low, fit.low, poor) & spread;
        const maskw noisy = isNoisy(&fit, &chart);
        // What a ridge decides is not moved by noise, and not right for that.
        poor &= attempt ? noisy | (unsure & moved) : noisy | unsure | (chart.round < LEAST_ROUND);
        moved = noisy;
        if (attempt == 2 || !anyw(poor)) break;
        moments.uu = moments.uv = moments.vv = moments.nn = 0.0f, moments.weight = 1e-20f;
        const Walk intoMoments = {slices,    rings,  runs, links,    rounds,
                                  positions, &chart, 0,    &moments, attempt};
        if (attempt)
            walkFurther(&intoMoments, ring, poor);
        else
            walkPoints(&intoMoments, ring, poor);
        poor = widenChart(&chart, &moments, poor);
    }
    if (counts && anyw(low)) atomic_add(&counts->lowDegreeFits, countLanes(low, first, slots));

    // Back to derivatives of the height, in units of the reach, by the tangent vectors.
    const floatw fx = best[0], fxx = best[2], fxy = best[3];
    const floatw fy = best[1], fyy = best[4];
    const floatw du = chart.su + fma(chart.xx, fx, chart.xy * fy), dv = fma(chart.yy, fy, chart.sv);
    const floatw duu = chart.xx * fma(chart.xx, fxx, 2.0f * chart.xy * fxy) + chart.xy * chart.xy * fyy;
    const floatw duv = chart.yy * fma(chart.xx, fxy, chart.xy * fyy), dvv = chart.yy * chart.yy * fyy;
    // The second fundamental form of the graph, in an orthonormal frame of its tangent plane at the slot.
    const Vec3w n = chart.n, u = chart.u, v = chart.v;
    const floatw slope2 = fma(du, du, dv * dv), w = sqrt(1.0f + slope2);
    const Vec3w normal = scale3(sub3(n, add3(scale3(u, du), scale3(v, dv))), 1.0f / w);
    const Vec3w tu = scale3(add3(u, scale3(n, du)), inverseRootw(fma(du, du, (floatw)(1.0f))));
    const Vec3w tv = cross3(normal, tu);
    const floatw ux = dot3(tu, u), uy = dot3(tu, v), vx = dot3(tv, u), vy = dot3(tv, v);
    const floatw part = -chart.scale / w;  // heights along the normal: bending away from it is negative
    const floatw xx = duu * part, xy = duv * part, yy = dvv * part;
    const floatw uu = ux * fma(xx, ux, 2.0f * xy * uy) + yy * uy * uy;
    const floatw vv = vx * fma(xx, vx, 2.0f * xy * vy) + yy * vy * vy;
    const floatw uv = xx * ux * vx + xy * fma(ux, vy, uy * vx) + yy * uy * vy;
    const maskw measured = spread & finitew(uu) & finitew(uv) & finitew(vv);
    storePrincipal(uu, uv, vv, tu, tv, measured, first, planeStride, planes);
}
