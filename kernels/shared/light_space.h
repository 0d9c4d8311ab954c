// Constants of sums over the texels of shadow maps, laid out alike on host and device (docs/mathematics.md,
// section 10, "Light space"). Lengths are in the caller's unit, positions from PelDiffusionFrame.origin.
#pragma once
#include "shared/diffusion.h"

// The lit surface as a pyramid of blocks of 2^l x 2^l texels. A block of level 1 or coarser holds two
// clusters: where a map shows a near surface beside a far one, there is no surface in between. A level is
// rows of planes, as those of the screen: row y of plane p begins at offset + ((y + PEL_PYRAMID_ROWS) planes
// + p) stride + PEL_PYRAMID_GUARD. The other planes of blocks without flux are undefined.
#define PEL_LIGHT_LEVELS 12
#define PEL_LIGHT_MAPS 24   // of all lights of a frame: cascades and faces of cubes one by one
#define PEL_LIGHT_FLUX 0    // length^2: irradiance dA, over the light's colour
#define PEL_LIGHT_EXTENT 1  // length^2 of surface
#define PEL_LIGHT_X 2       // length: the middle of the flux
#define PEL_LIGHT_Y 3
#define PEL_LIGHT_Z 4
#define PEL_LIGHT_ID 5  // the bits of an id, 0: unknown; absent with PEL_HIDDEN
// Planes of one cluster.
#define PEL_LIGHT_PLANES(hidden) ((hidden) ? 5u : 6u)

// A byte per cell of this many texels along a side: the last bits of the number of the last frame in which
// some of them had flux, even and odd frames apart. A cell without flux in this frame and the one before is
// skipped: the pyramid already holds zeros there, up to the level of the cell.
#define PEL_LIGHT_CELL 16

#define PEL_SEEN_OTHER 255u  // mark of a texel: a camera-visible object that does not scatter

typedef struct PelLightMap {
    float toMap[16];         // to homogeneous (u, v, z)
    float toWorld[16];       // its inverse
    PelUint32 type;          // PelLightType
    float toLight[3];        // directional: unit
    float position[3];       // length
    float spotDirection[3];  // unit
    float spotCosOuter;
    float spotScale;  // 1 / (cosInner - cosOuter)
    float range2;     // length^2; FLT_MAX: no limit
    float color[3];
    float radius;        // sphere: length
    float halfWidth[3];  // rectangle: from its centre to the middles of two sides, length
    float halfHeight[3];
    float radialRange;  // length per unit of depth where depth is the distance from the light; 0: it is not
    float perExponent;  // depth per log2 of a texel; exponential maps
    float texel;        // length of a texel over the homogeneous coordinate there
    float reach;        // length: of the widest profile, for a factor of the radius of 1
    float size[2];      // texels across
    float middle;       // where in a texel its depth is sampled, from its edge: 0.5 if step is 1
    PelUint32 step;     // image texels along a side of a texel here, which has the depth of one of them
    PelUint32 width;    // the image's texels; of a cube's face
    PelUint32 height;
    PelUint32 finer;     // number of finer cascades before this map; surface inside them is theirs
    PelUint32 firstRow;  // of the image: a cube's face
    PelUint32 seen;      // where its texels begin in the buffer of camera-visible marks
    PelUint32 cells;     // where its cells begin in the buffers of flux marks, row by row
    PelUint32 levels;
    PelUint32 light;   // maps of one light follow one another
    PelUint32 buffer;  // number of the kernel argument with its image
    PelShadeImage map;
    PelPyramidLevel level[PEL_LIGHT_LEVELS];
} PelLightMap;

// Counters, after those of PelDiffusionFrame.
#define PEL_COUNT_LIGHT_PIXELS (PEL_DIFFUSION_COUNTERS + 0)  // that summed texels of a map
#define PEL_COUNT_LIGHT_TEXELS (PEL_DIFFUSION_COUNTERS + 1)  // blocks of texels that were read
#define PEL_COUNT_LIGHT_TILES (PEL_DIFFUSION_COUNTERS + 2)
#define PEL_LIGHT_COUNTERS (PEL_DIFFUSION_COUNTERS + 3)

// After the counters, for each map the texels within reach of scattering pixels, as a rectangle: the map's
// width less the first column, the last column plus 1, the same of rows; 0: none. Other texels have no flux.
#define PEL_LIGHT_REGION(map) (PEL_LIGHT_COUNTERS + 4 * (map))
#define PEL_LIGHT_WORDS PEL_LIGHT_REGION(PEL_LIGHT_MAPS)

#ifndef __OPENCL_VERSION__
static_assert(sizeof(PelLightMap) ==
              4 * (32 + 1 + 3 + 3 + 3 + 3 + 3 + 7 + 9 + 8) + 32 + PEL_LIGHT_LEVELS * 16);
#endif
