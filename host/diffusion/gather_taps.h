// Positions of the taps of methods that gather, and their shares of the light.
#pragma once
#include "lut/profile.h"
#include "shared/gather.h"

namespace pel {

// On a disk: PEL_GATHER_TURNS sets of `count`, one after the other. Each tap stands for a ring with an
// equal part of the light of the channel that scatters widest. `reach`: length beyond which light is left
// out.
std::vector<PelGatherTap> diskTaps(const ProfileShape& shape, double scale, double reach, uint32_t count);

// Along a line: consecutive pieces from -reach to reach, with the line spread integrated over each.
std::vector<PelGatherTap> lineTaps(const ProfileShape& shape, double scale, double reach, uint32_t count);

}  // namespace pel
