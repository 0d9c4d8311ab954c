// How a look-up table lies in memory and which texel a value belongs to; compiled by host and device.
#pragma once

// How texels are spread over the axes (PelLutAxis).
#define PEL_LUT_AXIS_LINEAR 0
// Rows: the root of the row value is linear. Columns of curvature tables: u = s |s|, s from -1 to 1 across.
// Columns of shadow tables: the position across the edge is linear. Both axes run from end to end (the
// square-root axis).
#define PEL_LUT_AXIS_ROOT 1

// Texels are float4 (R, G, B, 0), row-major, rowTexels to a row; the row of the smallest curvature, or of the
// widest penumbra, comes first. A copy of the last column and of the last row follow. So a bilinear look-up
// at texel coordinates within [0, width - 1] x [0, height - 1] reads texel (i, j) and its three neighbours at
// +1, +rowTexels and +rowTexels + 1 without clamping, also if width or height is 1. lib/lut/lut_lookup.clh
// turns values into texel coordinates.
typedef struct LutLayout {
    unsigned int width;      // texels, without the copied column
    unsigned int height;     // texels, without the copied row
    unsigned int rowTexels;  // width + 1
    unsigned int axis;       // LUT_AXIS_...
    float rowMin;    // row value at the upper edge of row 0: 1/radiusMax or 1/widthMax, 1/length, or its root
    float rowScale;  // texels per row value (or root), height / (rowMax - rowMin); 0 where both are the same
    float radius;    // diffusion radius that the table was made for, length; typical 2.7 mm
    float pad;
} LutLayout;
#ifdef __cplusplus
static_assert(sizeof(LutLayout) == 32);
#endif
