// Curvature tables: limits, encodings, and the tables of FaceWorks.
#include "lut_cases.h"
#include "test_size.h"

using namespace pellucid;

namespace {

PelCurvatureLutDesc describe(uint32_t width, uint32_t height, float radiusMin, float radiusMax,
                             float diffusionRadius) {
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = width;
    desc.height = height;
    desc.radiusMin = radiusMin;
    desc.radiusMax = radiusMax;
    desc.diffusionRadius = diffusionRadius;
    return desc;
}

reference::CurvatureLutSpec specOf(const PelCurvatureLutDesc& desc) {
    reference::CurvatureLutSpec spec;
    spec.width = int(desc.width);
    spec.height = int(desc.height);
    spec.radiusMin = desc.radiusMin;
    spec.radiusMax = desc.radiusMax;
    return spec;
}

}  // namespace

TEST(CurvatureLut, LimitsOfRadius) {
    const Device device("");
    // A plane scatters nothing into the dark: all of the profile within the cut arrives, times N.L.
    const auto plane = Lut(device, describe(16, 2, 3e37f, 3e38f, 1e-3f)).read<float>(PEL_LUT_FLOAT);
    for (int x = 0; x < 16; ++x) {
        const double u = -1 + (x + 0.5) / 8;
        EXPECT_NEAR(plane[x * 3 + 2], std::max(0.0, u), tolerance::lutTexelGaussians) << "column " << x;
    }
    for (const auto& desc : {describe(16, 4, 1e-38f, 1e38f, 1), describe(16, 4, 1e-38f, 1e-38f, 1e38f)})
        for (float texel : Lut(device, desc).read<float>(PEL_LUT_FLOAT)) {
            EXPECT_TRUE(std::isfinite(texel));
            EXPECT_GE(texel, 0);
            EXPECT_LE(texel, 1 + tolerance::lutTexelGaussians);
        }
}

TEST(CurvatureLut, RisesWithTheLightAndHasNoKinks) {
    const Device device("");
    auto desc = pelCurvatureLutDescFaceWorks();
    desc.height = sized(desc.height, 2u);
    const auto texels = Lut(device, desc).read<float>(PEL_LUT_FLOAT);
    double roughest = 0;
    for (uint32_t y = 0; y < desc.height; ++y)
        for (uint32_t x = 1; x + 1 < desc.width; ++x)
            for (int c = 0; c < 3; ++c) {
                const float* t = texels.data() + (size_t(y) * desc.width + x) * 3 + c;
                ASSERT_GE(t[0] - t[-3], -tolerance::lutTexelGaussians) << x << ", " << y;
                // D bends most where u = 0, at the flattest row: there it is all but max0(u).
                if (x < 240 || x > 270)
                    roughest = std::max(roughest, double(std::fabs(t[3] - 2 * t[0] + t[-3])));
            }
    EXPECT_LT(roughest, tolerance::lutSecondDifference);
}

TEST(CurvatureLut, EncodingsRoundTruth) {
    const Device device("");
    const int height = sized(64, 4);
    const auto desc = describe(256, uint32_t(height), 1, 100, 2.7f);
    const Lut lut(device, desc);
    const auto texels = lut.read<float>(PEL_LUT_FLOAT);
    const auto bytes = lut.read<uint8_t>(PEL_LUT_FACEWORKS8);
    const auto profile = reference::skinProfile();
    const auto spec = specOf(desc);
    ASSERT_EQ(bytes.size(), 256u * size_t(height) * 4);
    int clipped = 0;
    for (int y = 0; y < height; y += 3)
        for (int x = 0; x < 256; x += 3) {
            const reference::Rgb truth = reference::curvatureTexel(spec, *profile, x, y);
            const reference::Rgb steps = reference::faceworksCurvatureSteps(truth, spec.u(x));
            clipped += reference::faceworksCurvatureClips(truth, spec.u(x));
            fixture::expectRounded(&bytes[(size_t(y) * 256 + x) * 4], steps, x, y);
        }
    EXPECT_TRUE(clipped > 0 || testsAreSmall())
        << "the narrowest radii exceed what FaceWorks' residual holds";
    uint64_t all = 0;
    for (size_t i = 0; i < texels.size(); i += 3) {
        const double u = spec.u(int(i / 3 % 256));
        all += reference::faceworksCurvatureClips({texels[i], texels[i + 1], texels[i + 2]}, u);
    }
    EXPECT_EQ(lut.clippedTexels(), all);
    EXPECT_EQ(Lut(Device(""), sizedTable(pelShadowLutDescFaceWorks())).clippedTexels(), 0u);
    EXPECT_EQ(pelLutCountClipped(lut.get(), nullptr), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(lut.read<uint16_t>(PEL_LUT_HALF).size(), texels.size());
}

TEST(CurvatureLut, EqualsTheExactTableOfFaceWorksProfile) {
    REQUIRE_ORACLE_DIRECTORY(directory);
    const auto truth = npy::read<float>(directory / "truth_lut_curv_A_arc10_f32.npy");
    const Lut lut(Device(""), pelCurvatureLutDescFaceWorks());
    const auto texels = lut.read<float>(PEL_LUT_FLOAT);
    ASSERT_EQ(texels.size(), truth.data.size());
    double worst = 0;
    for (size_t i = 0; i < texels.size(); ++i)
        worst = std::max(worst, std::abs(double(texels[i]) - truth.data[i]));
    EXPECT_LT(worst, tolerance::lutTexelGaussians);
    fixture::expectNearFaceWorks(lut, directory / "fw_lut_curv_A_u8.npy");
}
