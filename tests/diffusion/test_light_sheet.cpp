// A thin strip that is lit from behind, before something bright and far away: light comes through it, also
// where a tile of pixels is mostly what lies behind.
#include <gtest/gtest.h>

#include "diffusion/lit_ball.h"
#include "tolerances.h"

using namespace lit_ball;

namespace {

constexpr double pixel = 0.25, halfWidth = 1, thickness = 0.8, extent = 16;  // mm

Picture stripPicture(uint32_t side, double shift) {
    Picture p(side, side);
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const double u = (x + 0.5 - 0.5 * side) * pixel - shift, v = (0.5 * side - y - 0.5) * pixel;
            const bool strip = std::abs(u) < halfWidth;
            p.set(p.at(x, y), {u, v, strip ? 0.0 : -50.0}, strip ? Vec3{} : Vec3{1, 1, 1});
        }
    return p;
}

// Light along +z, whose map shows the strip's back.
LitBall lightBehind(uint32_t side) {
    LitBall light;
    light.toLight = {0, 0, -1};
    for (int k = 0; k < 3; ++k) light.light.toLight[k] = float(light.toLight[k]);
    light.width = light.height = side;
    setRow(light.light.worldToShadow, 0, {1 / extent, 0, 0}, 0.5);
    setRow(light.light.worldToShadow, 1, {0, -1 / extent, 0}, 0.5);
    setRow(light.light.worldToShadow, 2, {0, 0, 0.05}, 1);
    setRow(light.light.worldToShadow, 3, {}, 1);
    light.light.shadowDepthRange = 20;
    light.maps.emplace_back(side * side, 1.0f);
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x)
            if (std::abs(((x + 0.5) / side - 0.5) * extent) < halfWidth)
                light.maps[0][y * side + x] = float(1 - 0.05 * thickness);
    return light;
}

// What comes through at x: the sum over the strip's back, infinitely long.
reference::Rgb through(const reference::Profile& profile, double x) {
    constexpr double step = 0.05, far = 12;
    reference::Rgb sum;
    for (double u = -halfWidth + step / 2; u < halfWidth; u += step)
        for (double v = step / 2; v < far; v += step)
            sum = sum + 2 * step * step * profile.radial(std::hypot(u - x, v, thickness));
    return sum;
}

}  // namespace

TEST(LightSheet, LightComesThroughInEveryTile) {
    const uint32_t side = sized(64u, 32u);
    const auto exact = reference::skinProfile();
    const LitBall light = lightBehind(sized(256u, 128u));
    for (double shift : {0.0, 1.0, 1.75, -1.5}) {  // over the borders of tiles
        const Picture p = stripPicture(side, shift);
        const Lit lit = shaded(p, light, PEL_SCATTERING_AUTO, Profile::skin());
        EXPECT_GT(lit.stats.tilesByScattering[PEL_SCATTERING_LIGHT], 0u);
        EXPECT_LT(lit.stats.tilesByScattering[PEL_SCATTERING_LIGHT], side * side / 256u);
        for (uint32_t y = side / 4; y < 3 * side / 4; ++y)
            for (uint32_t x = 0; x < side; ++x) {
                const size_t i = p.at(x, y);
                if (p.irradiance[3 * i] > 0) continue;
                const reference::Rgb truth = through(*exact, p.positions[3 * i]);
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(lit.light[3 * i + size_t(c)], truth[c],
                                tolerance::throughSheet * truth[0] + tolerance::neverWorse)
                        << "pixel " << x << " " << y << ", channel " << c << ", shift " << shift;
            }
    }
}
