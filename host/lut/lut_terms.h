// Profiles and row axes in the units of the integrating kernels: lengths in diffusion radii.
#pragma once
#include "lut/lut.h"
#include "shared/lut_integral.h"

namespace pel {

// FaceWorks ends its integrals at 10 mm for a profile of radius 2.7 mm.
constexpr double profileCut = 10 / 2.7;  // diffusion radii

// Narrow Gaussians first; empty for a tabulated profile.
std::vector<LutGaussian> deviceTerms(const Profile& profile, double steepestRow);

// Angles (pi/2) (j/nodes)^4, j = 0 ... nodes.
std::vector<LutNode> meshOfNodes(int nodes);
double nodeAngle(int j, int nodes);

// N.L from 0 to 1 of a column of the unlit half: |u|.
double columnElevation(uint32_t x, uint32_t width, PelLutAxis axis);

// Where the columns of the unlit half read the nodes of that mesh: cubic Hermite interpolation.
std::vector<LutColumn> curvatureColumns(uint32_t width, PelLutAxis axis, int nodes);

// The rows of a table: `min`, upper edge of the first row, and `step`, of the row value (1/length, in any
// unit of length) or of its square root; `scale`, texels per row value, 0 if all rows are one. On the linear
// axis values are in the middle of texels, as in FaceWorks. On the square-root axis they reach the ends of
// the axis, so that no look-up within the range is clamped.
struct RowAxis {
    double min, step, scale;
};
RowAxis rowAxis(PelLutAxis axis, uint32_t height, double least, double most);

// 1/length of the first and the last row of a curvature or shadow table, 1/diffusion radii, limited to what
// float arithmetic on squares can hold. Beyond, tables have reached their limits.
struct RowRange {
    double least, most;
};
RowRange rowRange(const Lut& lut);
// The rows in that range.
RowAxis rowsOf(const Lut& lut);

// What the kernels for tabulated profiles (kernels/lut/table_*.cl) read, prepared in double precision.
// Lengths in diffusion radii.

// R at 0 and at each distance where its slope changes: (R, G, B, distance). Linear between; 0 beyond.
std::vector<cl_float4> tableKnots(const Profile& profile);

// Where the line spread ends: at the end of the table, or at the cut.
double tableEnd(const Profile& profile);
// Where the table ends.
double tableReach(const Profile& profile);
// Within `end`, PEL_TAIL_VALUES float4 at each of PEL_TAIL_CELLS + 1 distances, as shared/lut_integral.h
// describes.
std::vector<cl_float4> tableTails(const Profile& profile, double end);

// Within `end`, PEL_SUM_VALUES float4 at each of cells + 1 distances: of P, or of R.
std::vector<cl_float4> lineSums(const Profile& profile, double end, int cells);
std::vector<cl_float4> radialSums(const Profile& profile, double end, int cells);

// P or R opposite to the shaded point on circles of those radii: at chords just below the diameter.
std::vector<cl_float4> antipodes(const Profile& profile, bool radial, const std::vector<double>& radii);

// The intervals of the mesh of curvature tables (lut_terms.h). `chord`: distances are chords, not arcs.
std::vector<TableInterval> tableMesh(int nodes, bool chord);

// Weights of samples, PEL_RAMP_PARTS to a half width of the ramp 3/4 (1 - y^2), -1 <= y <= 1, for a function
// that is cubic between them.
std::vector<RampWeight> rampWeights();

// Points (weight R, G, B; distance) that represent the table with those knots on a sphere of that diameter,
// or on any larger one if the profile ends before a quarter of the way round. The normalised integral of R f
// 2 pi d over the sphere is the sum of weight times f, for f with at most a corner at a quarter of the way
// round. Distances rise.
std::vector<cl_float4> tablePoints(const std::vector<cl_float4>& knots, double diameter);

}  // namespace pel
