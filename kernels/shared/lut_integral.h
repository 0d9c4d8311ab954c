// What the LUT integrators share with the host: the nodes of the curvature rows and the parameters of both
// kernels. All lengths are in units of the LUT's diffusion radius, so that no radius leaves the range of
// float.
#ifndef PEL_SHARED_LUT_INTEGRAL
#define PEL_SHARED_LUT_INTEGRAL

// One Gaussian of a profile, as line spread weight * exp(-s^2 / 2 sigma^2) / (sigma sqrt(2 pi)); in a list,
// sigma rises.
typedef struct LutGaussian {
    float sigma;  // diffusion radii
    float red;    // weights
    float green;
    float blue;
} LutGaussian;

// A row's record of curvature_lut.cl, in float4: E, F at node 0, ... E, F at the last node, back, front, scale of E. And of
// table_curvature_lut.cl, which has slots in place of nodes.
#define PEL_CURVATURE_RECORD(nodes) (2 * (nodes) + 5)
#define PEL_TABLE_RECORD(slots) (2 * (slots) + 3)

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

typedef struct CurvatureLutParams {
    unsigned int width;
    unsigned int height;
    unsigned int gaussians;
    unsigned int axis;  // LUT_AXIS_...
    float rowMin;       // curvature, 1/diffusion radii, or its root, at the upper edge of row 0
    float rowStep;      // per row
    float cut;          // length at which the kernel of form arc ends, diffusion radii; 10/2.7
} CurvatureLutParams;

typedef struct ShadowLutParams {
    unsigned int width;
    unsigned int height;
    unsigned int gaussians;
    float reciprocalMin;   // 1/penumbra width at the upper edge of row 0, 1/diffusion radii
    float reciprocalStep;  // per row
    float sharpening;
    float cut;                // half length of the integral, diffusion radii
    float mass[3];            // of the cut profile, per channel
    unsigned int axis;        // LUT_AXIS_...
    unsigned int closedEnds;  // rows are rescaled to run from 0 to 1
} ShadowLutParams;

// --- tabulated profiles (kernels/lut/tabulated_*.cl) ---

// The line spread of a table and its integrals, within the cut, at distances end (i / PEL_TAIL_CELLS)^2, i = 0 ...
// PEL_TAIL_CELLS: PEL_TAIL_VALUES float4 (R, G, B, 0) each.
#define PEL_TAIL_CELLS 512
#define PEL_TAIL_SPREAD 0  // P
#define PEL_TAIL_MASS 1    // integral of P beyond
#define PEL_TAIL_FIRST 2   // integral of (t - s) P beyond
#define PEL_TAIL_SECOND 3  // ... of (t - s)^2 / 2 P
#define PEL_TAIL_THIRD 4   // ... of (t - s)^3 / 6 P
#define PEL_TAIL_VALUES 5

// A column of the dark half.
typedef struct TableColumn {
    float angle;      // behind the terminator, radians
    float elevation;  // its sine, |N.L|
} TableColumn;

typedef struct TabulatedCurvatureLutParams {
    unsigned int width;
    unsigned int height;
    unsigned int axis;      // LUT_AXIS_...
    unsigned int nodes;     // of the angular mesh, at 0 ... pi/2
    unsigned int knots;     // distances at which the table bends, without 0
    unsigned int slots;     // nodes that a row's record has room for
    unsigned int firstRow;  // of this launch
    unsigned int rows;      // of this launch
    float rowMin;           // as in CurvatureLutParams
    float rowStep;
    float end;  // where the tails end, diffusion radii
} TabulatedCurvatureLutParams;

// Which points represent the profile on the sphere of a row.
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
} TabulatedShadowLutParams;

#endif
