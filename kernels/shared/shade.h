// Constants of one execution of the shading pass (shading constants), with the same layout on host and
// device. Lengths are in the caller's unit, colours are linear RGB, matrices are row-major and multiply
// column vectors.
#pragma once
#include "shared/choices.h"
#include "shared/formats.h"
#include "shared/image_slots.h"
#include "shared/lut.h"
#include "shared/scalars.h"

#define PEL_TILE_WIDTH 128  // pixels; measured, docs/design-notes.md
#define PEL_TILE_HEIGHT 2
#define PEL_TILE_PIXELS (PEL_TILE_WIDTH * PEL_TILE_HEIGHT)
#define PEL_LIGHT_BUFFERS 16  // distinct buffers among all images of all lights
#define PEL_EACH_LIGHT_BUFFER(X) \
    X(0) X(1) X(2) X(3) X(4) X(5) X(6) X(7) X(8) X(9) X(10) X(11) X(12) X(13) X(14) X(15)
#define PEL_EYES 64        // materials that are eyes, at most
#define PEL_MATERIALS 256  // ids 0 (background) to 255
// Lists of tiles in one buffer: PEL_COUNTERS counters of pixels, PEL_TILE_LISTS counts of tiles, then the
// lists, each with room for PelShadeFrame.listTiles. List 0 has every tile with a material; list 1 + i has
// the tiles of variant i of the shading kernel, if there are several.
#define PEL_TILE_VARIANTS 4
#define PEL_TILE_LISTS (1 + PEL_TILE_VARIANTS)
#define PEL_TILE_COUNT(list) (PEL_COUNTERS + (list))
#define PEL_TILE_LIST(frame, list) \
    (PEL_COUNTERS + PEL_TILE_LISTS + (size_t)(list) * (frame)->listTiles)  // its first tile
#define PEL_EVERY_TILE 0xffffffffu  // instead of a list's number: visit all tiles
// Transmittance below 2^-16 counts as 0: taps can stop early, and it is a third of the promised accuracy.
#define PEL_LEAST_TRANSMITTANCE_LOG2 16

// Where the pixels of an image are in its buffer.
typedef struct PelShadeImage {
    PelUint32 offset[2];    // bytes to the first pixel, low and high word
    PelUint32 plane[2];     // bytes from plane to plane, low and high word; planar formats only
    PelUint32 pixelStride;  // bytes
    PelUint32 rowStride;    // bytes
    PelUint32 width;        // pixels
    PelUint32 height;
} PelShadeImage;

typedef struct PelShadeFrame {
    PelUint32 width;  // pixels
    PelUint32 height;
    PelUint32 tilesX;  // tiles in a row
    // tiles of this launch, from firstTile on; all of them unless the frame is shaded in bands
    PelUint32 tiles;
    PelUint32 firstTile;
    PelUint32 scratchRow;  // first pixel row of the scratch images
    PelUint32 listTiles;   // room in each list of tiles
    PelUint32 lights;
    PelUint32 materialMask[PEL_MATERIALS / 32];  // bit i: id i has a material
    float cameraPosition[3];                     // length, world
    float inverseViewProjection[16];             // clip to world
    // Irradiance / pi as a polynomial of the normal: 1, y, z, x, xy, yz, 3z^2 - 1, xz, x^2 - y^2; the basis'
    // factors and the constant term are folded in.
    float ambient[9][3];
    float invalidColor[3];     // radiance of a pixel with NaN or Inf input
    PelUint32 cubeSize;        // texels along an edge of the ambient cube map; 0: none
    PelUint32 reflectionSize;  // of the cube map that eyes reflect; 0: none
    PelShadeImage images[PEL_IMAGE_SLOTS];
} PelShadeFrame;

// A look-up table inside the buffer of all tables.
typedef struct PelShadeLut {
    LutLayout layout;   // width 0: no table
    PelUint32 offset;   // texels
    float radiusRatio;  // material's diffusion radius / the table's: multiplies row values
} PelShadeLut;

typedef struct PelShadeMaterial {
    float albedo[3];
    float normalBlend[3];  // how far Nb replaces N, per channel
    PelShadeLut curvature;
    PelShadeLut shadow;
    // 1 / shadowFilterWidth, 1/length: reciprocal penumbra width = sat(Ng.L) times this
    float penumbraPerCosine;
    float specularSharpening;  // 0.9 k: specular's shadow is smoothstep(w 0.9k + (1 - 0.9k) / 2); 0: plain w
    float deepScatterColor[3];
    float deepScatterFalloff;       // -log2(e) / (2 radius^2), 1/length^2: transmittance = exp2(falloff t^2)
    float thicknessCutoff;          // length beyond which the transmittance counts as 0
    float deepScatterNormalOffset;  // length
    float thicknessFilterRadius;    // UV of the shadow map
    PelUint32 thicknessTaps;        // 0: no taps
    float specular;
    float roughness;
    float f0;
    float diffusionRadius;    // length
    float shadowFilterWidth;  // length; 0: a sharp shadow
    float shadowBias;         // length; this and the next two apply to lights without their own
    float shadowSoftness;     // of the filter's width
    float shadowConeSlope;
    PelUint32 hasNormalMap;
    PelUint32 specularModel;  // PelSpecularModel
    float roughness2;
    float lobeMix;
    float deepScatterAmbient;
    PelShadeLut transmission;     // one row over the root of thickness: layout.width 0: none
    float transmissionPerLength;  // 1 / the thickness at its end, 1/length
    float transmissionShare;
    float gain[3];  // length: mean free path for lib/shading/curvature_gain.clh; all 0: none
    float gainSlope[3], gainSaturation[3];
    float absorption[3];   // sqrt(1 - albedo) of that medium
    PelUint32 needs;       // PEL_BIT_...: features of this material
    PelUint32 scattering;  // PelScattering; auto is replaced by the chosen method
    PelUint32 named;       // the method that the caller set, auto included
    float albedoAfter;     // power of albedo that scattered irradiance is multiplied by
    float through[3];      // share of the light on a sheet's other side
    PelUint32 eye;         // 1 + which eye of shared/eye.h; 0: none
    PelUint32 variants;    // bit i: variant i of the shading kernel has all of these features
    PelUint32 tapDisk;     // which of PelTapCells; PEL_TAP_DISKS: none
} PelShadeMaterial;

#define PEL_CASCADES 4   // of one light, at most
#define PEL_TAP_DISKS 4  // disks of thickness taps that materials share, at most
// Nodes of an occluder-depth grid along the radius of its disk: a coarser grid errs more than the taps do
// (docs/design-notes.md).
#define PEL_CELLS_PER_RADIUS 4
#define PEL_NODE_TAPS 32        // for every material, since they cost next to nothing
#define PEL_SAMPLES_PER_CELL 2  // samples of the map from node to node
// Samples along an axis with this many nodes, and a margin of one radius on either side.
#define PEL_TAP_SAMPLES(nodes) \
    (((nodes)-1) * PEL_SAMPLES_PER_CELL + 1 + 2 * PEL_CELLS_PER_RADIUS * PEL_SAMPLES_PER_CELL)

// Depths under the taps of one disk in one map, at the nodes of a grid (lib/shading/tap_cells.clh). Nodes
// begin a radius before the map and end a radius behind it.
typedef struct PelTapCells {
    PelUint32 columns, rows;    // nodes; 0: no cells, pixels take taps of their own
    PelUint32 offset, samples;  // floats, to the first node's lengths and to the first sample
    float perUv[2];             // nodes per UV
} PelTapCells;

// One of the parallel maps of a light with cascades.
typedef struct PelShadeCascade {
    float worldToShadow[16];
    float depthRange;     // length per unit of depth
    float tapScale[2];    // UV of this map per UV of the first, along u and v
    PelUint32 mapBuffer;  // which light buffer
    PelShadeImage map;
    PelTapCells cells[PEL_TAP_DISKS];
} PelShadeCascade;

typedef struct PelShadeLight {
    PelUint32 type;     // PelLightType
    float toLight[3];   // directional: unit
    float position[3];  // length, world
    float spotDirection[3];
    float spotCosOuter;
    float spotScale;  // 1 / (cosInner - cosOuter)
    float color[3];
    float range2;  // length^2, square of the range; FLT_MAX: no limit
    float worldToShadow[16];
    PelUint32 projection;  // PelShadowProjection
    float depthRange;  // parallel: length per unit of depth; radial cube: distance from the light per unit
    float depthA;      // perspective, cube: distance = 1 / (A z + B), 1/length
    float depthB;
    PelUint32 wideBuffer;  // which light buffer; >= PEL_LIGHT_BUFFERS: no image
    PelUint32 mapBuffer;
    PelShadeImage wide;
    PelShadeImage map;
    PelUint32 cascades;  // 0: the map above is not a cascade
    float perExponent;   // depth per log2 of a texel; exponential maps
    PelShadeCascade cascade[PEL_CASCADES];
    PelTapCells cells[PEL_TAP_DISKS];  // of the map above, unless that is a cascade
    float radius;                      // sphere: length
    float halfWidth[3];                // rectangle: from its centre to the middles of two sides, length
    float halfHeight[3];
} PelShadeLight;

// Counters of one execution, in a buffer of their own.
#define PEL_COUNT_SHADED 0
#define PEL_COUNT_SHADOW_LUT 1
#define PEL_COUNT_THICKNESS 2
#define PEL_COUNT_SPECULAR 3
#define PEL_COUNT_INVALID 4
#define PEL_COUNT_WIDE_SHADOW 5
#define PEL_COUNT_SHADOW_TEXELS 6
#define PEL_COUNT_IRRADIANCE 7
#define PEL_COUNT_SCATTERING 8                                  // and on: one for each PelScattering
#define PEL_COUNT_CHOICE (PEL_COUNT_SCATTERING + PEL_SCATTERS)  // of materials with auto, by chosen method
#define PEL_COUNT_EYE (PEL_COUNT_CHOICE + PEL_SCATTERS)
#define PEL_COUNT_IRIS (PEL_COUNT_EYE + 1)
#define PEL_COUNT_CAUSTIC (PEL_COUNT_EYE + 2)
#define PEL_COUNTERS (PEL_COUNT_EYE + 3)

#ifndef __OPENCL_VERSION__
static_assert(sizeof(PelShadeImage) == 32 && sizeof(PelShadeLut) == 40);
static_assert(sizeof(PelShadeFrame) == 4 * (8 + 8 + 3 + 16 + 27 + 3 + 2) + PEL_IMAGE_SLOTS * 32);
static_assert(sizeof(PelShadeMaterial) == 4 * 53 + 3 * sizeof(PelShadeLut));
static_assert(sizeof(PelTapCells) == 24);
static_assert(sizeof(PelShadeCascade) == 4 * (16 + 4) + 32 + PEL_TAP_DISKS * sizeof(PelTapCells));
static_assert(sizeof(PelShadeLight) == 4 * (16 + 16 + 6) + 64 + 8 + PEL_CASCADES * sizeof(PelShadeCascade) +
                                           PEL_TAP_DISKS * sizeof(PelTapCells) + 4 * 7);
#endif
