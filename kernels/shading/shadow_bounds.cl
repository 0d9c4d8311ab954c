// Bounds of every block of a shadow map, for lib/shading/shadow_bounds.clh: the mean slope along x and y, and
// the least and greatest depth minus the plane of that slope through 0 at the block's middle.
//
// Input: a map of depths, or of moments or exponentials of depths. Output: four planes of one float per block; depths are multiplied
// by the sign with which they grow away from the light. Texels with NaN or Inf cast no shadow: they count as infinitely far,
// and their block as level. One work-item: one block. Nothing is written if so few tiles have a material that
// reading the map would cost more than their filters.
#include "lib/shading/shadow_bounds.clh"

// PEL_BOUNDS_BLOCK texels of a row; after its end the last texel again.
static inline float8 boundsTexels(__global const uchar* row, __global const PelShadeImage* map, uint column) {
    if (column + PEL_BOUNDS_BLOCK <= map->width) {
        if (PEL_FORMAT_SHADOW_MAP == PEL_FMT_R32F) return vload8(0, (__global const float*)row + column);
        if (PEL_FORMAT_SHADOW_MAP == PEL_FMT_RG32F)
            return vload16(0, (__global const float*)row + 2 * column).even;
    }
#define PEL_AT_(k)                                                                                          \
    pixelComponent(PEL_FORMAT_SHADOW_MAP, row + (size_t)min(column + k, map->width - 1) * map->pixelStride, \
                   0, 0)
    return (float8)(PEL_AT_(0), PEL_AT_(1), PEL_AT_(2), PEL_AT_(3), PEL_AT_(4), PEL_AT_(5), PEL_AT_(6),
                    PEL_AT_(7));
#undef PEL_AT_
}

static inline float sum4(float4 v) {
    return (v.x + v.y) + (v.z + v.w);
}

__kernel __attribute__((reqd_work_group_size(PEL_BOUNDS_GROUP, 1, 1))) void shadow_bounds(
    __global const PelShadeFrame* frame, __global const uint* list, __global const PelWideShadow* cascades,
    uint cascade, __global uchar* mapBuffer, __global float* bounds) {
    __global const PelWideShadow* light = cascades + cascade;
    __global const PelShadeImage* map = &light->map;
    const uint columns = boundsBlocks(map->width), plane = boundsPlane(map), block = get_global_id(0);
    if (block >= plane || !boundsPay(frame, list, map)) return;
    const uint x = block % columns * PEL_BOUNDS_BLOCK, y = block / columns * PEL_BOUNDS_BLOCK;
    const bool falls = PEL_SHADOW_CONTENT == PEL_CONTENT_EXPONENTIAL ? light->exponent < 0.0f
                       : light->projection == PEL_MAP_PARALLEL       ? light->zPerLength < 0.0f
                                                                     : light->depthA > 0.0f;
    __global const uchar* first = firstTexel(mapBuffer, map);
    float8 depth[PEL_BOUNDS_BLOCK], sums = 0.0f;
    float slopeY = 0.0f;
    for (uint k = 0; k < PEL_BOUNDS_BLOCK; ++k) {
        float8 z = boundsTexels(first + (size_t)min(y + k, map->height - 1) * map->rowStride, map, x);
        if (PEL_SHADOW_CONTENT == PEL_CONTENT_EXPONENTIAL)
            z = select((float8)(NAN), log2(z) * light->perExponent, z > 0.0f);
        depth[k] = select((float8)(INFINITY), falls ? -z : z, (as_int8(z) & 0x7f800000) != 0x7f800000);
        sums += depth[k];
        const float across = sum4(depth[k].lo + depth[k].hi);
        slopeY += k < PEL_BOUNDS_BLOCK / 2 ? -across : across;
    }
    // The middles of a block's halves lie half a block apart.
    const float perSlope = 4.0f / (PEL_BOUNDS_BLOCK * PEL_BOUNDS_BLOCK * PEL_BOUNDS_BLOCK);
    float slopeX = (sum4(sums.hi) - sum4(sums.lo)) * perSlope;
    slopeY *= perSlope;
    if ((as_int(slopeX + slopeY) & 0x7f800000) == 0x7f800000) slopeX = slopeY = 0.0f;
    const float8 offsets = (float8)(0, 1, 2, 3, 4, 5, 6, 7) - PEL_BLOCK_HALF;
    float8 least = INFINITY, most = -INFINITY;
    for (uint k = 0; k < PEL_BOUNDS_BLOCK; ++k) {
        const float8 rest = depth[k] - (slopeX * offsets + slopeY * ((float)k - PEL_BLOCK_HALF));
        least = fmin(least, rest);
        most = fmax(most, rest);
    }
    const float4 least4 = fmin(least.lo, least.hi), most4 = fmax(most.lo, most.hi);
    __global float* to = bounds + light->bounds + block;
    to[0] = fmin(fmin(least4.x, least4.y), fmin(least4.z, least4.w));
    to[plane] = fmax(fmax(most4.x, most4.y), fmax(most4.z, most4.w));
    to[2 * (size_t)plane] = slopeX;
    to[3 * (size_t)plane] = slopeY;
}
