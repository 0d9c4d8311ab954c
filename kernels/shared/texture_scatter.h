// Constants of scattering in texture space, laid out alike on host and device (docs/mathematics.md, section
// 7).
#pragma once
#include "shared/shade.h"

#define PEL_TEXTURE_TILE 16  // texels along a side

// Per texel: lengths along u and v, and bits along u and v. Bits: how many texels of the same island precede
// it without a gap, and (<< 16) how many follow; 0 without this flag: no triangle covers it.
#define PEL_TEXEL_COVERED 0x8000u

typedef struct PelTextureFrame {
    PelUint32 width;  // texels
    PelUint32 height;
    PelUint32 tilesX;
    PelUint32 triangles;
    float before, after;  // powers of albedo before and after
    PelUint32 pad[2];
    PelShadeImage irradiance, albedo, out;
} PelTextureFrame;

// One Gaussian of the chain.
typedef struct PelTextureBlur {
    float variance;   // length^2: increase over the previous Gaussian's
    float before;     // length^2: variance of the previous Gaussian
    float weight[3];  // of its result, per channel
    PelUint32 down;   // 0: along u, 1: along v, and add
    PelUint32 first;  // 1: nothing was added before
} PelTextureBlur;

// What a PelShader samples for one material.
typedef struct PelTextureSample {
    PelUint32 width;  // pixels
    PelUint32 height;
    PelUint32 tilesX;
    PelUint32 id;
    PelUint32 copies;  // 1: other pixels are copied
    PelUint32 pad[3];
    PelShadeImage texture, uv, ids, irradiance, out;
} PelTextureSample;

#define PEL_COUNT_TEXELS_COVERED 0
#define PEL_COUNT_TEXELS_INVALID 1
#define PEL_COUNT_TEXTURE_TILES 2
#define PEL_TEXTURE_COUNTERS 3

#ifndef __OPENCL_VERSION__
static_assert(sizeof(PelTextureFrame) == 32 + 3 * 32 && sizeof(PelTextureBlur) == 28);
static_assert(sizeof(PelTextureSample) == 32 + 5 * 32);
#endif
