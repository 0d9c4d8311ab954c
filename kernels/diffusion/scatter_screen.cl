// Irradiance scattered under the surface, gathered on the screen (docs/mathematics.md, sections 9 and 10):
// S(x) = sum over y of R(|x - y|) E(y) A(y), over the pixels near x and over ever larger blocks further away.
//
// The blocks that a pixel sums over are those of 2 x 2 parents round its own parent, six on a side; from level 1 on without those that
// the level below has taken apart. So every pixel of the neighbourhood is in one block, whose width is at most about half of its
// distance. The sum is divided by what the weights add up to: what the screen does not show counts like the rest. Where more surface
// lies within reach than a plane has (in creases), the surplus beyond the finest level is gain.
//
// Input: the pyramid, the words of classify_scatter. Output: an image like the irradiance's; pixels of the same value where nothing
// was to be done. One work-group takes tiles, one work-item PEL_WIDTH pixels of a row at a time. Variants: PEL_FORMAT_IRRADIANCE,
// PEL_FORMAT_OUT.
#include "lib/diffusion/profile_table.clh"
#include "lib/diffusion/pyramid.clh"
#include "lib/image/image.clh"
#include "lib/shading/material_id.clh"

#define REACH_FIRST -2 // of the six blocks on a side, from the parent's first child on
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
static inline __attribute__((always_inline)) uint addLevel(__global const PelDiffusionFrame* frame, __global const float* pyramid, const PelProfileTable table,
                            __global const float* nodes, uint x, uint y, const uint level, const Pixels* here, maskw active,
                            Sums* sums) {
    __global const PelPyramidLevel* blocks = &frame->level[level];
    const uint stride = blocks->stride;
    const int parentX = (int)(x >> (level + 1)) * 2, parentY = (int)(y >> (level + 1)) * 2;
    const intw own = ((lanesw() + (int)x) >> (int)level) & 1; // which child of its parent
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
            if (level == 0 && j == ownY) taken &= own != i; // the pixel itself
            const Vec3w q = vec3(loadBlocks(at + PEL_PLANE_X * stride, level), loadBlocks(at + PEL_PLANE_Y * stride, level),
                                 loadBlocks(at + PEL_PLANE_Z * stride, level));
            const Vec3w d = sub3(q, here->p);
            const floatw distance2 = dot3(d, d);
            taken &= distance2 < reach2;
            if (!anyw(taken)) continue;
            const Vec3w e = vec3(loadBlocks(at + PEL_PLANE_RED * stride, level), loadBlocks(at + PEL_PLANE_GREEN * stride, level),
                                 loadBlocks(at + PEL_PLANE_BLUE * stride, level));
            const Vec3w weight = scale3(profileDensity(nodes, table, distance2), selectw((floatw)(0.0f), area, taken));
            sums->weight = add3(sums->weight, weight);
            sums->light.x = fma(weight.x, e.x, sums->light.x);
            sums->light.y = fma(weight.y, e.y, sums->light.y);
            sums->light.z = fma(weight.z, e.z, sums->light.z);
            taps += PEL_WIDTH;
        }
    }
    return taps;
}

// Surplus of surface below this counts as an error of the sums.
#ifndef LEAST_GAIN
#define LEAST_GAIN 0.05f
#define GAIN 1
#endif

static inline floatw finished(floatw light, floatw weight, floatw e, floatw skipped, floatw far, floatw farOnPlane, float tolerance) {
    // Levels that were left out, and a pixel that has nothing round it, keep the pixel's own.
    const floatw total = weight + skipped;
    const floatw change = (light - weight * e) / selectw((floatw)(1.0f), total, total > 0.0f);
    const floatw gain = GAIN * max0w(far - farOnPlane - LEAST_GAIN);
    return (e + change) * (1.0f + gain);
}

// The share of the light that comes from within the blocks of a level, six on a side, on the pixel's plane: of an ellipse of their
// area as slender as the pixel's view of the plane, by its radii at every eighth of a turn.
static inline Vec3w shareOfBlocks(__global const float* nodes, const PelProfileTable table, const Pixels* here, uint level) {
    const float scale = 36.0f / 3.14159265f * (float)(1u << 2 * level);
    const floatw minor = here->size, major = here->area * here->area / fmax(here->size, (floatw)(FLT_MIN));
    const floatw oblique = 2.0f * minor * major / fmax(minor + major, (floatw)(FLT_MIN));
    const Vec3w ends = add3(profileShare(nodes, table, scale * minor), profileShare(nodes, table, scale * major));
    return add3(scale3(ends, (floatw)(0.25f)), scale3(profileShare(nodes, table, scale * oblique), (floatw)(0.5f)));
}

// One table's pixels among PEL_WIDTH of a row.
static inline Vec3w scatterPixels(__global const PelDiffusionFrame* frame, __global const float* pyramid, const PelProfileTable table,
                                  __global const float* nodes, uint x, uint y, uint first, uint levels, const Pixels* here,
                                  maskw active, uint* taps) {
    Sums sums, far;
    sums.light = sums.weight = vec3((floatw)(0.0f), (floatw)(0.0f), (floatw)(0.0f));
    far = sums;
    Vec3w skipped = sums.light, near = shareOfBlocks(nodes, table, here, 0);
    if (first == 0) {
        sums.weight = shareOfArea(nodes, table, here->area);
        sums.light = mul3(sums.weight, here->e);
        *taps += addLevel(frame, pyramid, table, nodes, x, y, 0, here, active, &sums);
    } else {
        skipped = shareOfBlocks(nodes, table, here, first - 1);
    }
#define LEVEL(k) \
    if (first <= k && k < levels) *taps += addLevel(frame, pyramid, table, nodes, x, y, k, here, active, &far);
    LEVEL(1)
    LEVEL(2)
    for (uint k = max(first, 3u); k < levels; ++k) *taps += addLevel(frame, pyramid, table, nodes, x, y, k, here, active, &far);
#undef LEVEL
    const Vec3w beyond = first > 0 ? vec3((floatw)(1.0f), (floatw)(1.0f), (floatw)(1.0f))
                                   : sub3(shareOfBlocks(nodes, table, here, levels - 1), near);
    const Vec3w light = add3(sums.light, far.light), weight = add3(sums.weight, far.weight);
    return vec3(finished(light.x, weight.x, here->e.x, skipped.x, far.weight.x, beyond.x, frame->tolerance),
                finished(light.y, weight.y, here->e.y, skipped.y, far.weight.y, beyond.y, frame->tolerance),
                finished(light.z, weight.z, here->e.z, skipped.z, far.weight.z, beyond.z, frame->tolerance));
}

// The table of each lane, 1 + its number; 0: none.
static inline intw tablesOf(__global const PelDiffusionFrame* frame, uintw id) {
#define TABLE(i, s) (int)frame->tableOf[id s]
    return (intw)(PEL_LIST_LANES_(TABLE));
#undef TABLE
}

__kernel __attribute__((reqd_work_group_size(PEL_DIFFUSION_GROUP, 1, 1))) void scatter_screen(
    __global const PelDiffusionFrame* frame, __global const float* pyramid, __global const PelProfileTable* tables,
    __global const float* nodes, __global const uint* tiles, __global uchar* irradiance, __global uchar* out,
    __global uint* counters) {
    const uint count = frame->tilesX * frame->tilesY;
    uint pixels = 0, taps = 0;
    for (uint tile = get_group_id(0); tile < count; tile += get_num_groups(0)) {
        const uint word = tiles[tile];
        if (!word && frame->inPlace) continue;
        const uint first = (word & 255) - 1, levels = word >> 8;
        for (uint item = get_local_id(0); item < PEL_DIFFUSION_TILE * PEL_DIFFUSION_TILE / PEL_WIDTH; item += PEL_DIFFUSION_GROUP) {
            const uint x = tile % frame->tilesX * PEL_DIFFUSION_TILE + item % (PEL_DIFFUSION_TILE / PEL_WIDTH) * PEL_WIDTH;
            const uint y = tile / frame->tilesX * PEL_DIFFUSION_TILE + item / (PEL_DIFFUSION_TILE / PEL_WIDTH);
            if (x >= frame->width || y >= frame->height) continue;
            const uint start = vectorStart(x, frame->width); // of the images' vectors
            const intw column = lanesw() + (int)x;
            const maskw inside = column < (int)frame->width;
            if (!frame->inPlace) {
                const intw imageColumn = lanesw() + (int)start;
                const Vec3w as = loadColor(PEL_FORMAT_IRRADIANCE, imageSpan(irradiance, &frame->irradiance, start, y));
                storeColor(PEL_FORMAT_OUT, imageSpan(out, &frame->out, start, y), as,
                           (imageColumn >= (int)x) & (imageColumn < (int)frame->width));
                if (!word) continue;
            }
            __global const PelPyramidLevel* level = &frame->level[0];
            __global const float* at = pyramid + pyramidRow(level, (int)y) + x;
            Pixels here;
            here.area = loadw(PEL_PLANE_AREA * level->stride, at);
            here.size = loadw(PEL_PLANE_SIZE * level->stride, at);
            here.id = as_uintw(loadw(PEL_PLANE_ID * level->stride, at));
            const maskw active = inside & (here.area > 0.0f);
            if (!anyw(active)) continue;
            here.p = vec3(loadw(PEL_PLANE_X * level->stride, at), loadw(PEL_PLANE_Y * level->stride, at),
                          loadw(PEL_PLANE_Z * level->stride, at));
            here.e = vec3(loadw(PEL_PLANE_RED * level->stride, at), loadw(PEL_PLANE_GREEN * level->stride, at),
                          loadw(PEL_PLANE_BLUE * level->stride, at));
            const intw table = selectw((intw)(0), tablesOf(frame, here.id), active);
            pixels += countw(active);
            for (uint t = 1; t <= frame->tables; ++t) {
                const maskw mine = table == (intw)((int)t);
                if (!anyw(mine)) continue;
                const Vec3w s = scatterPixels(frame, pyramid, tables[t - 1], nodes, x, y, first, levels, &here, mine, &taps);
                // Stored from the tile's own first column on, lane by lane where the row ends.
                storeColor(PEL_FORMAT_OUT, imageSpan(out, &frame->out, x, y), s, mine);
            }
        }
    }
    if (pixels) atomic_add(&counters[PEL_COUNT_PIXELS_TAPPED], pixels);
    if (taps) atomic_add(&counters[PEL_COUNT_TAPS], taps);
}
