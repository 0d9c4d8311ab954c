// Which tiles of the screen need taps, and from which level of the pyramid on (docs/mathematics.md, section
// 10, "Error-driven choice").
//
// Where irradiance is linear within the profile's reach, as much light flows in as out: only the second
// differences of irradiance matter. The second difference at a step of 2^k pixels, times the light that comes
// from further away than that, bounds what the rings from level k on can change. Their sum over all levels is
// compared with the tolerance. The first levels are left out if they contribute little.
//
// Input: the pyramid. Output: a word per tile: 0 if the irradiance is right already; otherwise 1 + first
// level | levels << 8. One work-item: one tile.
#undef PEL_WIDTH
#define PEL_WIDTH 1
#include "lib/diffusion/profile_table.clh"
#include "lib/diffusion/pyramid.clh"

// Measured on a head and on balls, so that 99 % of the pixels keep to the tolerance.
#define ERROR_PER_BEND 0.15f
// Share of the tolerance that a tile may leave without taps. Smooth changes cost few taps and cover many
// pixels.
#define LEFT_ALONE 0.5f
#define LEAST_LIGHT 0.004f  // that a level must contribute

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
    const float size = block[PEL_PLANE_SIZE * own->stride];
    float bends[PEL_PYRAMID_LEVELS];
    for (uint k = 0; k + 1 < frame->levels; ++k) bends[k] = bendNear(frame, pyramid, tileX, tileY, (int)k);
    uint first = PEL_PYRAMID_LEVELS, levels = 0;
    for (uint t = 0; t < frame->tables; ++t) {
        const PelProfileTable table = tables[t];
        float errors[PEL_PYRAMID_LEVELS], error = 0.0f;
        uint end = 1;
        for (uint k = 0; k + 1 < frame->levels; ++k) {
            // Beyond the centre, or beyond the six blocks on a side of the level below.
            const float half_ = k ? 1.5f * (float)(1 << k) : 0.56f;
            const Vec3w within = profileShare(nodes, table, half_ * half_ * size);
            const float beyond = 1.0f - fmin(within.x, fmin(within.y, within.z));
            if (beyond < LEAST_LIGHT) break;
            end = k + 1;
            errors[k] = ERROR_PER_BEND * beyond * bends[k];
            error += errors[k];
        }
        if (!(error > LEFT_ALONE * frame->tolerance) && !frame->everyTile) continue;
        // Levels are left out as long as they make up little of the whole, too.
        const float most = frame->everyTile ? -1.0f : fmin(0.25f * frame->tolerance, 0.5f * error);
        uint start = 0;
        for (float sum = error > 0.0f ? errors[0] : 0.0f; sum <= most && start + 1 < end; sum += errors[start])
            ++start;
        first = min(first, start);
        levels = max(levels, end);
    }
    if (!levels) return;
    tiles[tile] = (1 + first) | levels << 8;
    atomic_inc(&counters[PEL_COUNT_TILES_TAPPED]);
}
