// Cube shadow maps of point lights: thickness and wide shadow against the oracle, against a perspective map,
// and turned.
#include <gtest/gtest.h>

#include <limits>

#include "shader_ready.h"
#include "shadow_form_truth.h"
#include "tolerances.h"

using namespace shade_test;

namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
const Vec3 lamp{24, 10, 70}, down{0, 0, -1};
// A face in the middle of the picture, an edge, a corner of three faces.
const Vec3 aims[] = {{0, 0, 1}, {1, 0, 1}, {-1, 1, 1}};

// Bumps on open ground, in cells of texels: nothing that a mistaken texel would leave as it is.
double bumps(Vec3 d, int texel) {
    const double ground = d.z < -1e-3 ? (lamp.z + 8) / -d.z : 500;
    const int cell = texel / 7 * 31;
    return std::min(ground, 500.0) - (cell % 3 ? 9 + cell % 23 : 0) / reference::length(d);
}

TEST(ShadowCube, MatchesTheOracle) {
    for (const bool radial : {false, true})
        for (const Vec3 aim : aims)
            for (const uint32_t size : {16u, 128u}) {
                const CubeLight from = cubeLight(size, radial, turnTo(down, aim), lamp, bumps);
                Frame f = formFrame();
                f.options.rotateTaps = radial && size == 16;
                const Seen seen = shadeForms(f, {from.light});
                EXPECT_TRUE(seen.stats.features & PEL_FEATURE_SHADOW_CUBE);
                const Worst worst = worstOf(f, seen, truthOf(from));
                const auto what = testing::Message()
                                  << "radial " << radial << ", aim " << aim.x << aim.y << ", " << size;
                EXPECT_LE(worst.wide, tolerance::wideShadow) << what;
                EXPECT_LE(worst.thickness, tolerance::cubeThickness) << what;
                EXPECT_GT(worst.penumbra, f.pixels() / 50) << what;
                EXPECT_GT(worst.thick, f.pixels() / 20) << what;
            }
}

// A ball over open ground: where the light looks along the axis of a face, that face alone is a perspective
// map.
double ballOverGround(Vec3 d, int) {
    const Vec3 centre = Vec3{24, 10, 30} - lamp;
    const double radius = 8, along = reference::dot(d, centre), d2 = reference::dot(d, d),
                 root = along * along - d2 * (reference::dot(centre, centre) - radius * radius);
    if (root > 0 && along > 0) return (along - std::sqrt(root)) / d2;
    return d.z < -1e-3 ? std::min((lamp.z + 8) / -d.z, 500.0) : 500;
}

TEST(ShadowCube, EqualsAPerspectiveMapAlongTheAxis) {
    const uint32_t size = 512;
    const CubeLight cube = cubeLight(size, false, turnTo(down, {0, 0, 1}), lamp, ballOverGround);
    Light face = cube.light;
    face.params.shadowProjection = PEL_SHADOW_PERSPECTIVE;
    face.maps[0].height = size;
    face.maps[0].values.assign(cube.map.depth.begin() + 4 * size * size,
                               cube.map.depth.begin() + 5 * size * size);
    // u = (x / z + 1) / 2, v = (-y / z + 1) / 2; z = (1 / distance - B) / A, times the distance.
    const float* t = cube.light.params.worldToShadow;
    for (int c = 0; c < 4; ++c) {
        face.params.worldToShadow[c] = 0.5f * (t[c] + t[8 + c]);
        face.params.worldToShadow[4 + c] = 0.5f * (-t[4 + c] + t[8 + c]);
        face.params.worldToShadow[8 + c] =
            ((c == 3) - cube.light.params.shadowDepthB * t[8 + c]) / cube.light.params.shadowDepthA;
        face.params.worldToShadow[12 + c] = t[8 + c];
    }
    const Frame f = formFrame();
    const Seen asCube = shadeForms(f, {cube.light}), asFace = shadeForms(f, {face});
    size_t compared = 0;
    for (size_t i = 0; i < f.pixels(); ++i) {
        const Vec3 aside = f.slots[PEL_SLOT_POSITION].vec(i) - lamp;
        if (!materialAt(f, i) || std::hypot(aside.x, aside.y) > 5)
            continue;  // 4 degrees: 1 - cosine = 0.0025
        ++compared;
        EXPECT_NEAR(asCube.wide[i], asFace.wide[i], tolerance::cubeAsPerspective) << i;
        EXPECT_NEAR(asCube.thickness[i], asFace.thickness[i],
                    tolerance::cubeAsPerspective * (1 + asFace.thickness[i]))
            << i;
    }
    EXPECT_GT(compared, 300u);
}

TEST(ShadowCube, TurningItChangesNothingAndFacesMeetWithoutASeam) {
    const Frame f = formFrame();
    const Seen straight =
        shadeForms(f, {cubeLight(512, false, turnTo(down, aims[0]), lamp, ballOverGround).light});
    for (const Vec3 aim : {aims[1], aims[2]})
        for (const bool radial : {false, true}) {
            const Seen turned =
                shadeForms(f, {cubeLight(512, radial, turnTo(down, aim), lamp, ballOverGround).light});
            double wide = 0, thickness = 0;
            for (size_t i = 0; i < f.pixels(); ++i) {
                if (!materialAt(f, i)) continue;
                EXPECT_NEAR(turned.wide[i], straight.wide[i], tolerance::cubeTurned) << i;
                wide += std::abs(turned.wide[i] - straight.wide[i]);
                // Taps lie elsewhere in the disk: only the mean of thickness can stay.
                thickness += turned.thickness[i] - straight.thickness[i];
            }
            EXPECT_LE(wide / double(f.pixels()), tolerance::cubeTurned / 10);
            EXPECT_NEAR(thickness / double(f.pixels()), 0, tolerance::cubeTurnedThickness);
        }
}

TEST(ShadowCube, SkippingAndRunsChangeNoBit) {
    Frame f = formFrame(3);
    f.options.countPixels = 1;
    CubeLight from = cubeLight(64, false, turnTo(down, aims[2]), lamp, bumps);
    from.light.params.range = 71;  // reaches the middle only
    const Seen with = shadeForms(f, {from.light}), again = shadeForms(f, {from.light});
    f.options.disableSkipping = 1;
    const Seen without = shadeForms(f, {from.light});
    EXPECT_EQ(with.wide, again.wide);
    EXPECT_EQ(with.thickness, again.thickness);
    EXPECT_EQ(with.wide, without.wide);
    EXPECT_EQ(with.thickness, without.thickness);
    EXPECT_LT(with.stats.pixelsWideShadow, without.stats.pixelsWideShadow);
    EXPECT_GT(with.stats.pixelsWideShadow, 0u);
}

TEST(ShadowCube, BadTexelsAndPlaces) {
    CubeLight from = cubeLight(64, false, turnTo(down, aims[2]), lamp, bumps);
    for (size_t i = 0; i < from.map.depth.size(); i += 5)
        from.light.maps[0].values[i] = nan, from.map.depth[i] = NAN;
    Frame f = formFrame();
    Worst worst = worstOf(f, shadeForms(f, {from.light}), truthOf(from));
    EXPECT_LE(worst.wide, tolerance::wideShadow) << "such texels throw no shadow";
    // Of thickness the oracle's NaN taps count as none too.
    EXPECT_LE(worst.thickness, tolerance::cubeThickness);
    const Seen before = shadeForms(f, {from.light});
    f.slots[PEL_SLOT_POSITION].values[3 * 1700] = nan;
    for (int c = 0; c < 3; ++c) f.slots[PEL_SLOT_POSITION].values[3 * 1703 + c] = 1e30f;
    for (int c = 0; c < 3; ++c)
        f.slots[PEL_SLOT_POSITION].values[3 * 1706 + c] = float(lamp[c]);  // at the light
    const Seen after = shadeForms(f, {from.light});
    for (size_t i = 0; i < f.pixels(); ++i) {
        EXPECT_TRUE(std::isfinite(after.thickness[i])) << i;
        if (i != 1700 && i != 1703 && i != 1706) {
            EXPECT_EQ(after.wide[i], before.wide[i]) << i;
            EXPECT_EQ(after.thickness[i], before.thickness[i]) << i;
        }
    }
    // The smallest of cubes.
    const CubeLight tiny = cubeLight(1, true, turnTo(down, aims[1]), lamp, bumps);
    f = formFrame(1, 9, 3);
    worst = worstOf(f, shadeForms(f, {tiny.light}), truthOf(tiny));
    EXPECT_LE(worst.wide, tolerance::wideShadow);
    EXPECT_LE(worst.thickness, tolerance::cubeThickness);
}

TEST(ShadowCube, WhatIsRefused) {
    const auto refused = [&](const char* word, auto change) {
        CubeLight from = cubeLight(16, false, turnTo(down, aims[0]), lamp, bumps);
        change(from.light);
        expectError(PEL_ERROR_INVALID_ARGUMENT, {word},
                    [&] { shadeForms(formFrame(1, 9, 3), {from.light}); });
    };
    refused("16 x 96", [](Light& l) { l.maps[0].height = 95; });
    refused("directional", [](Light& l) { l.params.type = PEL_LIGHT_DIRECTIONAL; });
    refused("shadowDepthA is 0", [](Light& l) { l.params.shadowDepthA = 0; });
    refused("shadowDepthRange", [](Light& l) {
        l.params.shadowProjection = PEL_SHADOW_CUBE_RADIAL;
        l.params.shadowDepthRange = -1;
    });
    refused("origin", [](Light& l) { l.params.worldToShadow[3] += 1; });
    refused("rotation", [](Light& l) {
        for (int c = 0; c < 4; ++c) l.params.worldToShadow[c] *= 2;
    });
    refused("rotation", [](Light& l) { std::fill_n(l.params.worldToShadow, 16, 0.0f); });
    refused("finite", [](Light& l) { l.params.worldToShadow[5] = nan; });
    refused("PelShadowProjection", [](Light& l) { l.params.shadowProjection = PelShadowProjection(4); });
    refused("cascades", [](Light& l) { l.params.shadowCascades = 1; });
}

}  // namespace
