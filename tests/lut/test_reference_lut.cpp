// The oracle's curvature LUT against second methods: Bessel series, Fourier modes, Boost.Math quadrature; its
// limits and energy; and tables that were integrated elsewhere.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <numbers>
#include <random>

#include "npy.h"
#include "reference/lut.h"
#include "reference/quadrature.h"
#include "tolerances.h"

using namespace reference;
namespace {

constexpr double pi = std::numbers::pi;
constexpr Form allForms[] = {Form::arc, Form::ring, Form::halfRing, Form::sphere, Form::pennerRing};
const double someU[] = {-1, -0.9, -0.5, -0.1, -1e-3, 0, 1e-3, 0.1, 0.3, 0.7, 0.99, 1};

ProfilePtr oneGaussian(double sigma) {
    return gaussiansProfile({{sigma * sigma, {1, 1, 1}}});
}

// Coefficient of cos(n theta) in max0(cos theta) on the circle.
double circleMode(int n) {
    if (n == 0) return 1 / pi;
    if (n == 1) return 0.5;
    if (n % 2) return 0;
    const double m = n / 2;
    return (n / 2 % 2 ? 1 : -1) * 2 / pi / (4 * m * m - 1);
}

// Coefficient of the Legendre polynomial l in max0(cos theta) on the sphere.
double sphereMode(int l) {
    if (l == 0) return 0.25;
    if (l == 1) return 0.5;
    if (l % 2) return 0;
    double moment = 0.125;  // integral of x P_2 over [0, 1]; each l + 2 follows by a factor
    for (int k = 2; k < l; k += 2) moment *= -double(k - 1) / (k + 4);
    return (2 * l + 1) / 2.0 * moment;
}

// Ratios I_{n+order}(kappa)/I_order(kappa) for n = 0..count by downward recurrence (Miller's algorithm).
std::vector<double> besselRatios(double order, double kappa, int count) {
    std::vector<double> ratio(count + 1, 1.0);
    double quotient = 0;  // I_{nu+1}/I_nu, from the continued fraction's tail
    std::vector<double> quotients(count + 1);
    for (int n = 2 * count + 50; n >= 0; --n) {
        quotient = 1 / (2 * (n + order + 1) / kappa + quotient);
        if (n < count) quotients[n] = quotient;
    }
    for (int n = 0; n < count; ++n) ratio[n + 1] = ratio[n] * quotients[n];
    return ratio;
}

double ringSeries(double u, double kappa) {
    const int count = 200 + int(12 * std::sqrt(kappa));
    const auto ratio = besselRatios(0, kappa, count);
    const double theta = std::acos(u);
    double sum = 0;
    for (int n = 0; n <= count; ++n) sum += circleMode(n) * ratio[n] * std::cos(n * theta);
    return sum;
}

double sphereSeries(double u, double kappa) {
    const int count = 200 + int(12 * std::sqrt(kappa));
    const auto ratio = besselRatios(0.5, kappa, count);
    double sum = 0, previous = 1, current = u;  // Legendre polynomials l, l + 1
    for (int l = 0; l <= count; ++l) {
        sum += sphereMode(l) * ratio[l] * previous;
        const double next = ((2 * l + 3) * u * current - (l + 1) * previous) / (l + 2);
        previous = current;
        current = next;
    }
    return sum;
}

TEST(ReferenceLut, RingOfOneGaussianIsABesselSeries) {
    for (double r : {0.05, 0.3, 1.0, 3.0, 30.0, 300.0})  // in sigmas
        for (double u : someU)
            EXPECT_NEAR(curvatureD(Form::ring, *oneGaussian(1), u, r).x, ringSeries(u, r * r),
                        tolerance::oracleClosedForm)
                << "u " << u << " r " << r;
}

TEST(ReferenceLut, SphereOfOneGaussianIsABesselLegendreSeries) {
    for (double r : {0.05, 0.3, 1.0, 3.0, 30.0, 300.0})
        for (double u : someU)
            EXPECT_NEAR(curvatureD(Form::sphere, *oneGaussian(1), u, r).x, sphereSeries(u, r * r),
                        tolerance::oracleClosedForm)
                << "u " << u << " r " << r;
}

TEST(ReferenceLut, ArcLongEnoughIsAWrappedGaussian) {
    // With the cut at 12 sigma and pi r beyond it, each mode n of the circle shrinks by exp(-n² v / 2r²).
    for (double r : {4.0, 10.0, 100.0})
        for (double u : someU) {
            double sum = 0;
            for (int n = 0; n <= 3000; ++n)
                sum += circleMode(n) * std::exp(-0.5 * n * n / (r * r)) * std::cos(n * std::acos(u));
            EXPECT_NEAR(curvatureD(Form::arc, *oneGaussian(1), u, r, 12).x, sum, tolerance::oracleClosedForm)
                << "u " << u << " r " << r;
        }
}

// The definitions as written, each smooth stretch by Boost's 61-point rule, no folding and no substitution.
double boostCurvature(Form form, const Profile& profile, int channel, double u, double r) {
    using Rule = boost::math::quadrature::gauss_kronrod<double, 61>;
    const double theta = std::acos(u);
    const double end = form == Form::arc          ? std::min(pi * r, profileCut(profile)) / r
                       : form == Form::ring       ? pi
                       : form == Form::pennerRing ? pi
                       : form == Form::sphere     ? pi
                                                  : pi / 2;
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
    const std::pair<const char*, ProfilePtr> profiles[] = {
        {"skin", skinProfile()},
        {"dipole", dipoleProfile({0.032, 0.17, 0.48}, {0.74, 0.88, 1.01}, 1.3)},
        {"table",
         tableProfile({0, 0.5, 1, 2, 4}, {{9, 8, 7}, {4, 3, 2}, {1, .5, .2}, {.2, .05, .01}, {0, 0, 0}})},
        {"burley", burleyProfile({3.67, 1.37, 0.68}, {0.9, 0.6, 0.4})}};
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
    // A sphere much smaller than the profile is lit evenly, as is the ring: 1/4 and 1/pi.
    EXPECT_NEAR(curvatureD(Form::sphere, *oneGaussian(1), 0.7, 1e-4).x, 0.25, tolerance::smallRadiusLimit);
    EXPECT_NEAR(curvatureD(Form::ring, *oneGaussian(1), 0.7, 1e-4).x, 1 / pi, tolerance::smallRadiusLimit);
}

TEST(ReferenceLut, MeanOfSphereIsAQuarterAndOfRingOneOverPi) {
    for (const auto& profile : {skinProfile(), burleyProfile({3.67, 1.37, 0.68}, {0.9, 0.6, 0.4})})
        for (double r : {0.3, 5.0, 200.0}) {
            // The terminator changes D over widths of each Gaussian: borders there.
            std::vector<double> borders;
            for (double l : profile->lengths())
                for (double sign : {-1, 1}) borders.push_back(sign * l / r);
            borders.push_back(0);
            const Rgb mean =
                integrate<Rgb>([&](double u) { return 0.5 * curvatureD(Form::sphere, *profile, u, r); },
                               panelPoints(-1, 1, borders), 1e-11, 1e-11);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], 0.25, tolerance::oracleClosedForm) << "r " << r;
            if (profile->singularAtZero()) continue;
            const Rgb ringMean = integrate<Rgb>(
                [&](double theta) { return curvatureD(Form::ring, *profile, std::cos(theta), r) / pi; },
                panelPoints(0, pi, {pi / 2}), 1e-11, 1e-11);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(ringMean[c], 1 / pi, tolerance::oracleClosedForm) << "r " << r;
        }
}

TEST(ReferenceLut, ArcEqualsTheIndependentTable) {
    REQUIRE_ORACLE_DIRECTORY(directory);
    const auto truth = npy::read<float>(directory / "truth_lut_curv_A_arc10_f32.npy");
    const auto axes = npy::read<double>(directory / "truth_lut_curv_A_axes_f64.npy");
    const CurvatureLutSpec spec;
    ASSERT_EQ(truth.shape, (std::vector<size_t>{512, 512, 3}));
    const auto skin = skinProfile();
    double worst = 0;
    for (int y = 0; y < 512; y += 73)
        for (int x = 0; x < 512; x += 19) {
            EXPECT_NEAR(axes.row(0)[x], spec.u(x), tolerance::oracleExact);
            const Rgb d = curvatureTexel(spec, *skin, x, y);
            for (int c = 0; c < 3; ++c)
                worst = std::max(worst, std::abs(d[c] - truth.data[(y * 512 + x) * 3 + c]));
        }
    RecordProperty("worst", std::to_string(worst));
    EXPECT_LE(worst, tolerance::oracleFloatTable);
}

}  // namespace
