// The surface integral (docs/mathematics.md, section 9): S(x) = sum over triangles of the integral of
// R(|x - y|) E(y) dA, with E linear on each triangle.
//
// Far sets of triangles count as points, from the distance on that host/diffusion/surface_tree.cpp computed.
// Near triangles are integrated over their borders. Let M(r) = integral of R(s) s ds, and let x be at height
// h above the plane, over the point p. Polar coordinates round p turn the integral of R into one of M(r) -
// M(h) over the border's angle, since s ds is the same along the plane and in space. As R (y - p) is the
// gradient of M, the first moment is M times the border's normal, integrated along the border. Both are exact
// for every profile and contain no 1/r. Along an edge whose line passes p at distance D, t = D sinh u makes
// both integrands smooth at every scale.
//
// Inputs: a tree of triangles, a table of M, points (length). Output: RGB per point; 0 for points with NaN or
// Inf. One work-item: PEL_WIDTH consecutive points, which walk the tree together.

#include "lib/vector.clh"
#include "shared/mesh.h"
#include "shared/surface_integral.h"

// Row and fraction of a distance in the table.
static inline floatw surfaceRow(SurfaceSum sum, floatw r) {
    const floatw row = (log2(r) - sum.firstLog2) * (float)PEL_SURFACE_ROWS;
    return fmin(fmax(row, (floatw)(0.0f)), (floatw)((float)(sum.rows - 1) - 0.0078125f));
}

// M(r). It is linear below the first row. If R ends abruptly the table continues, and M stays at 1 / 2 pi.
static inline Vec3w surfaceEnclosed(SurfaceSum sum, __global const float4* table, floatw r) {
    const floatw row = surfaceRow(sum, fmax(r, (floatw)(1e-37f)));
    const floatw below = fmin(r * exp2(-sum.firstLog2), (floatw)(1.0f));
    const intw i = convert_intw(row);
    const floatw f = row - convert_floatw(i);
    const floatw g = 1.0f - f, v1 = f * f * fma((floatw)(-2.0f), f, (floatw)(3.0f)), s0 = f * g * g,
                 s1 = -f * f * g;
    Vec3w m;
#define SURFACE_LANE_(k, s)                                                                  \
    {                                                                                        \
        __global const float4* at = table + 2 * (i s);                                       \
        const float4 value = at[0] + (v1 s) * (at[2] - at[0]) + (s0 s)*at[1] + (s1 s)*at[3]; \
        m.x s = value.x, m.y s = value.y, m.z s = value.z;                                   \
    }
    PEL_EACH_LANE(SURFACE_LANE_)
#undef SURFACE_LANE_
    const floatw most = (floatw)(sum.whole);
    return vec3(fmin(m.x * below, most), fmin(m.y * below, most), fmin(m.z * below, most));
}

// R(r) = M'(r) / r, from the slopes.
static inline Vec3w surfaceRadial(SurfaceSum sum, __global const float4* table, floatw r2) {
    const floatw row = surfaceRow(sum, sqrt(r2));
    const intw i = convert_intw(row);
    const floatw f = row - convert_floatw(i);
    Vec3w slope;
#define SURFACE_LANE_(k, s)                                            \
    {                                                                  \
        __global const float4* at = table + 2 * (i s);                 \
        const float4 value = at[1] + (f s) * (at[3] - at[1]);          \
        slope.x s = value.x, slope.y s = value.y, slope.z s = value.z; \
    }
    PEL_EACH_LANE(SURFACE_LANE_)
#undef SURFACE_LANE_
    return scale3(slope, (floatw)(PEL_SURFACE_ROWS / 0.693147181f) / r2);
}

static inline float largestLane(floatw x) {
    float most = 0.0f;
#define SURFACE_LANE_(k, s) most = fmax(most, x s);
    PEL_EACH_LANE(SURFACE_LANE_)
#undef SURFACE_LANE_
    return most;
}

static inline floatw surfaceAsinh(floatw x) {
    const floatw a = fabs(x);
    return copysign(log(a + sqrt(fma(a, a, (floatw)(1.0f)))), x);
}

// Gauss-Legendre, 4 points on [0, 1].
__constant float surface_at[4] = {0.0694318442f, 0.3300094782f, 0.6699905218f, 0.9305681558f};
__constant float surface_part[4] = {0.1739274226f, 0.3260725774f, 0.3260725774f, 0.1739274226f};
// Edges that span less, as the tangent of half the hyperbolic angle, take one rule in t.
#define SURFACE_SHORT 0.125f
#define SURFACE_PIECES 512  // of an edge, at most
// Smallest D, relative to the edge: nearer lines are passed at this distance.
#define SURFACE_NARROW 1e-6f

// The contribution of one triangle.
static inline Vec3w surfaceTriangle(SurfaceSum sum, __global const float4* table,
                                    __global const SurfaceTriangle* triangle, Vec3w x) {
    float3 corner[3], light[3];
    for (int k = 0; k < 3; ++k) {
        corner[k] = vload3(k, triangle->corner);
        light[k] = vload3(k, triangle->irradiance);
    }
    const float3 ab = corner[1] - corner[0], ac = corner[2] - corner[0], area = cross(ab, ac);
    const float twice = length(area);
    const float3 n = area / twice;
    const Vec3w toPoint = sub3(x, spread3(corner[0]));
    floatw h = dot3(toPoint, spread3(n));
    // Points on the surface are off it only by rounding, which 1/r would amplify.
    const float extent =
        fmax(fmax(fabs(corner[0].x), fabs(corner[0].y)), fmax(fabs(corner[0].z), length(ab)));
    h = selectw(h, (floatw)(0.0f), fabs(h) < (floatw)(5e-7f * extent));
    const Vec3w p = sub3(toPoint, scale3(spread3(n), h)), atHeight = surfaceEnclosed(sum, table, fabs(h));
    // E = light[0] + b beta + c gamma at p, and its gradient along the plane, per channel.
    // gradients of beta and gamma
    const float3 towardsB = cross(ac, n) / twice, towardsC = cross(n, ab) / twice;
    const floatw beta = dot3(p, spread3(towardsB)), gamma = dot3(p, spread3(towardsC));
    const float3 b = light[1] - light[0], c = light[2] - light[0];
    Vec3w there = add3(spread3(light[0]), add3(scale3(spread3(b), beta), scale3(spread3(c), gamma)));
    Vec3w result = same3(0.0f);
    for (int k = 0; k < 3; ++k) {
        const float3 begin = corner[k] - corner[0], along = corner[k == 2 ? 0 : k + 1] - corner[k];
        const float edge = length(along);
        const float3 t = along / edge, m = cross(t, n);
        const Vec3w from = sub3(spread3(begin), p);
        const floatw D = dot3(from, spread3(m)), t0 = dot3(from, spread3(t)), t1 = t0 + edge;
        const floatw distance = fmax(fabs(D), (floatw)(SURFACE_NARROW * edge));
        Vec3w angle = same3(0.0f), length = angle;
        // From far away an edge spans 2 artanh of this; the difference of two asinh would cancel for small
        // triangles.
        const floatw root0 = sqrt(fma(t0, t0, distance * distance)),
                     root1 = sqrt(fma(t1, t1, distance * distance));
        const bool isShort = largestLane(edge / (root0 + root1)) < SURFACE_SHORT && sum.piecesPerU < 1.0f;
        const floatw u0 = surfaceAsinh(t0 / distance), range = surfaceAsinh(t1 / distance) - u0;
        const int pieces =
            isShort ? 1 : clamp((int)ceil(largestLane(range) * sum.piecesPerU), 1, SURFACE_PIECES);
        const floatw step = range / (floatw)((float)pieces);
        for (int i = 0; i < pieces; ++i)
            for (int q = 0; q < 4; ++q) {
                floatw rho2, turn, way;
                if (isShort) {
                    const floatw t = fma((floatw)(surface_at[q]), (floatw)(edge), t0);
                    rho2 = fma(t, t, distance * distance);
                    way = (floatw)(surface_part[q] * edge);
                    turn = way * distance / rho2;
                } else {
                    const floatw e = exp(fma(step, (floatw)((float)i + surface_at[q]), u0));
                    const floatw c = 0.5f * (e + 1.0f / e), rho = distance * c;
                    rho2 = rho * rho;
                    turn = step * surface_part[q] / c;
                    way = step * surface_part[q] * rho;
                }
                const Vec3w M = surfaceEnclosed(sum, table, sqrt(fma(h, h, rho2)));
                angle = add3(angle, scale3(sub3(M, atHeight), turn));
                length = add3(length, scale3(sub3(M, spread3((float3)(sum.whole))), way));
            }
        const float mb = dot(m, towardsB), mc = dot(m, towardsC);
        // An edge whose line contains the point spans no angle.
        const floatw sign =
            selectw(copysign((floatw)(1.0f), D), (floatw)(0.0f), fabs(D) < (floatw)(SURFACE_NARROW * edge));
        result = add3(result, add3(mul3(there, scale3(angle, sign)), mul3(spread3(mb * b + mc * c), length)));
    }
    return result;
}

// R(r), 0 where it ends.
static inline Vec3w surfaceEnded(SurfaceSum sum, __global const float4* table, floatw r2) {
    const Vec3w R = surfaceRadial(sum, table, r2);
    floatw within[3];
    for (int c = 0; c < 3; ++c) {
        const float ends = sum.cut[c] > 0.0f ? sum.cut[c] : sum.reach;
        within[c] = selectw((floatw)(0.0f), (floatw)(1.0f), (r2 < (floatw)(ends * ends)));
    }
    return vec3(R.x * within[0], R.y * within[1], R.z * within[2]);
}

// The same by 7 points, exact to degree 5 [Radon 1948], for triangles that are small compared with their
// distance: sums over their borders would cancel.
__constant float surface_corner[7][3] = {
    {0.333333333f, 0.333333333f, 0.333333333f}, {0.059715872f, 0.470142064f, 0.470142064f},
    {0.470142064f, 0.059715872f, 0.470142064f}, {0.470142064f, 0.470142064f, 0.059715872f},
    {0.797426985f, 0.101286507f, 0.101286507f}, {0.101286507f, 0.797426985f, 0.101286507f},
    {0.101286507f, 0.101286507f, 0.797426985f}};
__constant float surface_weight[7] = {0.225f,       0.132394153f, 0.132394153f, 0.132394153f,
                                      0.125939181f, 0.125939181f, 0.125939181f};
#define SURFACE_SMALL 5.0f  // distances in radii from which on this is done: 1e-5 of the energy are left

static inline Vec3w surfaceSampled(SurfaceSum sum, __global const float4* table,
                                   __global const SurfaceTriangle* triangle, Vec3w x) {
    float3 corner[3], light[3];
    for (int k = 0; k < 3; ++k) {
        corner[k] = vload3(k, triangle->corner);
        light[k] = vload3(k, triangle->irradiance);
    }
    const float area = 0.5f * length(cross(corner[1] - corner[0], corner[2] - corner[0]));
    const Vec3w from = sub3(spread3(corner[0]), x);
    Vec3w result = same3(0.0f);
    for (int q = 0; q < 7; ++q) {
        const float a = surface_corner[q][0], b = surface_corner[q][1], c = surface_corner[q][2];
        const Vec3w d = add3(from, spread3(b * (corner[1] - corner[0]) + c * (corner[2] - corner[0])));
        const float3 E = (area * surface_weight[q]) * (a * light[0] + b * light[1] + c * light[2]);
        result = add3(result, mul3(spread3(E), surfaceEnded(sum, table, dot3(d, d))));
    }
    return result;
}

// Kahan's sum: otherwise thousands of small terms would be lost in a float near 1.
static inline void surfaceAdd(Vec3w* total, Vec3w* lost, Vec3w term) {
    const Vec3w corrected = sub3(term, *lost), next = add3(*total, corrected);
    *lost = sub3(sub3(next, *total), corrected);
    *total = next;
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void surface_integral(
    SurfaceSum sum, __global const SurfaceNode* nodes, __global const SurfaceTriangle* triangles,
    __global const float4* table, __global const float* restrict points, VertexLayout pointLayout,
    __global float* result, VertexLayout resultLayout, uint first, uint end) {
    const uint begin = first + get_global_id(0) * PEL_WIDTH;
    if (begin >= end) return;
    Vec3w x;
    // Lanes behind the last point repeat it.
#define SURFACE_LANE_(k, s)                                                                                \
    {                                                                                                      \
        const float3 p =                                                                                   \
            vload3(0, points + pointLayout.offset + (size_t)min(begin + k, end - 1) * pointLayout.stride); \
        x.x s = p.x, x.y s = p.y, x.z s = p.z;                                                             \
    }
    PEL_EACH_LANE(SURFACE_LANE_)
#undef SURFACE_LANE_
    const maskw usable = finite3(x);
    x = select3(same3(0.0f), x, usable);
    Vec3w total = same3(0.0f), lost = total;
    uint i = 0;
    while (i < sum.nodes) {
        __global const SurfaceNode* node = nodes + i;
        const Vec3w d = sub3(loadUniform3(node->centre), x);
        const floatw r2 = dot3(d, d);
        const float reach = sum.reach + node->radius;
        const maskw beyond = (r2 >= (floatw)(reach * reach));
        if (!anyw(notw(beyond))) {
            i = node->skip;
            continue;
        }
        maskw near = (r2 < (floatw)(node->accept2));
        for (int c = 0; c < 3; ++c)
            if (sum.cut[c] > 0.0f) near |= (fabs(sqrt(r2) - sum.cut[c]) < (floatw)(node->radius));
        if (!anyw(near)) {
            const Vec3w R = surfaceEnded(sum, table, r2);
            surfaceAdd(&total, &lost, mul3(R, loadUniform3(node->weight)));
            i = node->skip;
        } else if (node->triangle != PEL_SURFACE_NONE) {
            const float small = SURFACE_SMALL * node->radius;
            if (anyw((maskw)(r2 < (floatw)(small * small))))
                surfaceAdd(&total, &lost, surfaceTriangle(sum, table, triangles + node->triangle, x));
            else
                surfaceAdd(&total, &lost, surfaceSampled(sum, table, triangles + node->triangle, x));
            i = node->skip;
        } else {
            ++i;
        }
    }
    total = select3(same3(0.0f), total, usable);
#define SURFACE_LANE_(k, s)                                   \
    if (begin + k < end)                                      \
        vstore3((float3)(total.x s, total.y s, total.z s), 0, \
                result + resultLayout.offset + (size_t)(begin + k) * resultLayout.stride);
    PEL_EACH_LANE(SURFACE_LANE_)
#undef SURFACE_LANE_
}
