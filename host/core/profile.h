// Diffusion profiles as sums of Gaussians (section 1 of the mathematics).
#pragma once
#include <array>
#include <vector>

namespace pel {

// weight * exp(-d^2 / 2 variance) / (2 pi variance) as energy per area, and with the same weight
// exp(-s^2 / 2 variance) / sqrt(2 pi variance) as line spread.
struct GaussianTerm {
    double variance;               // length^2; mm^2 for skin
    std::array<double, 3> weight;  // red, green, blue; each channel sums to 1
};

struct GaussianSum {
    double radius;                    // the profile's own diffusion radius, length; 2.7 mm for skin
    std::vector<GaussianTerm> terms;  // variance rises
};

const GaussianSum& skinProfile();

}  // namespace pel
