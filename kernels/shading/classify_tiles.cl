// Finds the tiles that hold a pixel of a material, and the variant of the shading kernel that each needs:
// compact lists of tile numbers (docs/guide/shading.md, "Tiles").
//
// Inputs: the material id image, PelShadeFrame.materialMask, PelShadeMaterial.variants. Output: lists of
// tiles (shared/shade.h); list 0 is left out if only the lists of the variants are needed. Variants:
// PEL_FORMAT_MATERIAL; PEL_BIT_NO_SKIPPING lists every tile.
//
// One lane: a work-group is a tile, a work-item every PEL_CLASSIFY_GROUP-th pixel of it. Several lanes: a
// work-item is a run of PEL_CLASSIFY_RUN tiles, which keep their order, since neighbours share cache lines
// and pages.
#include "lib/image/image.clh"
#include "lib/shading/material_id.clh"

#if PEL_WIDTH == 1

// Writes a tile's number to the list of all tiles and to that of its variant.
static inline void listTile(__global const PelShadeFrame* frame, __global uint* lists, uint list, uint tile) {
    lists[PEL_TILE_LIST(frame, list) + atomic_inc(&lists[PEL_TILE_COUNT(list)])] = tile;
}

__kernel __attribute__((reqd_work_group_size(PEL_CLASSIFY_GROUP, 1, 1))) void classify_tiles(
    __global const PelShadeFrame* restrict frame, __global const PelShadeMaterial* restrict materials,
    __global uchar* material, __global uint* lists, uint variants, uint listAll) {
    __local uint found, able;  // whether a pixel has a material; variants with the features of all pixels
    const uint item = get_local_id(0), group = get_group_id(0), all = (1u << variants) - 1u;
    const uint tile = frame->firstTile + group;
    const uint x0 = tile % frame->tilesX * PEL_TILE_WIDTH, y0 = tile / frame->tilesX * PEL_TILE_HEIGHT;
    if (item == 0) found = PEL_FEATURES & PEL_BIT_NO_SKIPPING, able = all;
    barrier(CLK_LOCAL_MEM_FENCE);
    uint some = 0, common = all;
    for (uint pixel = item; pixel < PEL_TILE_PIXELS && group < frame->tiles; pixel += PEL_CLASSIFY_GROUP) {
        const uint x = x0 + pixel % PEL_TILE_WIDTH, y = y0 + pixel / PEL_TILE_WIDTH;
        if (x >= frame->width || y >= frame->height) continue;
        const uint id =
            loadId(PEL_FORMAT_MATERIAL, imageSpan(material, &frame->images[PEL_IMAGE_MATERIAL], x, y));
        if (!hasMaterial(frame, id)) continue;
        some = 1;
        if (all != 1u) common &= materials[id].variants;
    }
    if (some) atomic_or(&found, 1u);
    if (common != all) atomic_and(&able, common);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item > 0 || group >= frame->tiles || !found) return;
    if (listAll) listTile(frame, lists, 0, tile);
    if (variants > 1u) listTile(frame, lists, 32u - clz(able), tile);
}

#else

// Bits of the variants with all features that the materials of the pixels in `left` need.
static inline uint commonVariants(__global const PelShadeMaterial* materials, uintw id, maskw left) {
    uint able = ~0u;
    while (anyw(left)) {
        const uint current = greatestId(id, left);
        able &= materials[current].variants;
        left &= id != current;
    }
    return able;
}

// The id of a tile that has a single one, as nearly all have; ~0 for other tiles. Compares bytes, without a
// branch for each vector.
static inline uint onlyId(__global const PelShadeFrame* frame, __global uchar* material, uint x, uint y) {
    if (PEL_FORMAT_MATERIAL != PEL_FMT_R8_UINT || x + PEL_TILE_WIDTH > frame->width ||
        y + PEL_TILE_HEIGHT > frame->height)
        return ~0u;
    __global const PelShadeImage* image = &frame->images[PEL_IMAGE_MATERIAL];
    __global const uchar* first = imageSpan(material, image, x, y).first;
    const uchar id = *first;
    uchar16 differs = (uchar16)(0);
    for (uint j = 0; j < PEL_TILE_HEIGHT; ++j, first += image->rowStride) {
        for (uint i = 0; i < PEL_TILE_WIDTH; i += 64) PEL_PREFETCH(first + 4 * PEL_TILE_WIDTH + i);
        for (uint i = 0; i < PEL_TILE_WIDTH; i += 16) differs |= vload16(0, first + i) ^ (uchar16)(id);
    }
    const ulong2 words = as_ulong2(differs);
    return words.x | words.y ? ~0u : (uint)id;
}

// 0: no pixel of a material; otherwise 1 + the last variant that has all features that its materials need
// (later ones are cheaper).
static PEL_OUT_OF_LINE uint classOfTile(__global const PelShadeFrame* frame,
                                        __global const PelShadeMaterial* materials, __global uchar* material,
                                        uint tile, uint variants) {
    const uint x0 = tile % frame->tilesX * PEL_TILE_WIDTH, y0 = tile / frame->tilesX * PEL_TILE_HEIGHT;
    const uint x1 = min(x0 + PEL_TILE_WIDTH, frame->width), y1 = min(y0 + PEL_TILE_HEIGHT, frame->height);
    uint found = PEL_FEATURES & PEL_BIT_NO_SKIPPING, able = (1u << variants) - 1u, known = ~0u;
    if (!found && able != 1u) {
        const uint id = onlyId(frame, material, x0, y0);
        if (id != ~0u)
            return anyw(hasMaterial(frame, (uintw)(id))) ? 32u - clz(able & materials[id].variants) : 0u;
    }
    for (uint y = y0; y < y1; ++y)
        for (uint x = x0; x < x1; x += PEL_WIDTH) {
            if (found && able == 1u) return 1u;
            const uint first = vectorStart(x, frame->width);
            const uintw id = loadId(PEL_FORMAT_MATERIAL,
                                    imageSpan(material, &frame->images[PEL_IMAGE_MATERIAL], first, y));
            if (!anyw(id != known)) continue;  // nearly always
            const maskw has = hasMaterial(frame, id);
            // its variants are known now; in mixed vectors only those of this id
            known = greatestId(id, (maskw)(-1));
            if (!anyw(has)) continue;
            found = 1;
            if (able != 1u) able &= commonVariants(materials, id, has);
        }
    return found ? 32u - clz(able) : 0u;
}

__kernel __attribute__((reqd_work_group_size(PEL_CLASSIFY_GROUP, 1, 1))) void classify_tiles(
    __global const PelShadeFrame* frame, __global const PelShadeMaterial* materials, __global uchar* material,
    __global uint* lists, uint variants, uint listAll) {
    const uint begin = get_global_id(0) * PEL_CLASSIFY_RUN;
    if (begin >= frame->tiles) return;
    const uint count = min((uint)PEL_CLASSIFY_RUN, frame->tiles - begin), start = frame->firstTile + begin;
    uchar classes[PEL_CLASSIFY_RUN];
    uint counts[PEL_TILE_LISTS] = {0};
    for (uint i = 0; i < count; ++i) {
        const uint class_ = classOfTile(frame, materials, material, start + i, variants);
        classes[i] = (uchar)class_;
        if (!class_) continue;
        counts[0] += listAll;
        if (variants > 1u) ++counts[class_];
    }
    for (uint list = 0; list < PEL_TILE_LISTS; ++list) {
        if (!counts[list]) continue;
        size_t to = PEL_TILE_LIST(frame, list) + atomic_add(&lists[PEL_TILE_COUNT(list)], counts[list]);
        for (uint i = 0; i < count; ++i)
            if (list ? classes[i] == list : classes[i] != 0) lists[to++] = start + i;
    }
}

#endif
