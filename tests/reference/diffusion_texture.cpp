#include "reference/diffusion_texture.h"

#include <numbers>

namespace reference {

std::vector<Rgb> scatterTexels(const std::vector<Texel>& texels, const Profile& profile) {
    std::vector<Rgb> result;
    for (const Texel& here : texels) {
        Rgb light{}, weights{};
        for (const Texel& there : texels) {
            if (!(here.area > 0) || !(there.area > 0) || there.island != here.island) continue;
            const double distance = length(there.position - here.position);
            const Rgb weight = &there == &here
                                   ? enclosedEnergy(profile, std::sqrt(here.area / std::numbers::pi))
                                   : there.area * profile.radial(distance);
            light = light + weight * there.irradiance;
            weights = weights + weight;
        }
        Rgb mean{};
        for (int c = 0; c < 3; ++c) mean[c] = weights[c] > 0 ? light[c] / weights[c] : 0;
        result.push_back(mean);
    }
    return result;
}

}  // namespace reference
