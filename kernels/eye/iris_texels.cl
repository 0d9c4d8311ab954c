// Albedo of an iris in the layout that shading samples: float4 texels with a copied column and row
// (shared/lut.h), from the caller's square image or drawn as fibres, with smaller levels for distant eyes.
// The fourth component is 1 inside the rim, so that texels outside do not darken smaller levels.
//
// One work-item: one texel of the padded square, or of a level. Variants: PEL_FORMAT_IRIS, the format of the
// image; 0: the iris is drawn from `seed`. PEL_WIDTH is 1.
#include "lib/image/image.clh"
#include "shared/eye.h"

#if !PEL_FORMAT_IRIS
// A number from 0 to 1 for each whole number [Wellons, hash32: lowbias32].
static inline float noiseAt(uint n, uint seed) {
    uint h = n + seed * 0x9e3779b9u;
    h ^= h >> 16;
    h *= 0x7feb352du;
    h ^= h >> 15;
    h *= 0x846ca68bu;
    h ^= h >> 16;
    return (float)(h >> 8) * (1.0f / 16777216.0f);
}

// Smooth noise of `count` values round a circle; turn from 0 to 1.
static inline float noiseRound(float turn, uint count, uint seed) {
    const float at = turn * (float)count;
    const uint i = min((uint)at, count - 1);
    const float f = at - (float)i, t = f * f * (3.0f - 2.0f * f);
    return mix(noiseAt(i, seed), noiseAt((i + 1) % count, seed), t);
}

// Brightness about 1: fibres from pupil to rim, a bright wavy ring a third of the way out (the collarette),
// and a dark rim.
static inline float drawn(float x, float y, uint seed) {
    const float r = fmin(hypot(x, y), 1.0f), turn = clamp(atan2(y, x) * 0.159154943f + 0.5f, 0.0f, 1.0f);
    const float bent = turn + 0.004f * (noiseRound(turn, 40, seed + 7u) - 0.5f) * sin(9.0f * r);
    const float around = bent - floor(bent);
    const float fibres = 0.55f * noiseRound(around, 180, seed) + 0.3f * noiseRound(around, 420, seed + 1u) +
                         0.15f * noiseRound(around, 61, seed + 2u);
    const float ring = 0.48f + 0.05f * (noiseRound(turn, 23, seed + 3u) - 0.5f), d = (r - ring) / 0.07f;
    const float inner = smoothstep(ring + 0.06f, ring - 0.06f, r);
    const float rim = 1.0f - 0.7f * smoothstep(0.8f, 1.0f, r);
    return (0.45f + 1.1f * fibres * mix(1.0f, 0.75f, inner) + 0.35f * exp(-d * d)) * rim;
}
#endif

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void iris_texels(
    __global const uchar* restrict image, ulong offset, ulong row, ulong plane, uint pixel, uint size,
    uint seed, uint first, __global float4* restrict texels) {
    const uint i = get_global_id(0), j = get_global_id(1);
    if (i > size) return;
    const uint x = min(i, size - 1), y = min(j, size - 1);
#if PEL_FORMAT_IRIS
    __global const uchar* p = image + offset + y * row + (ulong)x * pixel;
    float4 texel = (float4)(0.0f);
    texel.x = pixelComponent(PEL_FORMAT_IRIS, p, plane, 0);
    texel.y = pixelComponent(PEL_FORMAT_IRIS, p, plane, 1);
    texel.z = pixelComponent(PEL_FORMAT_IRIS, p, plane, 2);
#else
    const float side = 2.0f / (float)size;
    const float value = drawn(((float)x + 0.5f) * side - 1.0f, ((float)y + 0.5f) * side - 1.0f, seed);
    float4 texel = (float4)(value, value, value, 0.0f);
#endif
    const float middle = 0.5f * (float)size;
    texel.w = hypot((float)x + 0.5f - middle, (float)y + 0.5f - middle) < middle + 0.7f ? 1.0f : 0.0f;
    texels[first + (size_t)j * irisRowTexels(size) + i] = texel;
}

// A level from the next finer one: means over the area of each texel.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void iris_level(
    const uint size, const uint level, const uint first, __global float4* restrict texels) {
    const uint i = get_global_id(0), j = get_global_id(1);
    const uint side = size >> level, finer = size >> (level - 1);
    if (i > side) return;
    const uint row = irisRowTexels(size);
    __global const float4* from = texels + first + irisLevelStart(size, level - 1);
    const float scale = (float)finer / (float)side;
    const float x0 = (float)min(i, side - 1) * scale, y0 = (float)min(j, side - 1) * scale;
    const float x1 = fmin(x0 + scale, (float)finer), y1 = fmin(y0 + scale, (float)finer);
    float4 all = (float4)(0.0f), within = (float4)(0.0f);
    for (uint y = (uint)y0; (float)y < y1; ++y)
        for (uint x = (uint)x0; (float)x < x1; ++x) {
            const float4 texel = from[(size_t)y * row + x];
            const float share = (fmin(x1, (float)(x + 1)) - fmax(x0, (float)x)) *
                                (fmin(y1, (float)(y + 1)) - fmax(y0, (float)y));
            all += share * (float4)(texel.xyz, 1.0f);
            if (texel.w > 0.0f) within += share * texel.w * (float4)(texel.xyz, 1.0f);
        }
    const float4 sum = within.w > 0.0f ? within : all;
    texels[first + irisLevelStart(size, level) + (size_t)j * row + i] =
        (float4)(sum.xyz / sum.w, within.w / all.w);
}
