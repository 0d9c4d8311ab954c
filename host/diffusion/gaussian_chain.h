// A few Gaussians that represent a profile.
#pragma once
#include "lut/profile.h"

namespace pel {

struct GaussianChain {
    std::vector<GaussianTerm> terms;  // variances rising, weights adding up to 1 per channel
    double error;  // greatest difference of the light within any distance, over the channels
};

// The Gaussians of the profile itself if it is a sum of at most `most`, otherwise `most` Gaussians fitted
// to the light within distances.
GaussianChain gaussianChain(const Profile& profile, uint32_t most);

}  // namespace pel
