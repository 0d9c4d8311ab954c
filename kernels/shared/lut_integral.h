// Data that the LUT integrators share with the host: nodes of the curvature rows, parameters of both kernels.
// All lengths are in units of the LUT's diffusion radius, so that no radius leaves the range of float.
#pragma once

// One Gaussian of a profile, as line spread weight * exp(-s^2 / 2 sigma^2) / (sigma sqrt(2 pi)); in a list,
// sigma rises.
typedef struct LutGaussian {
    float sigma;  // diffusion radii
    float red;    // weights
    float green;
    float blue;
} LutGaussian;

// A row's record, in float4: E, F at node 0, ... E, F at the last node, back, front, scale of E
// (lut/curvature_lut.cl).
#define PEL_CURVATURE_RECORD(nodes) (2 * (nodes) + 5)

// A node of the angular mesh, at angle (pi/2) (j/N)^4 behind the terminator, j = 0 ... N.
typedef struct LutNode {
    float angle;  // radians
    float sine;
    float cosine;
    float versine;  // 1 - cosine, without its cancellation
} LutNode;

// Where a column of the dark half reads the row's nodes: cubic Hermite weights between node and node + 1.
typedef struct LutColumn {
    float value0;  // of E at the lower node
    float slope0;  // of F at the lower node (E' = -F)
    float value1;
    float slope1;
    float elevation;  // |N.L| of the column
    int node;
} LutColumn;

// One table of a stack, which is several tables of one size made by one launch. The Gaussians of all tables
// follow the last of these in the same buffer.
typedef struct StackedLut {
    unsigned int first;  // of its Gaussians
    unsigned int gaussians;
    // At the upper edge of row 0: curvature or 1/penumbra width in 1/diffusion radii, or its root.
    float rowMin;
    float rowStep;     // per row
    float sharpening;  // of a shadow table
    float total[3];    // of a shadow table: of the cut profile, per channel
} StackedLut;

// The parameters that all tables of a stack share.
typedef struct StackParams {
    unsigned int width;
    unsigned int height;
    unsigned int axis;        // LUT_AXIS_...
    unsigned int closedEnds;  // of shadow tables: rows are rescaled to run from 0 to 1
    // Length at which the kernel of form arc ends, half length of a shadow table's integral: diffusion radii;
    // 10/2.7
    float cut;
} StackParams;

// --- tabulated profiles (kernels/lut/tabulated_*.cl) ---

// The line spread of a table and its integrals, within the cut, at distances end (i / PEL_TAIL_CELLS)^2, i =
// 0 ... PEL_TAIL_CELLS: PEL_TAIL_VALUES float4 (R, G, B, 0) each.
#define PEL_TAIL_CELLS 512
#define PEL_TAIL_SPREAD 0  // P
#define PEL_TAIL_TOTAL 1   // integral of P beyond
#define PEL_TAIL_FIRST 2   // integral of (t - s) P beyond
#define PEL_TAIL_SECOND 3  // ... of (t - s)^2 / 2 P
#define PEL_TAIL_THIRD 4   // ... of (t - s)^3 / 6 P
#define PEL_TAIL_VALUES 5

// A profile's density along the surface (P, or R for the rings) and its integrals from 0 on, at `cells` + 1
// distances that are spread in the same way: PEL_SUM_VALUES float4 (R, G, B, 0) each.
#define PEL_SUM_DENSITY 0
#define PEL_SUM_TOTAL 1   // integral of the density
#define PEL_SUM_MOMENT 2  // integral of that
#define PEL_SUM_VALUES 3

// A weight w of the density on an interval of the mesh as the best linear function of the distance x, in
// radii of the circle, from the interval's nearer end: at + slope x.
typedef struct TableWeight {
    float at;
    float slope;
} TableWeight;

// How an interval of the mesh weights the density on one side of the shaded point.
typedef struct TableSide {
    float distance;  // of the node at the interval's smaller angle, in radii
    // 1: the moment is computed from the density at both ends, which are so near to one another that
    // differences of sums cancel in float. 2: the total is too, and the weights are for the angle instead.
    float antipodal;
    TableWeight toE;    // sin of the angle from that node on
    TableWeight toF;    // its cos
    TableWeight light;  // cos of the angle from the shaded point on
    TableWeight total;  // 1
} TableSide;

// An interval of the mesh, with the turn of E and F over it.
typedef struct TableInterval {
    float sine;
    float versine;
    TableSide front;
    TableSide back;  // of the angles pi - t
} TableInterval;

typedef struct TabulatedCurvatureLutParams {
    unsigned int height;
    unsigned int axis;  // LUT_AXIS_...
    float rowMin;       // as in CurvatureLutParams
    float rowStep;
    float end;                // where the sums end, diffusion radii
    unsigned int cells;       // of the sums
    float frontReach;         // distance of pi/2, in radii
    unsigned int normalised;  // rows are divided by their total
} TabulatedCurvatureLutParams;

// The points that represent the profile on the sphere of a row.
typedef struct TablePoints {
    unsigned int first;
    unsigned int count;
} TablePoints;

typedef struct TabulatedShadowLutParams {
    unsigned int width;
    unsigned int height;
    float reciprocalMin;  // as in ShadowLutParams
    float reciprocalStep;
    float sharpening;
    float end;                // where the tails end, diffusion radii
    unsigned int axis;        // LUT_AXIS_...
    unsigned int closedEnds;  // rows are rescaled to run from 0 to 1
    unsigned int nodes;       // intervals between the nodes of a row; 0: rows have none
} TabulatedShadowLutParams;

// Rows with ramps of a smaller half width, in diffusion radii, have nodes: PEL_RAMP_PARTS to a half width.
#define PEL_WIDE_RAMP 0.25f
#define PEL_RAMP_PARTS 12
#define PEL_RAMP_TOGETHER 4  // nodes that are made at once
#define PEL_RAMP_SHARP 3     // nodes beyond a half width that still take quadrature
#define PEL_RAMP_CELLS 12    // cells of the list of tails in a part of the quadrature
#define PEL_RAMP_SAMPLES(nodes) ((nodes) + 1 + 2 * PEL_RAMP_PARTS + PEL_RAMP_TOGETHER)
#define PEL_RAMP_RECORD(nodes) (2 * ((nodes) + 1))

// Weights of a sample (value, and slope per interval) in the mean of the function under the ramp, and in the
// mean of its slope per half width.
typedef struct RampWeight {
    float value;
    float slope;
    float valueToSlope;
    float slopeToSlope;
} RampWeight;
