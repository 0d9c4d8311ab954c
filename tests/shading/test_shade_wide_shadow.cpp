// Wide shadows that the shader filters from shadow maps.
#include <gtest/gtest.h>

#include <limits>

#include "pass_scene.h"
#include "shader_ready.h"
#include "tolerances.h"

using namespace shade_test;

namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

Frame litRelief(const MapLight& from, uint32_t seed = 1) {
    Frame f = reliefFrame(seed, 120, 50, 0.4f);
    f.materials[2].shadowFilterWidth = 5;
    f.lights = {from.light};
    showWideShadow(f);
    return f;
}

reference::WideFilterParams params(const PelLight& l, double width) {
    return {width, l.shadowBias, l.shadowSoftness, l.shadowConeSlope, int(l.shadowFilterTexels)};
}

double worstShadow(const Frame& f, const MapLight& from, const std::vector<float>& shown) {
    double worst = 0;
    for (size_t i = 0; i < f.pixels(); ++i) {
        const auto found = f.materials.find(uint32_t(f.slots[PEL_SLOT_MATERIAL].at(i)));
        if (found == f.materials.end()) continue;
        const double truth = reference::wideShadow(
            from.map, from.view, f.slots[PEL_SLOT_POSITION].vec(i), f.slots[PEL_SLOT_NORMAL_GEOMETRIC].vec(i),
            params(from.light.params, found->second.shadowFilterWidth));
        worst = std::max(worst, std::abs(truth - shown[3 * i]));
    }
    return worst;
}

TEST(WideShadow, MatchesTheOracle) {
    for (const bool perspective : {false, true})
        for (const bool reversed : {false, true})
            for (const uint32_t size : {61u, 300u}) {
                const MapLight from =
                    mapLight(size, perspective, reversed, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, size);
                const Frame f = litRelief(from);
                PelShaderStats stats = pelShaderStatsDefaults();
                const auto shown = shade(device(), f, tables(), &stats);
                EXPECT_EQ(stats.features, uint32_t(PEL_FEATURE_SHADOW | PEL_FEATURE_FILTER_SHADOW));
                EXPECT_EQ(stats.launches, 4u);
                EXPECT_LE(worstShadow(f, from, shown), tolerance::wideShadow)
                    << "perspective " << perspective << ", reversed " << reversed << ", " << size
                    << " texels";
                size_t penumbra = 0;
                for (size_t i = 0; i < f.pixels(); ++i)
                    penumbra += shown[3 * i] > 0.1f && shown[3 * i] < 0.9f;
                EXPECT_GT(penumbra, f.pixels() / 20) << "there is something to see";
            }
}

// A straight edge high over a plane gives w = (1 + q sqrt(2 - q^2)) / 2 at q from -1 to 1 across it: the
// profile by which the shadow table reads its columns.
TEST(WideShadow, AStraightEdgeHasTheTablesProfile) {
    MapLight from = mapLight(1, false, false, {0, 0, 1}, {24, 10, 0}, 64, 640);
    const Vec3 edge = from.view.right;
    for (uint32_t i = 0; i < 640 * 640; ++i) {
        const double u = (i % 640 + 0.5) / 640;
        from.light.map.values[i] = float((u < 0.5 ? 100 : 200) / 300.0);
    }
    from.light.params.shadowFilterTexels = 256;
    Frame f = reliefFrame(1, 120, 50, 0.4f);
    for (size_t i = 0; i < f.pixels(); ++i) {
        f.slots[PEL_SLOT_MATERIAL].values[i] = 1;
        f.slots[PEL_SLOT_POSITION].values[3 * i + 2] = 0;
        const float up[3] = {0, 0, 1};
        std::copy_n(up, 3, &f.slots[PEL_SLOT_NORMAL_GEOMETRIC].values[3 * i]);
    }
    f.lights = {from.light};
    showWideShadow(f);
    const auto shown = shade(device(), f, tables());
    for (size_t i = 0; i < f.pixels(); ++i) {
        const double across = reference::dot(f.slots[PEL_SLOT_POSITION].vec(i) - Vec3{24, 10, 0}, edge);
        const double q = std::clamp(across / 4, -1.0, 1.0);
        EXPECT_NEAR(shown[3 * i], (1 + q * std::sqrt(2 - q * q)) / 2, tolerance::wideShadowEdge) << across;
    }
}

// Pre-integrated materials are shadowed by a map whatever the light says of its filter, unless it turns the
// filter off.
TEST(WideShadow, ALightWithAShadowMapCastsAShadowByDefault) {
    MapLight from = mapLight(3, false, false, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, 61);
    from.light.params.shadowFilterTexels = pelLightDefaults().shadowFilterTexels;
    const auto warningsOf = [](const Frame& f) {
        pellucid::Shader s(device());
        setFrame(device(), s, f, tables());
        const auto target = setTarget(device(), s, f);
        return s.commit().warnings();
    };
    for (const bool besideScreen : {false, true}) {
        Frame f = litRelief(from);
        if (besideScreen) f.materials[2].scattering = PEL_SCATTERING_NONE;
        const auto darkPixels = [&] {
            const auto shown = shade(device(), f, tables());
            size_t dark = 0;
            for (size_t i = 0; i < f.pixels(); ++i)
                dark += f.slots[PEL_SLOT_MATERIAL].at(i) == 1 && shown[3 * i] < 0.5f;
            return dark;
        };
        EXPECT_GT(darkPixels(), f.pixels() / 50);
        EXPECT_EQ(warningsOf(f).find("no shadow"), std::string::npos);
        f.lights[0].params.shadowFilterTexels = 0;
        EXPECT_EQ(darkPixels(), 0u);
        EXPECT_NE(warningsOf(f).find("gets no shadow from the map of light 0"), std::string::npos)
            << warningsOf(f);
    }
}

TEST(WideShadow, OffCostsNothingAndAnImageGoesFirst) {
    const MapLight from = mapLight(3, false, false, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, 61);
    Frame f = litRelief(from);
    f.options.countPixels = 1;
    PelShaderStats off = pelShaderStatsDefaults(), on = off, given = off;
    shade(device(), f, tables(), &on);
    size_t skin = 0;
    for (float id : f.slots[PEL_SLOT_MATERIAL].values) skin += id != 0;
    EXPECT_EQ(on.pixelsWideShadow, skin);
    f.lights[0].params.shadowFilterTexels = 0;
    shade(device(), f, tables(), &off);
    EXPECT_EQ(off.features, 0u);
    EXPECT_EQ(off.launches + 2, on.launches);
    EXPECT_GE(on.scratchBytes, off.scratchBytes + 4 * f.pixels());
    EXPECT_EQ(off.pixelsWideShadow, 0u);
    f.lights[0].params.shadowFilterTexels = 24;
    f.lights[0].wide.components = 1;
    f.lights[0].wide.values.assign(f.pixels(), 0.5f);
    EXPECT_EQ(shade(device(), f, tables(), &given)[3 * (f.pixels() - 1)], 0.5f);
    EXPECT_EQ(given.launches, off.launches);
}

// Filters that the bounds of the map's blocks decide read no texel, and come out as if they had.
TEST(WideShadow, BoundsDecideWithoutTexels) {
    double decided = 0, all = 0;
    for (uint32_t seed = 0; seed < 24; ++seed) {
        MapLight from =
            mapLight(seed, seed % 2, seed / 2 % 2, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, 90 + 37 * seed);
        if (seed % 3 == 0)
            for (size_t i = seed; i < from.light.map.values.size(); i += 1001)
                from.light.map.values[i] = seed % 2 ? nan : -std::numeric_limits<float>::infinity();
        Frame f = litRelief(from, seed);
        f.options.countPixels = 1;
        f.lights[0].params.shadowFilterTexels = seed % 5 ? 24 : 4;
        if (seed % 4)
            for (auto& [id, material] : f.materials) material.shadowFilterWidth *= 0.3f;
        PelShaderStats with = pelShaderStatsDefaults();
        const auto first = shade(device(), f, tables(), &with);
        f.options.disableSkipping = 1;
        EXPECT_EQ(first, shade(device(), f, tables())) << seed;
        EXPECT_GT(with.pixelsShadowTexels, 0u) << "penumbrae are read";
        decided += double(with.pixelsWideShadow - with.pixelsShadowTexels);
        all += double(with.pixelsWideShadow);
        size_t uniform = 0;
        for (size_t i = 0; i < f.pixels(); ++i)
            uniform += f.slots[PEL_SLOT_MATERIAL].values[i] != 0 && (first[3 * i] == 0 || first[3 * i] == 1);
        EXPECT_LE(with.pixelsWideShadow - with.pixelsShadowTexels, uniform) << seed;
    }
    EXPECT_GT(decided / all, 0.2) << decided << " of " << all;
}

// A matrix of homogeneous coordinates may have any factor.
TEST(WideShadow, AFactorOfTheMatrixChangesNothing) {
    for (const bool perspective : {false, true})
        for (const bool reversed : {false, true}) {
            Frame f = litRelief(mapLight(5, perspective, reversed, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, 90));
            const auto first = shade(device(), f, tables());
            for (float factor : {0.25f, 4.0f}) {
                Frame scaled = f;
                for (float& m : scaled.lights[0].params.worldToShadow) m *= factor;
                EXPECT_EQ(shade(device(), scaled, tables()), first) << factor << perspective << reversed;
            }
        }
}

TEST(WideShadow, BadTexelsAndPixels) {
    MapLight from = mapLight(3, true, false, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, 61);
    for (size_t i = 0; i < from.map.depth.size(); i += 5)
        from.light.map.values[i] = i % 2 ? nan : std::numeric_limits<float>::infinity(),
        from.map.depth[i] = NAN;
    Frame f = litRelief(from);
    EXPECT_LE(worstShadow(f, from, shade(device(), f, tables())), tolerance::wideShadow)
        << "such texels throw no shadow";
    const auto before = shade(device(), f, tables());
    f.options.invalidColor[0] = -7;
    f.slots[PEL_SLOT_NORMAL_GEOMETRIC].values[3 * 1700] = nan;
    for (int c = 0; c < 3; ++c) f.slots[PEL_SLOT_POSITION].values[3 * 1703 + c] = 1e30f;
    const auto after = shade(device(), f, tables());
    for (size_t i = 0; i < f.pixels(); ++i) {
        EXPECT_TRUE(std::isfinite(after[3 * i])) << i;
        if (i != 1700 && i != 1703) {
            EXPECT_EQ(after[3 * i], before[3 * i]) << i;
        }
    }
    EXPECT_EQ(after[3 * 1703], 1.0f) << "far outside of the map: lit";
}

TEST(WideShadow, WhatIsRefused) {
    const MapLight from = mapLight(3, false, false, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, 61);
    const auto refused = [&](PelError code, const char* word, auto change) {
        Frame f = litRelief(from);
        change(f);
        expectError(code, {word}, [&] { shade(device(), f, tables()); });
    };
    const auto invalid = PEL_ERROR_INVALID_ARGUMENT;
    refused(invalid, "position image", [](Frame& f) { f.slots[PEL_SLOT_POSITION] = {}; });
    refused(invalid, "singular", [](Frame& f) {
        std::copy_n(f.lights[0].params.worldToShadow, 4, f.lights[0].params.worldToShadow + 4);
    });
    refused(invalid, "singular", [](Frame& f) { std::fill_n(f.lights[0].params.worldToShadow, 4, 0.0f); });
    // Beside a filtered shadow, images of the host have its format.
    pellucid::Shader shader(device());
    Frame f = litRelief(from);
    f.lights.push_back(f.lights[0]);
    setFrame(device(), shader, f, tables());
    const pellucid::Buffer target(device(), f.pixels() * 12), wide(device(), f.pixels() * 4);
    shader.set(PEL_SLOT_RADIANCE, pellucid::imageDesc(target, PEL_FORMAT_RGB32F, f.width, f.height));
    shader.set(1, PEL_LIGHT_WIDE_SHADOW, pellucid::imageDesc(wide, PEL_FORMAT_R8_UNORM, f.width, f.height));
    EXPECT_THROW(shader.commit(), pellucid::Error);
    EXPECT_NE(std::string(pelGetErrorMessage()).find("R32F"), std::string::npos) << pelGetErrorMessage();
    shader.set(1, PEL_LIGHT_WIDE_SHADOW, pellucid::imageDesc(wide, PEL_FORMAT_R32F, f.width, f.height));
    EXPECT_NO_THROW(shader.commit().execute());
}

TEST(WideShadow, OddFramesAndMaps) {
    for (const auto& [width, height, size] : {std::tuple{1u, 1u, 1u}, {1u, 7u, 2u}, {131u, 3u, 5u}}) {
        const MapLight from = mapLight(3, false, false, {0.5, 0.2, 0.9}, {0, 0, 0}, 70, size);
        Frame f = reliefFrame(1, width, height, 0.4f);
        f.lights = {from.light};
        showWideShadow(f);
        EXPECT_LE(worstShadow(f, from, shade(device(), f, tables())), tolerance::wideShadow)
            << width << " x " << height;
    }
}

}  // namespace
