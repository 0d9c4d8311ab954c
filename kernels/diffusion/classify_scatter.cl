// Finds the tiles of the screen that scattering changes, and how many levels of blocks they need
// (docs/mathematics.md, section 10, "Error-driven choice").
//
// Where irradiance is linear within the reach of the profile, as much light flows in as out, so only second
// differences matter. The second difference over 2^k pixels, times the share of the light that comes from
// further away, estimates what level k can change. The sum over the levels is compared with the tolerance.
// Below half of it a tile is left as it is; between half and all of it the scattered light is blended in,
// so that slowly changing pictures show no step. Single pixels are left out where they contribute little.
//
// Input: the pyramid. Output: packed flags per tile (shared/diffusion.h). One work-item: one tile; on a
// device of one lane (PEL_TILE_IS_GROUP): one work-group.
#undef PEL_WIDTH
#define PEL_WIDTH 1
#include "lib/diffusion/item.clh"
#include "lib/diffusion/profile_table.clh"
#include "lib/diffusion/pyramid.clh"

// Measured on a head and on balls, so that 99 % of the pixels keep to the tolerance.
#define LEFT_ALONE 0.5f   // of the tolerance: error of a tile that is left as it is
#define MIN_LIGHT 0.002f  // share of the light below which coarser levels are left out

// Number of this work-item among those that share a tile, and how many they are.
#if PEL_TILE_IS_GROUP
#define ITEMS PEL_GROUP
#define ITEM ((int)get_local_id(0))
#define SYNCHRONIZE() barrier(CLK_LOCAL_MEM_FENCE)
#else
#define ITEMS 1
#define ITEM 0
#define SYNCHRONIZE()
#endif
#define COLUMNS (ITEMS < 16 ? ITEMS : 16)

// The largest second difference between blocks of level k in and around a tile, over this work-item's share
// of them.
static PEL_OUT_OF_LINE float maxDifference2(__global const PelDiffusionFrame* frame,
                                            __global const float* pyramid, uint tileX, uint tileY, int k) {
    __global const PelPyramidLevel* level = &frame->level[k + 1];
    const int shift = PEL_TILE_LEVEL - (k + 1), dilate = 2;  // as far as the ring of level k reaches
    const int x0 = (shift >= 0 ? (int)tileX << shift : (int)(tileX >> -shift)) - dilate,
              y0 = (shift >= 0 ? (int)tileY << shift : (int)(tileY >> -shift)) - dilate,
              side = (shift >= 0 ? 1 << shift : 1) + 2 * dilate;
    float difference2 = 0.0f;
    for (int y = y0 + ITEM / COLUMNS; y < min(y0 + side, (int)level->height); y += ITEMS / COLUMNS) {
        if (y < 0) continue;
        __global const float* row = pyramid + pyramidRow(level, y);
        for (int x = x0 + ITEM % COLUMNS; x < min(x0 + side, (int)level->width); x += COLUMNS)
            if (x >= 0 && row[x + PEL_PLANE_AREA * level->stride] > 0.0f)
                difference2 = fmax(difference2, row[x + PEL_PLANE_DIFFERENCE2 * level->stride]);
    }
    return difference2;
}

// The smallest squared step from pixel to pixel in the tile and the eight tiles around it. Light that comes
// from n pixels away is at least n of these steps away. Tiles at a silhouette have longer steps, but not
// all the way to where their light comes from.
static inline float minSize(__global const PelPyramidLevel* level, __global const float* pyramid, uint tileX,
                            uint tileY) {
    float least = FLT_MAX;
    for (int y = (int)tileY - 1; y <= (int)tileY + 1; ++y) {
        for (int x = (int)tileX - 1; x <= (int)tileX + 1; ++x) {
            __global const float* block = pyramid + pyramidRow(level, y) + x;
            const float size = block[PEL_PLANE_SIZE * level->stride];
            if (block[PEL_PLANE_AREA * level->stride] > 0.0f && size > 0.0f) least = fmin(least, size);
        }
    }
    return least < FLT_MAX ? least : 0.0f;
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void classify_scatter(
    __global const PelDiffusionFrame* restrict frame, __global const float* restrict pyramid,
    __global const PelProfileTable* restrict tables, __global const float* restrict nodes,
    __global uint* tiles, __global uint* restrict counters) {
    // Per level; differences as bits, which are ordered like non-negative floats. In local memory, because
    // GPUs keep indexed private arrays in global memory.
#if PEL_TILE_IS_GROUP
    __local uint differences[PEL_PYRAMID_LEVELS];
    __local float beyond[PEL_PYRAMID_LEVELS];
    const uint tile = get_group_id(0);
#else
    uint differences[PEL_PYRAMID_LEVELS];
    float beyond[PEL_PYRAMID_LEVELS];
    const uint tile = itemOfFolded();
    if (tile >= frame->tilesX * frame->tilesY) return;
#endif
    const uint levelCount = frame->levels, tileX = tile % frame->tilesX, tileY = tile / frame->tilesX;
    __global const PelPyramidLevel* own = &frame->level[PEL_TILE_LEVEL];
    // No return before the barriers, even a uniform one: PoCL 3.1 would then run the end of the kernel for
    // every work-item.
    const bool covered = pyramid[pyramidRow(own, (int)tileY) + tileX + PEL_PLANE_AREA * own->stride] > 0.0f;
    for (uint k = ITEM; k < levelCount; k += ITEMS) differences[k] = 0;
    SYNCHRONIZE();
    for (uint k = 0; covered && k + 1 < levelCount; ++k) {
        const float most = maxDifference2(frame, pyramid, tileX, tileY, (int)k);
#if PEL_TILE_IS_GROUP
        if (most > 0.0f) atomic_max(&differences[k], as_uint(most));
#else
        differences[k] = as_uint(most);
#endif
    }
    SYNCHRONIZE();
    const float size = covered ? minSize(own, pyramid, tileX, tileY) : 0.0f,
                widest = covered ? maxRadius(frame, pyramid, tileX, tileY) : 0.0f;
    uint levels = 0;
    bool near = false;
    float greatest = 0.0f;
    for (uint t = 0; t < frame->tables; ++t) {
        const PelProfileTable table = atRadius(tables[t], widest);
        for (uint k = ITEM; covered && k < levelCount; k += ITEMS) {
            // Beyond the pixel, or beyond the blocks that a level leaves to finer ones.
            const float half_ = k ? 1.6f * (float)(1 << k) : 0.56f;
            const Vec3w within = profileShare(nodes, table, half_ * half_ * size);
            beyond[k] = 1.0f - fmin(within.x, fmin(within.y, within.z));
            if (ITEMS == 1 && beyond[k] < MIN_LIGHT) break;
        }
        SYNCHRONIZE();
        float error = 0.0f, errorOfPixels = 0.0f;
        uint end = 1;
        for (uint k = 0; covered && k < levelCount && !(beyond[k] < MIN_LIGHT); ++k) {
            end = k + 1;
            // the coarsest level has no coarser blocks
            error += PEL_ERROR_PER_DIFFERENCE2 * beyond[k] * as_float(differences[min(k, levelCount - 2)]);
            if (k == 0) errorOfPixels = error;
        }
        SYNCHRONIZE();
        if (!(error > LEFT_ALONE * frame->tolerance) && !frame->everyTile) continue;
        near |= frame->everyTile || errorOfPixels > fmin(PEL_LEFT_OF_PIXELS * frame->tolerance, 0.5f * error);
        greatest = fmax(greatest, error);
        levels = max(levels, max(end, PEL_MIN_LEVELS));
    }
    if (ITEM > 0) return;
    const float weight = frame->everyTile ? 1.0f : weightOfTile(greatest, LEFT_ALONE * frame->tolerance);
    tiles[tile] = covered && levels ? (near ? PEL_TILE_NEAR : 0) | levels << 8 | packedWeight(weight) : 0;
    if (covered) atomic_inc(&counters[PEL_COUNT_TILES_COVERED]);
    if (covered && levels) atomic_inc(&counters[PEL_COUNT_TILES_TAPPED]);
}
