// Constants of scattering on the screen, with the same layout on host and device (docs/mathematics.md,
// sections 9 and 10). Lengths are in the caller's unit.
#pragma once
#include "shared/shade.h"

// The surface as a pyramid of blocks of 2^l x 2^l pixels. A level is rows of planes: row y of plane p begins
// at offset + ((y + PEL_PYRAMID_ROWS) PEL_PYRAMID_PLANES + p) stride + PEL_PYRAMID_GUARD. Blocks outside the
// image have no area.
#define PEL_PYRAMID_LEVELS 8
#define PEL_PYRAMID_GUARD 16  // blocks before and after a row
#define PEL_PYRAMID_ROWS 4    // rows before the first and after the last
#define PEL_PLANE_AREA 0      // length^2 of surface
#define PEL_PLANE_ID 1        // the bits of an id, 0: nothing
#define PEL_PLANE_X 2         // length, from PelDiffusionFrame.origin: the mean over the block's surface
#define PEL_PLANE_Y 3
#define PEL_PLANE_Z 4
#define PEL_PLANE_RED 5  // irradiance
#define PEL_PLANE_GREEN 6
#define PEL_PLANE_BLUE 7
#define PEL_PLANE_DIFFERENCE2 8  // largest second difference of irradiance between blocks one level finer
#define PEL_PLANE_CURVATURE 8    // level 0 keeps the mean curvature there instead, 1/length
#define PEL_PLANE_SIZE 9         // length^2, of a pixel: the smaller of the squared steps to the next one
#define PEL_PLANE_RADIUS 10      // factor of the profile's radius; only with PEL_RADII, where it varies
#ifndef PEL_RADII
#define PEL_RADII 0
#endif
#define PEL_PYRAMID_PLANES (10 + PEL_RADII)
#define PEL_MIN_RADIUS 0.015625f  // smaller factors of the radius count as this one
#define PEL_MAX_RADIUS 4.0f

// Light that flows in to the blocks of a level from it and from all coarser ones: laid out as the pyramid,
// from level 1 on.
#define PEL_SUM_LIGHT 0   // three planes: irradiance times weight
#define PEL_SUM_WEIGHT 3  // three: accumulated weight, the share of the profile that was found
#define PEL_SUM_CENTRE 6  // three: the share of the nearer surface, which is not summed
#define PEL_SUM_PLANES 9

#define PEL_HIDDEN_PLANES \
    9  // occluded light for blocks of level 1: three planes each of light, weight and distant light

// Packed tile flags: these bits, levels << 8, weight of the scattered light << 24. 0: nothing scatters.
#define PEL_TILE_NEAR 1u            // single pixels are summed too, not only blocks
#define PEL_MIN_LEVELS 3u           // of a tile that scatters
#define PEL_TILE_HIDDEN (1u << 16)  // occluded light may come in
#define PEL_DIFFUSION_TILE 16       // pixels along a side: blocks of level 4
#define PEL_TILE_LEVEL 4
#define PEL_PART_LEVEL 2  // level of the blocks that are the parts of a tile for light from shadow maps
#define PEL_DIFFUSION_IDS 256
#define PEL_MAX_IRRADIANCE 1e15f  // larger values count as invalid: sums over areas would overflow

// A profile as three tables over the squared distance, four floats a node: R (1/length^2), the share of the
// light that stays within, and the mean of R over a block of a ring at that distance. Nodes are equally
// spaced in the bits of a float, PEL_PROFILE_NODES to the octave. From the last node on R is 0 and the
// share 1.
//
// After the nodes follow R, the mean over a block, and V (docs/mathematics.md, section 12, "Slabs") as sums
// of PEL_PROFILE_TERMS Gaussians, four floats a term. Term i is exp2(-widest 2^i d^2), so each is the square
// of the one before, and a vector of distances needs no look-up.
#define PEL_PROFILE_TERMS 16
#define PEL_PROFILE_NODES 16
#define PEL_PROFILE_NODE_BITS 19  // 23 bits of mantissa, less those of a node
// Light through the body (docs/mathematics.md, section 12, "Slabs"): q is PEL_SLAB_FIRST, plus
// PEL_SLAB_SPREAD times the root of the thickness in mean free paths.
#define PEL_SLAB_FIRST 1.42f
#define PEL_SLAB_SPREAD 0.96
#define PEL_SLAB_MOST 1.05f  // upper bound of the light at any angle, over the light along the normal
// Where light counts as through a slab: the cosine to a sample, less a sphere's, rises from the first value
// to the second, and the receiver's cosine to the light is below the third.
#define PEL_SLAB_FROM 0.08f
#define PEL_SLAB_COSINE 0.25
#define PEL_SLAB_TURNED 0.3f
#define PEL_SLAB_TERMS 14  // Gaussians in use: the others are narrower than the texels of any map
// Width of such blocks over their distance: the root of the mean square over a ring around a point,
// weighted by an R that falls as distance^-1.5.
#define PEL_BLOCK_WIDTH 0.431
typedef struct PelProfileTable {
    PelUint32 offset;  // of the first node, nodes
    PelUint32 nodes;
    PelUint32 firstBits;    // of the first node's squared distance
    float reach;            // length beyond which nothing is left
    float widest;           // 1/length^2: the widest Gaussian is exp2(-widest d^2)
    float directed;         // R has the factor 1 + directed t, t: cosine from the inward normal to the sample
    float perCurvature[3];  // length: first-order gain of uniform light by that, per curvature
    float slab;             // 0 to 1: the share of light through the body that counts as through a slab
    float spread[3];   // 1/sqrt(length): how much narrower light leaves a slab by the root of its thickness
    float perRadius2;  // factor of squared lengths: 1, or 1 / the receiver's squared radius factor
    float path[3];     // length: mean free path where a slab of the medium keeps less light; 0: it does not
    float absorption[3];  // sqrt(1 - albedo of the medium)
} PelProfileTable;

typedef struct PelPyramidLevel {
    PelUint32 offset;  // floats
    PelUint32 stride;  // floats, a multiple of 16
    PelUint32 width;   // blocks
    PelUint32 height;
} PelPyramidLevel;

// How a picture is seen.
#define PEL_VIEW_UNKNOWN 0
#define PEL_VIEW_POINT 1      // from `origin`
#define PEL_VIEW_DIRECTION 2  // along `direction`

typedef struct PelDiffusionFrame {
    PelUint32 width;  // pixels
    PelUint32 height;
    PelUint32 tilesX;
    PelUint32 tilesY;
    PelUint32 levels;     // of the pyramid, level 0 included
    PelUint32 everyTile;  // 1: all tiles and all levels are computed
    PelUint32 inPlace;    // 1: `out` is `irradiance`
    PelUint32 tables;
    PelUint32 view;      // PEL_VIEW_...
    float tolerance;     // of irradiance
    float origin[3];     // length, world; of the pyramid's positions
    float direction[3];  // unit, away from the camera
    float inverseViewProjection[16];
    PelShadeImage irradiance, position, ids, out, curvature, radii, thickness;  // position: or depth
    PelPyramidLevel level[PEL_PYRAMID_LEVELS];
    PelUint32 tableOf[PEL_DIFFUSION_IDS];  // 1 + the table of an id; 0: the id does not scatter
} PelDiffusionFrame;

// Counters.
#define PEL_COUNT_TILES_COVERED 0  // tiles with pixels that scatter
#define PEL_COUNT_TILES_TAPPED 1
#define PEL_COUNT_PIXELS_COVERED 2
#define PEL_COUNT_PIXELS_TAPPED 3
#define PEL_COUNT_TAPS 4
#define PEL_COUNT_IRRADIANCE_INVALID 5
#define PEL_COUNT_PIXELS_HISTORY 6
#define PEL_DIFFUSION_COUNTERS 7

#ifndef __OPENCL_VERSION__
static_assert(sizeof(PelProfileTable) == 80 && sizeof(PelPyramidLevel) == 16);
static_assert(sizeof(PelDiffusionFrame) ==
              4 * (10 + 3 + 3 + 16 + PEL_DIFFUSION_IDS) + 7 * 32 + PEL_PYRAMID_LEVELS * 16);
#endif
