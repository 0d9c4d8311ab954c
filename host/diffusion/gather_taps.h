// Where the taps of methods that gather lie, and what share of the light each brings.
#pragma once
#include <vector>

#include "lut/profile.h"
#include "shared/gather.h"

namespace pel {

// On a disk: PEL_GATHER_TURNS sets of `count`, one after the other. Each tap stands for a ring that has the same part of the light of
// the channel that scatters widest. `reach`: length beyond which light is left out.
std::vector<PelGatherTap> diskTaps(const ProfileShape& shape, double scale, double reach, uint32_t count);

// Along a line: pieces that follow one another from -reach to reach, with what the line spread has in each.
std::vector<PelGatherTap> lineTaps(const ProfileShape& shape, double scale, double reach, uint32_t count);

}  // namespace pel
