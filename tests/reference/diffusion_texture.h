// What scattering in texture space approximates: a sum over the surface under the texels, in double
// precision.
#pragma once

#include <vector>

#include "reference/profile.h"

namespace reference {

struct Texel {
    Vec3 position;
    double area = 0;  // 0: not covered
    Rgb irradiance{};
    int island = 0;
};

// Every texel over every other one of its island, divided by what the weights add up to.
std::vector<Rgb> scatterTexels(const std::vector<Texel>& texels, const Profile& profile);

}  // namespace reference
