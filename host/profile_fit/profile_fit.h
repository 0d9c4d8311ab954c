// Fits a sum of K Gaussians to a profile.
#pragma once
#include <pellucid/pellucid.hpp>

namespace pellucid::io {

struct ProfileFit {
    std::vector<PelGaussian> gaussians;  // variances rising, mm^2
    double error[3];  // per channel of the profile that these Gaussians make when they are loaded: fitError
};

// Variances are shared by the channels; weights are >= 0 and add up to 1 per channel, as those of a loaded
// profile do; 1 <= count <= 12. Gaussians are added one by one where they help most. After each, variances
// and weights are optimised together (Levenberg, Marquardt). Finally each is removed and added where it
// helps most, until none moves. A profile that is a sum of `count` Gaussians is returned exactly.
ProfileFit fitGaussians(const Profile& profile, int count);

// Per channel: root of int (P - fit)^2 ds / int P^2 ds, over the line spread P of `profile`.
std::array<double, 3> fitError(const Profile& profile, const Profile& fit);

// The fit as a profile file that parseProfile reads.
std::string profileText(const ProfileFit& fit, const std::string& name, const std::string& source);

}  // namespace pellucid::io
