#include "ops/lut_terms.h"

#include <algorithm>
#include <cmath>

namespace pel {

double rowLimit(double length, double diffusionRadius) {
    return std::clamp(diffusionRadius / length, 1e-9, 1e9);
}

// A Gaussian narrower than 1e-8 of the profile and of the table's smallest radius changes no texel by more:
// it is kept from 0, where its density has no value. Terms that weigh nothing in any channel are left out.
std::vector<LutGaussian> deviceTerms(const Profile& profile, double steepestRow) {
    if (profile.terms().empty())
        fail(PEL_ERROR_UNSUPPORTED, "profile ", profile.name(),
             " is a table, and tables are not integrated: give a sum of Gaussians fitted to it");
    std::vector<LutGaussian> terms;
    for (const GaussianTerm& term : profile.terms()) {
        if (std::max({term.weight[0], term.weight[1], term.weight[2]}) < 1e-9) continue;
        const double sigma =
            std::max(std::sqrt(term.variance) / profile.radius(), 1e-8 / std::max(1.0, steepestRow));
        terms.push_back({float(sigma), float(term.weight[0]), float(term.weight[1]), float(term.weight[2])});
    }
    return terms;
}

}  // namespace pel
