// Scattering by a few taps (section 10 of the mathematics) in double precision: on a disk round each pixel,
// and along two lines.
#pragma once

#include "reference/diffusion_screen.h"

namespace reference {

struct TapScene {
    ScatterPicture picture;
    int taps = 0, frame = 0;
    std::vector<double> radii, weights;  // per pixel; empty: 1
    Rgb border{};                        // share of what flows between ids
};

// A disk of taps, one for each ring with the same part of the light, turned from pixel to pixel; pixels seen
// in parallel along z.
std::vector<Rgb> scatterOnDisk(const TapScene& scene, const Profile& profile);

// Two filters, along rows and then along columns, of pieces of a line.
std::vector<Rgb> scatterSeparably(const TapScene& scene, const Profile& profile);

}  // namespace reference
