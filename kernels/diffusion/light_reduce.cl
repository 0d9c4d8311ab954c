// One level of a light's pyramid (shared/light_space.h) from the next finer one: blocks of 2 x 2.
//
// The flux of a block is stored in two clusters. The first begins at the brightest child. Children far from
// it, or of another id, go to the second, which begins at the farthest of them. Input and output: the
// pyramid. One work-item: PEL_WIDTH blocks of a row. Variants: PEL_HIDDEN.
#include "lib/diffusion/item.clh"
#include "lib/diffusion/light_space.clh"
#include "lib/diffusion/pyramid.clh"

#if PEL_WIDTH == 1
#define UNROLL _Pragma("unroll")
#else
#define UNROLL
#endif
#define APART 1.5f  // widths of a block between two clusters

typedef struct Cluster {
    floatw flux, extent;
    uintw id;
    Vec3w p;
} Cluster;

static inline void loadClusters(__global const float* at, uint stride, Cluster* even, Cluster* odd) {
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

static inline maskw sameId(Cluster a, Cluster b) {
    return PEL_HIDDEN ? (maskw)(-1) : (maskw)(a.id == b.id);
}

static inline floatw apart2(Cluster a, Cluster b) {
    const Vec3w d = sub3(a.p, b.p);
    return selectw((floatw)(FLT_MAX), dot3(d, d), sameId(a, b));
}

static inline Cluster chooseCluster(Cluster a, Cluster b, maskw second) {
    Cluster s;
    s.flux = selectw(a.flux, b.flux, second);
    s.extent = selectw(a.extent, b.extent, second);
    s.id = as_uintw(selectw(as_intw(a.id), as_intw(b.id), second));
    s.p = select3(a.p, b.p, second);
    return s;
}

// Sums are relative to the seed, so that nothing cancels.
static inline void addToCluster(Cluster* sum, Cluster seed, Cluster s, maskw on) {
    const floatw flux = selectw((floatw)(0.0f), s.flux, on);
    sum->flux += flux;
    sum->extent += selectw((floatw)(0.0f), s.extent, on);
    sum->p = add3(sum->p, scale3(sub3(s.p, seed.p), flux));
}

static inline void storeCluster(Cluster sum, Cluster seed, size_t at, uint stride, __global float* pyramid) {
    const floatw share = 1.0f / selectw((floatw)(1.0f), sum.flux, sum.flux > 0.0f);
    const Vec3w p = add3(seed.p, scale3(sum.p, share));
    storew(sum.flux, at + PEL_LIGHT_FLUX * stride, pyramid);
    storew(sum.extent, at + PEL_LIGHT_EXTENT * stride, pyramid);
    if (!PEL_HIDDEN) storew(as_floatw(seed.id), at + PEL_LIGHT_ID * stride, pyramid);
    storew(p.x, at + PEL_LIGHT_X * stride, pyramid);
    storew(p.y, at + PEL_LIGHT_Y * stride, pyramid);
    storew(p.z, at + PEL_LIGHT_Z * stride, pyramid);
}

// Whether some cell between the texels (left, top) and (right, bottom) has flux, or had flux in the frame
// before.
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

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void light_reduce(
    __global const PelLightMap* restrict maps, uint index, uint to, __global const uchar* restrict before,
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
    Cluster clusters[8];
    loadClusters(upper, stride, &clusters[0], &clusters[1]);
    loadClusters(lower, stride, &clusters[2], &clusters[3]);
    if (points == 2) {
        loadClusters(upper + layer, stride, &clusters[4], &clusters[5]);
        loadClusters(lower + layer, stride, &clusters[6], &clusters[7]);
    } else if (PEL_WIDTH == 1) {
        for (uint k = 4; k < 8; ++k) clusters[k] = clusters[0], clusters[k].flux = 0.0f;
    }
    // One lane: loops of constant length are unrolled, and the clusters stay in registers.
    const uint count = PEL_WIDTH == 1 || points == 2 ? 8 : 4;
    Cluster first = clusters[0];
    UNROLL for (uint k = 1; k < count; ++k) {
        first = chooseCluster(first, clusters[k], clusters[k].flux > first.flux);
    }
    if (!anyw(first.flux > 0.0f)) {
        storew((floatw)(0.0f), at + PEL_LIGHT_FLUX * coarse->stride, pyramid);
        storew((floatw)(0.0f), at + (lightPlanes(1) + PEL_LIGHT_FLUX) * coarse->stride, pyramid);
        return;
    }
    Cluster second = first;
    floatw farthest = 0.0f;
    UNROLL for (uint k = 0; k < count; ++k) {
        const floatw distance2 = selectw((floatw)(0.0f), apart2(clusters[k], first), clusters[k].flux > 0.0f);
        second = chooseCluster(second, clusters[k], distance2 > farthest);
        farthest = fmax(farthest, distance2);
    }
    const floatw width = APART * map->texel * (float)(1u << to) * matrixRow(map->toMap, 3, first.p);
    const maskw two = farthest > width * width;
    Cluster a, b;
    a.flux = a.extent = b.flux = b.extent = 0.0f;
    a.p = b.p = vec3((floatw)(0.0f), (floatw)(0.0f), (floatw)(0.0f));
    UNROLL for (uint k = 0; k < count; ++k) {
        const maskw there = clusters[k].flux > 0.0f;
        const floatw toFirst = apart2(clusters[k], first), toSecond = apart2(clusters[k], second);
        const maskw beyond = two & (toSecond < toFirst);
        addToCluster(&a, first, clusters[k], there & notw(beyond) & sameId(clusters[k], first));
        addToCluster(&b, second, clusters[k], there & beyond & sameId(clusters[k], second));
    }
    storeCluster(a, first, at, coarse->stride, pyramid);
    storeCluster(b, second, at + lightPlanes(1) * coarse->stride, coarse->stride, pyramid);
}
