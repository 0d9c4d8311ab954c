// One level of a light's pyramid (shared/light_space.h) from the next finer one: blocks of 2 x 2.
//
// A block's flux stands at two points. The first is that of the brightest child; children far from it, or of another id, gather at the
// second, which begins at the farthest of them. Input and output: the pyramid. One work-item: PEL_WIDTH blocks of a row. Variants: PEL_HIDDEN.
#include "lib/diffusion/item.clh"
#include "lib/diffusion/light_space.clh"
#include "lib/diffusion/pyramid.clh"

#define APART 1.5f  // widths of a block: what lies closer together is one point

typedef struct Spot {
    floatw flux, extent;
    uintw id;
    Vec3w p;
} Spot;

static inline void loadSpots(__global const float* at, uint stride, Spot* even, Spot* odd) {
    loadEvenOdd(at + PEL_LIGHT_FLUX * stride, &even->flux, &odd->flux);
    loadEvenOdd(at + PEL_LIGHT_EXTENT * stride, &even->extent, &odd->extent);
    even->id = odd->id = (uintw)(0);
    if (!PEL_HIDDEN) {
        floatw left, right;
        loadEvenOdd(at + PEL_LIGHT_ID * stride, &left, &right);
        even->id = as_uintw(left), odd->id = as_uintw(right);
    }
    loadEvenOdd(at + PEL_LIGHT_X * stride, &even->p.x, &odd->p.x);
    loadEvenOdd(at + PEL_LIGHT_Y * stride, &even->p.y, &odd->p.y);
    loadEvenOdd(at + PEL_LIGHT_Z * stride, &even->p.z, &odd->p.z);
}

static inline maskw sameId(Spot a, Spot b) {
    return PEL_HIDDEN ? (maskw)(-1) : (maskw)(a.id == b.id);
}

static inline floatw apart2(Spot a, Spot b) {
    const Vec3w d = sub3(a.p, b.p);
    return selectw((floatw)(FLT_MAX), dot3(d, d), sameId(a, b));
}

static inline Spot chooseSpot(Spot a, Spot b, maskw second) {
    Spot s;
    s.flux = selectw(a.flux, b.flux, second);
    s.extent = selectw(a.extent, b.extent, second);
    s.id = as_uintw(selectw(as_intw(a.id), as_intw(b.id), second));
    s.p = select3(a.p, b.p, second);
    return s;
}

// Sums about the seed, so that nothing cancels.
static inline void addSpot(Spot* sum, Spot seed, Spot s, maskw on) {
    const floatw flux = selectw((floatw)(0.0f), s.flux, on);
    sum->flux += flux;
    sum->extent += selectw((floatw)(0.0f), s.extent, on);
    sum->p = add3(sum->p, scale3(sub3(s.p, seed.p), flux));
}

static inline void storeSpot(Spot sum, Spot seed, size_t at, uint stride, __global float* pyramid) {
    const floatw share = 1.0f / selectw((floatw)(1.0f), sum.flux, sum.flux > 0.0f);
    const Vec3w p = add3(seed.p, scale3(sum.p, share));
    storew(sum.flux, at + PEL_LIGHT_FLUX * stride, pyramid);
    storew(sum.extent, at + PEL_LIGHT_EXTENT * stride, pyramid);
    if (!PEL_HIDDEN) storew(as_floatw(seed.id), at + PEL_LIGHT_ID * stride, pyramid);
    storew(p.x, at + PEL_LIGHT_X * stride, pyramid);
    storew(p.y, at + PEL_LIGHT_Y * stride, pyramid);
    storew(p.z, at + PEL_LIGHT_Z * stride, pyramid);
}

// Whether some cell from texel (left, top) to (right, bottom) has flux, or had it.
static inline bool cellsMatter(__global const PelLightMap* map, __global const uchar* before,
                               __global const uchar* now, uint left, uint top, uint right, uint bottom) {
    const uint across = cellsAcross(map), width = map->level[0].width, height = map->level[0].height;
    for (uint y = top / PEL_LIGHT_CELL; y * PEL_LIGHT_CELL < min(bottom, height); ++y)
        for (uint x = left / PEL_LIGHT_CELL; x * PEL_LIGHT_CELL < min(right, width); ++x) {
            const uint cell = map->cells + y * across + x;
            if (before[cell] | now[cell]) return true;
        }
    return false;
}

__kernel __attribute__((reqd_work_group_size(PEL_DIFFUSION_GROUP, 1, 1))) void light_reduce(
    __global const PelLightMap* maps, uint index, uint to, __global const uchar* before,
    __global const uchar* now, __global float* pyramid) {
    __global const PelLightMap* map = maps + index;
    __global const PelPyramidLevel *fine = &map->level[to - 1], *coarse = &map->level[to];
    const uint across = (coarse->width + PEL_WIDTH - 1) / PEL_WIDTH, y = itemOfFolded() / across;
    if (y >= coarse->height) return;
    const uint x = itemOfFolded() % across * PEL_WIDTH, points = to == 1 ? 1 : 2, stride = fine->stride;
    if (!cellsMatter(map, before, now, x << to, y << to, (x + PEL_WIDTH) << to, (y + 1) << to)) return;
    __global const float* upper = pyramid + lightRow(fine, points, 2 * (int)y) + 2 * x;
    __global const float* lower = pyramid + lightRow(fine, points, 2 * (int)y + 1) + 2 * x;
    const size_t at = lightRow(coarse, 2, (int)y) + x;
    const uint layer = lightPlanes(1) * stride;
    Spot spots[8];
    loadSpots(upper, stride, &spots[0], &spots[1]);
    loadSpots(lower, stride, &spots[2], &spots[3]);
    uint count = 4;
    if (points == 2) {
        loadSpots(upper + layer, stride, &spots[4], &spots[5]);
        loadSpots(lower + layer, stride, &spots[6], &spots[7]);
        count = 8;
    }
    Spot first = spots[0];
    for (uint k = 1; k < count; ++k) first = chooseSpot(first, spots[k], spots[k].flux > first.flux);
    if (!anyw(first.flux > 0.0f)) {
        storew((floatw)(0.0f), at + PEL_LIGHT_FLUX * coarse->stride, pyramid);
        storew((floatw)(0.0f), at + (lightPlanes(1) + PEL_LIGHT_FLUX) * coarse->stride, pyramid);
        return;
    }
    Spot second = first;
    floatw farthest = 0.0f;
    for (uint k = 0; k < count; ++k) {
        const floatw distance2 = selectw((floatw)(0.0f), apart2(spots[k], first), spots[k].flux > 0.0f);
        second = chooseSpot(second, spots[k], distance2 > farthest);
        farthest = fmax(farthest, distance2);
    }
    const floatw width = APART * map->texel * (float)(1u << to) * matrixRow(map->toMap, 3, first.p);
    const maskw two = farthest > width * width;
    Spot a, b;
    a.flux = a.extent = b.flux = b.extent = 0.0f;
    a.p = b.p = vec3((floatw)(0.0f), (floatw)(0.0f), (floatw)(0.0f));
    for (uint k = 0; k < count; ++k) {
        const maskw there = spots[k].flux > 0.0f;
        const floatw toFirst = apart2(spots[k], first), toSecond = apart2(spots[k], second);
        const maskw beyond = two & (toSecond < toFirst);
        addSpot(&a, first, spots[k], there & notw(beyond) & sameId(spots[k], first));
        addSpot(&b, second, spots[k], there & beyond & sameId(spots[k], second));
    }
    storeSpot(a, first, at, coarse->stride, pyramid);
    storeSpot(b, second, at + lightPlanes(1) * coarse->stride, coarse->stride, pyramid);
}
