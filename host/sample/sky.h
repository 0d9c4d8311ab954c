// Light from everywhere, as nine spherical harmonics per channel.
#pragma once
#include <functional>

#include "sample/vector.h"

namespace pellucid::sample {

using Rgb = std::array<double, 3>;
// Orders 0 to 2 of the orthonormal real basis: 1; y, z, x; xy, yz, 3z^2-1, xz, x^2-y^2.
using Harmonics = std::array<Rgb, 9>;

std::array<double, 9> harmonicBasis(Vec3 direction);  // direction: unit

// A studio sky: a gradient from horizon to zenith, a soft lamp in it and a floor that returns some light.
struct Sky {
    Vec3 up{0, 0, 1};              // unit
    Rgb zenith{0.30, 0.38, 0.52};  // radiance
    Rgb horizon{0.46, 0.45, 0.44};
    Rgb floor{0.16, 0.12, 0.09};
    Vec3 lamp{0.5, -0.7, 0.5};  // towards the lamp; need not be unit
    Rgb lampRadiance{0.9, 0.82, 0.7};
    double lampSharpness = 8;  // exponent of the cosine to the lamp

    Rgb radiance(Vec3 direction) const;
};

// Projects irradiance / pi of an environment: a sky of radiance 1 all round gives 1 for every normal. The
// integral is a product rule, Gauss-Legendre in the cosine to z and uniform round z, exact up to degree 127.
// The cosine's weights per order are pi, 2 pi / 3, pi / 4 [Ramamoorthi and Hanrahan, SIGGRAPH 2001].
Harmonics projectIrradiance(const std::function<Rgb(Vec3)>& radiance);
Harmonics projectIrradiance(const Sky& sky);

Rgb evaluate(const Harmonics& harmonics, Vec3 normal);  // normal: unit

}  // namespace pellucid::sample
