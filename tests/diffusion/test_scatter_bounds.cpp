// What no sum over lit surface can bring: less than the darkest or more than the brightest irradiance of
// the picture, and, in a dark gap between lit walls, less light of a channel that scatters farther.
#include <gtest/gtest.h>

#include <algorithm>

#include "diffusion/scatter_scene.h"
#include "tolerances.h"

using namespace scatter_scene;

namespace {

// Two rods that touch, as lips do, seen along -z and lit from above, the upper one casting its shadow on
// the lower: below the middle of the upper one lies a dark gap, which ends at a limb.
Picture lips(uint32_t side, double size, double radius, double elevation, double turn) {
    Picture p(side, side);
    const Vec3 toLight{0, std::sin(elevation), std::cos(elevation)};
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const double a = (x + 0.5 - 0.5 * side) * size, b = (0.5 * side - y - 0.5) * size,
                         u = std::cos(turn) * a - std::sin(turn) * b,
                         v = std::sin(turn) * a + std::cos(turn) * b;
            const double middle = v > 0 ? radius : -radius,
                         rest = radius * radius - (v - middle) * (v - middle);
            if (rest <= 0) continue;
            const double z = std::sqrt(rest);
            const Vec3 n{0, (v - middle) / radius, z / radius};
            double e = reference::max0(dot(n, toLight));
            // The ray to the light passes the upper rod's axis at this distance.
            const double across = (v - radius) * toLight.z - z * toLight.y;
            if (v < 0 && std::abs(across) < radius) e = 0;
            p.set(p.at(x, y), {u, v, z}, {e, e, e});
        }
    return p;
}

// What is wrong with a picture: by how much it is brighter than all irradiance, and a dark pixel's channel
// darker than one that scatters less far.
struct Wrong {
    double brighter = 0, bluer = 0;
    size_t dark = 0;
};

Wrong wrongOf(const Picture& p, double radius) {
    const Result result = run(p, Profile::skin());
    const float brightest = *std::max_element(p.irradiance.begin(), p.irradiance.end());
    Wrong wrong;
    for (size_t i = 0; i < p.pixels(); ++i) {
        if (!p.ids[i]) continue;
        const float *s = &result.scattered[3 * i], v = p.positions[3 * i + 1];
        for (int c = 0; c < 3; ++c) {
            EXPECT_GE(s[c], 0);
            wrong.brighter = std::max(wrong.brighter, double(s[c] - brightest));
        }
        const bool atEdge = i % p.width < 2 || i % p.width + 2 >= p.width;  // what lies beyond is not known
        if (atEdge || p.irradiance[3 * i] > 0 || v < -radius / 8 || v > radius) continue;
        ++wrong.dark;
        for (int c = 0; c < 2; ++c) wrong.bluer = std::max(wrong.bluer, double(s[c + 1] - s[c]));
    }
    return wrong;
}

}  // namespace

TEST(ScatterBounds, NeitherBrighterThanItsLightNorBlueInADarkGap) {
    const uint32_t side = sized(96u, 24u);
    size_t dark = 0;
    for (double size : {0.15, 0.35, 0.7})
        for (double turn : {0.0, 0.3, 1.2})
            for (double elevation : {0.6, 1.0, 1.35}) {
                const double radius = 0.24 * side * size;
                const Wrong wrong = wrongOf(lips(side, size, radius, elevation, turn), radius);
                dark += wrong.dark;
                EXPECT_LE(wrong.brighter, 1e-4) << size << " mm, " << turn << ", " << elevation;
                EXPECT_LE(wrong.bluer, tolerance::scatterBluer)
                    << size << " mm, " << turn << ", " << elevation;
            }
    EXPECT_GT(dark, 0u);
}
