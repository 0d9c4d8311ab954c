// Irradiance scattered under the surface, gathered on the screen (docs/mathematics.md, sections 9 and 10):
// S(x) = sum over y of R(|x - y|) E(y) A(y), over the pixels near x and over ever larger blocks further away.
//
// The blocks that a pixel sums over are those of the 2 x 2 parents round its own parent, six on a side; from
// level 1 on without those that the level below has resolved. So every pixel of the neighbourhood is in
// exactly one block, whose width is at most about half of its distance. The sum is divided by the sum of
// weights: what the screen does not show is assumed to be like the rest.
//
// Inputs: the pyramid, the words of classify_scatter. Output: an image in the format of the irradiance;
// pixels without taps keep their value. One work-group takes tiles, one work-item PEL_WIDTH pixels of a row
// at a time. Variants: PEL_FORMAT_IRRADIANCE, PEL_FORMAT_OUT.
#include "lib/diffusion/profile_table.clh"
#include "lib/diffusion/pyramid.clh"
#include "lib/image/image.clh"
#include "lib/shading/material_id.clh"

#define REACH_FIRST -2  // of the six blocks on a side, from the parent's first child on
#define REACH_LAST 3

typedef struct Pixels {
    Vec3w p, e;
    floatw area, size;
    uintw id;
} Pixels;

typedef struct Sums {
    Vec3w light, weight;
} Sums;

// A plane's values for all lanes: of column `first` + (lane >> level, made even).
static inline __attribute__((always_inline)) floatw loadBlocks(__global const float* first, uint level) {
#if PEL_WIDTH == 1
    return *first;
#elif PEL_WIDTH == 8
    if (level >= 2) return (floatw)(*first);
    const floatw v = loadw(0, first);
    return level == 0 ? PEL_SHUFFLE8(v, v, 0, 0, 2, 2, 4, 4, 6, 6) : PEL_SHUFFLE8(v, v, 0, 0, 0, 0, 2, 2, 2, 2);
#else
    if (level >= 3) return (floatw)(*first);
    const floatw v = loadw(0, first);
    if (level == 0) return PEL_SHUFFLE16(v, v, 0, 0, 2, 2, 4, 4, 6, 6, 8, 8, 10, 10, 12, 12, 14, 14);
    if (level == 1) return PEL_SHUFFLE16(v, v, 0, 0, 0, 0, 2, 2, 2, 2, 4, 4, 4, 4, 6, 6, 6, 6);
    return PEL_SHUFFLE16(v, v, 0, 0, 0, 0, 0, 0, 0, 0, 2, 2, 2, 2, 2, 2, 2, 2);
#endif
}

// Adds the blocks of one level. Returns how many lanes were taken.
static inline __attribute__((always_inline)) uint addLevel(__global const PelDiffusionFrame* frame,
                                                           __global const float* pyramid,
                                                           const PelProfileTable table,
                                                           __global const float* nodes, uint x, uint y,
                                                           const uint level, const Pixels* here, maskw active,
                                                           Sums* sums) {
    __global const PelPyramidLevel* blocks = &frame->level[level];
    const uint stride = blocks->stride;
    const int parentX = (int)(x >> (level + 1)) * 2, parentY = (int)(y >> (level + 1)) * 2;
    const intw own = ((lanesw() + (int)x) >> (int)level) & 1;  // which child of its parent
    const int ownY = (int)(y >> level) & 1;
    const float reach2 = table.reach * table.reach;
    uint taps = 0;
    for (int j = REACH_FIRST; j <= REACH_LAST; ++j) {
        __global const float* row = pyramid + pyramidRow(blocks, parentY + j) + parentX;
        const bool innerRow = level > 0 && abs(j - ownY) <= 1;
        for (int i = REACH_FIRST; i <= REACH_LAST; ++i) {
            if (innerRow && (i == 0 || i == 1)) continue;
            __global const float* at = row + i;
            const floatw area = loadBlocks(at, level);
            maskw taken = active & (area > 0.0f);
            taken &= as_uintw(loadBlocks(at + PEL_PLANE_ID * stride, level)) == here->id;
            if (innerRow) taken &= (own - i > 1) | (i - own > 1);
            if (level == 0 && j == ownY) taken &= own != i;  // the pixel itself
            const Vec3w q = vec3(loadBlocks(at + PEL_PLANE_X * stride, level),
                                 loadBlocks(at + PEL_PLANE_Y * stride, level),
                                 loadBlocks(at + PEL_PLANE_Z * stride, level));
            const Vec3w d = sub3(q, here->p);
            const floatw distance2 = dot3(d, d);
            taken &= distance2 < reach2;
            if (!anyw(taken)) continue;
            const Vec3w e = vec3(loadBlocks(at + PEL_PLANE_RED * stride, level),
                                 loadBlocks(at + PEL_PLANE_GREEN * stride, level),
                                 loadBlocks(at + PEL_PLANE_BLUE * stride, level));
            const Vec3w weight =
                scale3(profileDensity(nodes, table, distance2), selectw((floatw)(0.0f), area, taken));
            sums->weight = add3(sums->weight, weight);
            sums->light.x = fma(weight.x, e.x, sums->light.x);
            sums->light.y = fma(weight.y, e.y, sums->light.y);
            sums->light.z = fma(weight.z, e.z, sums->light.z);
            taps += PEL_WIDTH;
        }
    }
    return taps;
}

// The share of the light that comes from within three blocks on a side: the block and those round it, on its
// plane. It is that of an ellipse of their area, as slender as the plane is seen, from its radii at every
// eighth of a turn.
static inline Vec3w shareWithin(__global const float* nodes, const PelProfileTable table, const Pixels* here,
                                uint level) {
    const floatw area = here->area * (9.0f / 3.14159265f),
                 size = here->size * (9.0f / 3.14159265f * (float)(1u << 2 * level));
    const floatw minor = fmin(size, area), major = area * area / fmax(minor, (floatw)(FLT_MIN));
    const floatw oblique = 2.0f * minor * major / fmax(minor + major, (floatw)(FLT_MIN));
    const Vec3w ends = add3(profileShare(nodes, table, minor), profileShare(nodes, table, major));
    return add3(scale3(ends, (floatw)(0.25f)), scale3(profileShare(nodes, table, oblique), (floatw)(0.5f)));
}

// The change by scattering in one channel. Levels that were left out, and pixels without neighbours, keep the
// pixel's own value.
static inline floatw changeOf(floatw light, floatw weight, floatw e, floatw skipped) {
    const floatw total = weight + skipped;
    return (light - weight * e) / selectw((floatw)(1.0f), total, total > 0.0f);
}

// One table's pixels among PEL_WIDTH of a row: by how much their irradiance changes.
static inline Vec3w scatterPixels(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                                  const PelProfileTable table, __global const float* nodes, uint x, uint y,
                                  uint first, uint levels, const Pixels* here, maskw active, uint* taps) {
    const Vec3w none = vec3((floatw)(0.0f), (floatw)(0.0f), (floatw)(0.0f));
    Sums sums;
    sums.light = sums.weight = none;
    Vec3w skipped = none;
    if (first == 0) {
        sums.weight = shareOfArea(nodes, table, here->area);
        sums.light = mul3(sums.weight, here->e);
        *taps += addLevel(frame, pyramid, table, nodes, x, y, 0, here, active, &sums);
    } else {
        skipped = shareWithin(nodes, table, here, first);
    }
    if (first <= 1 && levels > 1)
        *taps += addLevel(frame, pyramid, table, nodes, x, y, 1, here, active, &sums);
    if (first <= 2 && levels > 2)
        *taps += addLevel(frame, pyramid, table, nodes, x, y, 2, here, active, &sums);
    for (uint k = max(first, 3u); k < levels; ++k)
        *taps += addLevel(frame, pyramid, table, nodes, x, y, k, here, active, &sums);
    return vec3(changeOf(sums.light.x, sums.weight.x, here->e.x, skipped.x),
                changeOf(sums.light.y, sums.weight.y, here->e.y, skipped.y),
                changeOf(sums.light.z, sums.weight.z, here->e.z, skipped.z));
}

// The table of each lane, 1 + its number; 0: none.
static inline intw tablesOf(__global const PelDiffusionFrame* frame, uintw id) {
#define TABLE(i, s) (int)frame->tableOf[id s]
    return (intw)(PEL_LIST_LANES_(TABLE));
#undef TABLE
}

static inline Pixels loadPixels(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                                uint x, uint y) {
    const uint stride = frame->level[0].stride;
    __global const float* at = pyramid + pyramidRow(&frame->level[0], (int)y) + x;
    Pixels here;
    here.area = loadw(PEL_PLANE_AREA * stride, at);
    here.size = loadw(PEL_PLANE_SIZE * stride, at);
    here.id = as_uintw(loadw(PEL_PLANE_ID * stride, at));
    here.p =
        vec3(loadw(PEL_PLANE_X * stride, at), loadw(PEL_PLANE_Y * stride, at), loadw(PEL_PLANE_Z * stride, at));
    here.e = vec3(loadw(PEL_PLANE_RED * stride, at), loadw(PEL_PLANE_GREEN * stride, at),
                  loadw(PEL_PLANE_BLUE * stride, at));
    return here;
}

// The blocks of a level that hold the pixels from (x, y) on.
static inline Pixels loadOwnBlocks(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                                   uint level, uint x, uint y) {
    const uint stride = frame->level[level].stride;
    __global const float* at = pyramid + pyramidRow(&frame->level[level], (int)(y >> level));
    Pixels here;
#define OWN(plane)                                          \
    {                                                       \
        __global const float* values = at + (plane)*stride; \
        own = PEL_LANES(VALUE);                             \
    }
#define VALUE(i, s) values[(x + (i)) >> level]
    floatw own;
    OWN(PEL_PLANE_AREA) here.area = own;
    OWN(PEL_PLANE_SIZE) here.size = own;
    OWN(PEL_PLANE_ID) here.id = as_uintw(own);
    OWN(PEL_PLANE_X) here.p.x = own;
    OWN(PEL_PLANE_Y) here.p.y = own;
    OWN(PEL_PLANE_Z) here.p.z = own;
    OWN(PEL_PLANE_RED) here.e.x = own;
    OWN(PEL_PLANE_GREEN) here.e.y = own;
    OWN(PEL_PLANE_BLUE) here.e.z = own;
#undef VALUE
#undef OWN
    return here;
}

// By how much the irradiance of the lanes in `active` changes.
static inline Vec3w changeOfPixels(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                                   __global const PelProfileTable* tables, __global const float* nodes,
                                   uint x, uint y, uint first, uint levels, const Pixels* here, maskw active,
                                   uint* pixels, uint* taps) {
    const intw table = selectw((intw)(0), tablesOf(frame, here->id), active);
    Vec3w change = vec3((floatw)(0.0f), (floatw)(0.0f), (floatw)(0.0f));
    *pixels += countw(active);
    for (uint t = 1; t <= frame->tables; ++t) {
        const maskw mine = table == (intw)((int)t);
        if (!anyw(mine)) continue;
        const Vec3w one =
            scatterPixels(frame, pyramid, tables[t - 1], nodes, x, y, first, levels, here, mine, taps);
        change = select3(change, one, mine);
    }
    return change;
}

__kernel __attribute__((reqd_work_group_size(PEL_DIFFUSION_GROUP, 1, 1))) void scatter_screen(
    __global const PelDiffusionFrame* frame, __global const float* pyramid,
    __global const PelProfileTable* tables, __global const float* nodes, __global const uint* tiles,
    __global uchar* irradiance, __global uchar* out, __global uint* counters) {
    const uint count = frame->tilesX * frame->tilesY;
    uint pixels = 0, taps = 0;
    for (uint tile = get_group_id(0); tile < count; tile += get_num_groups(0)) {
        const uint word = tiles[tile];
        if (!word && frame->inPlace) continue;
        const uint first = word ? (word & 255) - 1 : 0, levels = word >> 8;
        // The change by levels from `first` on is nearly the same over a block of that level, and nearer
        // light flows both ways.
        const uint rows = 1u << min(first, (uint)PEL_TILE_LEVEL);
        const uint items = PEL_DIFFUSION_TILE / PEL_WIDTH * (PEL_DIFFUSION_TILE / rows);
        for (uint item = get_local_id(0); item < items; item += PEL_DIFFUSION_GROUP) {
            const uint x = tile % frame->tilesX * PEL_DIFFUSION_TILE +
                           item % (PEL_DIFFUSION_TILE / PEL_WIDTH) * PEL_WIDTH;
            const uint top =
                tile / frame->tilesX * PEL_DIFFUSION_TILE + item / (PEL_DIFFUSION_TILE / PEL_WIDTH) * rows;
            if (x >= frame->width || top >= frame->height) continue;
            const uint start = vectorStart(x, frame->width);  // of the images' vectors
            const intw column = lanesw() + (int)x, imageColumn = lanesw() + (int)start;
            const maskw inside = column < (int)frame->width;
            Vec3w shared = vec3((floatw)(0.0f), (floatw)(0.0f), (floatw)(0.0f));
            uintw sharedId = (uintw)(0);
            if (word && rows > 1) {
                const Pixels here = loadOwnBlocks(frame, pyramid, first, x, top);
                const maskw active = inside & (here.area > 0.0f);
                sharedId = as_uintw(selectw((intw)(0), as_intw(here.id), active));
                if (anyw(active))
                    shared = changeOfPixels(frame, pyramid, tables, nodes, x, top, first, levels, &here,
                                            active, &pixels, &taps);
            }
            for (uint y = top; y < min(top + rows, frame->height); ++y) {
                if (!frame->inPlace) {
                    const Vec3w as =
                        loadColor(PEL_FORMAT_IRRADIANCE, imageSpan(irradiance, &frame->irradiance, start, y));
                    storeColor(PEL_FORMAT_OUT, imageSpan(out, &frame->out, start, y), as,
                               (imageColumn >= (int)x) & (imageColumn < (int)frame->width));
                    if (!word) continue;
                }
                const Pixels here = loadPixels(frame, pyramid, x, y);
                const maskw active = inside & (here.area > 0.0f);
                if (!anyw(active)) continue;
                const maskw known = active & (here.id == sharedId), unknown = active & notw(known);
                Vec3w change = shared;
                if (anyw(unknown))
                    change = select3(shared,
                                     changeOfPixels(frame, pyramid, tables, nodes, x, y, 0, levels, &here,
                                                    unknown, &pixels, &taps),
                                     unknown);
                // A negative value is an error of the sums.
                const Vec3w s = add3(here.e, change);
                storeColor(PEL_FORMAT_OUT, imageSpan(out, &frame->out, x, y),
                           vec3(max0w(s.x), max0w(s.y), max0w(s.z)), active);
            }
        }
    }
    if (pixels) atomic_add(&counters[PEL_COUNT_PIXELS_TAPPED], pixels);
    if (taps) atomic_add(&counters[PEL_COUNT_TAPS], taps);
}
