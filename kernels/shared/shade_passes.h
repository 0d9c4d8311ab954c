// Constants of the passes that run before shade.cl, with the same layout on host and device. Units as in
// shared/shade.h.
#pragma once
#include "shared/shade.h"

#define PEL_BLUR_TAPS 6  // of the normal blur, to each side
#define PEL_BLUR_STEP_MAX \
    64  // pixels from tap to tap: a close-up is blurred over no more than 384 pixels to each side
#define PEL_BLUR_GAP 3  // a step this many times longer than the one before is a depth edge
// Values before the first and after the last pixel of a scratch plane: the farthest tap and a vector, so that
// no load is cut.
#define PEL_PLANE_GUARD (PEL_BLUR_TAPS * PEL_BLUR_STEP_MAX + 16)
#define PEL_MAP_LEVELS 16  // of a normal map

#define PEL_BOUNDS_BLOCK 8  // texels along a side of the blocks whose min and max depth are stored

// Which pixels a pass computes (lib/shading/between.clh).
#define PEL_PIXELS_ALL 0
#define PEL_PIXELS_SECOND 1   // of every second column and row, from the first on
#define PEL_PIXELS_BETWEEN 2  // the others, interpolated where that is accurate enough
#define PEL_BETWEEN_ROWS 2    // of tiles whose values are read before and after a row of tiles

// One light's wide shadow, made from its shadow map or from one of its cascades. For a cube, worldToShadow
// maps to the cube's space; right, down, forward, extent, centre and zPerLength are not used.
typedef struct PelWideShadow {
    float worldToShadow[16];
    float right[3];        // unit, world: along +u
    float down[3];         // unit, world: along +v
    float forward[3];      // unit, world: away from the light
    float extent[2];       // length that u, v from 0 to 1 span; perspective: at distance 1 along forward
    float centre[2];       // u, v that lies straight ahead; perspective
    PelUint32 projection;  // PelShadowProjection
    float zPerLength;      // parallel: depth per length along forward, 1/length
    float depthA;          // perspective, cube: distance = 1 / (A z + B), 1/length
    float depthB;
    float depthRange;    // radial cube: distance from the light per unit of depth, length
    float exponent;      // exponential maps: c / ln 2
    float perExponent;   // 1 / that
    float minDeviation;  // moments: length
    float bleeding;      // moments: share of light that counts as none
    float bias;          // length; this and the next two: negative values mean the material's own
    float softness;      // of the filter's width
    float coneSlope;     // length per length
    float maxTexels;     // across the filter
    PelUint32 light;     // number of the light
    PelUint32 cascades;  // number of maps, from this one on; 0: a single map
    PelUint32 bounds;    // where the bounds of the map's blocks begin (lib/shading/shadow_bounds.clh)
    PelShadeImage map;
    PelShadeImage out;  // R32F
} PelWideShadow;

// The levels of one material's normal map.
typedef struct PelNormalMap {
    PelShadeImage levels[PEL_MAP_LEVELS];
    PelUint32 count;
    PelUint32 material;  // its id
    PelUint32 fallback;  // 1: materials without a map get their geometric normal from this launch
    float baseLevel;     // log2(max(size radius, uvScale) / uvScale)
} PelNormalMap;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(PelWideShadow) == 4 * (16 + 9 + 4 + 16) + 64);
static_assert(sizeof(PelNormalMap) == PEL_MAP_LEVELS * 32 + 16);
#endif
