// Irradiance scattered under the surface, gathered on the screen (docs/mathematics.md, sections 9 and 10):
// S(x) = sum over y of R(|x - y|) E(y) A(y), over the pixels near x and over larger blocks further away.
//
// scatter_level has summed the blocks; their sums are interpolated. Tiles flagged NEAR also sum individual
// pixels. The sum is divided by the accumulated weight: surface that the screen does not show is assumed to
// be lit like the rest, except where light_hidden has found occluded light. Inputs: the pyramid, the packed
// flags of classify_scatter, the sums of level 1. Output: an image in the format of the irradiance; pixels
// of other tiles keep their value. One work-group takes tiles, one work-item PEL_WIDTH pixels of a row at a
// time. Variants: PEL_FORMAT_IRRADIANCE, PEL_FORMAT_OUT, PEL_HIDDEN (with shadow maps).
#include "lib/diffusion/item.clh"
#include "lib/diffusion/levels.clh"
#include "lib/image/image.clh"
#include "lib/shading/material_id.clh"

// Scattered light in one channel. `gain`: directedGain; `known`: accumulated weight from level 1 on;
// `hidden...`: light and weight of occluded texels.
static inline floatw lightOf(floatw light, floatw weight, floatw centre, floatw e, floatw gain, floatw known,
                             floatw hiddenLight, floatw hiddenWeight, floatw hiddenFar) {
    const floatw found = weight + centre, any = selectw((floatw)(1.0f), found, found > 0.0f);
    const floatw shown =
        selectw(e * gain, fma(centre * e, directedGainOfCentre(gain, centre), light) / any, found > 0.0f);
#if PEL_HIDDEN
    // Occluded light fills only missing weight. The remainder of the missing weight is taken to be lit like
    // the surface that is shown.
    const floatw missing = max0w(1.0f - known),
                 fills = clamp(2.0f * missing - 2.0f * PEL_MIN_MISSING, (floatw)(0.0f), missing);
    const floatw filled = fmin(hiddenWeight, fills);
    // Where occluded light is most of the light, all of it counts: visible light cannot have been counted
    // in its place.
    const floatw most = satw(PEL_HIDDEN_SLOPE *
                             (hiddenLight / fmax(hiddenLight + shown, (floatw)(FLT_MIN)) - PEL_HIDDEN_FROM));
    const floatw part = filled / fmax(hiddenWeight, (floatw)(FLT_MIN));
    return max0w(shown * (1.0f - filled) + hiddenLight * part + hiddenFar * (most * (1.0f - part))) / gain;
#else
    return max0w(shown) / gain;  // a negative value is an error of the sums
#endif
}

// Near pixels stand for no more than this multiple of their own weight: where they have far less than the
// full weight, the rest lies on other surface.
#define MAX_PER_WEIGHT 3.0f

// Splits the central share of level 1 into the share of the pixel itself and the rest, whose light is the
// mean of the near pixels. These are too few for their weights to add up to the share. A pixel without a
// block, such as one of a thin strand, has only the near pixels.
static inline __attribute__((always_inline)) void addNear(floatw* light, floatw* weight, floatw* centre,
                                                          floatw nearLight, floatw nearWeight, floatw own,
                                                          maskw on) {
    on &= nearWeight > 0.0f;
    const floatw rest =
        selectw(nearWeight, fmin(max0w(*centre - own), MAX_PER_WEIGHT * nearWeight), *centre > 0.0f);
    *light += selectw((floatw)(0.0f), nearLight * (rest / nearWeight), on);
    *weight += selectw((floatw)(0.0f), rest, on);
    *centre = selectw(*centre, selectw(own, *centre - rest, *centre > 0.0f), on);
}

// Whether second differences around a vector of pixels are so large that single pixels have to be summed.
static inline bool pixelsMatter(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                                uint x, uint y) {
    __global const PelPyramidLevel* level = &frame->level[1];
    floatw difference2 = 0.0f;
    for (int row = -1; row <= 1; ++row) {
        __global const float* at = pyramid + pyramidRow(level, (int)(y / 2) + row) + (int)(x / 2) - 1 +
                                   PEL_PLANE_DIFFERENCE2 * level->stride;
#if PEL_WIDTH == 1
        difference2 = fmax(difference2, fmax(at[0], fmax(at[1], at[2])));
#else
        difference2 = fmax(difference2, loadw(0, at));
#endif
    }
    // Only the blocks of the pixels, and one more on each side, matter.
    const maskw far = PEL_ERROR_PER_DIFFERENCE2 * difference2 > PEL_LEFT_OF_PIXELS * frame->tolerance;
    return frame->everyTile || anyw(far & (lanesw() < PEL_WIDTH / 2 + 2));
}

// PEL_WIDTH pixels from (x, y) on, all of one tile.
static PEL_OUT_OF_LINE Vec3w scatterPixels(__global const PelDiffusionFrame* frame,
                                           __global const float* pyramid,
                                           __global const PelProfileTable* tables,
                                           __global const float* nodes, __global const float* sums,
                                           __global const float* hidden, uint x, uint y, bool near,
                                           float weight, const Blocks* here, maskw active) {
    const uint stride = frame->level[0].stride;
    __global const float* at = pyramid + pyramidRow(&frame->level[0], (int)y) + x;
    const Vec3w e = loadPlanes3(at + PEL_PLANE_RED * stride, stride);
    Slope slope = slopeAt(frame, at, stride, here, e, active);
    if (PEL_FORMAT_MEAN_CURVATURE) slope.curvature = loadw(PEL_PLANE_CURVATURE * stride, at);
    // Computed first, so that fewer values are live.
    Sums single = noSums();
    Vec3w own = single.light, gain = same3(1.0f);
    if (near || PEL_FORMAT_MEAN_CURVATURE) {
        const intw table = selectw((intw)(0), tablesOf(frame, here->id), active);
        for (uint t = 1; t <= frame->tables; ++t) {
            const maskw mine = table == (intw)((int)t);
            if (!anyw(mine)) continue;
            const floatw curvature = PEL_TIMES_RADIUS(slope.curvature, here);
            if (PEL_FORMAT_MEAN_CURVATURE)
                gain = select3(
                    gain,
                    vec3(directedGain(tables[t - 1], 0, curvature), directedGain(tables[t - 1], 1, curvature),
                         directedGain(tables[t - 1], 2, curvature)),
                    mine);
            if (!near) continue;
            Sums more = noSums();
            addPixels(at, stride, nodes, tables[t - 1], here, &slope, mine, &more);
            single.light = select3(single.light, more.light, mine);
            single.weight = select3(single.weight, more.weight, mine);
            own = select3(own,
                          shareOfPixelItself(nodes, tables[t - 1], PEL_OVER_RADIUS2(here->area, here),
                                             PEL_OVER_RADIUS2(here->size, here)),
                          mine);
        }
    }
    Interpolated all = interpolateSums(frame, pyramid, sums, hidden, 1, x, y, here, active);
    Sums* s = &all.sums;
    // Pixels are too coarse for their weights to add up: within the ring of level 1 no weight is missing.
    const Vec3w known = add3(s->weight, s->centre);
    if (near) {
        addNear(&s->light.x, &s->weight.x, &s->centre.x, single.light.x, single.weight.x, own.x, active);
        addNear(&s->light.y, &s->weight.y, &s->centre.y, single.light.y, single.weight.y, own.y, active);
        addNear(&s->light.z, &s->weight.z, &s->centre.z, single.light.z, single.weight.z, own.z, active);
    }
    const Vec3w found = vec3(lightOf(s->light.x, s->weight.x, s->centre.x, e.x, gain.x, known.x,
                                     all.hiddenLight.x, all.hiddenWeight.x, all.hiddenFar.x),
                             lightOf(s->light.y, s->weight.y, s->centre.y, e.y, gain.y, known.y,
                                     all.hiddenLight.y, all.hiddenWeight.y, all.hiddenFar.y),
                             lightOf(s->light.z, s->weight.z, s->centre.z, e.z, gain.z, known.z,
                                     all.hiddenLight.z, all.hiddenWeight.z, all.hiddenFar.z));
    return add3(e, scale3(sub3(found, e), (floatw)(weight)));
}

// Prefetches the same rows of the next tile, and the rows beyond its ends.
static inline void fetchNextTile(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                                 __global const float* sums, uint x, uint y) {
    const uint stride = frame->level[0].stride;
    __global const float* at = pyramid + pyramidRow(&frame->level[0], (int)y) + x + PEL_DIFFUSION_TILE;
    for (uint plane = 0; plane < PEL_PYRAMID_PLANES; ++plane) PEL_PREFETCH(at + plane * stride);
    const uint inTile = y % PEL_DIFFUSION_TILE;
    if (inTile < 2 || inTile >= PEL_DIFFUSION_TILE - 2) {
        at += (inTile < 2 ? -2L : 2L) * (long)(stride * PEL_PYRAMID_PLANES);
        for (uint plane = 0; plane < PEL_PLANE_DIFFERENCE2; ++plane) PEL_PREFETCH(at + plane * stride);
    }
    if (inTile % 2 == 0) {
        const uint sumStride = frame->level[1].stride;
        __global const float* sum = sums + sumRow(frame, 1, (int)(y / 2)) + x / 2 + PEL_DIFFUSION_TILE / 2;
        for (uint plane = 0; plane < PEL_SUM_PLANES; ++plane) PEL_PREFETCH(sum + plane * sumStride);
    } else {
        const uint blockStride = frame->level[1].stride;
        __global const float* block =
            pyramid + pyramidRow(&frame->level[1], (int)(y / 2)) + x / 2 + PEL_DIFFUSION_TILE / 2;
        for (uint plane = 0; plane < PEL_PLANE_RED; ++plane) PEL_PREFETCH(block + plane * blockStride);
    }
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void scatter_screen(
    __global const PelDiffusionFrame* restrict frame, __global const float* restrict pyramid,
    __global const PelProfileTable* restrict tables, __global const float* restrict nodes,
    __global const uint* restrict tiles, __global const float* sums, __global const float* restrict hidden,
    __global uchar* irradiance, __global uchar* out, __global uint* restrict counters) {
    // Each group takes a run of adjacent tiles, so that their data stay in the cache.
    const uint count = frame->tilesX * frame->tilesY, groups = get_num_groups(0), group = get_group_id(0);
    const uint end = (uint)((ulong)count * (group + 1) / groups);
    uint pixels = 0, taps = 0;
    for (uint tile = (uint)((ulong)count * group / groups); tile < end; ++tile) {
        const uint word = tiles[tile];
        if (!word && frame->inPlace) continue;
        const uint items = PEL_DIFFUSION_TILE / PEL_WIDTH * PEL_DIFFUSION_TILE;
        for (uint item = get_local_id(0); item < items; item += PEL_GROUP) {
            const uint x = tile % frame->tilesX * PEL_DIFFUSION_TILE +
                           item % (PEL_DIFFUSION_TILE / PEL_WIDTH) * PEL_WIDTH;
            const uint y =
                tile / frame->tilesX * PEL_DIFFUSION_TILE + item / (PEL_DIFFUSION_TILE / PEL_WIDTH);
            if (x >= frame->width || y >= frame->height) continue;
            const uint start = vectorStart(x, frame->width);  // of the images' vectors
            const intw column = lanesw() + (int)x, imageColumn = lanesw() + (int)start;
            if (!frame->inPlace) {
                const Vec3w as =
                    loadColor(PEL_FORMAT_IRRADIANCE, imageSpan(irradiance, &frame->irradiance, start, y));
                storeColor(PEL_FORMAT_OUT, imageSpan(out, &frame->out, start, y), as,
                           (imageColumn >= (int)x) & (imageColumn < (int)frame->width));
                if (!word) continue;
            }
            fetchNextTile(frame, pyramid, sums, x, y);
            const Blocks here =
                loadBlocks(pyramid + pyramidRow(&frame->level[0], (int)y) + x, frame->level[0].stride);
            const maskw active = (column < (int)frame->width) & (here.area > 0.0f);
            if (!anyw(active)) continue;
            const bool near = word & PEL_TILE_NEAR && pixelsMatter(frame, pyramid, x, y);
            const Vec3w s =
                scatterPixels(frame, pyramid, tables, nodes, sums, word & PEL_TILE_HIDDEN ? hidden : NULL, x,
                              y, near, unpackedWeight(word), &here, active);
            storeColor(PEL_FORMAT_OUT, imageSpan(out, &frame->out, x, y), s, active);
            const uint covered = countw(active);
            pixels += covered;
            if (near) taps += PEL_BAND * covered;
        }
    }
    PEL_ADD_COUNT(&counters[PEL_COUNT_PIXELS_TAPPED], pixels);
    PEL_ADD_COUNT(&counters[PEL_COUNT_TAPS], taps);
}
