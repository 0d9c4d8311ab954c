// Encodings of curvature and shadow tables against the oracle's exact steps, and FaceWorks' tables.
#include "lut_cases.h"

using namespace pellucid;

namespace {

// FaceWorks' table of `radiusMin` to `radiusMax` and its specification, of few rows in small tests.
template <class Spec, class Desc>
std::pair<Desc, Spec> described(Desc desc) {
    desc.width = 256, desc.height = sized(64u, 4u);
    Spec spec;
    spec.width = int(desc.width), spec.height = int(desc.height);
    return {desc, spec};
}

// RGBA bytes against the exact steps of every third texel, except near rounding boundaries.
template <class Steps>
void expectRounded(const Lut& lut, uint32_t height, const Steps& stepsOf) {
    const auto bytes = lut.read<uint8_t>(PEL_LUT_FACEWORKS8);
    ASSERT_EQ(bytes.size(), 256u * height * 4);
    for (int y = 0; y < int(height); y += 3)
        for (int x = 0; x < 256; x += 3) {
            const reference::Rgb steps = stepsOf(x, y);
            const uint8_t* texel = &bytes[(size_t(y) * 256 + size_t(x)) * 4];
            EXPECT_EQ(texel[3], 255);
            for (int c = 0; c < 3; ++c)
                if (std::abs(steps[c] - std::floor(steps[c]) - 0.5) > tolerance::lutRoundingBoundary) {
                    EXPECT_EQ(texel[c], reference::roundedSteps(steps)[c])
                        << x << ", " << y << ": " << steps[c];
                }
        }
    const auto texels = lut.read<float>(PEL_LUT_FLOAT);
    std::vector<uint16_t> halves;
    for (float texel : texels) halves.push_back(toHalf(texel));
    EXPECT_EQ(lut.read<uint16_t>(PEL_LUT_HALF), halves);
}

// The exact table of FaceWorks' profile; its own tables are sampled and clipped: near, but not the same.
void expectFaceWorks(const Lut& lut, const char* exactFile, const char* theirFile, bool faded) {
    REQUIRE_ORACLE_DIRECTORY(directory);
    const auto truth = npy::read<float>(directory / exactFile).data;
    const auto theirs = npy::read<uint8_t>(directory / theirFile).data;
    const auto texels = lut.read<float>(PEL_LUT_FLOAT);
    const auto bytes = lut.read<uint8_t>(PEL_LUT_FACEWORKS8);
    ASSERT_EQ(texels.size(), truth.size());
    ASSERT_EQ(bytes.size(), theirs.size());
    double worst = 0;
    int furthest = 0;
    for (size_t i = 0; i < texels.size(); ++i) {
        const double fade = faded ? reference::shadowFade(int(i / 3 % 512), 512) : 1;
        worst = std::max(worst, std::abs(fade * texels[i] - truth[i]));
    }
    for (size_t i = 0; i < bytes.size(); ++i)
        furthest = std::max(furthest, std::abs(int(bytes[i]) - theirs[i]));
    EXPECT_LT(worst, tolerance::lutTexelGaussians);
    EXPECT_LE(furthest, tolerance::faceWorksBytes);
}

}  // namespace

TEST(LutEncodings, CurvatureRoundsTruth) {
    const auto [desc, spec] = described<reference::CurvatureLutSpec>(pelCurvatureLutDescFaceWorks());
    const Lut lut(device(), desc);
    const auto profile = reference::skinProfile();
    const auto u = [spec = spec](int x) { return spec.u(x); };
    uint64_t clipped = 0, all = 0;
    expectRounded(lut, desc.height, [&, spec = spec](int x, int y) {
        const reference::Rgb truth = reference::curvatureTexel(spec, *profile, x, y);
        clipped += reference::faceworksCurvatureClips(truth, u(x));
        return reference::faceworksCurvatureSteps(truth, u(x));
    });
    EXPECT_TRUE(clipped > 0 || testsAreSmall())
        << "the narrowest radii exceed what FaceWorks' residual holds";
    const auto texels = lut.read<float>(PEL_LUT_FLOAT);
    for (size_t i = 0; i < texels.size(); i += 3)
        all += reference::faceworksCurvatureClips({texels[i], texels[i + 1], texels[i + 2]},
                                                  u(int(i / 3 % 256)));
    EXPECT_EQ(lut.clippedTexels(), all);
    EXPECT_EQ(pelLutCountClipped(lut.get(), nullptr), PEL_ERROR_INVALID_ARGUMENT);
}

TEST(LutEncodings, ShadowRoundsTruth) {
    const auto [desc, spec] = described<reference::ShadowLutSpec>(pelShadowLutDescFaceWorks());
    const Lut lut(device(), desc);
    const auto profile = reference::skinProfile();
    expectRounded(lut, desc.height, [&, spec = spec](int x, int y) {
        return reference::faceworksShadowSteps(reference::shadowTexel(spec, *profile, x, y), x, 256);
    });
    EXPECT_EQ(lut.clippedTexels(), 0u);
}

TEST(LutEncodings, FaceWorksCurvatureTable) {
    expectFaceWorks(Lut(device(), pelCurvatureLutDescFaceWorks()), "truth_lut_curv_A_arc10_f32.npy",
                    "fw_lut_curv_A_u8.npy", false);
}

TEST(LutEncodings, FaceWorksShadowTable) {
    expectFaceWorks(Lut(device(), pelShadowLutDescFaceWorks()), "truth_lut_shadow_A_withfade_f32.npy",
                    "fw_lut_shadow_A_u8.npy", true);
}

// Every half, and values between two halves: rounded to the nearest, ties to even. Values beyond the range
// become the nearest finite half.
TEST(LutEncodings, HalvesOfAnyTexel) {
    PelLutInfo info = pelLutInfoDefaults();
    info.kind = PEL_LUT_SPECULAR;
    info.specular.width = 512, info.specular.height = 83;
    std::vector<float> texels{-0.0f, 65504.0f, 65520.0f, -1e30f, 3e38f};
    for (uint16_t h = 0; h < 0x7bff; ++h) {
        const float sign = h % 2 ? -1 : 1, low = fromHalf(h), high = fromHalf(uint16_t(h + 1)),
                    tie = low + (high - low) / 2;
        for (float value : {low, tie, std::nextafter(tie, low), std::nextafter(tie, high)})
            texels.push_back(sign * value);
    }
    texels.resize(3 * info.specular.width * info.specular.height);
    std::vector<uint16_t> halves;
    for (float texel : texels) halves.push_back(toHalf(std::clamp(texel, -65504.0f, 65504.0f)));
    EXPECT_EQ(Lut(device(), info, texels).read<uint16_t>(PEL_LUT_HALF), halves);
}
