// Marks the shadow-map texels that show camera-visible surface (docs/mathematics.md, section 10, "Light
// space").
//
// The surface of a pixel is taken for a parallelogram of two of its steps to the neighbours, so one pixel
// of 2 x 2 is enough. This patch is projected into the map; texels whose depth is that of the patch there
// show the same surface. Input: images of positions (length) or depth, and of ids. Output: a byte per
// texel, set to 0 beforehand: the id of the pixel, or PEL_SEEN_OTHER where the pixel does not scatter.
// Patches of several work-items meet at a texel, so bytes are merged atomically, and the result does not
// depend on their order: with PEL_HIDDEN the bits of all ids, since only "not 0" matters, otherwise the
// smallest id. Also output: the part of the map within reach of scattering pixels, the only part that
// light_texels computes (PEL_LIGHT_REGION). One work-item: PEL_WIDTH pixels of every other row, one lane:
// every other pixel of it, in a map. Variants: PEL_FORMAT_POSITION or PEL_FORMAT_DEPTH, PEL_FORMAT_MATERIAL
// (0: everything is id 1), PEL_FORMAT_SHADOW_MAP, PEL_SHADOW_CONTENT, PEL_HIDDEN.
#include "lib/diffusion/item.clh"
#include "lib/diffusion/lanes.clh"
#include "lib/diffusion/light_space.clh"
#include "lib/diffusion/pyramid.clh"
#include "lib/shading/material_id.clh"
#include "lib/shading/position.clh"

#define MAX_TEXELS \
    6.0f  // half the width of a patch; wider patches are seen at a grazing angle, and neighbours cover them
#define EVERY 2                                    // pixel, along a side, has a patch
#define STEP (PEL_WIDTH == 1 ? EVERY : PEL_WIDTH)  // pixels of a row from work-item to work-item
#define OFF_PLANE 0.75f  // largest distance of a texel from the plane of the patch, in lengths of a texel

static inline Vec3w loadPositions(__global const PelDiffusionFrame* frame, __global uchar* position, uint x,
                                  uint y) {
    const Span span = imageSpan(position, &frame->position, x, y);
#if PEL_FORMAT_POSITION
    const Vec3w p = loadColor(PEL_FORMAT_POSITION, span);
#else
    const Vec3w p = positionFromDepth(frame->inverseViewProjection, frame->width, frame->height, x, y,
                                      loadScalar(PEL_FORMAT_DEPTH, span));
#endif
    return sub3(p, loadUniform3(frame->origin));
}

#if PEL_WIDTH == 8
#define BEFORE(v) PEL_SHUFFLE8(v, v, 1, 0, 1, 2, 3, 4, 5, 6)
#define AFTER(v) PEL_SHUFFLE8(v, v, 1, 2, 3, 4, 5, 6, 7, 6)
#elif PEL_WIDTH == 16
#define BEFORE(v) PEL_SHUFFLE16(v, v, 1, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14)
#define AFTER(v) PEL_SHUFFLE16(v, v, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 14)
#endif

// The shorter of the offsets to two neighbours; the second if the first is not finite.
static inline Vec3w shorterOffset(Vec3w p, Vec3w a, Vec3w b) {
    const Vec3w toA = sub3(a, p), toB = sub3(b, p);
    const floatw lengthA = dot3(toA, toA), lengthB = dot3(toB, toB);
    return select3(toB, toA, finitew(lengthA) & ((lengthA <= lengthB) | notw(finitew(lengthB))));
}

typedef struct Patch {
    floatw column, row, depth;    // of its middle
    floatw acrossX, acrossY;      // texels to each side
    floatw slopeX, slopeY, most;  // depth per texel; depth tolerance
} Patch;

static inline maskw patchOf(__global const PelLightMap* map, Vec3w p, Vec3w right, Vec3w down, Patch* patch) {
    floatw w, unused;
    const Vec3w at = texelOf(map, p, &w), a = sub3(texelOf(map, add3(p, right), &unused), at),
                b = sub3(texelOf(map, add3(p, down), &unused), at);
    const floatw across = a.x * b.y - a.y * b.x, inverse = 1.0f / across;
    patch->column = at.x, patch->row = at.y, patch->depth = at.z;
    patch->slopeX = (a.z * b.y - b.z * a.y) * inverse;
    patch->slopeY = (b.z * a.x - a.z * b.x) * inverse;
    patch->acrossX = fmin(0.5f * (fabs(a.x) + fabs(b.x)) + 0.5f, (floatw)(MAX_TEXELS));
    patch->acrossY = fmin(0.5f * (fabs(a.y) + fabs(b.y)) + 0.5f, (floatw)(MAX_TEXELS));
    // Depth along the light of a texel's length.
    const Vec3w slope = vec3(map->toMap[8] - at.z * map->toMap[12], map->toMap[9] - at.z * map->toMap[13],
                             map->toMap[10] - at.z * map->toMap[14]);
    const floatw perLength = sqrt(dot3(slope, slope)) / fabs(w);
    patch->most = OFF_PLANE * (fabs(patch->slopeX) + fabs(patch->slopeY) + perLength * fabs(w) * map->texel);
    const float width = (float)map->level[0].width, height = (float)map->level[0].height;
    return (w > 0.0f) & finitew(inverse) & finitew(patch->most) & (at.x > -MAX_TEXELS) &
           (at.y > -MAX_TEXELS) & (at.x < width + MAX_TEXELS) & (at.y < height + MAX_TEXELS);
}

// Merges the bytes of up to four texels, those of `mask`, into a word of the output.
static inline void mergeMarks(volatile __global uint* word, uint mask, uint id) {
    if (!mask) return;
    const uint marks = mask & id * 0x01010101u;
    if (PEL_HIDDEN) {
        atomic_or(word, marks);
        return;
    }
    for (uint old = 0, expected;;) {
        expected = old;
        uint merged = 0;
        for (uint shift = 0; shift < 32; shift += 8) {
            const uint now = old >> shift & 255u, mark = marks >> shift & 255u;
            merged |= (!now || (mark && mark < now) ? mark : now) << shift;
        }
        if (merged == expected) return;
        old = atomic_cmpxchg(word, expected, merged);
        if (old == expected) return;
    }
}

static PEL_OUT_OF_LINE void markPatch(__global const PelLightMap* map, __global const uchar* first,
                                      volatile __global uint* seen, float column, float row, float depth,
                                      float acrossX, float acrossY, float slopeX, float slopeY, float most,
                                      uint id) {
    const int left = max((int)ceil(column - acrossX), 0),
              right = min((int)floor(column + acrossX), (int)map->level[0].width - 1);
    const int top = max((int)ceil(row - acrossY), 0),
              bottom = min((int)floor(row + acrossY), (int)map->level[0].height - 1);
    for (int y = top; y <= bottom; ++y) {
        __global const uchar* texels =
            first + (size_t)(map->firstRow + imageTexel(y, map->step, map->height)) * map->map.rowStride;
        const size_t start = map->seen + (size_t)y * map->level[0].width;
        size_t word = (start + left) / 4;
        uint mask = 0;
        for (int x = left; x <= right; ++x) {
            float there = pixelComponent(
                PEL_FORMAT_SHADOW_MAP,
                texels + (size_t)imageTexel(x, map->step, map->width) * map->map.pixelStride, 0, 0);
            if (PEL_SHADOW_CONTENT == PEL_CONTENT_EXPONENTIAL) there = log2(there) * map->perExponent;
            if (map->radialRange > 0.0f) {
                const float s = 2.0f * ((float)x + map->middle) / map->size[0] - 1.0f,
                            t = 2.0f * ((float)y + map->middle) / map->size[1] - 1.0f;
                there = sqrt(fma(s, s, fma(t, t, 1.0f))) / (there * map->radialRange);
            }
            const float plane = fma((float)x - column, slopeX, fma((float)y - row, slopeY, depth));
            const size_t texel = start + x;
            if (texel / 4 != word) {
                mergeMarks(seen + word, mask, id);
                word = texel / 4, mask = 0;
            }
            if (fabs(there - plane) <= most) mask |= 255u << texel % 4 * 8;
        }
        mergeMarks(seen + word, mask, id);
    }
}

// Prefetches the depths around the middle of a patch. They lie far apart in memory, and the requests of all
// lanes can overlap.
static inline void fetchDepths(__global const PelLightMap* map, __global const uchar* first, float column,
                               float row) {
    const uint x = imageTexel((int)column, map->step, map->width);
    for (int k = 0; k < 2; ++k) {
        const uint y = imageTexel((int)row + k, map->step, map->height);
        PEL_PREFETCH(first + (size_t)(map->firstRow + y) * map->map.rowStride +
                     (size_t)x * map->map.pixelStride);
    }
}

// Width of the region around a pixel's texel, over the profile's reach: a block that the profile reaches may
// be as wide as the reach, and its middle that far away.
#define BLOCKS_REACH 3.0f
#define LEAST_TEXELS 16.0f

// Adds PEL_WIDTH pixels of level 0 of the screen's pyramid to a region of the map.
static inline void widenRegion(__global const PelLightMap* map, __global const float* pixels, uint stride,
                               volatile __local uint* region) {
    maskw on = as_uintw(loadw(PEL_PLANE_ID * stride, pixels)) != (uintw)(0);
    if (!anyw(on)) return;
    floatw w, reach = map->reach;
#if PEL_RADII
    reach *= fmax(loadw(PEL_PLANE_RADIUS * stride, pixels), (floatw)(PEL_MIN_RADIUS));
#endif
    const Vec3w at = texelOf(map, loadPlanes3(pixels + PEL_PLANE_X * stride, stride), &w);
    const float width = (float)map->level[0].width, height = (float)map->level[0].height;
    const floatw around = BLOCKS_REACH * reach / (map->texel * w) + LEAST_TEXELS;
    on &= (w > 0.0f) & finitew(at.x) & finitew(at.y) & (at.x > -around) & (at.y > -around) &
          (at.x < width + around) & (at.y < height + around);
    if (!anyw(on)) return;
    atomic_max(region, (uint)(width - clamp(floor(minLane(at.x - around, on)), 0.0f, width - 1.0f)));
    atomic_max(region + 1, 1 + (uint)clamp(-floor(minLane(-at.x - around, on)), 0.0f, width - 1.0f));
    atomic_max(region + 2, (uint)(height - clamp(floor(minLane(at.y - around, on)), 0.0f, height - 1.0f)));
    atomic_max(region + 3, 1 + (uint)clamp(-floor(minLane(-at.y - around, on)), 0.0f, height - 1.0f));
}

// Marks the patches of PEL_WIDTH pixels, those from column `from` on. `own`: level 0 of the pyramid there.
static PEL_OUT_OF_LINE void markPatches(__global const PelDiffusionFrame* frame,
                                        __global const PelLightMap* map, __global const uchar* first,
                                        __global uchar* position, __global uchar* ids,
                                        __global const float* own, uint x, uint y, uint from,
                                        volatile __global uint* seen) {
    const uint stride = frame->level[0].stride;
    const intw column = lanesw() + (int)x;
    const maskw mine = (column >= (int)from) & (column < (int)frame->width) & (column % EVERY == 0);
    const Vec3w p = loadPositions(frame, position, x, y);
#if PEL_WIDTH == 1
    const Vec3w before = loadPositions(frame, position, x > 0 ? x - 1 : min(x + 1, frame->width - 1), y),
                after = loadPositions(frame, position, x + 1 < frame->width ? x + 1 : max(x, 1u) - 1, y);
#else
    // Shuffled only at the borders of the picture: marks must not depend on where vectors begin.
    const Vec3w before = x > 0 ? loadPositions(frame, position, x - 1, y)
                               : vec3(BEFORE(p.x), BEFORE(p.y), BEFORE(p.z)),
                after = x + PEL_WIDTH < frame->width ? loadPositions(frame, position, x + 1, y)
                                                     : vec3(AFTER(p.x), AFTER(p.y), AFTER(p.z));
#endif
    // A pixel without a step to a neighbour has no patch. Most of the background is skipped here.
    const Vec3w sideways = shorterOffset(p, before, after);
    const maskw steps =
        mine & finite3(p) & ((sideways.x != 0.0f) | (sideways.y != 0.0f) | (sideways.z != 0.0f));
    if (!anyw(steps)) return;
    const Vec3w above = loadPositions(frame, position, x, y > 0 ? y - 1 : min(y + 1, frame->height - 1)),
                below = loadPositions(frame, position, x, y + 1 < frame->height ? y + 1 : max(y, 1u) - 1);
    Patch patch;
    maskw on = steps & patchOf(map, p, scale3(sideways, (floatw)(EVERY)),
                               scale3(shorterOffset(p, above, below), (floatw)(EVERY)), &patch);
    uintw id = (uintw)(1);
#if PEL_FORMAT_MATERIAL
    id = loadId(PEL_FORMAT_MATERIAL, imageSpan(ids, &frame->ids, x, y));
#endif
    // A scattering pixel without irradiance is not lit by any light, so its texel shows something else.
    const maskw dark = (loadw(PEL_PLANE_RED * stride, own) == 0.0f) &
                       (loadw(PEL_PLANE_GREEN * stride, own) == 0.0f) &
                       (loadw(PEL_PLANE_BLUE * stride, own) == 0.0f);
    on &= notw(dark & (as_uintw(loadw(PEL_PLANE_ID * stride, own)) != (uintw)(0)));
    if (!anyw(on)) return;
#define FETCH(k, s) \
    if (on s) fetchDepths(map, first, patch.column s, patch.row s);
    PEL_EACH_LANE(FETCH)
#undef FETCH
#define MARK(k, s)                                                                                    \
    if (on s)                                                                                         \
        markPatch(map, first, seen, patch.column s, patch.row s, patch.depth s, patch.acrossX s,      \
                  patch.acrossY s, patch.slopeX s, patch.slopeY s, patch.most s,                      \
                  id s&& id s < PEL_DIFFUSION_IDS && frame->tableOf[id s] ? min(id s, PEL_SEEN_OTHER) \
                                                                          : PEL_SEEN_OTHER);
    PEL_EACH_LANE(MARK)
#undef MARK
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void light_seen(
    __global const PelDiffusionFrame* restrict frame, __global uchar* position, __global uchar* ids,
    __global const PelLightMap* restrict maps, __global const float* restrict pyramid,
    volatile __global uint* seen, volatile __global uint* counters PEL_LIGHT_BUFFER_ARGUMENTS) {
    const uint across = (frame->width + STEP - 1) / STEP, y = itemOfFolded() / across * EVERY;
    __global const PelLightMap* map = maps + get_global_id(2);
    const uint from = itemOfFolded() % across * STEP, x = vectorStart(from, frame->width);
    __global const PelPyramidLevel* level = &frame->level[0];
    __global const float* own = pyramid + pyramidRow(level, (int)y) + x;
    const uint stride = level->stride;
    // First the region of the work-group.
    __local uint region[4];
    for (uint k = get_local_id(0); k < 4; k += PEL_GROUP) region[k] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    // Columns beyond the picture have no id.
    PEL_ROLL for (uint down = 0; down < EVERY && y + down < frame->height; ++down)
        PEL_ROLL for (uint right = 0; right < STEP; right += PEL_WIDTH)
            widenRegion(map, own + down * PEL_PYRAMID_PLANES * stride + right, stride, region);
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint k = get_local_id(0); k < 4; k += PEL_GROUP)
        if (region[k]) atomic_max(&counters[PEL_LIGHT_REGION(get_global_id(2)) + k], region[k]);
    if (y < frame->height)
        markPatches(frame, map, firstTexel(PEL_LIGHT_BUFFER_OF(map->buffer), &map->map), position, ids, own,
                    x, y, from, seen);
}
