// Wide shadows and blurred normals at every second pixel, with interpolation between them, against the same
// at every pixel.
#include <gtest/gtest.h>

#include <limits>

#include "pass_scene.h"
#include "shadow_forms.h"
#include "tolerances.h"

using namespace shade_test;

namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

Frame interpolated(Frame f) {
    f.options.everyPixel = 0;
    return f;
}

struct Difference {
    double rms = 0, share = 0;  // share of pixels more than a hundredth off
};
Difference between(const Frame& f, const std::vector<float>& a, const std::vector<float>& b,
                   double scale = 1) {
    double sum = 0, off = 0, count = 0;
    for (size_t i = 0; i < f.pixels(); ++i) {
        if (f.materials.count(uint32_t(f.slots[PEL_SLOT_MATERIAL].at(i))) == 0) continue;
        double d2 = 0;
        for (int c = 0; c < 3; ++c) d2 += std::pow(scale * (double(a[3 * i + c]) - b[3 * i + c]), 2) / 3;
        sum += d2, off += d2 > 1e-4, count += 1;
    }
    return {std::sqrt(sum / count), off / count};
}

Frame shadowed(uint32_t seed, const Light& light, uint32_t width = 230, uint32_t height = 91,
               float pixel = 0.21f) {
    Frame f = reliefFrame(seed, width, height, pixel);
    f.lights = {light};
    f.options.countPixels = 1;
    showWideShadow(f);
    return f;
}

TEST(BetweenPixels, WideShadowsAreThoseOfEveryPixel) {
    double filtered = 0, all = 0;
    for (uint32_t seed = 0; seed < 8; ++seed) {
        const MapLight from =
            mapLight(seed, seed & 1, seed & 2, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, 97 + 50 * seed);
        const Frame f = shadowed(seed, from.light);
        PelShaderStats every = pelShaderStatsDefaults(), some = every;
        const auto exact = shade(device(), f, tables(), &every),
                   shown = shade(device(), interpolated(f), tables(), &some);
        const Difference d = between(f, exact, shown);
        EXPECT_LE(d.rms, tolerance::betweenShadowRms) << seed;
        EXPECT_LE(d.share, tolerance::betweenShadowShare) << seed;
        EXPECT_EQ(some.launches, every.launches + 1);
        filtered += double(some.pixelsWideShadow), all += double(every.pixelsWideShadow);
    }
    EXPECT_LT(filtered, 0.5 * all) << "most pixels are interpolated";
}

TEST(BetweenPixels, NothingIsTakenAcrossADepthEdgeOrAMaterial) {
    // Light and shadow side by side: the far half lies under a roof that the near half does not know of.
    for (const bool material : {false, true}) {
        const MapLight from = mapLight(1, false, false, {0, 0, 1}, {24, 10, 0}, 64, 320);
        Frame f = shadowed(1, from.light, 200, 60, 0.3f);
        const float up[3] = {0, 0, 1};
        for (size_t i = 0; i < f.pixels(); ++i) {
            const bool far = (i % f.width + i / f.width) % 16 < 5;  // slanted stripes, a few pixels wide
            f.slots[PEL_SLOT_MATERIAL].values[i] = material && far ? 2 : 1;
            f.slots[PEL_SLOT_POSITION].values[3 * i + 2] = far ? -25 : 5;
            std::copy_n(up, 3, &f.slots[PEL_SLOT_NORMAL_GEOMETRIC].values[3 * i]);
        }
        showWideShadow(f);
        const auto exact = shade(device(), f, tables()), shown = shade(device(), interpolated(f), tables());
        const Difference d = between(f, exact, shown);
        EXPECT_LE(d.rms, tolerance::betweenShadowRms) << material;
        EXPECT_LE(d.share, tolerance::betweenShadowShare) << material;
    }
}

TEST(BetweenPixels, BadPixelsStayAlone) {
    Frame f =
        interpolated(shadowed(5, mapLight(5, false, false, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, 97).light));
    const auto before = shade(device(), f, tables());
    const size_t normal = 22 * f.width + 60, position = sized(41, 9) * f.width + 121;
    f.slots[PEL_SLOT_NORMAL_GEOMETRIC].values[3 * normal] = nan;
    f.slots[PEL_SLOT_POSITION].values[3 * position + 1] = std::numeric_limits<float>::infinity();
    const auto after = shade(device(), f, tables());
    for (size_t i = 0; i < f.pixels(); ++i)
        for (int c = 0; c < 3; ++c) {
            EXPECT_TRUE(std::isfinite(after[3 * i + c])) << i;
            const auto far = [&](size_t bad) {
                return std::abs(int(i % f.width) - int(bad % f.width)) > 3 ||
                       std::abs(int(i / f.width) - int(bad / f.width)) > 3;
            };
            if (far(normal) && far(position)) {
                EXPECT_EQ(after[3 * i + c], before[3 * i + c]) << i;
            }
        }
}

TEST(BetweenPixels, SharpShadowsAndNarrowFramesAreComputedEverywhere) {
    const MapLight from = mapLight(2, false, false, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, 97);
    Frame sharp = shadowed(2, from.light);
    for (auto& [id, m] : sharp.materials) m.scattering = PEL_SCATTERING_NONE;
    EXPECT_EQ(shade(device(), sharp, tables()), shade(device(), interpolated(sharp), tables()));
    for (const auto& [width, height] : {std::pair{1u, 1u}, {17u, 40u}, {63u, 9u}}) {
        const Frame f = shadowed(2, from.light, width, height);
        EXPECT_EQ(shade(device(), f, tables()), shade(device(), interpolated(f), tables())) << width;
    }
    for (const auto& [width, height] : {std::pair{64u, 1u}, {65u, 2u}, {97u, 5u}, {128u, 7u}}) {
        const Frame f = shadowed(2, from.light, width, height);
        EXPECT_LE(between(f, shade(device(), f, tables()), shade(device(), interpolated(f), tables())).rms,
                  tolerance::betweenShadowRms)
            << width;
    }
}

}  // namespace
