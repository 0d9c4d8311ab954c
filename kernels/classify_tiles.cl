// Which tiles hold a pixel of a material, and which variant of the shading kernel they need: compact lists of their numbers
// (docs/shading.md, "Tiles").
//
// Inputs: the material id image, PelShadeFrame.materialMask, PelShadeMaterial.variants. Output: lists of tiles (shared/shade.h),
// in no fixed order; list 0 is left out when only those of the variants are wanted. One work-item: one tile. Variants:
// PEL_FORMAT_MATERIAL; PEL_BIT_NO_SKIPPING lists every tile.
#include "lib/image.clh"
#include "lib/material_id.clh"
#include "shared/shade.h"

// Bits of the variants that have what all materials of the pixels of `left` need.
static inline uint commonVariants(__global const PelShadeMaterial* materials, uintw id, maskw left) {
    uint able = ~0u;
    while (anyw(left)) {
        const uint current = greatestId(id, left);
        able &= materials[current].variants;
        left &= id != current;
    }
    return able;
}

__kernel __attribute__((reqd_work_group_size(PEL_CLASSIFY_GROUP, 1, 1))) void classify_tiles(
    __global const PelShadeFrame* frame, __global const PelShadeMaterial* materials, __global uchar* material,
    __global uint* lists, uint variants, uint listAll) {
    if (get_global_id(0) >= frame->tiles) return;
    const uint tile = frame->firstTile + get_global_id(0);
    const uint x0 = tile % frame->tilesX * PEL_TILE_WIDTH, y0 = tile / frame->tilesX * PEL_TILE_HEIGHT;
    const uint x1 = min(x0 + PEL_TILE_WIDTH, frame->width), y1 = min(y0 + PEL_TILE_HEIGHT, frame->height);
    uint found = PEL_FEATURES & PEL_BIT_NO_SKIPPING, able = (1u << variants) - 1u;
    for (uint y = y0; y < y1 && !(found && able == 1u); ++y)
        for (uint x = x0; x < x1; x += PEL_WIDTH) {
            const uint first = vectorStart(x, frame->width);
            const uintw id = loadId(PEL_FORMAT_MATERIAL, imageSpan(material, &frame->images[PEL_IMAGE_MATERIAL], first, y));
            const maskw has = hasMaterial(frame, id);
            if (!anyw(has)) continue;
            found = 1;
            if (able == 1u) break;
            able &= commonVariants(materials, id, has);
        }
    if (!found) return;
    if (listAll) lists[PEL_TILE_LISTS + atomic_inc(lists)] = tile;
    if (variants > 1u) {
        const uint list = 32u - clz(able); // of the last variant that will do: they get cheaper
        lists[PEL_TILE_LISTS + (size_t)list * frame->listTiles + atomic_inc(&lists[list])] = tile;
    }
}
