// Constants of the mean curvature per pixel, with the same layout on host and device (docs/mathematics.md,
// section 12).
#pragma once
#include "shared/shade.h"

#define PEL_CURVATURE_IDS 256

typedef struct PelMeanCurvature {
    PelUint32 width;  // pixels
    PelUint32 height;
    PelUint32 pad[2];
    float inverseViewProjection[16];
    PelShadeImage normal, position, ids, out;  // position: or depth
    float window[PEL_CURVATURE_IDS];  // length over which it is measured, per material; 0: not at all
} PelMeanCurvature;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(PelMeanCurvature) == 4 * (4 + 16 + PEL_CURVATURE_IDS) + 4 * 32);
#endif
