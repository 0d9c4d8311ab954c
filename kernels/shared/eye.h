// Constants of eyes (section 13 of the mathematics), with the same layout on host and device. An eye's own
// space: mm, the sclera's centre at 0, the gaze along z, PelEye.up along y. Tables are made in units of the
// iris' radius.
#pragma once
#include "shared/scalars.h"

// The surfaces of an eye.
typedef struct PelEyeShape {
    float sclera2;   // square of the sclera's radius
    float cornea;    // radius of curvature at the apex
    float conic1;    // 1 + conic constant
    float limbus;    // radius
    float limbusZ;   // the plane in which cornea and sclera meet
    float apexZ;     // of the cornea
    float iris;      // radius
    float irisZ;     // of its centre
    float irisBend;  // the iris' height is irisZ + irisBend r^2
    float corneaIndex;
    float aqueousIndex;
    float pad;
} PelEyeShape;

#define PEL_AMBIENT_NODES 33  // even in the distance from the axis, from 0 to the iris' rim

typedef struct PelShadeEye {
    PelEyeShape shape;
    float center[3];  // world
    float right[3];   // unit, world
    float up[3];
    float gaze[3];
    float mmPerUnit;
    float limbusPerWidth;  // 1 / width of the soft border
    float limbusDepth;     // optical depth of the rim
    float pupil;           // mm
    float pupilBase;       // the iris' share is pupilBase + (r - pupil) pupilPerWidth, clamped
    float pupilPerWidth;
    float textureBase;  // radius in the texture: textureBase + textureScale r; 0 centre, 1 rim
    float textureScale;
    PelUint32 textureSize;  // texels along a side
    PelUint32 textureLevels;
    PelUint32 textureOffset;  // texels, in the buffer of all irises
    float irisColor[3];
    float tearRoughness;
    float wetLineRoughness;
    float tearIndex;
    PelUint32 causticOffset;  // texels, in the buffer of all tables
    PelUint32 causticWidth;
    PelUint32 causticHeight;  // of one slice
    PelUint32 causticDepth;
    float slicesPerRadian;
    float ambient[PEL_AMBIENT_NODES];  // ambient light on the iris over that outside the eye
} PelShadeEye;

// How a table of caustics is integrated: the half of the limbus' disc where y is above 0, in rows of cells.
typedef struct PelEyeLutGrid {
    PelUint32 width;  // texels of a slice
    PelUint32 height;
    PelUint32 depth;
    PelUint32 columns;  // cells across the limbus
    PelUint32 rows;     // from the middle to the rim
    float anglePerSlice;
    float perTexel;        // counts of the sums for one texel's irradiance of 1
    PelUint32 firstSlice;  // of a launch
} PelEyeLutGrid;

#define PEL_FIBRE_TEXELS 256  // along a side of a procedural iris

// An iris' texels: level 0, and below it the smaller levels side by side, each with a copied column and row.
// Level l has size >> l texels a side; all levels have rows of the same length.
#define PEL_IRIS_LEVELS 12
static inline PelUint32 irisLevels(PelUint32 size) {
    PelUint32 levels = 1;
    while (levels < PEL_IRIS_LEVELS && (size >> levels) >= 2) ++levels;
    return levels;
}
static inline PelUint32 irisRowTexels(PelUint32 size) {
    return size + PEL_IRIS_LEVELS;
}
// Of a level's first texel.
static inline PelUint32 irisLevelStart(PelUint32 size, PelUint32 level) {
    return level ? (size + 1) * irisRowTexels(size) + size - (size >> (level - 1)) + level - 1 : 0;
}
static inline PelUint32 irisRows(PelUint32 size) {
    return size + 1 + (size >> 1) + 1;
}

#ifndef __OPENCL_VERSION__
static_assert(sizeof(PelEyeShape) == 48 && sizeof(PelEyeLutGrid) == 32);
static_assert(sizeof(PelShadeEye) == 48 + 4 * (13 + 9 + 4 + 3 + 5 + PEL_AMBIENT_NODES));
#endif
