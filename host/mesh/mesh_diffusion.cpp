#include "mesh/mesh_diffusion.h"

#include <cmath>
#include <numbers>

namespace pel {
namespace {

// erfc of this is 2e-4.
constexpr double reach = 2.63;

}  // namespace

double stagesOfSpan(double span) {
    return std::ceil(1 + reach * std::sqrt(2 * span));
}

double spanOfStages(uint32_t stages) {
    const double wide = (stages > 1 ? stages - 1.0 : 0.5) / reach;
    return 0.5 * wide * wide;
}

std::vector<float> heatCoefficients(uint32_t stages, double span, double correction) {
    // Cosine sums over Chebyshev points, twice as many as there are terms. The aliasing error is then far
    // below the truncation error.
    const size_t points = 2 * (size_t(stages) + 8);
    std::vector<double> cosines(4 * points), terms(stages + 1);
    for (size_t i = 0; i < cosines.size(); ++i)
        cosines[i] = std::cos(std::numbers::pi * double(i) / double(2 * points));
    for (size_t j = 0; j < points; ++j) {
        const double x = 1 - cosines[2 * j + 1],
                     value = std::exp(-span * (x + correction * x * x)) / double(points);
        for (size_t k = 0; k <= stages; ++k)
            terms[k] += (k ? 2 : 1) * value * cosines[(2 * j + 1) * k % cosines.size()];
    }
    double total = 0;
    for (double term : terms) total += term;
    std::vector<float> coefficients;
    for (double term : terms) coefficients.push_back(float(term / total));
    return coefficients;
}

}  // namespace pel
