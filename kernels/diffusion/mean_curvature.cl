// Signed mean curvature of the surface under each pixel, from positions and normals (docs/mathematics.md,
// section 12).
//
// Differences are taken between pixels that lie a window's length to both sides, along rows and along
// columns. With P_u, P_v the differences of positions and N_u, N_v those of normals, H = (N_u.P_u G -
// (N_u.P_v + N_v.P_u) F + N_v.P_v E) / 2 (E G - F^2), with E = P_u.P_u, F = P_u.P_v, G = P_v.P_v. The pixel
// itself takes the place of a neighbour that is missing, of another material, or on another surface.
//
// Inputs: images of unit normals, of positions (length) or depth, and of ids (0 is background). Output: an
// image of 1/length, positive on convex surface; 0 where no difference can be taken. One work-item:
// PEL_WIDTH pixels of a row. Variants: PEL_FORMAT_NORMAL, PEL_FORMAT_POSITION or PEL_FORMAT_DEPTH,
// PEL_FORMAT_MATERIAL (0: everything is id 1), PEL_FORMAT_OUT.
#include "lib/diffusion/item.clh"
#include "lib/image/image.clh"
#include "lib/shading/material_id.clh"
#include "lib/shading/position.clh"
#include "shared/mean_curvature.h"

#define MAX_PIXELS 32          // of a window
#define SAME_SURFACE 3.0f      // windows' lengths to a neighbour
#define SAME_SIDE -0.2f        // cosine between its normal and the pixel's
#define MIN_INDEPENDENT 1e-3f  // of the squared sine between the two differences

typedef struct Images {
    __global const PelMeanCurvature* frame;
    __global uchar *normal, *position, *ids;
} Images;

typedef struct Point {
    Vec3w p, n;
    uintw id;
} Point;

static inline Vec3w positionAt(const Images* in, uint x, uint y) {
    const Span span = imageSpan(in->position, &in->frame->position, x, y);
#if PEL_FORMAT_POSITION
    return loadColor(PEL_FORMAT_POSITION, span);
#else
    return positionFromDepth(in->frame->inverseViewProjection, in->frame->width, in->frame->height, x, y,
                             loadScalar(PEL_FORMAT_DEPTH, span));
#endif
}

static inline uintw idAt(const Images* in, uint x, uint y) {
#if PEL_FORMAT_MATERIAL
    return loadId(PEL_FORMAT_MATERIAL, imageSpan(in->ids, &in->frame->ids, x, y));
#else
    return (uintw)(1);
#endif
}

static inline Point pointAt(const Images* in, uint x, uint y) {
    Point point;
    point.p = positionAt(in, x, y);
    point.n = loadNormal(PEL_FORMAT_NORMAL, imageSpan(in->normal, &in->frame->normal, x, y));
    point.id = idAt(in, x, y);
    return point;
}

// The pixels of a vector that exist.
static inline maskw insideAt(const Images* in, int x, int y) {
    const intw column = lanesw() + x;
    return (column >= 0) & (column < (int)in->frame->width) &
           (intw)(y >= 0 && y < (int)in->frame->height ? -1 : 0);
}

// Lane k takes the value of lane k - by.
static inline floatw movedLanes(floatw v, int by) {
    float lanes[PEL_WIDTH];
    storew(v, 0, lanes);
#define MOVED(k, s) lanes[clamp((k)-by, 0, PEL_WIDTH - 1)]
    return PEL_LANES(MOVED);
#undef MOVED
}

// The same from an x that may be less than a vector from an end of the row, or negative: lanes outside the
// row have no pixel.
static inline Point pointFrom(const Images* in, int x, uint y) {
    const uint start = vectorStart((uint)max(x, 0), in->frame->width);
    const int by = (int)start - x;
    Point point = pointAt(in, start, y);
    if (PEL_WIDTH == 1 || by == 0) return point;
    point.p = vec3(movedLanes(point.p.x, by), movedLanes(point.p.y, by), movedLanes(point.p.z, by));
    point.n = vec3(movedLanes(point.n.x, by), movedLanes(point.n.y, by), movedLanes(point.n.z, by));
    point.id = as_uintw(movedLanes(as_floatw(point.id), by));
    return point;
}

// Squared length of the shorter step to the next pixel on either side; FLT_MAX without one of the material.
static inline floatw stepAlong(const Images* in, const Point* here, int x, int y, int dx, int dy) {
    floatw shortest = FLT_MAX;
    for (int side = -1; side <= 1; side += 2) {
        const maskw inside = insideAt(in, x + side * dx, y + side * dy);
        if (!anyw(inside)) continue;
        const Point there = pointFrom(in, x + side * dx, (uint)(y + side * dy));
        const Vec3w d = sub3(there.p, here->p);
        const floatw length2 = dot3(d, d);
        shortest = selectw(shortest, fmin(shortest, length2),
                           inside & (there.id == here->id) & finitew(length2) & (length2 > 0.0f));
    }
    return shortest;
}

// Differences of positions and of normals along one axis. Returns the lanes that have them.
static inline maskw differences(const Images* in, const Point* here, int x, int y, int dx, int dy,
                                floatw far2, Vec3w* positions, Vec3w* normals) {
    maskw known = (maskw)(0);
    *positions = *normals = same3(0.0f);
    for (int side = -1; side <= 1; side += 2) {
        const maskw inside = insideAt(in, x + side * dx, y + side * dy);
        if (!anyw(inside)) continue;
        const Point there = pointFrom(in, x + side * dx, (uint)(y + side * dy));
        const Vec3w d = sub3(there.p, here->p), turned = sub3(there.n, here->n);
        const maskw same = inside & (there.id == here->id) & (dot3(d, d) < far2) & finite3(there.n) &
                           (dot3(there.n, here->n) > SAME_SIDE);
        const floatw factor = selectw((floatw)(0.0f), (floatw)((float)side), same);
        const Vec3w none = same3(0.0f);
        *positions = add3(*positions, scale3(select3(none, d, same), factor));
        *normals = add3(*normals, scale3(select3(none, turned, same), factor));
        known |= same;
    }
    return known;
}

// Curvature from neighbours `pixels` away; `step`: length to the next pixel.
static inline floatw curvatureAt(const Images* in, const Point* here, uint x, uint y, float window,
                                 floatw step, int pixels, maskw on) {
    const floatw far = SAME_SURFACE * fmax((floatw)(window), (float)pixels * step), far2 = far * far;
    Vec3w pu, nu, pv, nv;
    const maskw known = differences(in, here, (int)x, (int)y, pixels, 0, far2, &pu, &nu) &
                        differences(in, here, (int)x, (int)y, 0, pixels, far2, &pv, &nv);
    const floatw e = dot3(pu, pu), f = dot3(pu, pv), g = dot3(pv, pv), area2 = fma(e, g, -f * f);
    const floatw sum = dot3(nu, pu) * g - (dot3(nu, pv) + dot3(nv, pu)) * f + dot3(nv, pv) * e;
    const maskw sound = on & known & (area2 > MIN_INDEPENDENT * e * g);
    const floatw curvature = 0.5f * sum / selectw((floatw)(1.0f), area2, sound);
    return selectw((floatw)(0.0f), curvature, sound & finitew(curvature));
}

// Curvature of the pixels `on`, all of one material. Lanes with equally wide windows, in pixels, go together.
static inline floatw curvatureOf(const Images* in, const Point* here, uint x, uint y, float window,
                                 maskw on) {
    const floatw step =
        sqrt(fmin(stepAlong(in, here, (int)x, (int)y, 1, 0), stepAlong(in, here, (int)x, (int)y, 0, 1)));
    const uintw pixels =
        convert_uintw(clamp(window / step + 0.5f, (floatw)(1.0f), (floatw)((float)MAX_PIXELS)));
    floatw value = 0.0f;
    while (anyw(on)) {
        const uint most = greatestId(pixels, on);
        const maskw mine = on & (pixels == most);
        value = selectw(value, curvatureAt(in, here, x, y, window, step, (int)most, mine), mine);
        on &= notw(mine);
    }
    return value;
}

// Curvature of the pixels from x on, each with the window of its id.
static PEL_OUT_OF_LINE floatw curvatureFrom(const Images* in, uint x, uint y) {
    floatw value = 0.0f;
    const uintw id = idAt(in, x, y);
#define MEASURED(i, s) (id s < PEL_CURVATURE_IDS && in->frame->window[id s] > 0.0f ? id s : 0)
    const uintw wanted = PEL_UINT_LANES(MEASURED);
#undef MEASURED
    maskw left = wanted != (uintw)(0);
    if (anyw(left)) {
        const Point here = pointAt(in, x, y);
        left &= finite3(here.p) & finite3(here.n);
        while (anyw(left)) {
            const uint current = greatestId(wanted, left);
            const maskw mine = left & (wanted == current);
            value = selectw(value, curvatureOf(in, &here, x, y, in->frame->window[current], mine), mine);
            left &= notw(mine);
        }
    }
    return value;
}

// `firstRow`: of the launch; `outRow`: of the output.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void mean_curvature(
    __global const PelMeanCurvature* restrict frame, __global uchar* normal, __global uchar* position,
    __global uchar* ids, __global uchar* restrict out, uint firstRow, uint rows, uint outRow) {
    const uint across = (frame->width + PEL_WIDTH - 1) / PEL_WIDTH, row = itemOfFolded() / across,
               y = firstRow + row;
    if (row >= rows || y >= frame->height) return;
    const uint x = vectorStart(itemOfFolded() % across * PEL_WIDTH, frame->width);
    const Images in = {frame, normal, position, ids};
    const floatw value = curvatureFrom(&in, x, y);
    storeScalar(PEL_FORMAT_OUT, imageSpan(out, &frame->out, x, y - outRow), value,
                lanesw() + (int)x < (intw)((int)frame->width));
}
