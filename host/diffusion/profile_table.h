// A profile as the tables of weights that kernels/diffusion reads (kernels/shared/diffusion.h).
#pragma once
#include "lut/profile.h"
#include "shared/diffusion.h"

namespace pel {

// Light beyond the distance that leaves this share is cut off, and the rest is scaled up. For Burley's
// profile that is 16 d, where others cut it too.
constexpr double lightBeyondReach = 4e-3;

struct ProfileNodes {
    PelProfileTable table{};    // its offset is 0
    std::vector<float> values;  // R of all nodes, the shares within, R of blocks; both, and V, as Gaussians
    Rgb meanDistance{};         // of the light, length
};

// `scale`: lengths of the tables per length of the profile, > 0. `meanFreePath`: length in the tables' unit;
// 0: the medium is not known, and nothing counts as through a slab (docs/mathematics.md, section 12,
// "Slabs"). `strength`: PelMaterial.curvatureGain. Throws if squares of such lengths are outside float.
ProfileNodes profileNodes(const ProfileShape& shape, double scale, const Rgb& meanFreePath = {},
                          double strength = 0);

}  // namespace pel
