// The surface integral (mathematics, section 9) by brute force: triangles are split until the sum converges.
#pragma once

#include <array>

#include "reference/profile.h"

namespace reference {

struct LitTriangle {
    std::array<Vec3, 3> corner;     // length
    std::array<Rgb, 3> irradiance;  // at the corners; linear between
};

// Sum of the integrals of R(|x - y|) E(y) dA. R ends at `cut` (per channel, length; 0: nowhere) and is scaled
// to 1 on a plane within. Error about 1e-7 times the largest irradiance.
Rgb surfaceIntegral(const Profile& profile, const std::vector<LitTriangle>& mesh, Vec3 x, Rgb cut = {});

}  // namespace reference
