// Light that occluded shadow-map texels bring to blocks of 2 x 2 pixels (docs/mathematics.md, section 10,
// "Light space").
//
// Input: the screen's pyramid, the packed flags of its tiles, the sums of level 1, the light that
// light_classify has found per tile, the pyramids of the lights. Output: light, weight and far light per
// block of flagged tiles, and zeros in the tiles beside them, which interpolation reads. One work-group
// takes tiles, one work-item blocks of them. Variants: PEL_HIDDEN is 1.
#include "lib/diffusion/item.clh"
#include "lib/diffusion/levels.clh"
#include "lib/diffusion/windowed.clh"

#define WINDOW 1.5f
// Adds the light of all lights, and takes the largest weight of any light.
static PEL_OUT_OF_LINE void addHidden(__global const PelLightMap* maps, uint mapCount,
                                      __global const float* lights, __global const float* nodes,
                                      const PelProfileTable table, Receiver* receiver, float3* light,
                                      float3* weight, float3* far, uint* texels) {
    for (uint k = 0; k < mapCount;) {
        Windowed sums;
        clearWindowed(&sums);
        const uint number = maps[k].light;
        const float3 color = vload3(0, maps[k].color);
        for (; k < mapCount && maps[k].light == number; ++k)
            *texels += addMap(&sums, maps + k, lights, nodes, table, receiver, 0, 1);
        const float3 all = sumOfLanes3(sums.farLight);
        *light += color * all;
        *far += color * (all - sumOfLanes3(sums.nearLight));
        *weight = fmax(*weight, sumOfLanes3(sums.farWeight));
    }
}

static inline float missingOf(__global const float* sums, uint stride) {
    float most = 0.0f;
    for (uint c = 0; c < 3; ++c)
        most = fmax(most, 1.0f - sums[(PEL_SUM_CENTRE + c) * stride] - sums[(PEL_SUM_WEIGHT + c) * stride]);
    return most;
}

// Whether occluded light of up to `most` counts: because accumulated weight is missing, or because it is
// most of the light in some channel.
static inline bool lightCounts(__global const float* sums, __global const float* block, uint stride,
                               float most) {
    if (missingOf(sums, stride) > PEL_MIN_MISSING) return true;
    float least = FLT_MAX;
    for (uint c = 0; c < 3; ++c)
        least = fmin(least, fma(sums[(PEL_SUM_CENTRE + c) * stride], block[(PEL_PLANE_RED + c) * stride],
                                sums[(PEL_SUM_LIGHT + c) * stride]));
    return most > PEL_HIDDEN_FROM * (most + least);
}

// Flagged tiles interpolate between their own blocks and those of their neighbours.
static inline bool isBesideReached(__global const PelDiffusionFrame* frame, __global const uint* tiles,
                                   uint tile) {
    const int x = (int)(tile % frame->tilesX), y = (int)(tile / frame->tilesX);
    for (int j = max(y - 1, 0); j <= min(y + 1, (int)frame->tilesY - 1); ++j)
        for (int i = max(x - 1, 0); i <= min(x + 1, (int)frame->tilesX - 1); ++i)
            if (tiles[j * (int)frame->tilesX + i] & PEL_TILE_HIDDEN) return true;
    return false;
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void light_hidden(
    __global const PelDiffusionFrame* restrict frame, __global const float* restrict pyramid,
    __global const PelProfileTable* restrict tables, __global const float* restrict nodes,
    __global const uint* restrict tiles, __global const float* sums, __global const uint* restrict change,
    __global const PelLightMap* restrict maps, uint mapCount, __global const float* restrict lights,
    __global float* hidden, __global uint* restrict counters) {
    const uint count = frame->tilesX * frame->tilesY, side = PEL_DIFFUSION_TILE / 2;
    __global const PelPyramidLevel* level = &frame->level[1];
    const uint stride = level->stride;
    uint texels = 0, pixels = 0;
    for (uint tile = get_group_id(0); tile < count; tile += get_num_groups(0)) {
        const bool reached = tiles[tile] & PEL_TILE_HIDDEN;
        if (!reached && !isBesideReached(frame, tiles, tile)) continue;
        for (uint item = get_local_id(0); item < side * side; item += PEL_GROUP) {
            const uint x = tile % frame->tilesX * side + item % side,
                       y = tile / frame->tilesX * side + item / side;
            if (x >= level->width || y >= level->height) continue;
            __global const float* block = pyramid + pyramidRow(level, (int)y) + x;
            float3 light = (float3)(0.0f), weight = (float3)(0.0f), far = (float3)(0.0f);
            const uint id = as_uint(block[PEL_PLANE_ID * stride]);
            if (reached && block[PEL_PLANE_AREA * stride] > 0.0f &&
                lightCounts(sums + sumRow(frame, 1, (int)y) + x, block, stride, as_float(change[tile]))) {
                Receiver receiver;
                receiver.id = id;
                receiver.margin = 0.0f;
                const float step = sqrt(fmax(block[PEL_PLANE_SIZE * stride], FLT_MIN));
                receiver.rho = WINDOW * fmax(block[PEL_PLANE_AREA * stride] / (4.0f * step), step);
                receiver.p = pointAt(block, stride);
                const PelProfileTable table = tableAt(tables + frame->tableOf[id] - 1, block, stride);
                receiver.directed = table.directed;
                receiver.curvature = 0.0f;
                if (PEL_FORMAT_MEAN_CURVATURE) {  // of a pixel
                    const uint pixels = frame->level[0].stride;
                    receiver.curvature = pyramid[pyramidRow(&frame->level[0], (int)(2 * y)) + 2 * x +
                                                 PEL_PLANE_CURVATURE * pixels];
                }
                receiver.normal = outwardNormal(frame, block, stride);
                addHidden(maps, mapCount, lights, nodes, table, &receiver, &light, &weight, &far, &texels);
                ++pixels;
            }
            __global float* to = hidden + hiddenRow(frame, (int)y) + x;
            to[0] = light.x, to[stride] = light.y, to[2 * stride] = light.z;
            to[3 * stride] = weight.x, to[4 * stride] = weight.y, to[5 * stride] = weight.z;
            to[6 * stride] = far.x, to[7 * stride] = far.y, to[8 * stride] = far.z;
        }
    }
    PEL_ADD_COUNT(&counters[PEL_COUNT_LIGHT_PIXELS], pixels);
    PEL_ADD_COUNT(&counters[PEL_COUNT_LIGHT_TEXELS], texels);
}
