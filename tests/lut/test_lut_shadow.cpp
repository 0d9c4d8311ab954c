// Shadow tables: limits, closed ends, encodings, and the tables of FaceWorks.
#include <algorithm>
#include <limits>

#include "lut_cases.h"
#include "test_size.h"

using namespace pellucid;

namespace {

struct Case {
    uint32_t width, height;
    float widthMin, widthMax, diffusionRadius, sharpening;
};

PelShadowLutDesc describe(const Case& c) {
    PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
    desc.width = c.width;
    desc.height = c.height;
    desc.widthMin = c.widthMin;
    desc.widthMax = c.widthMax;
    desc.diffusionRadius = c.diffusionRadius;
    desc.sharpening = c.sharpening;
    return desc;
}

reference::ShadowLutSpec specOf(const PelShadowLutDesc& desc) {
    return {int(desc.width),
            int(desc.height),
            desc.widthMin,
            desc.widthMax,
            desc.diffusionRadius ? desc.diffusionRadius : 2.7,
            desc.sharpening};
}

}  // namespace

TEST(ShadowLut, LimitsAreFiniteAndMonotone) {
    const Device device("");
    for (const Case& c : {Case{16, 4, 1e-38f, 1e38f, 1, 1}, Case{16, 4, 1e-38f, 1e-38f, 1e38f, 1e6f},
                          Case{16, 4, 1e38f, 1e38f, 1e-38f, 3e38f}, Case{64, 16, 8, 100, 2.7f, 10}}) {
        const auto texels = Lut(device, describe(c)).read<float>(PEL_LUT_FLOAT);
        for (size_t i = 0; i < texels.size(); ++i) {
            ASSERT_TRUE(std::isfinite(texels[i])) << i;
            EXPECT_GE(texels[i], -tolerance::lutTexelGaussians);
            EXPECT_LE(texels[i], 1 + tolerance::lutTexelGaussians);
            if (i / 3 % c.width > 0) {
                EXPECT_GE(texels[i] - texels[i - 3], -tolerance::lutTexelGaussians);
            }
        }
    }
}

// Closed ends: (T - T(0)) / (T(1) - T(0)) per row of the oracle's T, 0 and 1 at the ends of the axis of
// roots, whose columns are even in the position across the edge and whose rows are even in the root of
// 1/width.
TEST(ShadowLut, ClosedEndsRunFromNoneToAll) {
    const Device device("");
    const auto profile = reference::skinProfile();
    for (float sharpening : {1.0f, 10.0f}) {
        PelShadowLutDesc desc = describe({33, 9, 4, 400, 2.7f, sharpening});
        desc.closedEnds = 1;
        desc.axis = PEL_AXIS_ROOT;
        const auto texels = Lut(device, desc).read<float>(PEL_LUT_FLOAT);
        for (uint32_t y = 0; y < 9; ++y) {
            const double root = std::sqrt(1.0 / 400) + y / 8.0 * (std::sqrt(1.0 / 4) - std::sqrt(1.0 / 400)),
                         q = root * root;
            const auto low = reference::shadowT(*profile, 0, q, sharpening),
                       high = reference::shadowT(*profile, 1, q, sharpening);
            for (uint32_t x = 0; x < 33; ++x) {
                // w of a position p: p - 1/2 = (sqrt w - sqrt(1 - w)) / 2 = sin(asin(sqrt w) - pi/4) / sqrt 2
                const double z = x / 32.0 - 0.5,
                             angle = std::asin(std::clamp(z * std::sqrt(2.0), -1.0, 1.0)) + std::atan(1.0);
                const auto t = reference::shadowT(*profile, std::pow(std::sin(angle), 2), q, sharpening);
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(texels[(y * 33 + x) * 3 + size_t(c)], (t[c] - low[c]) / (high[c] - low[c]),
                                tolerance::closedEnds)
                        << x << ", " << y << " channel " << c;
            }
            for (size_t c = 0; c < 3; ++c) {
                EXPECT_EQ(texels[y * 33 * 3 + c], 0);
                EXPECT_EQ(texels[(y * 33 + 32) * 3 + c], 1);
            }
        }
    }
}

// Light is never negative, not even by rounding, and never more than the profile has.
TEST(ShadowLut, NoTexelIsBelowZero) {
    const Device device("");
    std::vector<PelShadowLutDesc> descs{sizedTable(pelShadowLutDescFaceWorks())};
    for (float sharpening : {1.0f, 10.0f, 1000.0f})
        for (auto [widthMin, widthMax] : {std::pair{0.1f, 8.0f}, {1.0f, 30.0f}, {8.0f, 30000.0f}})
            descs.push_back(describe({256, 32, widthMin, widthMax, 2.7f, sharpening}));
    for (const PelShadowLutDesc& desc : descs) {
        const auto texels = Lut(device, desc).read<float>(PEL_LUT_FLOAT);
        const auto [least, most] = std::minmax_element(texels.begin(), texels.end());
        EXPECT_GE(*least, 0) << desc.widthMin << " to " << desc.widthMax << ", sharpening "
                             << desc.sharpening;
        EXPECT_LE(*most, 1 + std::numeric_limits<float>::epsilon());
    }
}

TEST(ShadowLut, EncodingRoundsTruth) {
    const int height = sized(64, 4);
    const auto desc = describe({256, uint32_t(height), 8, 100, 2.7f, 10});
    const Lut lut(Device(""), desc);
    const auto bytes = lut.read<uint8_t>(PEL_LUT_FACEWORKS8);
    ASSERT_EQ(bytes.size(), 256u * size_t(height) * 4);
    const auto profile = reference::skinProfile();
    for (int y = 0; y < height; y += 3)
        for (int x = 0; x < 256; x += 3) {
            const auto steps =
                reference::faceworksShadowSteps(reference::shadowTexel(specOf(desc), *profile, x, y), x, 256);
            fixture::expectRounded(&bytes[(size_t(y) * 256 + x) * 4], steps, x, y);
        }
}

TEST(ShadowLut, EqualsTheExactTableOfFaceWorksProfile) {
    REQUIRE_ORACLE_DIRECTORY(directory);
    const auto truth = npy::read<float>(directory / "truth_lut_shadow_A_withfade_f32.npy");
    const Lut lut(Device(""), pelShadowLutDescFaceWorks());
    const auto texels = lut.read<float>(PEL_LUT_FLOAT);
    ASSERT_EQ(texels.size(), truth.data.size());
    double worst = 0;
    for (size_t i = 0; i < texels.size(); ++i) {
        const double faded = reference::shadowFade(int(i / 3 % 512), 512) * texels[i];
        worst = std::max(worst, std::abs(faded - truth.data[i]));
    }
    EXPECT_LT(worst, tolerance::lutTexelGaussians);
    fixture::expectNearFaceWorks(lut, directory / "fw_lut_shadow_A_u8.npy");
}
