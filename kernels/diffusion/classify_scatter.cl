// Finds the tiles of the screen that scattering changes, and how many levels of blocks they need
// (docs/mathematics.md, section 10, "Error-driven choice").
//
// Where irradiance is linear within the reach of the profile, as much light flows in as out, so only second
// differences matter. The second difference over 2^k pixels, times the share of the light that comes from
// further away, estimates what level k can change. The sum over the levels is compared with the tolerance.
// Below half of it a tile is left as it is; between half and all of it the scattered light is blended in,
// so that slowly changing pictures show no step. Single pixels are left out where they contribute little.
//
// Input: the pyramid. Output: packed flags per tile (shared/diffusion.h). One work-group: one tile.
#undef PEL_WIDTH
#define PEL_WIDTH 1
#include "lib/diffusion/item.clh"
#include "lib/diffusion/profile_table.clh"
#include "lib/diffusion/pyramid.clh"

// Measured on a head and on balls, so that 99 % of the pixels keep to the tolerance.
#define LEFT_ALONE 0.5f   // of the tolerance: error of a tile that is left as it is
#define MIN_LIGHT 0.002f  // share of the light below which coarser levels are left out

// The largest second difference between blocks of level k in and around a tile, of every `items`-th of them.
static inline float maxDifference2(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                                   uint tileX, uint tileY, int k, int item, int items) {
    __global const PelPyramidLevel* level = &frame->level[k + 1];
    const int shift = PEL_TILE_LEVEL - (k + 1), dilate = 2;  // as far as the ring of level k reaches
    const int side = shift >= 0 ? 1 << shift : 1, across = side + 2 * dilate;
    const int x0 = (shift >= 0 ? (int)tileX << shift : (int)(tileX >> -shift)) - dilate,
              y0 = (shift >= 0 ? (int)tileY << shift : (int)(tileY >> -shift)) - dilate;
    float difference2 = 0.0f;
    for (int i = item; i < across * across; i += items) {
        const int x = x0 + i % across, y = y0 + i / across;
        if (x < 0 || y < 0 || x >= (int)level->width || y >= (int)level->height) continue;
        __global const float* block = pyramid + pyramidRow(level, y) + x;
        if (block[PEL_PLANE_AREA * level->stride] > 0.0f)
            difference2 = fmax(difference2, block[PEL_PLANE_DIFFERENCE2 * level->stride]);
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
    // Of levels; differences as bits, which are ordered as floats are that are not negative.
    __local uint differences[PEL_PYRAMID_LEVELS];
    __local float beyond[PEL_PYRAMID_LEVELS];
    const uint tile = get_group_id(0), item = get_local_id(0), levelCount = frame->levels;
    const uint tileX = tile % frame->tilesX, tileY = tile / frame->tilesX;
    __global const PelPyramidLevel* own = &frame->level[PEL_TILE_LEVEL];
    const bool covered = pyramid[pyramidRow(own, (int)tileY) + tileX + PEL_PLANE_AREA * own->stride] > 0.0f;
    for (uint k = item; k < levelCount; k += PEL_GROUP) differences[k] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint k = 0; covered && k + 1 < levelCount; ++k) {
        const float most = maxDifference2(frame, pyramid, tileX, tileY, (int)k, (int)item, PEL_GROUP);
        if (most > 0.0f) atomic_max(&differences[k], as_uint(most));
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const float size = covered ? minSize(own, pyramid, tileX, tileY) : 0.0f,
                widest = covered ? maxRadius(frame, pyramid, tileX, tileY) : 0.0f;
    uint levels = 0;
    bool near = false;
    float greatest = 0.0f;
    for (uint t = 0; t < frame->tables; ++t) {
        const PelProfileTable table = atRadius(tables[t], widest);
        for (uint k = item; covered && k < levelCount; k += PEL_GROUP) {
            // Beyond the pixel, or beyond the blocks that a level leaves to finer ones.
            const float half_ = k ? 1.6f * (float)(1 << k) : 0.56f;
            const Vec3w within = profileShare(nodes, table, half_ * half_ * size);
            beyond[k] = 1.0f - fmin(within.x, fmin(within.y, within.z));
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        float error = 0.0f, errorOfPixels = 0.0f;
        uint end = 1;
        for (uint k = 0; covered && item == 0 && k < levelCount && !(beyond[k] < MIN_LIGHT); ++k) {
            end = k + 1;
            // the coarsest level has no coarser blocks
            error += PEL_ERROR_PER_DIFFERENCE2 * beyond[k] * as_float(differences[min(k, levelCount - 2)]);
            if (k == 0) errorOfPixels = error;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        if (!(error > LEFT_ALONE * frame->tolerance) && !frame->everyTile) continue;
        near |= frame->everyTile || errorOfPixels > fmin(PEL_LEFT_OF_PIXELS * frame->tolerance, 0.5f * error);
        greatest = fmax(greatest, error);
        levels = max(levels, max(end, PEL_MIN_LEVELS));
    }
    if (item > 0) return;
    const float weight = frame->everyTile ? 1.0f : weightOfTile(greatest, LEFT_ALONE * frame->tolerance);
    tiles[tile] = covered && levels ? (near ? PEL_TILE_NEAR : 0) | levels << 8 | packedWeight(weight) : 0;
    if (covered) atomic_inc(&counters[PEL_COUNT_TILES_COVERED]);
    if (covered && levels) atomic_inc(&counters[PEL_COUNT_TILES_TAPPED]);
}
