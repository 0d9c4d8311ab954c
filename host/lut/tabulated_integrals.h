// What the kernels for tabulated profiles (kernels/lut/table_*.cl) read, prepared in double precision.
// Lengths in diffusion radii.
#pragma once
#include <vector>

#include "lut/lut_terms.h"
#include "lut/profile.h"

namespace pel {

// R at 0 and at each distance where it bends: (R, G, B, distance). Linear between them, 0 beyond the last.
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

// Of samples PEL_RAMP_PARTS to a half width of the ramp 3/4 (1 - y^2), -1 <= y <= 1, of a function that is
// cubic between them.
std::vector<RampWeight> rampWeights();

// Points (weight R, G, B; distance) that represent the table with those knots on a sphere of that diameter,
// or on any larger one if the profile ends before a quarter of the way round. The normalised integral of R f
// 2 pi d over the sphere is the sum of weight times f, for f with at most a corner at a quarter of the way
// round. Distances rise.
std::vector<cl_float4> tablePoints(const std::vector<cl_float4>& knots, double diameter);

}  // namespace pel
