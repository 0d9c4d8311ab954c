// A profile as the tables that kernels/diffusion looks weights up in (kernels/shared/diffusion.h).
#pragma once
#include <vector>

#include "lut/profile.h"
#include "shared/diffusion.h"

namespace pel {

// What is further away than this share of the light reaches is left out, and the rest scaled up for it: where
// Burley's profile is cut by others too, at 16 d.
constexpr double lightBeyondReach = 4e-3;

struct ProfileNodes {
    PelProfileTable table{};    // its offset is 0
    std::vector<float> values;  // R of all nodes, the shares within, R of blocks
};

// `scale`: lengths of the tables per length of the profile, > 0. Throws where squares of such lengths are no
// floats.
ProfileNodes profileNodes(const ProfileShape& shape, double scale);

}  // namespace pel
