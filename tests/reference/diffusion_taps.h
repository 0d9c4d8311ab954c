// Scattering by a few taps (section 10 of the mathematics) in double precision: on a disk round each pixel,
// and along two lines.
#pragma once

#include "reference/diffusion_screen.h"

namespace reference {

struct TapScene {
    ScatterPicture picture;
    int taps = 0, frame = 0;
    int rate = 1;                        // pixels from one that gathers to the next
    std::vector<double> radii, weights;  // per pixel; empty: 1
    Rgb border{};                        // share of what flows between ids
};

// A disk of taps, one for each ring with the same part of the light, turned from pixel to pixel; pixels seen
// in parallel along z.
std::vector<Rgb> scatterOnDisk(const TapScene& scene, const Profile& profile);

// At half rate, from what the pixels of even columns and rows gather, weights apart: the mean of those round
// a pixel that lie on its surface, without light from within a disk as large as the pixel, for which its own
// irradiance counts. Empty where there are none.
std::vector<std::optional<Rgb>> betweenSamples(const TapScene& scene, const Profile& profile,
                                               const std::vector<Rgb>& gathered);

// The history at a pixel.
struct HistoryPixel {
    int id = 0, frames = 0;  // 0: nothing
    Rgb light{};
    double distance = 0;  // along z
};
// Blends the gathered light with that of earlier frames, except light from within each pixel. `motion`:
// columns, rows and distance to where each pixel was. Returns the blended light, and replaces the history,
// which is empty before the first frame.
std::vector<Rgb> blendHistory(const TapScene& scene, const Profile& profile, const std::vector<Rgb>& gathered,
                              const std::vector<Vec3>& motion, double weight,
                              std::vector<HistoryPixel>& history);

// Two filters, along rows and then along columns, of pieces of a line.
std::vector<Rgb> scatterSeparably(const TapScene& scene, const Profile& profile);

}  // namespace reference
