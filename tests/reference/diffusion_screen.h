// Scattering on the screen (sections 9 and 10 of the mathematics) in double precision: every pixel sums over
// every other one.
#pragma once

#include <optional>

#include "reference/profile.h"

namespace reference {

struct ScatterPicture {
    int width = 0, height = 0;
    std::vector<Vec3> positions;  // length
    std::vector<Rgb> irradiance;
    std::vector<int> ids;       // 0 is background
    std::vector<double> radii;  // s per pixel: it takes R(d / s) / s^2; empty: 1
    // surface seen at less than a quarter of its area counts as if it were a quarter
    std::optional<Vec3> camera;
    double directed = 0;  // with a camera: factor max0(1 + directed t) of section 12, t by n_x alone
    size_t at(int x, int y) const { return size_t(y) * width + x; }
    bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
};

// The distance beyond which the profile's light is left out: where no channel has more than 0.4 % left.
double scatterReach(const Profile& profile);

// Whether a pixel has an id, and a finite position and irradiance.
bool sound(const ScatterPicture& picture, size_t pixel);
// The shorter of the two steps along (dx, dy) to a sound pixel of the same id; empty where neither is one.
std::optional<Vec3> shorterStep(const ScatterPicture& picture, int x, int y, int dx, int dy);

// Surface under a pixel: the cross product of the shorter steps to neighbours of its id; squares where there
// is one step, 0 where there is none.
double surfaceArea(const ScatterPicture& picture, int x, int y);

// The sum divided by the sum of weights without the factor of directions. Pixels whose irradiance or position
// is not finite are ignored by others and keep their value.
std::vector<Rgb> scatterOnScreen(const ScatterPicture& picture, const Profile& profile);

}  // namespace reference
