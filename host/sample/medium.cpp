#include "sample/medium.h"

#include <algorithm>
#include <cmath>

namespace pellucid::sample {
namespace {

// With s = sqrt(1 - albedo): reflectance = F (1 - s)(1 - c s) / (1 + b s), and mean free path over Burley's
// length is a polynomial of s.
struct Fit {
    double F, c, b;
    std::array<double, 5> polynomial;
};
// F, c and b of the first: van de Hulst, Multiple Light Scattering, 1980, for isotropic scattering. All
// others are least squares over walks of half-spaces with 12 and 11 albedos from 0.3 to 0.9995.
constexpr Fit indexMatched{1, 0.139, 1.17, {0.6663, 4.7276, -4.9721, 7.2062, -3.3091}};
constexpr Fit fresnel{0.92964, 0.43956, 3.74894, {0.3441, 3.6519, -1.9133, 5.3307, 0}};

}  // namespace

Medium burleyMedium(const std::array<double, 3>& burleyLength, const std::array<double, 3>& reflectance,
                    Boundary boundary) {
    const Fit& fit = boundary == Boundary::Fresnel ? fresnel : indexMatched;
    Medium medium;
    medium.refractiveIndex = boundary == Boundary::Fresnel ? fresnelIndex : 1;
    for (int i = 0; i < 3; ++i) {
        const double A = std::clamp(reflectance[i], 0.001, 0.999 * fit.F), p = fit.F * fit.c,
                     q = fit.F * (1 + fit.c) + A * fit.b;
        const double s = (q - std::sqrt(q * q - 4 * p * (fit.F - A))) / (2 * p);
        medium.albedo[i] = std::clamp(1 - s * s, 0.0, 1.0);
        double ratio = 0;
        for (int k = 4; k >= 0; --k) ratio = ratio * s + fit.polynomial[k];
        medium.meanFreePath[i] = ratio * burleyLength[i];
    }
    return medium;
}

}  // namespace pellucid::sample
