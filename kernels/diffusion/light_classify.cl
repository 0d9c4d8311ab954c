// Which parts of the screen the texels of shadow maps matter to (docs/mathematics.md, section 10, "Light space").
//
// A tile has 4 x 4 parts of 4 x 4 pixels, blocks of level 2 of the screen's pyramid. With PEL_HIDDEN a part counts where the light of hidden texels
// that can reach some of its pixels may be more than a share of the tolerance; without, where the sum over the light's texels is not the
// irradiance, or where classify_scatter has found it to bend. Input: the pyramids, its words. Output: a word per tile, a bit for each part.
// One work-item is one tile. Variants: PEL_HIDDEN.
#include "lib/diffusion/windowed.clh"

#define PART_LEVEL 2
#define LEFT_ALONE 0.5f  // of the tolerance

static inline bool lightMatters(__global const PelDiffusionFrame* frame, __global const float* block,
                                uint stride, __global const PelProfileTable* tables,
                                __global const float* nodes, __global const PelLightMap* maps, uint mapCount,
                                __global const float* lights, bool bends, uint* texels) {
    const float area = block[PEL_PLANE_AREA * stride];
    if (!(area > 0.0f)) return false;
    const uint id = as_uint(block[PEL_PLANE_ID * stride]);
    const uint number = id < PEL_DIFFUSION_IDS ? frame->tableOf[id] : 0;
    if (!number) return false;
    if (!PEL_HIDDEN && bends) return true;
    const PelProfileTable table = tables[number - 1];
    const float size = fmax(block[PEL_PLANE_SIZE * stride], FLT_MIN), step = sqrt(size),
                longest = fmax(area / ((float)(1u << 2 * PART_LEVEL) * step), step);
    Place place;
    place.p = (float3)(block[PEL_PLANE_X * stride], block[PEL_PLANE_Y * stride], block[PEL_PLANE_Z * stride]);
    place.id = id;
    place.rho = PEL_HIDDEN ? longest : 2.0f * longest;
    place.slack = PEL_HIDDEN ? 0.71f * (float)(1 << PART_LEVEL) * longest : 0.0f;
    float3 light = (float3)(0.0f);
    for (uint k = 0; k < mapCount; ++k) {
        Windowed sums;
        clearWindowed(&sums);
        *texels += addMap(&sums, maps + k, lights, nodes, table, &place);
        float3 more = sumOfLanes3(sums.farLight);
        if (PEL_HIDDEN) more += sumOfLanes3(sums.nearLight);
        light += more * vload3(0, maps[k].color);
    }
    if (!PEL_HIDDEN) {
        const float3 e = (float3)(block[PEL_PLANE_RED * stride], block[PEL_PLANE_GREEN * stride],
                                  block[PEL_PLANE_BLUE * stride]);
        light = fabs(light - e * (1.0f - shareOfWindow(nodes, table, place.rho)));
    }
    return fmax(light.x, fmax(light.y, light.z)) > (frame->everyTile ? 0.0f : LEFT_ALONE * frame->tolerance);
}

__kernel __attribute__((reqd_work_group_size(PEL_DIFFUSION_GROUP, 1, 1))) void light_classify(
    __global const PelDiffusionFrame* frame, __global const float* pyramid,
    __global const PelProfileTable* tables, __global const float* nodes, __global const uint* tiles,
    __global const PelLightMap* maps, uint mapCount, __global const float* lights, __global uint* parts,
    __global uint* counters) {
    const uint tile = get_global_id(0);
    if (tile >= frame->tilesX * frame->tilesY) return;
    const uint tileX = tile % frame->tilesX, tileY = tile / frame->tilesX,
               side = PEL_DIFFUSION_TILE >> PART_LEVEL;
    uint word = 0, texels = 0;
    __global const PelPyramidLevel* level = &frame->level[PART_LEVEL];
    for (uint j = 0; j < side; ++j)
        for (uint i = 0; i < side; ++i) {
            const uint x = tileX * side + i, y = tileY * side + j;
            if (x >= level->width || y >= level->height) continue;
            if (lightMatters(frame, pyramid + pyramidRow(level, (int)y) + x, level->stride, tables, nodes,
                             maps, mapCount, lights, tiles[tile] != 0, &texels))
                word |= 1u << (j * side + i);
        }
    parts[tile] = word;
    if (word) atomic_inc(&counters[PEL_COUNT_LIGHT_TILES]);
    if (texels) atomic_add(&counters[PEL_COUNT_LIGHT_TEXELS], texels);
}
