// The surface integral of a lit mesh as host and device share it (kernels/diffusion/surface_integral.cl).
#pragma once
#include "shared/scalars.h"

// The table of a profile has this many rows per doubling of the distance. A row holds M(r) = integral of R(s)
// s ds from 0 to r as RGBX, then its slope per row; M ends at 1 / 2 pi, or goes on beyond it where R is cut.
#define PEL_SURFACE_ROWS 64

// A set of triangles. Nodes stand in the order of a walk from the root, each before its children.
typedef struct SurfaceNode {
    float centre[3];     // length; centroid of the light
    float radius;        // length; the sphere around the centre holds the set
    float weight[3];     // integral of E dA, length^2
    float accept2;       // length^2; from this squared distance on, the set counts as a point
    PelUint32 skip;      // node that follows when the children are left out
    PelUint32 triangle;  // of a leaf; PEL_SURFACE_NONE: there are children
    PelUint32 pad[2];
} SurfaceNode;
#define PEL_SURFACE_NONE 0xffffffffu

typedef struct SurfaceTriangle {
    float corner[9];      // length
    float irradiance[9];  // RGB at each corner
    float pad[2];
} SurfaceTriangle;

typedef struct SurfaceSum {
    PelUint32 nodes;
    PelUint32 rows;    // of the table
    float firstLog2;   // log2 of the first row's distance
    float reach;       // length; beyond it R is 0 in all channels
    float cut[3];      // length; where R ends abruptly, 0: nowhere
    float whole;       // 1 / 2 pi
    float piecesPerU;  // along an edge: rules of 4 points per unit of u
    float pad[3];
} SurfaceSum;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(SurfaceNode) == 48 && sizeof(SurfaceTriangle) == 80 && sizeof(SurfaceSum) == 48);
#endif
