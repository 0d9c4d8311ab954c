// Constants of the steps before and after the scattering methods, laid out alike on host and device.
#pragma once
#include "shared/diffusion.h"

typedef struct PelBlendMaterial {
    float albedo[3];  // without an albedo image
    // powers of albedo that irradiance is multiplied by before it is scattered, and after
    float before, after;
    float through[3];  // share of the light on the other side
    PelUint32 weighs;  // 1: the weights per pixel are still to be applied
    float gain[3];     // length: mean free path; 0: none
    float gainSlope[3], gainSaturation[3];
    PelUint32 pad[2];
} PelBlendMaterial;

typedef struct PelBlendFrame {
    PelUint32 width;  // pixels
    PelUint32 height;
    PelUint32 accumulate;  // 1: add to what `out` holds
    PelUint32 pad;
    PelShadeImage irradiance, scattered, material, back, weight, albedo, curvature, out;
    PelUint32 materialOf[PEL_DIFFUSION_IDS];  // of an id; entry 0 is for ids that do not scatter
} PelBlendFrame;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(PelBlendMaterial) == 80 && sizeof(PelBlendFrame) == 16 + 8 * 32 + 4 * PEL_DIFFUSION_IDS);
#endif
