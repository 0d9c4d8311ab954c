// A few Gaussians that stand for a profile.
#pragma once
#include <vector>

#include "lut/profile.h"

namespace pel {

struct GaussianChain {
    std::vector<GaussianTerm> terms;  // variances rising, weights adding up to 1 per channel
    double error;  // greatest difference of the light within any distance, over the channels
};

// The profile's own where it is a sum of at most `most`, else `most` of them, fitted to the light within distances.
GaussianChain gaussianChain(const Profile& profile, uint32_t most);

}  // namespace pel
