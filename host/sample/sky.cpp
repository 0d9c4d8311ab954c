#include "sample/sky.h"

#include <algorithm>

namespace pellucid::sample {

Rgb Sky::radiance(Vec3 direction) const {
    const double height = dot(direction, up), towards = std::max(0.0, dot(direction, normalize(lamp)));
    // The floor meets the horizon over a few degrees, so that the projection sees no jump.
    const double above = std::clamp(0.5 + 5 * height, 0.0, 1.0), rise = std::sqrt(std::max(0.0, height));
    const double glow = std::pow(towards, lampSharpness);
    Rgb out;
    for (int c = 0; c < 3; ++c)
        out[c] = scale * (floor[c] * (1 - above) + (horizon[c] + (zenith[c] - horizon[c]) * rise) * above +
                          lampRadiance[c] * glow);
    for (const Panel& panel : panels) {
        const Vec3 middle = normalize(panel.direction), right = normalize(cross(up, middle));
        const double depth = dot(direction, middle);
        constexpr double edge = 0.1;
        if (depth <= 0) continue;
        // Its edges fade, as those of a soft box do; over more than two texels of the reflected cube, so that
        // a wet eye shows no stairs.
        const auto within = [&](Vec3 axis, double half) {
            return std::clamp((half - std::abs(dot(direction, axis)) / depth) / edge + 0.5, 0.0, 1.0);
        };
        const double on = within(right, panel.halfWidth) * within(cross(middle, right), panel.halfHeight);
        for (int c = 0; c < 3; ++c) out[c] += on * panel.radiance[c];
    }
    return out;
}

std::vector<float> equirectangular(const Sky& sky, Vec3 front, int height) {
    std::vector<float> pixels;
    pixels.reserve(6 * size_t(height) * size_t(height));
    const Vec3 left = cross(sky.up, front);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < 2 * height; ++x) {
            const double latitude = pi * (0.5 - (y + 0.5) / height),
                         longitude = pi * (1 - (x + 0.5) / height);
            for (const double c :
                 sky.radiance(std::cos(latitude) * std::sin(longitude) * left + std::sin(latitude) * sky.up +
                              std::cos(latitude) * std::cos(longitude) * front))
                pixels.push_back(float(c));
        }
    return pixels;
}

}  // namespace pellucid::sample
