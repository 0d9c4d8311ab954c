// Light that comes through a small ball, from the shadow map of its light: against the surface integral, by
// quadrature over the ball, for every form of map. And what must hold for any input.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "diffusion/lit_ball.h"
#include "tolerances.h"

using namespace lit_ball;

namespace {

constexpr float notANumber = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

// Over the lit part, by midpoints in the angles round the light.
reference::Rgb surfaceIntegral(const LitBall& ball, const reference::Profile& profile, Vec3 at, int steps) {
    const Vec3 right = normalized(cross(Vec3{0, 1, 0}, ball.toLight)), up = cross(ball.toLight, right);
    reference::Rgb sum;
    for (int j = 0; j < steps; ++j)
        for (int i = 0; i < 2 * steps; ++i) {
            const double z = (j + 0.5) / steps, turn = std::numbers::pi * (i + 0.5) / steps,
                         s = std::sqrt(1 - z * z);
            const Vec3 y =
                radius * (z * ball.toLight + (s * std::cos(turn)) * right + (s * std::sin(turn)) * up);
            const double e = ball.irradiance(y), area = radius * radius / steps * std::numbers::pi / steps;
            if (e > 0) sum = sum + (e * area) * profile.radial(length(at - y));
        }
    return sum;
}

}  // namespace

// Where the ball is dark all light has come through it: every texel counts, and no pixel does.
TEST(LightSpace, ThroughABallIsTheSurfaceIntegralForEveryFormOfMap) {
    const uint32_t side = sized(24u, 16u), mapSide = sized(256u, 96u);
    const auto exact = reference::skinProfile();
    const Vec3 toLight = normalized(Vec3{0.3, 0.2, -1});
    std::vector<reference::Rgb> truths[2];  // of parallel light, of a point's
    for (Form form : forms) {
        if (form == Form::spot) continue;  // a point's, but darker
        // A cube's face is 90 degrees wide.
        const LitBall ball =
            makeBall(form, toLight, form == Form::cube || form == Form::radial ? 2 * mapSide : mapSide);
        const Picture p = pictureOf(ball, side);
        const auto at = [&](size_t i) {
            return Vec3{p.positions[3 * i], p.positions[3 * i + 1], p.positions[3 * i + 2]};
        };
        std::vector<size_t> dark;  // away from the lit rim
        for (size_t i = 0; i < p.pixels(); ++i)
            if (p.ids[i] && dot(at(i), toLight) < -0.25 * radius) dark.push_back(i);
        ASSERT_GT(dark.size(), 50u);
        std::vector<reference::Rgb>& truth = truths[ball.point];
        if (truth.empty())
            for (size_t i : dark) truth.push_back(surfaceIntegral(ball, *exact, at(i), 48));
        for (PelScattering method : {PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO}) {
            const Lit lit = shaded(p, ball, method, Profile::skin());
            double square = 0, whole = 0;
            for (size_t k = 0; k < dark.size(); ++k) {
                square += std::pow(lit.light[3 * dark[k]] - truth[k].x, 2), whole += truth[k].x * truth[k].x;
            }
            EXPECT_GT(std::sqrt(whole / double(dark.size())), 0.03);
            EXPECT_LT(std::sqrt(square / whole), method == PEL_SCATTERING_LIGHT
                                                     ? tolerance::lightThroughBall
                                                     : tolerance::hiddenThroughBall)
                << "form " << int(form) << ", method " << int(method);
        }
    }
}

// A camera that sees all that is lit needs no map.
TEST(LightSpace, TexelsThatTheCameraSeesCountOnce) {
    const LitBall ball = makeBall(Form::parallel, {0, 0, 1}, sized(256u, 64u));
    const Picture p = pictureOf(ball, sized(96u, 24u));
    LitBall without = ball;
    without.maps.clear();
    const float width = 0.4f;
    const Lit with = shaded(p, ball, PEL_SCATTERING_AUTO, Profile::skin(), width),
              alone = shaded(p, without, PEL_SCATTERING_AUTO, Profile::skin(), width);
    for (size_t i = 0; i < p.pixels(); ++i)
        if (p.ids[i] && p.positions[3 * i + 2] > 0.3 * radius) {
            ASSERT_NEAR(with.light[3 * i], alone.light[3 * i], tolerance::lightSeenTwice) << i;
        }
}

TEST(LightSpace, LightOfMapsFallsOnNobodyElse) {
    LitBall ball = makeBall(Form::parallel, normalized(Vec3{0.3, 0.2, -1}), 128);
    ball.light.worldToShadow[3] += 40;  // the ball lies outside of its map
    const Picture p = pictureOf(ball, 24);
    for (PelScattering method : {PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO}) {
        const Lit lit = shaded(p, ball, method, Profile::skin());
        for (size_t i = 0; i < p.pixels(); ++i) {
            const Vec3 at{p.positions[3 * i], p.positions[3 * i + 1], p.positions[3 * i + 2]};
            if (p.ids[i] && dot(at, ball.toLight) < -0.5 * radius) {
                ASSERT_NEAR(lit.light[3 * i], 0, 0.02) << i;
            }
        }
    }
}

TEST(LightSpace, InvalidTexelsThrowNoLight) {
    const LitBall sound = makeBall(Form::parallel, normalized(Vec3{0.3, 0.2, -1}), 128);
    LitBall ball = sound;
    for (size_t k = 0; k < ball.maps[0].size(); k += 3)
        ball.maps[0][k] = k % 2 ? notANumber : k % 4 ? infinity : -infinity;
    Picture p = pictureOf(ball, 32);
    const Lit before = shaded(p, sound, PEL_SCATTERING_LIGHT, Profile::skin()),
              after = shaded(p, ball, PEL_SCATTERING_LIGHT, Profile::skin());
    double sum[2] = {};
    for (size_t i = 0; i < 3 * p.pixels(); i += 3) {
        ASSERT_TRUE(std::isfinite(after.light[i]) && after.light[i] >= 0);
        sum[0] += before.light[i], sum[1] += after.light[i];
    }
    EXPECT_NEAR(sum[1] / sum[0], 2 / 3.0, 0.1);
}

TEST(LightSpace, AnInvalidPixelStaysAlone) {
    const LitBall ball = makeBall(Form::parallel, normalized(Vec3{1, 0.2, -0.2}), 128);
    Picture p = pictureOf(ball, 40);
    for (PelScattering method : {PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO}) {
        Picture bad = p;
        bad.irradiance[3 * p.at(25, 20) + 1] = notANumber;
        bad.positions[3 * p.at(12, 18)] = infinity;
        const Lit lit = shaded(bad, ball, method, Profile::skin(), 0.4f);
        EXPECT_EQ(lit.stats.pixelsInvalid, 2u);
        for (float v : lit.light) ASSERT_TRUE(std::isfinite(v));
    }
}

TEST(LightSpace, SizesAndRadiiAtTheirEnds) {
    const LitBall ball = makeBall(Form::parallel, normalized(Vec3{0.5, 0.2, -1}), 64);
    LitBall least = ball;
    least.width = least.height = 1;
    least.maps = {{0.4f}};
    for (PelScattering method : {PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO})
        for (uint32_t side : {1u, 17u})
            for (float width : {1e-6f, 1.0f, 1e6f})
                for (const LitBall* b : {&ball, static_cast<const LitBall*>(&least)}) {
                    const Picture p = pictureOf(*b, side);
                    for (float v : shaded(p, *b, method, Profile::skin(), width).light)
                        ASSERT_TRUE(v >= 0 && v < 2)
                            << side << " pixels, radius " << width << ", map of " << b->width;
                }
}

TEST(LightSpace, SameInputSameBits) {
    const LitBall ball = makeBall(Form::parallel, normalized(Vec3{0.6, 0.2, -0.5}), 128);
    const Picture p = pictureOf(ball, 48);
    for (PelScattering method : {PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO})
        EXPECT_EQ(shaded(p, ball, method, Profile::skin()).light,
                  shaded(p, ball, method, Profile::skin()).light);
}

// Parts of the lights' pyramids that hold nothing are not written.
TEST(LightSpace, AMapThatChangesLeavesNothingBehind) {
    const LitBall first = makeBall(Form::parallel, normalized(Vec3{0.6, 0.2, -0.5}), 128),
                  second = makeBall(Form::parallel, normalized(Vec3{-0.6, 0.1, -0.4}), 128);
    LitBall nothing = second;
    std::fill(nothing.maps[0].begin(), nothing.maps[0].end(), 1.0f);
    for (PelScattering method : {PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO}) {
        ShownImages shown(device(), 48, 48);
        for (const LitBall& ball : {first, second, nothing, nothing, first}) {
            const Picture p = pictureOf(ball, 48);
            EXPECT_EQ(show(shown, p, {ball}, Profile::skin(), {method}).light,
                      shaded(p, ball, method, Profile::skin()).light);
        }
    }
}

// A light without a map beside it: as on the screen, and said.
TEST(LightSpace, WithoutAllMapsTheScreenDoes) {
    LitBall ball = makeBall(Form::parallel, normalized(Vec3{1, 0.2, 0.4}), 64);
    ball.maps.clear();
    const Picture p = pictureOf(ball, 40);
    const Lit light = shaded(p, ball, PEL_SCATTERING_LIGHT, Profile::skin(), 0.4f),
              screen = shaded(p, ball, PEL_SCATTERING_SCREEN, Profile::skin(), 0.4f);
    EXPECT_EQ(light.light, screen.light);
    EXPECT_NE(light.warnings.find("shadow maps do not hold all light"), std::string::npos) << light.warnings;
    EXPECT_EQ(screen.warnings.find("shadow maps do not hold"), std::string::npos);
}

// Maps of all lights, faces of cubes one by one: 24 are the most.
TEST(LightSpace, MoreMapsThanThereIsRoomForAreSummedOnTheScreen) {
    const Vec3 toLight = normalized(Vec3{0.3, 0.2, 1});
    std::vector<LitBall> lights;
    for (int cubes = 0; cubes <= 4; ++cubes) {
        const Lit lit = shaded(pictureOf(lights, 16), lights, Profile::skin(), {PEL_SCATTERING_LIGHT});
        EXPECT_EQ(lit.warnings.find("do not hold all light") != std::string::npos, cubes == 0)
            << lit.warnings;
        lights.push_back(makeBall(Form::cube, toLight, 8));
    }
    lights.back() = makeBall(Form::parallel, toLight, 16);
    const Lit lit = shaded(pictureOf(lights, 16), lights, Profile::skin(), {PEL_SCATTERING_LIGHT});
    EXPECT_NE(lit.warnings.find("do not hold all light"), std::string::npos);
}

TEST(LightSpace, ASingularMatrixIsAnError) {
    LitBall ball = makeBall(Form::parallel, {0, 0, 1}, 16);
    std::fill_n(ball.light.worldToShadow + 4, 4, 0.0f);
    EXPECT_THROW(shaded(pictureOf(ball, 16), ball, PEL_SCATTERING_LIGHT, Profile::skin()), std::exception);
}
