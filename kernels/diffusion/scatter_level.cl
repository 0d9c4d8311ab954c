// Light that flows in to the blocks of one level of the screen's pyramid, from this level and from all
// coarser ones (docs/mathematics.md, section 10, "Sums by levels").
//
// Blocks near tiles that need the level interpolate the sums of the next coarser level and add the ring of
// their own. The sums of other blocks are 0. Input: the pyramid, the packed flags of classify_scatter,
// the sums of the coarser level. Output: the sums of the level. One work-item: PEL_WIDTH blocks of a row.
//
// One lane, all levels in two launches: scatter_bands has an item for each block of any level and stores what
// comes in from the block's own level; in scatter_sums a work-group interpolates down to SUM_SIDE x SUM_SIDE
// blocks of level 1, by way of the coarser blocks above and around them. Output: the sums of level 1.
#include "lib/diffusion/item.clh"
#include "lib/diffusion/levels.clh"

// Whether a tile under the blocks from x to `end`, or as far around them as interpolation reaches, needs
// this level.
static inline bool levelMatters(__global const PelDiffusionFrame* frame, __global const uint* tiles,
                                uint level, uint x, uint end, uint y) {
    const int reach = max(1 << level, PEL_DIFFUSION_TILE), tilesX = (int)frame->tilesX,
              tilesY = (int)frame->tilesY;
    const int left = max(((int)(x << level) - reach) / PEL_DIFFUSION_TILE, 0),
              right = min(((int)(end << level) - 1 + reach) / PEL_DIFFUSION_TILE, tilesX - 1),
              top = max(((int)(y << level) - reach) / PEL_DIFFUSION_TILE, 0),
              bottom = min(((int)((y + 1) << level) - 1 + reach) / PEL_DIFFUSION_TILE, tilesY - 1);
    for (int j = top; j <= bottom; ++j)
        for (int i = left; i <= right; ++i)
            if ((tiles[j * tilesX + i] >> 8 & 255u) > level) return true;
    return false;
}

// Prefetches the next vector of blocks: too many streams for the hardware prefetcher.
static inline void fetchNextBlocks(__global const float* at, uint stride) {
    for (int y = -2; y <= 2; ++y) {
        __global const float* row = at + (long)y * (long)(stride * PEL_PYRAMID_PLANES) + 2 * PEL_WIDTH;
        for (uint plane = PEL_PLANE_AREA; plane <= PEL_PLANE_BLUE; ++plane)
            PEL_PREFETCH(row + plane * stride);
    }
}

static inline Slope slopeOfBlocks(__global const PelDiffusionFrame* frame, __global const float* at,
                                  uint stride, const Blocks* here, maskw on) {
    return slopeAt(frame, at, stride, here, loadPlanes3(at + PEL_PLANE_RED * stride, stride), on);
}

// Adds what comes in from the blocks' own level.
static inline Sums addOwnLevel(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                               __global const PelProfileTable* tables, __global const float* nodes,
                               __global const float* at, uint stride, uint level, uint x, uint y,
                               const Blocks* here, Slope of, maskw on, Sums coarser) {
    Slope slope = of;
    Sums result = coarser;
    if (PEL_FORMAT_MEAN_CURVATURE && level == 1) {  // the curvature of a pixel
        const uint pixels = frame->level[0].stride;
        __global const float* pixel = pyramid + pyramidRow(&frame->level[0], 2 * (int)y) + 2 * x;
        floatw id, unused;
        loadEvenOdd(pixel + PEL_PLANE_ID * pixels, &id, &unused);
        loadEvenOdd(pixel + PEL_PLANE_CURVATURE * pixels, &slope.curvature, &unused);
        slope.curvature = selectw((floatw)(0.0f), slope.curvature, as_uintw(id) == here->id);
    }
    const intw table = selectw((intw)(0), tablesOf(frame, here->id), on);
    for (uint t = 1; t <= frame->tables; ++t) {
        const maskw mine = table == (intw)((int)t);
        if (!anyw(mine)) continue;
        Sums more = result;
        addBand(at, stride, nodes, tables[t - 1], level, here, &slope, mine, &more);
        result.light = select3(result.light, more.light, mine);
        result.weight = select3(result.weight, more.weight, mine);
        result.centre = select3(
            result.centre,
            shareOfCentre(nodes, tables[t - 1], PEL_OVER_RADIUS2(here->area, here),
                          PEL_OVER_RADIUS2(here->size, here) * (float)(1u << 2 * level), PEL_BAND_INSIDE),
            mine);
    }
    return result;
}

static inline void storeSums(Sums s, uint stride, __global float* to) {
    storePlanes3(s.light, to + PEL_SUM_LIGHT * stride, stride);
    storePlanes3(s.weight, to + PEL_SUM_WEIGHT * stride, stride);
    storePlanes3(s.centre, to + PEL_SUM_CENTRE * stride, stride);
}

#if PEL_WIDTH > 1
// Returns the number of blocks that sum something.
static PEL_OUT_OF_LINE uint sumBlocks(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                                      __global const PelProfileTable* tables, __global const float* nodes,
                                      __global const uint* tiles, uint level, __global float* sums, uint x,
                                      uint y) {
    __global const PelPyramidLevel* blocks = &frame->level[level];
    const uint stride = blocks->stride;
    __global float* to = sums + sumRow(frame, level, (int)y) + x;
    if (!levelMatters(frame, tiles, level, x, min(x + PEL_WIDTH, blocks->width), y)) {
        // Interpolation also reads blocks that no tile needs, so sums of an earlier picture must not remain.
        // All tiles that scatter need PEL_MIN_LEVELS.
        for (uint plane = 0; level >= PEL_MIN_LEVELS && plane < PEL_SUM_PLANES; ++plane)
            storew((floatw)(0.0f), plane * stride, to);
        return 0;
    }
    __global const float* at = pyramid + pyramidRow(blocks, (int)y) + x;
    fetchNextBlocks(at, stride);
    const Blocks here = loadBlocks(at, stride);
    const maskw on = here.area > 0.0f;
    if (!anyw(on)) return 0;
    const Slope slope = slopeOfBlocks(frame, at, stride, &here, on);
    Sums result = noSums();
    if (level + 1 < frame->levels)
        result = interpolateSums(frame, pyramid, sums, NULL, level + 1, x, y, &here, on).sums;
    result = addOwnLevel(frame, pyramid, tables, nodes, at, stride, level, x, y, &here, slope, on, result);
    storeSums(result, stride, to);
    return countw(on);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void scatter_level(
    __global const PelDiffusionFrame* restrict frame, __global const float* restrict pyramid,
    __global const PelProfileTable* restrict tables, __global const float* restrict nodes,
    __global const uint* restrict tiles, uint level, __global float* sums, __global uint* restrict counters) {
    __global const PelPyramidLevel* blocks = &frame->level[level];
    const uint across = (blocks->width + PEL_WIDTH - 1) / PEL_WIDTH, y = itemOfFolded() / across;
    if (y >= blocks->height) return;
    const uint summed =
        sumBlocks(frame, pyramid, tables, nodes, tiles, level, sums, itemOfFolded() % across * PEL_WIDTH, y);
    if (summed) atomic_add(&counters[PEL_COUNT_TAPS], PEL_BAND_OF_BLOCKS * summed);
}

#else

#define NOT_NEEDED -1.0f  // weight of a block that no tile needs

// Returns whether there was something to sum.
static inline bool storeBand(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                             __global const PelProfileTable* tables, __global const float* nodes,
                             __global const uint* tiles, __global float* sums) {
    uint x, y;
    const uint level = blockOfItem(frame, &x, &y);
    if (level == frame->levels) return false;
    const uint stride = frame->level[level].stride;
    __global float* to = sums + sumRow(frame, level, (int)y) + x;
    if (!levelMatters(frame, tiles, level, x, x + 1, y)) {
        to[PEL_SUM_WEIGHT * stride] = NOT_NEEDED;
        return false;
    }
    __global const float* at = pyramid + pyramidRow(&frame->level[level], (int)y) + x;
    const Blocks here = loadBlocks(at, stride);
    if (!(here.area > 0.0f)) return false;
    const Slope slope = slopeOfBlocks(frame, at, stride, &here, true);
    storeSums(
        addOwnLevel(frame, pyramid, tables, nodes, at, stride, level, x, y, &here, slope, true, noSums()),
        stride, to);
    return true;
}

__kernel PEL_WORK_GROUP(PEL_GROUP) void scatter_bands(
    __global const PelDiffusionFrame* restrict frame, __global const float* restrict pyramid,
    __global const PelProfileTable* restrict tables, __global const float* restrict nodes,
    __global const uint* restrict tiles, __global float* restrict sums, __global uint* restrict counters) {
    const bool summed = storeBand(frame, pyramid, tables, nodes, tiles, sums);
    PEL_ADD_OF_GROUP(&counters[PEL_COUNT_TAPS], summed ? PEL_BAND_OF_BLOCKS : 0);
}

#define SUM_SIDE 16
#define MOST_SUMS ((SUM_SIDE / 2 + 2) * (SUM_SIDE / 2 + 2))  // of level 2

// The blocks of a level that a group needs.
typedef struct Region {
    int left, top, right, bottom;
} Region;

static inline Region coarserRegion(Region r) {
    const Region c = {(r.left >> 1) - 1, (r.top >> 1) - 1, (r.right >> 1) + 1, (r.bottom >> 1) + 1};
    return c;
}

// The sums of a block from the level's own and from those of the coarser level's region; 0: not needed.
static inline Sums sumsOfBlock(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                               __global const float* sums, __local const float* coarser, Region above,
                               uint level, uint x, uint y) {
    const uint stride = frame->level[level].stride;
    __global const float* own = sums + sumRow(frame, level, (int)y) + x;
    __global const float* at = pyramid + pyramidRow(&frame->level[level], (int)y) + x;
    const Blocks here = loadBlocks(at, stride);
    Sums result = noSums();
    if (!(here.area > 0.0f) || own[PEL_SUM_WEIGHT * stride] == NOT_NEEDED) return result;
    if (level + 1 < frame->levels) {
        const Nearest n = nearestBlocks(frame, pyramid, level + 1, x, y, &here, true);
        const int across = above.right - above.left + 1, column = (int)(x >> 1) - above.left,
                  beside = x & 1 ? 1 : -1;
        __local const float* first = coarser + (n.rows[0] - above.top) * across + column;
        __local const float* second = coarser + (n.rows[1] - above.top) * across + column;
#define TAKE_(plane)                                               \
    (fma(first[(plane)*MOST_SUMS], n.shares[0].holding,            \
         first[(plane)*MOST_SUMS + beside] * n.shares[0].beside) + \
     fma(second[(plane)*MOST_SUMS], n.shares[1].holding,           \
         second[(plane)*MOST_SUMS + beside] * n.shares[1].beside))
        result.light = vec3(TAKE_(PEL_SUM_LIGHT), TAKE_(PEL_SUM_LIGHT + 1), TAKE_(PEL_SUM_LIGHT + 2));
        result.weight = vec3(TAKE_(PEL_SUM_WEIGHT), TAKE_(PEL_SUM_WEIGHT + 1), TAKE_(PEL_SUM_WEIGHT + 2));
#undef TAKE_
    }
    result.light = add3(result.light, loadPlanes3(own + PEL_SUM_LIGHT * stride, stride));
    result.weight = add3(result.weight, loadPlanes3(own + PEL_SUM_WEIGHT * stride, stride));
    result.centre = loadPlanes3(own + PEL_SUM_CENTRE * stride, stride);
    return result;
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void scatter_sums(
    __global const PelDiffusionFrame* restrict frame, __global const float* restrict pyramid,
    __global const uint* restrict tiles, __global float* sums) {
    // Sums of a level and of the next coarser one, alternating: six planes of light and weight.
    __local float values[2][6 * MOST_SUMS];
    const int groupsX = (int)(frame->level[1].width + SUM_SIDE - 1) / SUM_SIDE, group = (int)get_group_id(0);
    Region finest;
    finest.left = group % groupsX * SUM_SIDE, finest.top = group / groupsX * SUM_SIDE;
    finest.right = finest.left + SUM_SIDE - 1, finest.bottom = finest.top + SUM_SIDE - 1;
    bool needed = false;
    for (int row = 0; row < SUM_SIDE; row += SUM_SIDE / 2)
        needed |= levelMatters(frame, tiles, 1, (uint)finest.left, (uint)finest.right + 1,
                               (uint)(finest.top + row));
    if (!needed) return;
    for (uint level = frame->levels - 1; level > 0; --level) {
        Region here = finest;
        for (uint k = 1; k < level; ++k) here = coarserRegion(here);
        const Region above = coarserRegion(here);
        const int across = here.right - here.left + 1, count = across * (here.bottom - here.top + 1);
        __local float* to = values[level & 1];
        for (int item = (int)get_local_id(0); item < count; item += PEL_GROUP) {
            const int x = here.left + item % across, y = here.top + item / across;
            Sums s = noSums();
            if (x >= 0 && y >= 0 && x < (int)frame->level[level].width &&
                y < (int)frame->level[level].height) {
                s = sumsOfBlock(frame, pyramid, sums, values[~level & 1], above, level, (uint)x, (uint)y);
                if (level == 1) storeSums(s, frame->level[1].stride, sums + sumRow(frame, 1, y) + x);
            }
            if (level == 1) continue;
            to[item] = s.light.x, to[MOST_SUMS + item] = s.light.y, to[2 * MOST_SUMS + item] = s.light.z;
            to[3 * MOST_SUMS + item] = s.weight.x, to[4 * MOST_SUMS + item] = s.weight.y,
                               to[5 * MOST_SUMS + item] = s.weight.z;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}
#endif
