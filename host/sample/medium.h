// The scattering medium that a random walk needs, from the reflectance and the profile of a material.
#pragma once
#include <array>

namespace pellucid::sample {

// Homogeneous, with isotropic scattering.
struct Medium {
    std::array<double, 3> meanFreePath{1, 1, 1};  // per channel, unit of positions
    std::array<double, 3> albedo{};               // per channel, of a single scattering: 0 to 1
    double refractiveIndex = 1;  // relative to the outside; 1: index-matched, else smooth Fresnel
};

enum class Boundary { IndexMatched, Fresnel };
constexpr double fresnelIndex = 1.4;  // of skin; the only one for which burleyMedium has fits

// The medium whose half-space reflects `reflectance` of diffuse light, and scatters it like Burley's profile
// of length `burleyLength`, (exp(-r/d) + exp(-r/3d)) / (8 pi d r). Both are fits to walks of half-spaces
// (docs/mathematics.md, section 14). Their errors, for a reflectance from 0.07 to 0.95: 0.0021 of the
// reflectance (0.0001 at 0.8; Fresnel: 0.0024), 0.7 % of the mean free path (Fresnel: 0.9 %). A reflectance
// of 0 or 1 is moved a little inwards, so that walks scatter and end.
Medium burleyMedium(const std::array<double, 3>& burleyLength, const std::array<double, 3>& reflectance,
                    Boundary boundary);

}  // namespace pellucid::sample
