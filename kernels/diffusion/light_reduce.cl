// One level of a light's pyramid (shared/light_space.h) from the next finer one: blocks of 2 x 2.
//
// The flux of a block is stored in two clusters. The first begins at the brightest child. Children far from
// it, or of another id, go to the second, which begins at the farthest of them. The position of a cluster is
// the mean of the children near its first one: a mean over several surfaces would lie in the air between
// them. Input and output: the pyramid; level 1 also clears the marks of light_seen. One work-item: PEL_WIDTH
// blocks of a row of a map's level; one lane: a work-group is a block of the last of `count` levels.
// Variants: PEL_HIDDEN.
#include "lib/diffusion/item.clh"
#include "lib/diffusion/light_space.clh"
#include "lib/diffusion/pyramid.clh"

#define APART 1.5f   // widths of a block between two clusters
#define SPREAD 8.0f  // from the first child of a cluster to others in its mean position

typedef struct Cluster {
    floatw flux, extent;
    uintw id;
    Vec3w p;
} Cluster;

#if PEL_WIDTH == 1
// Cluster k of the children, loaded each time that it is needed: eight of them take half of a GPU's
// registers.
static inline Cluster clusterOf(__global const float* upper, uint stride, uint points, uint k) {
    __global const float* at =
        upper + (k & 1) + ((k & 2 ? lightPlanes(points) : 0) + (k & 4 ? lightPlanes(1) : 0)) * stride;
    Cluster c;
    c.flux = at[PEL_LIGHT_FLUX * stride], c.extent = at[PEL_LIGHT_EXTENT * stride];
    c.id = PEL_HIDDEN ? 0 : as_uint(at[PEL_LIGHT_ID * stride]);
    c.p = vec3(at[PEL_LIGHT_X * stride], at[PEL_LIGHT_Y * stride], at[PEL_LIGHT_Z * stride]);
    return c;
}
#define CLUSTER(k) clusterOf(upper, stride, points, k)
#else
#define CLUSTER(k) clusters[k]
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
#endif

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

// Sums are relative to the seed, to avoid cancellation. Children far from it count at its position.
static inline void addToCluster(Cluster* sum, Cluster seed, Cluster s, maskw on, maskw near) {
    const floatw flux = selectw((floatw)(0.0f), s.flux, on);
    sum->flux += flux;
    sum->extent += selectw((floatw)(0.0f), s.extent, on);
    sum->p = add3(sum->p, scale3(sub3(s.p, seed.p), selectw((floatw)(0.0f), flux, near)));
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

// Sets the marks of light_seen to 0 for the next frame: those of the texels of PEL_WIDTH blocks of level 1.
static inline void clearMarks(__global const PelLightMap* map, __global uchar* seen, uint x, uint y) {
    const uint width = map->level[0].width, end = min(2 * (x + PEL_WIDTH), width);
    for (uint j = 2 * y; j < min(2 * y + 2, map->level[0].height); ++j) {
        __global uchar* row = seen + map->seen + (size_t)j * width;
#if PEL_WIDTH == 16
        if (end == 2 * x + 32)
            vstore16((uchar16)(0), 0, row + 2 * x), vstore16((uchar16)(0), 1, row + 2 * x);
        else
#endif
            for (uint i = 2 * x; i < end; ++i) row[i] = 0;
    }
}

// Whether some cell between the texels (left, top) and (right, bottom) has flux, or had flux in the frame
// before.
static inline bool cellsMatter(__global const PelLightMap* map, __global const uchar* before,
                               __global const uchar* now, uint frameNumber, uint left, uint top, uint right,
                               uint bottom) {
    const uint across = cellsAcross(map), width = map->level[0].width, height = map->level[0].height;
    for (uint y = top / PEL_LIGHT_CELL; y * PEL_LIGHT_CELL < min(bottom, height); ++y)
        for (uint x = left / PEL_LIGHT_CELL; x * PEL_LIGHT_CELL < min(right, width); ++x) {
            const uint cell = map->cells + y * across + x;
            if (cellOfFrame(before[cell], frameNumber - 1) || cellOfFrame(now[cell], frameNumber))
                return true;
        }
    return false;
}

// Wider blocks, in cells, are always computed: few have no lit cell, and a search would take longer.
#define MOST_CELLS 4

// PEL_WIDTH blocks of level `to`.
static PEL_OUT_OF_LINE void reduceLight(__global const PelLightMap* map, uint to, uint x, uint y,
                                        uint frameNumber, __global const uchar* before,
                                        __global const uchar* now, __global uchar* seen,
                                        __global float* pyramid) {
    __global const PelPyramidLevel *fine = &map->level[to - 1], *coarse = &map->level[to];
    const uint points = to == 1 ? 1 : 2, stride = fine->stride;
    if (to == 1) clearMarks(map, seen, x, y);
    if ((1u << to) <= MOST_CELLS * PEL_LIGHT_CELL &&
        !cellsMatter(map, before, now, frameNumber, x << to, y << to, (x + PEL_WIDTH) << to, (y + 1) << to))
        return;
    __global const float* upper = pyramid + lightRow(fine, points, 2 * (int)y) + 2 * x;
    const size_t at = lightRow(coarse, 2, (int)y) + x;
    const uint count = 4 * points;
#if PEL_WIDTH > 1
    __global const float* lower = upper + lightPlanes(points) * stride;
    const uint layer = lightPlanes(1) * stride;
    Cluster clusters[8];
    loadClusters(upper, stride, &clusters[0], &clusters[1]);
    loadClusters(lower, stride, &clusters[2], &clusters[3]);
    if (points == 2) {
        loadClusters(upper + layer, stride, &clusters[4], &clusters[5]);
        loadClusters(lower + layer, stride, &clusters[6], &clusters[7]);
    }
#endif
    Cluster first = CLUSTER(0);
    for (uint k = 1; k < count; ++k) {
        const Cluster c = CLUSTER(k);
        first = chooseCluster(first, c, c.flux > first.flux);
    }
    if (!anyw(first.flux > 0.0f)) {
        storew((floatw)(0.0f), at + PEL_LIGHT_FLUX * coarse->stride, pyramid);
        storew((floatw)(0.0f), at + (lightPlanes(1) + PEL_LIGHT_FLUX) * coarse->stride, pyramid);
        return;
    }
    Cluster second = first;
    floatw farthest = 0.0f;
    for (uint k = 0; k < count; ++k) {
        const Cluster c = CLUSTER(k);
        const floatw distance2 = selectw((floatw)(0.0f), apart2(c, first), c.flux > 0.0f);
        second = chooseCluster(second, c, distance2 > farthest);
        farthest = fmax(farthest, distance2);
    }
    const floatw width = map->texel * (float)(1u << to) * matrixRow(map->toMap, 3, first.p),
                 width2 = width * width, most = SPREAD * SPREAD * width2;
    const maskw two = farthest > APART * APART * width2;
    Cluster a, b;
    a.flux = a.extent = b.flux = b.extent = 0.0f;
    a.p = b.p = same3(0.0f);
    for (uint k = 0; k < count; ++k) {
        const Cluster c = CLUSTER(k);
        const maskw there = c.flux > 0.0f;
        const floatw toFirst = apart2(c, first), toSecond = apart2(c, second);
        const maskw beyond = two & (toSecond < toFirst);
        addToCluster(&a, first, c, there & notw(beyond) & sameId(c, first), toFirst < most);
        addToCluster(&b, second, c, there & beyond & sameId(c, second), toSecond < most);
    }
    storeCluster(a, first, at, coarse->stride, pyramid);
    storeCluster(b, second, at + lightPlanes(1) * coarse->stride, coarse->stride, pyramid);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void light_reduce(
    __global const PelLightMap* restrict maps, uint to, uint count, __global const uchar* restrict before,
    __global const uchar* restrict now, uint frameNumber, __global uchar* seen, __global float* pyramid) {
    __global const PelLightMap* map = maps + get_global_id(2);
#define PEL_REDUCE_(level, x, y) reduceLight(map, level, x, y, frameNumber, before, now, seen, pyramid)
    PEL_REDUCE_LEVELS(map->level, map->levels, to, count, PEL_REDUCE_)
#undef PEL_REDUCE_
}
