// The oracle's look-up tables by Boost.Math's quadrature of the definitions, their limits, and FaceWorks'
// encodings in 8 bits. test_lut_encodings compares the library with tables that were integrated elsewhere.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <random>

#include "reference/lut.h"
#include "reference/quadrature.h"
#include "tolerances.h"

using namespace reference;
namespace {

constexpr Form allForms[] = {Form::arc, Form::ring, Form::halfRing, Form::sphere, Form::pennerRing};
const double someU[] = {-1, -0.9, -0.5, -0.1, -1e-3, 0, 1e-3, 0.1, 0.3, 0.7, 0.99, 1};

const std::pair<const char*, ProfilePtr> profiles[] = {
    {"skin", skinProfile()},
    {"dipole", dipoleProfile({0.032, 0.17, 0.48}, {0.74, 0.88, 1.01}, 1.3)},
    {"table",
     tableProfile({0, 0.5, 1, 2, 4}, {{9, 8, 7}, {4, 3, 2}, {1, .5, .2}, {.2, .05, .01}, {0, 0, 0}})},
    {"burley", burleyProfile({3.67, 1.37, 0.68}, {0.9, 0.6, 0.4})}};

using Rule = boost::math::quadrature::gauss_kronrod<double, 61>;

// The definitions as written, each smooth stretch by Boost's 61-point rule, no folding and no substitution.
double boostCurvature(Form form, const Profile& profile, int channel, double u, double r) {
    const double theta = std::acos(u);
    const double end = form == Form::arc        ? std::min(pi * r, profileCut(profile)) / r
                       : form == Form::halfRing ? pi / 2
                                                : pi;
    std::vector<double> borders{0};
    for (double l : profile.lengths()) {
        const double angle = form == Form::arc ? l / r : l < 2 * r ? 2 * std::asin(l / (2 * r)) : pi;
        borders.push_back(angle);
        borders.push_back(-angle);
    }
    for (int n = -3; n <= 3; ++n)
        for (double sign : {-1, 1}) borders.push_back(sign * theta + pi / 2 + n * pi);
    auto over = [&](double begin, auto f) {
        const auto points = panelPoints(begin, end, borders);
        double sum = 0;
        for (size_t i = 0; i + 1 < points.size(); ++i)
            sum += Rule::integrate(f, points[i], points[i + 1], 8, 1e-12);
        return sum;
    };
    if (form == Form::arc)
        return over(-end, [&](double x) {
            return std::max(0.0, std::cos(theta - x)) * profile.lineSpread(r * x)[channel] * r;
        });
    auto chord = [&](double x) {
        const double d = 2 * r * std::abs(std::sin(x / 2));
        return (form == Form::pennerRing ? profile.lineSpread(d) : profile.radial(d))[channel];
    };
    if (form != Form::sphere)
        return over(-end, [&](double x) { return std::max(0.0, std::cos(theta + x)) * chord(x); }) /
               over(-end, chord);
    auto mean = [&](double psi) {
        const double a = u * std::cos(psi), b = std::sin(theta) * std::sin(psi);
        if (std::abs(a) >= b) return std::max(a, 0.0);
        return (a * std::acos(-a / b) + std::sqrt(b * b - a * a)) / pi;
    };
    return over(0, [&](double psi) { return mean(psi) * chord(psi) * std::sin(psi); }) /
           over(0, [&](double psi) { return chord(psi) * std::sin(psi); });
}

TEST(ReferenceLut, EveryFormAndProfileEqualsBoostQuadrature) {
    std::mt19937 random(7);
    for (const auto& [name, profile] : profiles)
        for (Form form : allForms) {
            const bool ringLike = form == Form::ring || form == Form::halfRing;
            if (profile->singularAtZero() && ringLike) continue;  // no integral to compare with
            const bool nested = form == Form::arc && name != std::string("skin");
            for (int i = 0; i < (nested ? 1 : 12); ++i) {
                const double u = std::uniform_real_distribution<>(-1, 1)(random);
                const double r = std::pow(10, std::uniform_real_distribution<>(-0.3, 2.5)(random));
                const Rgb d = curvatureD(form, *profile, u, r);
                // Boost integrates the singular profile's logarithm without a substitution, so its tolerance
                // is larger.
                const double bound =
                    profile->singularAtZero() ? tolerance::oracleSingular : tolerance::oracleQuadrature;
                for (int c = 0; c < (nested ? 1 : 3); ++c)
                    EXPECT_NEAR(d[c], boostCurvature(form, *profile, c, u, r), bound)
                        << name << " form " << int(form) << " u " << u << " r " << r;
            }
        }
}

// The published listing: distances on the ring weighed by sums of one-dimensional Gaussians, 1/sqrt(2 pi v)
// exp(-d^2/2v), added up at even angles [Penner, SIGGRAPH 2011]; trapezoids over a circle converge faster
// than any power.
TEST(ReferenceLut, PennerRingIsThePublishedOne) {
    const double sigma[6] = {0.080, 0.220, 0.432, 0.753, 1.411, 2.722},
                 red[6] = {.233, .100, .118, .113, .358, .078};
    const auto skin = skinProfile();
    for (double r : {0.5, 1.0, 5.0})
        for (double u : someU) {
            const double theta = std::acos(u);
            double sum = 0, weights = 0;
            constexpr int steps = 400000;
            for (int i = 0; i < steps; ++i) {
                const double x = -pi + (i + 0.5) * 2 * pi / steps, d = 2 * r * std::sin(x / 2);
                double weight = 0;
                for (int g = 0; g < 6; ++g)
                    weight += red[g] / (sigma[g] * std::sqrt(2 * pi)) *
                              std::exp(-d * d / (2 * sigma[g] * sigma[g]));
                sum += weight * std::max(0.0, std::cos(theta + x));
                weights += weight;
            }
            EXPECT_NEAR(curvatureD(Form::pennerRing, *skin, u, r).x, sum / weights, tolerance::oracleListing)
                << "u " << u << " r " << r;
        }
}

TEST(ReferenceLut, HoldsFromATwentiethToTenThousandSigma) {
    const auto skin = skinProfile();
    const double sigma = 2.722;
    for (Form form : allForms)
        for (double u : someU) {
            // Flat: nothing scatters across a terminator that is far away. Next to it D - max0(u) is of order
            // sigma/r.
            const double scale = 1e4;
            const Rgb flat = curvatureD(form, *skin, u, scale * sigma);
            const Rgb kept = form == Form::arc ? curvatureD(form, *skin, 1, 1e9) : Rgb{1, 1, 1};
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(flat[c], max0(u) * kept[c], tolerance::flatLimit)
                    << "u " << u << " form " << int(form);
            const Rgb tiny = curvatureD(form, *skin, u, 0.05 * sigma);
            for (int c = 0; c < 3; ++c) {
                EXPECT_GE(tiny[c], 0);
                EXPECT_LE(tiny[c], 1);
            }
        }
    const ProfilePtr one = gaussiansProfile({{1, {1, 1, 1}}});
    // A sphere much smaller than the profile is lit evenly, as is the ring: 1/4 and 1/pi.
    EXPECT_NEAR(curvatureD(Form::sphere, *one, 0.7, 1e-4).x, 0.25, tolerance::smallRadiusLimit);
    EXPECT_NEAR(curvatureD(Form::ring, *one, 0.7, 1e-4).x, 1 / pi, tolerance::smallRadiusLimit);
}

TEST(ReferenceShadowLut, EveryProfileEqualsBoostQuadrature) {
    std::mt19937 random(11);
    for (const auto& [name, profile] : profiles)
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
                    sum += Rule::integrate(integrand, borders[j], borders[j + 1], 8, 1e-12);
            EXPECT_NEAR(shadowT(*profile, w, q, k).y, sum,
                        profile->singularAtZero() ? tolerance::oracleSingular : tolerance::oracleQuadrature);
        }
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

TEST(ReferenceBeckmann, IsNormalisedOverTheHemisphereAndHasItsLimits) {
    for (double m : {0.1, 0.3, 0.8}) {
        // A distribution of slopes: the integral of P cos over the hemisphere is pi.
        const double share = Rule::integrate(
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
