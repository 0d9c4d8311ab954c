// The best sum of K Gaussians for a profile.
#pragma once
#include <pellucid/pellucid.hpp>
#include <string>
#include <vector>

namespace pellucid::io {

struct ProfileFit {
    std::vector<PelGaussian> gaussians;  // variances rising, mm^2
    double error[3];  // per channel: root of int (P - fit)^2 ds / int P^2 ds, over the line spread P
};

// Variances shared by the channels, weights >= 0 per channel; 1 <= count <= 12. The weights are the exact
// least squares for the variances, and those are moved until no step improves them: a local optimum, from
// logarithmically even ones.
ProfileFit fitGaussians(const Profile& profile, int count);

// The fit as a profile file that parseProfile reads.
std::string profileText(const ProfileFit& fit, const std::string& name, const std::string& source);

}  // namespace pellucid::io
