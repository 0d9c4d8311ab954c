// The heat equation as a sum of Chebyshev polynomials (kernels/mesh/curvature_diffuse.cl).
#pragma once
#include <cstdint>
#include <vector>

namespace pel {

constexpr uint32_t mostStages = 4000;

// `span`: time times the largest rate, half the largest eigenvalue. The truncation error of a sum of n stages
// is erfc(n / sqrt(2 span)) for large n, about 2e-4 here.
double stagesOfSpan(double span);
double spanOfStages(uint32_t stages);

// Coefficients of degree 0 to `stages` for exp(-span (x + correction x^2)), where x from 0 to 2 is an
// eigenvalue divided by the largest rate. Their sum is 1. correction: waves on vertices h apart have the
// eigenvalues k^2 (1 - k^2 h^2 / 16) instead of k^2 (the mean over directions, on squares and on equilateral
// triangles alike), so their square times h^2 / 16, divided by the largest rate, is added.
std::vector<float> heatCoefficients(uint32_t stages, double span, double correction);

}  // namespace pel
