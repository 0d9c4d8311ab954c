// Which parts of the screen the texels of shadow maps matter to (docs/mathematics.md, section 10, "Light space").
//
// With PEL_HIDDEN: tiles that the light of hidden texels can reach with more than a share of the tolerance; their words (classify_scatter)
// get PEL_TILE_HIDDEN, and all levels, for their mass is asked for. Without: a tile has 4 x 4 parts of 4 x 4 pixels, blocks of level 2 of the screen's pyramid,
// and those count where the sum over the light's texels is not the irradiance, or where classify_scatter has found it to bend. Input: the
// pyramids, its words. Output: its words and how much light may come in, or a word per tile with a bit for each part. One work-item is one tile. Variants: PEL_HIDDEN.
#include "lib/diffusion/windowed.clh"

#define PART_LEVEL 2
#define LEFT_ALONE 0.5f  // of the tolerance

static inline float3 farLight(__global const PelLightMap* maps, uint mapCount, __global const float* lights,
                              __global const float* nodes, const PelProfileTable table, Place* place,
                              uint* texels) {
    float3 light = (float3)(0.0f);
    for (uint k = 0; k < mapCount; ++k) {
        Windowed sums;
        clearWindowed(&sums);
        *texels += addMap(&sums, maps + k, lights, nodes, table, place);
        light += sumOfLanes3(sums.farLight) * vload3(0, maps[k].color);
    }
    return light;
}

// The table of a block that scatters, or -1; and where the block is.
static inline int placeOf(__global const PelDiffusionFrame* frame, __global const float* block, uint stride,
                          Place* place) {
    if (!(block[PEL_PLANE_AREA * stride] > 0.0f)) return -1;
    place->id = as_uint(block[PEL_PLANE_ID * stride]);
    place->p = (float3)(block[PEL_PLANE_X * stride], block[PEL_PLANE_Y * stride], block[PEL_PLANE_Z * stride]);
    return place->id < PEL_DIFFUSION_IDS ? (int)frame->tableOf[place->id] - 1 : -1;
}

// The longer of the steps to the next pixel.
static inline float longestStep(__global const float* block, uint stride, uint level) {
    const float step = sqrt(fmax(block[PEL_PLANE_SIZE * stride], FLT_MIN));
    return fmax(block[PEL_PLANE_AREA * stride] / ((float)(1u << 2 * level) * step), step);
}

#if PEL_HIDDEN
// How much light may come in anywhere within the slack of a place.
static inline float lightNear(__global const PelProfileTable* tables, __global const float* nodes,
                              __global const PelLightMap* maps, uint mapCount, __global const float* lights,
                              int number, Place* place, uint* texels) {
    const float3 light = farLight(maps, mapCount, lights, nodes, tables[number], place, texels);
    return fmax(light.x, fmax(light.y, light.z));
}

// How much the light may change a tile. Its block stands for one surface; parts of it that lie further away, an ear before a neck, are asked for
// themselves.
static inline float changeByLight(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                                  uint tileX, uint tileY, __global const PelProfileTable* tables,
                                  __global const float* nodes, __global const PelLightMap* maps,
                                  uint mapCount, __global const float* lights, uint* texels) {
    __global const PelPyramidLevel *whole = &frame->level[PEL_TILE_LEVEL], *part = &frame->level[PART_LEVEL];
    __global const float* block = pyramid + pyramidRow(whole, (int)tileY) + tileX;
    Place place;
    place.rho = 0.0f;
    const int number = placeOf(frame, block, whole->stride, &place);
    if (number < 0) return 0.0f;
    place.slack = 0.71f * PEL_DIFFUSION_TILE * longestStep(block, whole->stride, PEL_TILE_LEVEL);
    float change = lightNear(tables, nodes, maps, mapCount, lights, number, &place, texels);
    const float3 middle = place.p;
    const float around = place.slack;
    const uint side = PEL_DIFFUSION_TILE >> PART_LEVEL;
    for (uint k = 0; k < side * side; ++k) {
        const uint x = tileX * side + k % side, y = tileY * side + k / side;
        if (x >= part->width || y >= part->height) continue;
        block = pyramid + pyramidRow(part, (int)y) + x;
        const int other = placeOf(frame, block, part->stride, &place);
        if (other < 0 || (other == number && distance(place.p, middle) < around)) continue;
        place.slack = 0.71f * (float)(1 << PART_LEVEL) * longestStep(block, part->stride, PART_LEVEL);
        change = fmax(change, lightNear(tables, nodes, maps, mapCount, lights, other, &place, texels));
    }
    return change;
}
#else
static inline bool lightMatters(__global const PelDiffusionFrame* frame, __global const float* block,
                                uint stride, __global const PelProfileTable* tables,
                                __global const float* nodes, __global const PelLightMap* maps, uint mapCount,
                                __global const float* lights, bool bends, uint* texels) {
    Place place;
    const int number = placeOf(frame, block, stride, &place);
    if (number < 0) return false;
    if (bends) return true;
    const PelProfileTable table = tables[number];
    place.rho = 2.0f * longestStep(block, stride, PART_LEVEL);
    place.slack = 0.0f;
    const float3 e = (float3)(block[PEL_PLANE_RED * stride], block[PEL_PLANE_GREEN * stride],
                              block[PEL_PLANE_BLUE * stride]);
    const float3 light = fabs(farLight(maps, mapCount, lights, nodes, table, &place, texels) -
                              e * (1.0f - shareOfWindow(nodes, table, place.rho)));
    return fmax(light.x, fmax(light.y, light.z)) > (frame->everyTile ? 0.0f : LEFT_ALONE * frame->tolerance);
}
#endif

__kernel __attribute__((reqd_work_group_size(PEL_DIFFUSION_GROUP, 1, 1))) void light_classify(
    __global const PelDiffusionFrame* frame, __global const float* pyramid,
    __global const PelProfileTable* tables, __global const float* nodes, __global uint* tiles,
    __global const PelLightMap* maps, uint mapCount, __global const float* lights, __global uint* parts,
    __global uint* counters) {
    const uint tile = get_global_id(0);
    if (tile >= frame->tilesX * frame->tilesY) return;
    const uint tileX = tile % frame->tilesX, tileY = tile / frame->tilesX;
    uint texels = 0;
#if PEL_HIDDEN
    const uint word = tiles[tile];
    const float change =
                    changeByLight(frame, pyramid, tileX, tileY, tables, nodes, maps, mapCount, lights, &texels),
                least = frame->everyTile ? 0.0f : LEFT_ALONE * frame->tolerance;
    const bool reached = change > least;
    if (reached)
        tiles[tile] = (word & PEL_TILE_NEAR) | frame->levels << 8 | PEL_TILE_HIDDEN |
                      max(word >> 24 << 24, wordOfWeight(weightOfTile(change, least)));
    parts[tile] = as_uint(change);
#else
    const uint side = PEL_DIFFUSION_TILE >> PART_LEVEL;
    uint reached = 0;
    __global const PelPyramidLevel* level = &frame->level[PART_LEVEL];
    for (uint j = 0; j < side; ++j)
        for (uint i = 0; i < side; ++i) {
            const uint x = tileX * side + i, y = tileY * side + j;
            if (x >= level->width || y >= level->height) continue;
            if (lightMatters(frame, pyramid + pyramidRow(level, (int)y) + x, level->stride, tables, nodes,
                             maps, mapCount, lights, tiles[tile] != 0, &texels))
                reached |= 1u << (j * side + i);
        }
    parts[tile] = reached;
#endif
    if (reached) atomic_inc(&counters[PEL_COUNT_LIGHT_TILES]);
    if (texels) atomic_add(&counters[PEL_COUNT_LIGHT_TEXELS], texels);
}
