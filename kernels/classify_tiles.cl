// Which tiles hold a pixel of a material: a compact list of their numbers (docs/shading.md, "Tiles").
//
// Inputs: the material id image, PelShadeFrame.materialMask. Output: list[0] the count, from list[1] on the tiles, in no
// fixed order. One work-item: one tile. Variants: PEL_FORMAT_MATERIAL; PEL_BIT_NO_SKIPPING lists every tile.
#include "lib/image.clh"
#include "lib/material_id.clh"
#include "shared/shade.h"

__kernel __attribute__((reqd_work_group_size(PEL_CLASSIFY_GROUP, 1, 1))) void classify_tiles(
    __global const PelShadeFrame* frame, __global uchar* material, __global uint* list) {
    const uint tile = get_global_id(0);
    if (tile >= frame->tiles) return;
    const uint x0 = tile % frame->tilesX * PEL_TILE_WIDTH, y0 = tile / frame->tilesX * PEL_TILE_HEIGHT;
    const uint x1 = min(x0 + PEL_TILE_WIDTH, frame->width), y1 = min(y0 + PEL_TILE_HEIGHT, frame->height);
    uint found = PEL_FEATURES & PEL_BIT_NO_SKIPPING;
    for (uint y = y0; y < y1 && !found; ++y)
        for (uint x = x0; x < x1; x += PEL_WIDTH) {
            const uint first = vectorStart(x, frame->width);
            const uintw id = loadId(PEL_FORMAT_MATERIAL, imageSpan(material, &frame->images[PEL_IMAGE_MATERIAL], first, y));
            found |= anyw(hasMaterial(frame, id));
        }
    if (found) list[1 + atomic_inc(list)] = tile;
}
