// Which tiles of the screen need taps, and whether of single pixels too (docs/mathematics.md, section 10,
// "Error-driven choice").
//
// Where irradiance is linear within the profile's reach, as much light flows in as out: only the second
// differences of irradiance matter. The second difference at a step of 2^k pixels, times the light that comes
// from further away than that, estimates what the band of level k can change. The sum over all levels is
// compared with the tolerance: below a part of it nothing is done, above twice that part everything, and in
// between what was found counts in part, so that no picture that changes slowly has a step. Single pixels are
// left out where they contribute little.
//
// Input: the pyramid. Output: a word per tile (shared/diffusion.h). One work-item: one tile.
#undef PEL_WIDTH
#define PEL_WIDTH 1
#include "lib/diffusion/profile_table.clh"
#include "lib/diffusion/pyramid.clh"

// Measured on a head and on balls, so that 99 % of the pixels keep to the tolerance.
#define LEFT_ALONE 0.5f     // of the tolerance: what a tile may lack without taps
#define LEAST_LIGHT 0.002f  // that a level must contribute

// The greatest second difference between blocks of level k in and round a tile.
static inline float bendNear(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                             uint tileX, uint tileY, int k) {
    __global const PelPyramidLevel* level = &frame->level[k + 1];
    const int shift = PEL_TILE_LEVEL - (k + 1), dilate = 2;  // as far as the ring of level k reaches
    const int x0 = (shift >= 0 ? (int)tileX << shift : (int)(tileX >> -shift)),
              side = shift >= 0 ? 1 << shift : 1;
    const int y0 = (shift >= 0 ? (int)tileY << shift : (int)(tileY >> -shift));
    float bend = 0.0f;
    for (int y = max(y0 - dilate, 0); y < min(y0 + side + dilate, (int)level->height); ++y) {
        __global const float* row = pyramid + pyramidRow(level, y);
        for (int x = max(x0 - dilate, 0); x < min(x0 + side + dilate, (int)level->width); ++x)
            if (row[x + PEL_PLANE_AREA * level->stride] > 0.0f)
                bend = fmax(bend, row[x + PEL_PLANE_BEND * level->stride]);
    }
    return bend;
}

// The least squared step from pixel to pixel, of the tile and of those round it: light that is so many pixels away is no nearer than so
// many of these steps. A tile at a limb has longer ones, but not all the way to where its light comes from.
static inline float leastSize(__global const PelPyramidLevel* level, __global const float* pyramid,
                              uint tileX, uint tileY) {
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

__kernel __attribute__((reqd_work_group_size(PEL_DIFFUSION_GROUP, 1, 1))) void classify_scatter(
    __global const PelDiffusionFrame* frame, __global const float* pyramid,
    __global const PelProfileTable* tables, __global const float* nodes, __global uint* tiles,
    __global uint* counters) {
    const uint tile = get_global_id(0);
    if (tile >= frame->tilesX * frame->tilesY) return;
    const uint tileX = tile % frame->tilesX, tileY = tile / frame->tilesX;
    __global const PelPyramidLevel* own = &frame->level[PEL_TILE_LEVEL];
    __global const float* block = pyramid + pyramidRow(own, (int)tileY) + tileX;
    tiles[tile] = 0;
    if (!(block[PEL_PLANE_AREA * own->stride] > 0.0f)) return;
    atomic_inc(&counters[PEL_COUNT_TILES_COVERED]);
    const float size = leastSize(own, pyramid, tileX, tileY);
    float bends[PEL_PYRAMID_LEVELS];
    for (uint k = 0; k + 1 < frame->levels; ++k) bends[k] = bendNear(frame, pyramid, tileX, tileY, (int)k);
    bends[frame->levels - 1] = bends[frame->levels - 2];  // no coarser blocks tell
    uint levels = 0;
    bool near = false;
    float greatest = 0.0f;
    for (uint t = 0; t < frame->tables; ++t) {
        const PelProfileTable table = tables[t];
        float error = 0.0f, errorOfPixels = 0.0f;
        uint end = 1;
        for (uint k = 0; k < frame->levels; ++k) {
            // Beyond the pixel, or beyond the blocks that a level leaves to finer ones.
            const float half_ = k ? 1.6f * (float)(1 << k) : 0.56f;
            const Vec3w within = profileShare(nodes, table, half_ * half_ * size);
            const float beyond = 1.0f - fmin(within.x, fmin(within.y, within.z));
            if (beyond < LEAST_LIGHT) break;
            end = k + 1;
            error += PEL_ERROR_PER_BEND * beyond * bends[k];
            if (k == 0) errorOfPixels = error;
        }
        if (!(error > LEFT_ALONE * frame->tolerance) && !frame->everyTile) continue;
        near |= frame->everyTile || errorOfPixels > fmin(PEL_LEFT_OF_PIXELS * frame->tolerance, 0.5f * error);
        greatest = fmax(greatest, error);
        levels = max(levels, max(end, PEL_LEAST_LEVELS));
    }
    if (!levels) return;
    const float weight = frame->everyTile ? 1.0f : weightOfTile(greatest, LEFT_ALONE * frame->tolerance);
    tiles[tile] = (near ? PEL_TILE_NEAR : 0) | levels << 8 | wordOfWeight(weight);
    atomic_inc(&counters[PEL_COUNT_TILES_TAPPED]);
}
