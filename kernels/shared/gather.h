// Constants of methods that gather irradiance by taps, laid out alike on host and device
// (docs/mathematics.md, section 10). Lengths are in the caller's unit.
#pragma once
#include "shared/diffusion.h"

// The surface under each pixel, 12 floats in a row.
#define PEL_GATHER_POINT 0  // x, y, z from PelGatherFrame.origin, area (length^2; 0: no surface)
#define PEL_GATHER_LIGHT 4  // irradiance r, g, b, the bits of an id (0: nothing)
#define PEL_GATHER_PIXEL \
    8  // length of a pixel across the view along x and y, scale of the profile's radius, weight
#define PEL_GATHER_FLOATS 12

// Flags of a tile.
#define PEL_TILE_GATHERS 1  // some pixel gathers
#define PEL_TILE_LIT 2      // some pixel has light that others may gather

#define PEL_GATHER_TURNS 4  // sets of taps at interleaved radii, one for each pixel of 2 x 2

// One tap of a disk, or of a line.
typedef struct PelGatherTap {
    float place[2];  // length, across the view; a line: where it begins and ends
    float place2;    // length^2, from the middle
    float pad;
    float perDensity[4];  // share of the light over R, or the line spread, at its place, per channel and 0
    float share[4];       // of the light, per channel and 0
} PelGatherTap;

typedef struct PelGatherMaterial {
    PelProfileTable table;
    PelUint32 firstTap, taps;  // of one set
    float farthest;            // length, of a tap
    float border[3];           // share of the light that flows in from other ids
    PelUint32 anyBorder;
    PelUint32 pad;
} PelGatherMaterial;

typedef struct PelGatherFrame {
    PelUint32 width;  // pixels
    PelUint32 height;
    PelUint32 tilesX;
    PelUint32 tilesY;
    PelUint32 view;  // PEL_VIEW_...
    PelUint32 frameIndex;
    PelUint32 everywhere;  // 1: pixels that are wider than the profile's radius are gathered too
    PelUint32 inPlace;     // 1: `out` is `irradiance`
    float origin[3];
    float direction[3];  // unit
    float inverseViewProjection[16];
    float historyWeight;
    PelShadeImage irradiance, position, ids, weight, radii, out;
    PelShadeImage motion, blended;              // of frames with a history
    PelUint32 sources[PEL_DIFFUSION_IDS / 32];  // bit i: light of id i may flow to others
    PelUint32 materialOf[PEL_DIFFUSION_IDS];    // 1 + the material of an id; 0: none, it is not gathered
} PelGatherFrame;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(PelGatherTap) == 48 && sizeof(PelGatherMaterial) == sizeof(PelProfileTable) + 32);
static_assert(sizeof(PelGatherFrame) ==
              4 * (8 + 6 + 16 + 1 + PEL_DIFFUSION_IDS / 32 + PEL_DIFFUSION_IDS) + 8 * 32);
#endif
