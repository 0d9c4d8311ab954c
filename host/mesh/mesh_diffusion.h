// The heat equation as a sum of Chebyshev polynomials (kernels/mesh/curvature_diffuse.cl).
#pragma once
#include <cstdint>
#include <vector>

namespace pel {

constexpr uint32_t mostStages = 4000;

// `span`: time times the limit of the rates, half the largest eigenvalue. What a sum of so many stages leaves
// out is erfc(stages / sqrt(2 span)) for long ones, about 2e-4 here.
double stagesOfSpan(double span);
double spanOfStages(uint32_t stages);

// Of degree 0 to `stages`, for exp(-span (x + correction x^2)), x from 0 to 2 being an eigenvalue in parts of
// the limit. Their sum is 1. correction: of waves, whose eigenvalues on vertices h apart are k^2 (1 - k^2 h^2
// / 16) instead of k^2 (the mean over directions, on squares and on equilateral triangles alike), so that
// their square times h^2 / 16, in parts of the limit, is added.
std::vector<float> heatCoefficients(uint32_t stages, double span, double correction);

}  // namespace pel
