// Constants of a pass over the screen, with the same layout on host and device.
#pragma once
#include "shared/shade.h"

typedef struct ScreenCurvatureFrame {
    PelUint32 width;  // pixels
    PelUint32 height;
    float scale;                      // multiplies the result
    float edge;                       // sine between a step and the surface from which it crosses an edge
    float inverseViewProjection[16];  // clip to world, for depth
    PelShadeImage normal, position, ids, curvature;  // position: or depth
} ScreenCurvatureFrame;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(ScreenCurvatureFrame) == 20 * 4 + 4 * sizeof(PelShadeImage));
#endif
