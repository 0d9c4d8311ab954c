// Curvature tensors by triangles [Rusinkiewicz, Estimating Curvatures and Their Derivatives on Triangle
// Meshes, 3DPVT 2004] (mathematics, section 5): the second fundamental form of each triangle round a slot by
// least squares on its three normal differences, turned into the slot's tangent plane, averaged with the part
// of the triangle's area that lies nearest to the slot.
//
// Inputs: position (length) and unit normal of each slot, one-rings (shared/mesh.h). Output:
// lib/mesh/mesh_frame.clh.
//
// One work-item: PEL_WIDTH slots. Each triangle is solved once for each of its corners: three times the
// arithmetic, but no memory traffic, no second pass and no atomic sums.
//
// Variants: PEL_MESH_STRIDE, PEL_MESH_RUNS (lib/mesh/mesh_slots.clh), PEL_MESH_PLANES
// (lib/mesh/mesh_frame.clh).

#include "lib/mesh/mesh_frame.clh"
#include "lib/mesh/mesh_triangle.clh"

typedef struct Corner {
    Vec3w offset;  // position from the slot's
    Vec3w normal;
    maskw usable;
} Corner;

static inline __attribute__((always_inline)) Corner loadCorner(Slots slots, uint last, Vec3w origin,
                                                               __global const float* positions,
                                                               __global const float* normals) {
    Corner c;
    Vec3w p;
    gather3(positions, last, slots, &p.x, &p.y, &p.z);
    gather3(normals, last, slots, &c.normal.x, &c.normal.y, &c.normal.z);
    usableNormals(&c.normal.x, &c.normal.y, &c.normal.z);
    c.offset = sub3(p, origin);
    c.usable = finite3(c.offset) & finite3(c.normal);
    return c;
}

static inline Corner cornerSelect(const Corner f, const Corner t, maskw mask) {
    Corner c;
    c.offset = select3(f.offset, t.offset, mask);
    c.normal = select3(f.normal, t.normal, mask);
    c.usable = selectw(f.usable, t.usable, mask);
    return c;
}

typedef struct Form {
    floatw uu, uv, vv, weight;
} Form;

// Adds triangle (slot, a, b), whose corners' order does not matter.
static inline __attribute__((always_inline)) void addTriangle(Form* form, Vec3w n, Vec3w u, Vec3w v, Corner a,
                                                              Corner b, maskw mask, floatw scale) {
    // In units of about the ring's size, so that products of lengths stay in the range of float.
    const Vec3w ea = scale3(a.offset, scale), eb = scale3(b.offset, scale);
    const Vec3w across = cross3(ea, eb);
    const floatw doubled2 = dot3(across, across);
    mask &= a.usable & b.usable & (doubled2 > PEL_TRIANGLE_FLAT * dot3(ea, ea) * dot3(eb, eb));
    const floatw doubled = sqrt(doubled2);
    // Orthonormal frame of the triangle, on the side of the slot's normal.
    Vec3w m = scale3(across, 1.0f / doubled);
    m = scale3(m, selectw((floatw)(1.0f), (floatw)(-1.0f), dot3(m, n) < 0.0f));
    const Vec3w x = scale3(ea, inverseRootw(dot3(ea, ea))), y = cross3(m, x);
    // The edges slot-a, a-b, b-slot in it. II (edge) = turn of the normal: six equations for xx, xy, yy.
    const Vec3w edges[3] = {ea, sub3(eb, ea), scale3(eb, -1.0f)};
    const Vec3w turns[3] = {sub3(a.normal, n), sub3(b.normal, a.normal), sub3(n, b.normal)};
    floatw p = 0.0f, q = 0.0f, r = 0.0f, rx = 0.0f, rxy = 0.0f, ry = 0.0f;
    for (int i = 0; i < 3; ++i) {
        const floatw ex = dot3(edges[i], x), ey = dot3(edges[i], y);
        const floatw tx = dot3(turns[i], x), ty = dot3(turns[i], y);
        p = fma(ex, ex, p), q = fma(ex, ey, q), r = fma(ey, ey, r);
        rx = fma(ex, tx, rx), ry = fma(ey, ty, ry);
        rxy = fma(ey, tx, fma(ex, ty, rxy));
    }
    // Normal equations ((p, q, 0), (q, p + r, q), (0, q, r)) by Cramer's rule.
    const floatw trace = p + r, minor = fma(p, r, -q * q);
    const floatw inverse = 1.0f / (trace * minor);
    const floatw xx = (rx * fma(trace, r, -q * q) - rxy * q * r + ry * q * q) * inverse;
    const floatw xy = (-rx * q * r + rxy * p * r - ry * p * q) * inverse;
    const floatw yy = (rx * q * q - rxy * p * q + ry * fma(trace, p, -q * q)) * inverse;
    // The slot's tangent vectors, rotated with its normal onto the triangle's (Rodrigues).
    const Vec3w axis = cross3(n, m);
    const floatw cosine = dot3(n, m), part = 1.0f / (1.0f + cosine);
    const Vec3w tu = add3(add3(scale3(u, cosine), cross3(axis, u)), scale3(axis, dot3(axis, u) * part));
    const Vec3w tv = add3(add3(scale3(v, cosine), cross3(axis, v)), scale3(axis, dot3(axis, v) * part));
    const floatw ux = dot3(tu, x), uy = dot3(tu, y), vx = dot3(tv, x), vy = dot3(tv, y);
    const floatw area = cornerArea(ea, eb, doubled);
    const floatw suu = ux * fma(xx, ux, 2.0f * xy * uy) + yy * uy * uy;
    const floatw svv = vx * fma(xx, vx, 2.0f * xy * vy) + yy * vy * vy;
    const floatw suv = xx * ux * vx + xy * fma(ux, vy, uy * vx) + yy * uy * vy;
    // A sliver without area gives 0 / 0, which must not be added.
    mask &= finitew(area) & finitew(suu) & finitew(suv) & finitew(svv);
    const floatw w = selectw((floatw)(0.0f), area, mask);
    form->uu = selectw(form->uu, fma(w, suu, form->uu), mask);
    form->uv = selectw(form->uv, fma(w, suv, form->uv), mask);
    form->vv = selectw(form->vv, fma(w, svv, form->vv), mask);
    form->weight += w;
}

__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void curvature_tensor(
    uint slots, uint listed, __global const uint* restrict list, __global const uint* restrict slices,
    __global const uint* restrict rings, __global const uint* restrict runs,
    __global const float* restrict positions, uint positionOffset, __global const float* restrict normals,
    uint normalOffset, uint planeStride, __global float* planes) {
    const uint first = meshSlot(get_global_id(0) * PEL_WIDTH, slots, listed, list);
    if (first >= slots) return;
    RingCursor ring = ringBegin(first, slots, slices);
    positions += positionOffset;
    normals += normalOffset;
    const Vec3w zero = same3(0.0f);
    const SlotFrame frame = slotFrame(ring.last, ring.self, positions, normals);
    const Vec3w n = frame.n, u = frame.u, v = frame.v;
    const maskw sound = frame.sound;

    Form form = {0.0f, 0.0f, 0.0f, 0.0f};
    floatw scale = 0.0f;
    Corner start, previous;
    start.offset = start.normal = zero;
    start.usable = sound & (maskw)(0);
    previous = start;
    RingWalk walk = {0, 0};
    for (; ring.row < ring.behind; ++ring.row) {
        const RingStep step = ringStep(&ring, &walk, rings, runs);
        const Corner current = loadCorner(step.entry.slots, ring.last, frame.origin, positions, normals);
        const floatw length2 = dot3(current.offset, current.offset);
        scale = selectw(scale, 1.0f / sqrt(length2),
                        !(scale > 0.0f) & (length2 >= PEL_MESH_MIN_LENGTH2) & finitew(length2));
        // Inside a walk: the triangle to the neighbour before. At its end: the one back to its start, if it
        // is closed.
        if (anyw(step.triangle))
            addTriangle(&form, n, u, v, previous, cornerSelect(current, start, step.ends),
                        step.triangle & sound, scale);
        start = cornerSelect(start, current, step.starts);
        previous = current;
    }
    const maskw measured = sound & (form.weight > 0.0f);
    const floatw inverse = scale / form.weight;
    storePrincipal(form.uu * inverse, form.uv * inverse, form.vv * inverse, u, v, measured, first,
                   planeStride, planes);
}
