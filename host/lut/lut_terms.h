// Profiles and row axes in the units of the integrating kernels: lengths in diffusion radii.
#pragma once
#include <vector>

#include "lut/lut.h"
#include "lut/profile.h"
#include "shared/lut_integral.h"

namespace pel {

// 1/length times the diffusion radius, limited to what float arithmetic on squares can hold. Tables are at
// their limits beyond.
double rowLimit(double length, double diffusionRadius);

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

template <class T>
cl::Memory upload(Device& device, const std::vector<T>& values) {
    return device.allocate(values.size() * sizeof(T), values.data());
}

}  // namespace pel
