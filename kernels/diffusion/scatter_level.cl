// Light that flows in to the blocks of one level of the screen's pyramid, from this level and from all
// coarser ones (docs/mathematics.md, section 10, "Sums by levels").
//
// Blocks near tiles that need the level interpolate the sums of the next coarser level and add the ring of
// their own. Other blocks are left as they are. Input: the pyramid, the packed flags of classify_scatter,
// the sums of the coarser level. Output: the sums of the level. One work-item: PEL_WIDTH blocks of a row.
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

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void scatter_level(
    __global const PelDiffusionFrame* restrict frame, __global const float* restrict pyramid,
    __global const PelProfileTable* restrict tables, __global const float* restrict nodes,
    __global const uint* restrict tiles, uint level, __global float* sums, __global uint* restrict counters) {
    __global const PelPyramidLevel* blocks = &frame->level[level];
    const uint across = (blocks->width + PEL_WIDTH - 1) / PEL_WIDTH, y = itemOfFolded() / across;
    if (y >= blocks->height) return;
    const uint x = itemOfFolded() % across * PEL_WIDTH;
    if (!levelMatters(frame, tiles, level, x, min(x + PEL_WIDTH, blocks->width), y)) return;
    const uint stride = blocks->stride;
    __global const float* at = pyramid + pyramidRow(blocks, (int)y) + x;
    fetchNextBlocks(at, stride);
    const Blocks here = loadBlocks(at, stride);
    const maskw on = here.area > 0.0f;
    if (!anyw(on)) return;
    Slope slope =
        slopeAt(at, stride, &here, loadPlanes3(at + PEL_PLANE_RED * stride, stride), frame->facing, on);
    if (PEL_FORMAT_MEAN_CURVATURE && level == 1) {  // that of a pixel
        const uint pixels = frame->level[0].stride;
        __global const float* pixel = pyramid + pyramidRow(&frame->level[0], 2 * (int)y) + 2 * x;
        floatw id, unused;
        loadEvenOdd(pixel + PEL_PLANE_ID * pixels, &id, &unused);
        loadEvenOdd(pixel + PEL_PLANE_CURVATURE * pixels, &slope.curvature, &unused);
        slope.curvature = selectw((floatw)(0.0f), slope.curvature, as_uintw(id) == here.id);
    }
    Sums result = noSums();
    if (level + 1 < frame->levels) {
        const Interpolated coarser = interpolateSums(frame, pyramid, sums, NULL, level + 1, x, y, &here, on);
        result = coarser.sums;
        result.light = movedLight(&result, &slope, coarser.place, &here);
    }
    const intw table = selectw((intw)(0), tablesOf(frame, here.id), on);
    for (uint t = 1; t <= frame->tables; ++t) {
        const maskw mine = table == (intw)((int)t);
        if (!anyw(mine)) continue;
        Sums more = result;
        addBand(at, stride, nodes, tables[t - 1], level, &here, &slope, mine, &more);
        result.light = select3(result.light, more.light, mine);
        result.weight = select3(result.weight, more.weight, mine);
        result.centre = select3(result.centre,
                                shareOfCentre(nodes, tables[t - 1], here.area,
                                              here.size * (float)(1u << 2 * level), PEL_BAND_INSIDE),
                                mine);
    }
    __global float* to = sums + sumRow(frame, level, (int)y) + x;
    storePlanes3(result.light, to + PEL_SUM_LIGHT * stride, stride);
    storePlanes3(result.weight, to + PEL_SUM_WEIGHT * stride, stride);
    storePlanes3(result.centre, to + PEL_SUM_CENTRE * stride, stride);
    const uint taps = PEL_BAND_OF_BLOCKS * countw(on);
    if (taps) atomic_add(&counters[PEL_COUNT_TAPS], taps);
}
