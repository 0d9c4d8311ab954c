// Curvature by a local polynomial through the two-ring of each slot (mathematics, section 5): heights over
// the tangent plane of the given normal, fitted by least squares with slope, quadratic and cubic terms. The
// slope corrects the normal. The cubic terms absorb what would otherwise disturb the quadratic ones on
// irregular meshes, and are not used further. Only positions are measured: the normal says which direction
// is up. A normal that differs much from the normals of its ring, for example where noise has folded a sliver
// over, is replaced by their mean.
//
// Heights are bent first: q becomes q r^2 / (r^2 + q^2), r being the distance along the plane. A circle
// through the slot that touches the plane, q = k (r^2 + q^2) / 2, then becomes exactly the parabola k r^2 /
// 2. So spheres and cylinders leave no terms of fourth order, which a fit of third order would take for
// quadratic ones, the more, the longer the cells are. The plane must touch the surface for that: the slope of
// the ring, unless it is small, is taken off first, and the bending fades out where the ring is still steep.
//
// The two-ring is a list, made once from the rings of the ring (two_ring.cl). Where those are closed, their
// walks begin after the slot's own neighbours and leave out the last vertex, with which the next walk
// begins, so each vertex of the two-ring counts once. Some vertices count several times: at borders; where
// triangles are not consistently oriented; and the one vertex behind a neighbour with four neighbours, which
// is kept although the next walk begins with it (on meshes of four and eight neighbours that takes up to a
// sixth off the error).
//
// The fit's coordinates come from the second moments of the two-ring, so that slivers fit as well as other
// triangles, and a ring that is small among larger triangles still has points that determine nine numbers.
//
// In a ring with many neighbours (the hub of a fan, for a vertex on its rim), only the nearest ones on either
// side are in the list. A slot of at most four neighbours with few points takes the three-ring as well
// (two_ring.cl).
//
// A ridge term determines the coefficients that the points do not (fewer than nine points, or all on a line),
// towards a quadric and then a plane. A term whose pivot is lost to rounding is dropped. The result is always
// finite. Such slots are counted.
//
// Inputs: position (length) and unit normal of each slot, one-rings, and points of the two-ring
// (shared/mesh.h). Output: lib/mesh/mesh_frame.clh; counts->lowDegreeFits, where counts is not NULL.
//
// One work-item: PEL_WIDTH slots; PEL_WIDTH may be 16.
//
// Variants: PEL_MESH_STRIDE (lib/mesh/mesh_slots.clh), PEL_MESH_PLANES (lib/mesh/mesh_frame.clh).

#include "mesh/quadric_fit.clh"

// How many lanes of the `slots` that begin at `first` are set.
static inline uint countLanes(maskw mask, uint first, uint slots) {
    const uintw one = selectw((uintw)(0), (uintw)(1), mask & ((uintw)(first) + as_uintw(lanesw()) < slots));
#if PEL_WIDTH == 1
    return one;
#else
#if PEL_WIDTH == 16
    const uint8 eight = one.lo + one.hi;
#else
    const uint8 eight = one;
#endif
    const uint4 four = eight.lo + eight.hi;
    const uint2 two = four.lo + four.hi;
    return two.x + two.y;
#endif
}

__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void curvature_quadric(
    uint slots, uint listed, __global const uint* restrict slicesWanted,
    __global const float* restrict positions, uint positionOffset, __global const float* restrict normals,
    uint normalOffset, uint planeStride, __global float* restrict planes,
    __global const uint* restrict starts, __global const uint* restrict points,
    __global const uint* restrict rounds, __global MeshCounts* restrict counts) {
    const uint first = meshSlot(get_global_id(0) * PEL_WIDTH, slots, listed, slicesWanted);
    if (first >= slots) return;
    const Points list = pointsBegin(first, slots, starts, rounds);
    positions += positionOffset;
    normals += normalOffset;
    Chart chart;
    chart.last = list.last;
    chart.replaced = 0;
    const SlotFrame frame = slotFrame(list.last, list.self, positions, normals);
    chart.origin = frame.origin, chart.n = frame.n, chart.u = frame.u, chart.v = frame.v;
    maskw spread;
    for (int again = 0; again < 2; ++again) {
        spread = measureRing(&chart, &list, points, positions) & frame.sound;
        const maskw doubtful = spread & chart.doubtful;
        if (again || !anyw(doubtful)) break;
        const Vec3w mean = ringNormal(&list, points, normals);
        chart.replaced = doubtful & (dot3(mean, chart.n) < WRONG_NORMAL);
        if (!anyw(chart.replaced)) break;
        orientChart(&chart, select3(chart.n, mean, chart.replaced));
    }

    Moments moments;
    moments.uu = moments.uv = moments.vv = moments.nn = 0.0f, moments.weight = 1e-20f;
    for (uint row = list.row; row < list.end; ++row) {
        const Slots at = pointsAt(&list, row, points);
        addMoments(&moments, at, spread & (at.each != list.self.each), &chart, positions);
    }
    shapeChart(&chart, &moments);
    Fit fit;
    clearFit(&fit);
    for (uint row = list.row; row < list.end; ++row) {
        const Slots at = pointsAt(&list, row, points);
        addPoint(&fit, locate(at, spread & (at.each != list.self.each), &chart, positions));
    }
    Equations solved;
    factorize(&fit, &chart, &solved);
    substitute(&solved);
    const maskw low = spread & solved.low;
    if (counts && anyw(low)) atomic_add(&counts->lowDegreeFits, countLanes(low, first, slots));

    // Back to derivatives of the height, in units of the reach, by the tangent vectors.
    const floatw fx = solved.right[0], fy = solved.right[1];
    const floatw fxx = solved.right[2], fxy = solved.right[3], fyy = solved.right[4];
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
