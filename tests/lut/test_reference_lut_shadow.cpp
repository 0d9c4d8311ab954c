// The oracle's shadow and specular LUTs and FaceWorks' 8-bit encodings: closed forms, limits, tables
// integrated elsewhere.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <numbers>
#include <random>

#include "npy.h"
#include "reference/lut.h"
#include "tolerances.h"

using namespace reference;
namespace {

constexpr double pi = std::numbers::pi;

// Integral over [-cut, cut] of smoothstep(clamped ramp from s0 to s1) times a Gaussian: moments of the
// Gaussian.
double closedForm(double sigma, double s0, double s1, double cut) {
    const double v = sigma * sigma;
    auto density = [&](double s) { return std::exp(-s * s / (2 * v)) / std::sqrt(2 * pi * v); };
    auto share = [&](double a, double b) {
        return 0.5 *
               (std::erf(b / (sigma * std::numbers::sqrt2)) - std::erf(a / (sigma * std::numbers::sqrt2)));
    };
    const double a = std::clamp(s0, -cut, cut), b = std::clamp(s1, -cut, cut);
    double moment[4] = {share(a, b), -v * (density(b) - density(a))};
    for (int n = 2; n < 4; ++n)
        moment[n] = (n - 1) * v * moment[n - 2] -
                    v * (std::pow(b, n - 1) * density(b) - std::pow(a, n - 1) * density(a));
    // 3t² - 2t³ of t = (s - s0)/w, expanded in powers of s.
    const double w = s1 - s0, w2 = w * w, w3 = w2 * w;
    const double ramp =
        3 / w2 * (moment[2] - 2 * s0 * moment[1] + s0 * s0 * moment[0]) -
        2 / w3 * (moment[3] - 3 * s0 * moment[2] + 3 * s0 * s0 * moment[1] - s0 * s0 * s0 * moment[0]);
    return ramp + share(b, cut);
}

TEST(ReferenceShadowLut, OneGaussianHasAClosedForm) {
    const double sigma = 2.7, cut = 10;
    const auto profile = gaussiansProfile({{sigma * sigma, {1, 1, 1}}});
    for (double k : {1.0, 2.0, 10.0})
        for (double q : {0.01, 0.05, 0.125})
            for (double w : {0.0, 0.01, 0.2, 0.5, 0.77, 1.0}) {
                const double p = (std::sqrt(w) - std::sqrt(1 - w)) / 2 + 0.5;
                const double s0 = (-(1 - k) / 2 / k - p) / q, s1 = ((1 - (1 - k) / 2) / k - p) / q;
                EXPECT_NEAR(shadowT(*profile, w, q, k).x, closedForm(sigma, s0, s1, cut),
                            tolerance::oracleClosedForm)
                    << "k " << k << " q " << q << " w " << w;
            }
}

TEST(ReferenceShadowLut, EveryProfileEqualsBoostQuadrature) {
    std::mt19937 random(11);
    const ProfilePtr profiles[] = {
        skinProfile(), dipoleProfile({0.032, 0.17, 0.48}, {0.74, 0.88, 1.01}, 1.3),
        tableProfile({0, 0.5, 1, 2, 4}, {{9, 8, 7}, {4, 3, 2}, {1, .5, .2}, {.2, .05, .01}, {0, 0, 0}}),
        burleyProfile({3.67, 1.37, 0.68}, {0.9, 0.6, 0.4})};
    for (const auto& profile : profiles)
        for (int i = 0; i < 2; ++i) {
            const double w = std::uniform_real_distribution<>(0, 1)(random);
            const double q = std::uniform_real_distribution<>(0.01, 0.12)(random) / profile->radius();
            const double k = std::uniform_real_distribution<>(1, 12)(random), p = shadowPosition(w);
            const double cut = profileCut(*profile);
            auto integrand = [&](double s) {
                const double t = std::clamp((p + s * q) * k + (1 - k) / 2, 0.0, 1.0);
                return t * t * (3 - 2 * t) * profile->lineSpread(s).y;
            };
            std::vector<double> borders{-cut, 0, cut, (0.5 - 0.5 / k - p) / q, (0.5 + 0.5 / k - p) / q};
            for (double l : profile->lengths()) {
                borders.push_back(l);
                borders.push_back(-l);
            }
            std::sort(borders.begin(), borders.end());
            double sum = 0;
            for (size_t j = 0; j + 1 < borders.size(); ++j)
                if (borders[j] >= -cut && borders[j + 1] <= cut && borders[j + 1] > borders[j])
                    sum += boost::math::quadrature::gauss_kronrod<double, 61>::integrate(
                        integrand, borders[j], borders[j + 1], 8, 1e-12);
            EXPECT_NEAR(shadowT(*profile, w, q, k).y, sum,
                        profile->singularAtZero() ? tolerance::oracleSingular : tolerance::oracleQuadrature);
        }
}

TEST(ReferenceShadowLut, HasItsLimits) {
    const auto skin = skinProfile();
    for (double k : {1.0, 10.0, 1e6}) {
        const Rgb dark = shadowT(*skin, 0, 1e-3, k), lit = shadowT(*skin, 1, 1e-3, k);
        for (int c = 0; c < 3; ++c) {
            // A very wide penumbra: nothing crosses it. Lit, only the light beyond the cut is missing.
            const double within =
                1 - std::array{0.078 * std::erfc(10 / (2.722 * std::numbers::sqrt2)), 0.0, 0.0}[c];
            EXPECT_NEAR(dark[c], 0, k == 1 ? tolerance::widePenumbra : tolerance::oracleClosedForm);
            EXPECT_NEAR(lit[c], within, k == 1 ? tolerance::widePenumbra : tolerance::oracleClosedForm);
        }
        double before = -1;
        for (int i = 0; i <= 40; ++i) {  // rises with w
            const double t = shadowT(*skin, i / 40.0, 0.1, k).x;
            EXPECT_GE(t, before - tolerance::oracleQuadrature);
            before = t;
        }
        // Half way across, by symmetry, half of what lies within the cut.
        EXPECT_NEAR(shadowT(*skin, 0.5, 0.1, k).x, lit.x / 2, tolerance::widePenumbra);
    }
}

TEST(ReferenceShadowLut, EqualsTheIndependentTable) {
    REQUIRE_ORACLE_DIRECTORY(directory);
    const auto truth = npy::read<float>(directory / "truth_lut_shadow_A_withfade_f32.npy");
    const auto axes = npy::read<double>(directory / "truth_lut_shadow_A_axes_f64.npy");
    const ShadowLutSpec spec;
    const auto skin = skinProfile();
    double worst = 0;
    for (int y = 0; y < 512; y += 73)
        for (int x = 0; x < 512; x += 7) {
            EXPECT_NEAR(axes.row(0)[x], shadowPosition(spec.w(x)), tolerance::oracleExact);
            EXPECT_NEAR(axes.row(1)[y], spec.reciprocalWidth(y, 1), tolerance::oracleExact);
            const Rgb t = shadowFade(x, 512) * shadowTexel(spec, *skin, x, y);
            for (int c = 0; c < 3; ++c)
                worst = std::max(worst, std::abs(t[c] - truth.data[(y * 512 + x) * 3 + c]));
        }
    EXPECT_LE(worst, tolerance::oracleFloatTable);
}

TEST(ReferenceEncoding, RoundsAndClips) {
    EXPECT_EQ(roundedSteps({0.49, 0.5, 254.9}), (Rgba8{0, 1, 255, 255}));
    const Rgb d{0.3, 0.5, 0.7};
    const Rgb steps = faceworksCurvatureSteps(d, 0.4);
    EXPECT_NEAR(steps.x, 255 * 0.3, tolerance::oracleClosedForm);
    EXPECT_NEAR(steps.y, 255 * 0.7, tolerance::oracleClosedForm);
    EXPECT_EQ(steps.z, 255);
    EXPECT_TRUE(faceworksCurvatureClips(d, 0.4));
    EXPECT_FALSE(faceworksCurvatureClips(d, 0.5));
    for (double linear : {0.0, 0.001, 0.0031308, 0.02, 0.5, 1.0})
        EXPECT_NEAR(linearFromSrgb(srgbFromLinear(linear)), linear, tolerance::srgbInverse);
    EXPECT_NEAR(srgbFromLinear(0.5), 0.7353569830524495, tolerance::oracleClosedForm);
    EXPECT_EQ(shadowFade(0, 512), 0);
    EXPECT_EQ(shadowFade(20, 512), 500.0 / 512);
    EXPECT_EQ(shadowFade(21, 512), 1);
}

// FaceWorks' own 8-bit tables carry its float error (7.7e-4 at most): beside the exact value they may round
// to the next step.
TEST(ReferenceEncoding, FaceWorksTablesAreOneStepFromExactAtMost) {
    REQUIRE_ORACLE_DIRECTORY(directory);
    const auto curvature = npy::read<uint8_t>(directory / "fw_lut_curv_A_u8.npy");
    const auto shadow = npy::read<uint8_t>(directory / "fw_lut_shadow_A_u8.npy");
    const CurvatureLutSpec curvatureSpec;
    const ShadowLutSpec shadowSpec;
    const auto skin = skinProfile();
    int texels = 0, differentCurvature = 0, differentShadow = 0;
    for (int y = 0; y < 512; y += 73)
        for (int x = 0; x < 512; x += 7, ++texels) {
            const Rgb d = curvatureTexel(curvatureSpec, *skin, x, y),
                      t = shadowTexel(shadowSpec, *skin, x, y);
            const Rgba8 ours = roundedSteps(faceworksCurvatureSteps(d, curvatureSpec.u(x)));
            const Rgba8 oursShadow = roundedSteps(faceworksShadowSteps(t, x, 512));
            const uint8_t* theirs = curvature.data.data() + (y * 512 + x) * 4;
            const uint8_t* theirsShadow = shadow.data.data() + (y * 512 + x) * 4;
            for (int c = 0; c < 4; ++c) {
                EXPECT_LE(std::abs(ours[c] - theirs[c]), 1) << x << ' ' << y;
                EXPECT_LE(std::abs(oursShadow[c] - theirsShadow[c]), 1) << x << ' ' << y;
                differentCurvature += ours[c] != theirs[c];
                differentShadow += oursShadow[c] != theirsShadow[c];
            }
        }
    EXPECT_LE(differentCurvature, tolerance::faceWorksRoundedApart * 4 * texels);
    EXPECT_LE(differentShadow, tolerance::faceWorksRoundedApart * 4 * texels);
}

TEST(ReferenceBeckmann, IsNormalisedOverTheHemisphereAndHasItsLimits) {
    for (double m : {0.1, 0.3, 0.8}) {
        // A distribution of slopes: the integral of P cos over the hemisphere is pi.
        const double share = boost::math::quadrature::gauss_kronrod<double, 61>::integrate(
            [&](double a) { return 2 * pi * beckmann(std::cos(a), m) * std::cos(a) * std::sin(a); }, 0,
            pi / 2, 12, 1e-12);
        EXPECT_NEAR(share, pi, tolerance::oracleClosedForm) << "m " << m;
        EXPECT_NEAR(beckmann(1, m), 1 / (m * m), tolerance::oracleClosedForm);
    }
    EXPECT_EQ(beckmann(0, 0.3), 0);
    EXPECT_EQ(beckmann(1e-200, 0.3), 0);
    EXPECT_EQ(beckmann(0.5, 1e-200), 0);
    EXPECT_EQ(beckmann(0.5, 0), 0);
    EXPECT_EQ(beckmann(1, 0), 0);
    for (int x = 0; x <= 50; ++x)
        for (int y = 0; y <= 50; ++y) EXPECT_TRUE(std::isfinite(beckmannEncoded(x / 50.0, y / 50.0)));
    EXPECT_NEAR(beckmannEncoded(0.9, 0.3),
                0.5 * std::pow(std::exp(-(1 / 0.81 - 1) / 0.09) / (0.09 * 0.6561), 0.1),
                tolerance::oracleExact);
}

}  // namespace
