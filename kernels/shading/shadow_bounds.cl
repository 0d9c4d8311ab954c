// Bounds of every block of a shadow map, for lib/shading/shadow_bounds.clh: the mean slope along x and y, and
// the min and max of depth minus the plane of that slope through 0 at the block's middle.
//
// Input: a map of depths, or of moments or exponentials of depths. Output: four planes of one float per
// block; depths are multiplied by the sign with which they grow away from the light. Texels with NaN or Inf
// cast no shadow: they count as infinitely far, and their block gets no slope. One work-item: two blocks side
// by side. Nothing is written if so few tiles have a material that reading the map would cost more than their
// filters, unless the bounds are `kept` for later frames and other views.
#include "lib/shading/shadow_bounds.clh"

// The texels of a row of two blocks; beyond its end the last texel is repeated.
static inline float16 boundsTexels(__global const uchar* row, __global const PelShadeImage* map,
                                   uint column) {
    if (column + 2 * PEL_BOUNDS_BLOCK <= map->width) {
        __global const float* at = (__global const float*)row;
        if (PEL_FORMAT_SHADOW_MAP == PEL_FMT_R32F) return vload16(0, at + column);
        if (PEL_FORMAT_SHADOW_MAP == PEL_FMT_RG32F)
            return (float16)(vload16(0, at + 2 * column).even,
                             vload16(0, at + 2 * (column + PEL_BOUNDS_BLOCK)).even);
    }
#define PEL_AT_(k)                                                                                          \
    pixelComponent(PEL_FORMAT_SHADOW_MAP, row + (size_t)min(column + k, map->width - 1) * map->pixelStride, \
                   0, 0)
    return (float16)(PEL_AT_(0), PEL_AT_(1), PEL_AT_(2), PEL_AT_(3), PEL_AT_(4), PEL_AT_(5), PEL_AT_(6),
                     PEL_AT_(7), PEL_AT_(8), PEL_AT_(9), PEL_AT_(10), PEL_AT_(11), PEL_AT_(12), PEL_AT_(13),
                     PEL_AT_(14), PEL_AT_(15));
#undef PEL_AT_
}

static inline float sum4(float4 v) {
    return (v.x + v.y) + (v.z + v.w);
}

static inline float least4(float4 v) {
    return fmin(fmin(v.x, v.y), fmin(v.z, v.w));
}

static inline float16 spread2(float first, float second) {
    return (float16)((float8)(first), (float8)(second));
}

// Slopes of a block from the sums of its columns, and from the lower half of each column minus the upper
// half. The middles of a block's halves lie half a block apart.
static inline float2 blockSlopes(float8 columns, float8 downwards) {
    const float perSlope = 4.0f / (PEL_BOUNDS_BLOCK * PEL_BOUNDS_BLOCK * PEL_BOUNDS_BLOCK);
    const float2 slope =
        (float2)(sum4(columns.hi) - sum4(columns.lo), sum4(downwards.lo + downwards.hi)) * perSlope;
    return (as_int(slope.x + slope.y) & 0x7f800000) == 0x7f800000 ? (float2)(0.0f) : slope;
}

static inline void storeBlock(__global float* to, uint plane, float8 least, float8 most, float2 slope) {
    to[0] = least4(fmin(least.lo, least.hi));
    to[plane] = -least4(fmin(-most.lo, -most.hi));
    to[2 * (size_t)plane] = slope.x;
    to[3 * (size_t)plane] = slope.y;
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void shadow_bounds(
    __global const PelShadeFrame* restrict frame, __global const uint* restrict list,
    __global const PelWideShadow* restrict cascades, uint cascade, __global uchar* restrict mapBuffer,
    __global float* restrict bounds, uint kept) {
    __global const PelWideShadow* light = cascades + cascade;
    __global const PelShadeImage* map = &light->map;
    const uint columns = boundsBlocks(map->width), plane = boundsPlane(map), pairs = (columns + 1) / 2,
               pair = get_global_id(0);
    if (pair >= pairs * boundsBlocks(map->height) || !(kept || boundsPay(frame, list, map))) return;
    const uint column = 2 * (pair % pairs), row = pair / pairs, y = row * PEL_BOUNDS_BLOCK;
    const bool falls = PEL_SHADOW_CONTENT == PEL_CONTENT_EXPONENTIAL ? light->exponent < 0.0f
                       : light->projection == PEL_MAP_PARALLEL       ? light->zPerLength < 0.0f
                                                                     : light->depthA > 0.0f;
    __global const uchar* first = firstTexel(mapBuffer, map);
    float16 depth[PEL_BOUNDS_BLOCK], sums = 0.0f, downwards = 0.0f;
#pragma unroll
    for (uint k = 0; k < PEL_BOUNDS_BLOCK; ++k) {
        float16 z = boundsTexels(first + (size_t)min(y + k, map->height - 1) * map->rowStride, map,
                                 column * PEL_BOUNDS_BLOCK);
        if (PEL_SHADOW_CONTENT == PEL_CONTENT_EXPONENTIAL)
            z = select((float16)(NAN), log2(z) * light->perExponent, z > 0.0f);
        depth[k] = select((float16)(INFINITY), falls ? -z : z, (as_int16(z) & 0x7f800000) != 0x7f800000);
        sums += depth[k];
        downwards += k < PEL_BOUNDS_BLOCK / 2 ? -depth[k] : depth[k];
    }
    const float2 slope0 = blockSlopes(sums.lo, downwards.lo), slope1 = blockSlopes(sums.hi, downwards.hi);
    const float8 across = (float8)(0, 1, 2, 3, 4, 5, 6, 7) - PEL_BLOCK_HALF;
    const float16 slopeX = spread2(slope0.x, slope1.x) * (float16)(across, across),
                  slopeY = spread2(slope0.y, slope1.y);
    float16 least = INFINITY, most = -INFINITY;
#pragma unroll
    for (uint k = 0; k < PEL_BOUNDS_BLOCK; ++k) {
        const float16 rest = depth[k] - (slopeX + slopeY * ((float)k - PEL_BLOCK_HALF));
        least = rest < least ? rest : least;  // not fmin, which also looks for NaN
        most = rest > most ? rest : most;
    }
    __global float* to = bounds + light->bounds + (size_t)row * columns + column;
    storeBlock(to, plane, least.lo, most.lo, slope0);
    if (column + 1 < columns) storeBlock(to + 1, plane, least.hi, most.hi, slope1);
}
