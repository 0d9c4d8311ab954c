// Thickness taps on a disk that is rotated from pixel to pixel: against the oracle, and what the rotation may
// change.
#include <gtest/gtest.h>

#include "shade_scene.h"
#include "tolerances.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

Frame tapFrame(uint32_t seed, uint32_t width, uint32_t height) {
    Frame f = randomFrame(seed, width, height, 2);
    f.options.rotateTaps = 1;
    return f;
}

// Thickness of every pixel, and radiance.
std::vector<float> measure(const Frame& f, std::vector<float>* radiance = nullptr) {
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const Buffer target(device(), f.pixels() * 12), thickness(device(), f.pixels() * 4);
    shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, f.width, f.height));
    shader.set(PEL_SLOT_OUT_THICKNESS, imageDesc(thickness, PEL_FORMAT_R32F, f.width, f.height));
    shader.commit().execute();
    if (radiance) *radiance = target.readAll<float>();
    return thickness.readAll<float>();
}

TEST(ShadeTaps, TurnedTheyMatchTheOracle) {
    for (uint32_t seed : {21u, 22u}) {
        const Frame f = tapFrame(seed, 203, 50);  // odd: the last vectors of a row begin earlier
        std::vector<float> radiance;
        const auto thickness = measure(f, &radiance);
        EXPECT_LE(worstError(f, radiance), tolerance::shadeSum);
        size_t compared = 0;
        for (size_t i = 0; i < f.pixels(); ++i) {
            const auto found = f.materials.find(uint32_t(f.slots[PEL_SLOT_MATERIAL].at(i)));
            if (found == f.materials.end()) continue;
            EXPECT_NEAR(thickness[i], truthLight(f, found->second, f.lights[0], i).thickness,
                        tolerance::shadeThickness)
                << i;
            ++compared;
        }
        EXPECT_GT(compared, f.pixels() / 2);
    }
}

TEST(ShadeTaps, TurningDependsOnThePlaceAlone) {
    // One and the same pixel everywhere: what differs is the angle.
    Frame f = tapFrame(23, 64, 16);
    f.slots[PEL_SLOT_MATERIAL].values.assign(f.pixels(), 1.0f);
    for (int slot :
         {PEL_SLOT_POSITION, PEL_SLOT_NORMAL_GEOMETRIC, PEL_SLOT_NORMAL_SHADING, PEL_SLOT_NORMAL_BLURRED})
        for (size_t i = 0; i < f.slots[slot].values.size(); ++i)
            f.slots[slot].values[i] = f.slots[slot].values[i % 3];
    for (size_t i = 0; i < f.pixels() * 3; ++i) f.slots[PEL_SLOT_POSITION].values[i] = 0;
    const auto turned = measure(f);
    EXPECT_EQ(turned, measure(f)) << "the same bits each time";
    f.options.disableSkipping = 1;
    EXPECT_EQ(turned, measure(f)) << "and without skipping";
    f.options.disableSkipping = 0;
    const auto range = std::minmax_element(turned.begin(), turned.end());
    EXPECT_GT(*range.second - *range.first, 0.05f) << "the map differs from texel to texel";
    f.options.rotateTaps = 0;
    const auto still = measure(f);
    EXPECT_EQ(*std::min_element(still.begin(), still.end()), *std::max_element(still.begin(), still.end()));

    // A part of the frame in a frame of its own, at the same columns and rows, gives the same bits.
    f.options.rotateTaps = 1;
    const Frame left = cropped(f, 0, 0, 33, f.height);
    const auto part = measure(left);
    for (size_t i = 0; i < left.pixels(); ++i) EXPECT_EQ(part[i], turned[i / 33 * f.width + i % 33]) << i;
}

TEST(ShadeTaps, TheAnglesFillTheCircle) {
    // Any 4 x 4 pixels: the largest gap between angles is far below that of random ones (about 76 degrees of
    // 16).
    const reference::Vec2 tap{1, 0};
    for (uint32_t x0 : {0u, 1u, 777u, 16380u})
        for (uint32_t y0 : {0u, 5u, 16380u}) {
            std::vector<double> turns;
            for (uint32_t k = 0; k < 16; ++k) {
                const auto turned = reference::turnedTaps({tap}, x0 + k % 4, y0 + k / 4)[0];
                turns.push_back(std::atan2(turned.y, turned.x) / (2 * M_PI));
            }
            std::sort(turns.begin(), turns.end());
            double gap = 1 + turns[0] - turns[15];
            for (size_t k = 1; k < 16; ++k) gap = std::max(gap, turns[k] - turns[k - 1]);
            EXPECT_LT(gap, 0.13) << x0 << ' ' << y0;
        }
}

TEST(ShadeTaps, WithoutTapsTheOptionMakesNoOtherKernel) {
    Frame f = tapFrame(24, 40, 10);
    for (auto& [id, m] : f.materials) m.thicknessTaps = 0;
    const auto on = shade(device(), f, tables());
    f.options.rotateTaps = 0;
    PelShaderStats stats = pelShaderStatsDefaults();
    EXPECT_EQ(shade(device(), f, tables(), &stats), on);
    EXPECT_EQ(stats.programsBuilt, 0u) << "the first shader's variant is there already";
}

TEST(ShadeTaps, AmbientScatterIsOffWithoutAThicknessImage) {
    // Shadow maps and taps are there, but measure along the lights.
    Frame f = tapFrame(25, 40, 10);
    const auto without = shade(device(), f, tables());
    for (auto& [id, m] : f.materials) m.deepScatterAmbient = 0.7f;
    PelShaderStats stats = pelShaderStatsDefaults();
    EXPECT_EQ(shade(device(), f, tables(), &stats), without);
    EXPECT_TRUE(stats.features & PEL_FEATURE_THICKNESS_TAPS);
    EXPECT_FALSE(stats.features & PEL_FEATURE_AMBIENT_SCATTER);
    f.slots[PEL_SLOT_THICKNESS] = f.slots[PEL_SLOT_CURVATURE];
    (void)shade(device(), f, tables(), &stats);
    EXPECT_TRUE(stats.features & PEL_FEATURE_AMBIENT_SCATTER);
}

}  // namespace
