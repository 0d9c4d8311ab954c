// The basis of the oracle's tables: the published ring, FaceWorks' encodings in 8 bits, Beckmann's
// distribution, energy and widths of profiles, published numbers. test_lut_encodings compares the library
// with tables that were integrated elsewhere.
#include "test.h"

#include "reference/lut.h"
#include "reference/quadrature.h"

namespace table_integrals {

using namespace reference;

namespace {

const double someU[] = {-1, -0.9, -0.5, -0.1, -1e-3, 0, 1e-3, 0.1, 0.3, 0.7, 0.99, 1};

using Rule = boost::math::quadrature::gauss_kronrod<double, 61>;

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

// --- profiles ---

ProfilePtr testDipole() {
    // Skin1 of Jensen et al. 2001, table 1, per mm.
    return dipoleProfile({0.032, 0.17, 0.48}, {0.74, 0.88, 1.01}, 1.3);
}
ProfilePtr testTable() {
    return tableProfile({0.1, 0.5, 1, 2, 4},
                        {{9, 8, 7}, {4, 3, 2}, {1, 0.5, 0.2}, {0.2, 0.05, 0.01}, {0, 0, 0}});
}
std::vector<std::pair<const char*, ProfilePtr>> allProfiles() {
    return {{"skin", skinProfile()},
            {"gaussians", gaussiansProfile({{0.3, {2, 1, 0.5}}, {4, {1, 1, 3}}})},
            {"burley", burleyProfile({3.67, 1.37, 0.68}, {0.9, 0.6, 0.4})},
            {"dipole", testDipole()},
            {"table", testTable()}};
}

TEST(ReferenceQuadrature, HandlesKinksAndSingularEnds) {
    EXPECT_NEAR(integrate<double>([](double x) { return std::abs(x - 0.3); }, {0, 1}), 0.29,
                tolerance::oracleQuadrature);
    EXPECT_NEAR(integrate<double>([](double x) { return -std::log(x); }, {0, 1}), 1,
                tolerance::oracleQuadrature);
    EXPECT_THROW(integrate<double>([](double x) { return 1 / (x - 0.5); }, {0, 1}), std::runtime_error);
}

TEST(ReferenceProfile, RadialIntegratesToOneOverThePlane) {
    for (const auto& [name, profile] : allProfiles()) {
        const Rgb energy = enclosedEnergy(*profile, profile->lengths().back());
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(energy[c], 1, tolerance::oracleEnergy) << name;
    }
}

TEST(ReferenceProfile, LineSpreadIntegratesToOneAndHasTheRmsWidthOfRadial) {
    for (const auto& [name, profile] : allProfiles()) {
        const Rgb width = rmsWidth(*profile);
        for (int c = 0; c < 3; ++c) {
            // s = x³ tames the logarithm of the singular profile at the centre.
            auto moment = [&, &profile = *profile](int power) {
                auto borders = profile.lengths();
                for (double& b : borders) b = std::cbrt(b);
                return 2 * integrate<double>(
                               [&](double x) {
                                   return std::pow(x, 3 * power) * profile.lineSpread(x * x * x)[c] * 3 * x *
                                          x;
                               },
                               panelPoints(0, borders.back(), borders), 0, 1e-12);
            };
            EXPECT_NEAR(moment(0), 1, tolerance::oracleEnergy) << name;
            EXPECT_NEAR(std::sqrt(moment(2)) / width[c], 1, tolerance::oracleEnergy) << name;
        }
    }
}

TEST(ReferenceProfile, BurleyScaleHasItsPublishedValues) {
    // Worked from the printed equations at A = 0.8 and 0.33, where a power vanishes.
    EXPECT_NEAR(burleyScale(BurleyFit::searchlight, 0.8), 1.05, tolerance::oracleExact);
    EXPECT_NEAR(burleyScale(BurleyFit::diffuseTransmission, 0.8), 1.1, tolerance::oracleExact);
    EXPECT_NEAR(burleyScale(BurleyFit::diffuseMeanFreePath, 0.33), 3.5, tolerance::oracleExact);
    EXPECT_NEAR(burleyScale(BurleyFit::searchlight, 0.3), 1.55 + 7 * 0.125, tolerance::oracleExact);
    EXPECT_NEAR(burleyScale(BurleyFit::diffuseMeanFreePath, 0.83), 3.5 + 100 * 0.0625,
                tolerance::oracleExact);
}

TEST(ReferenceProfile, DipoleHasTheTotalDiffuseReflectanceOfJensen) {
    // R_d = a'/2 (1 + exp(-4/3 A sqrt(3(1-a')))) exp(-sqrt(3(1-a'))): the unnormalised integral, so that
    // radial times it is the printed profile at any distance.
    const double absorption = 0.17, scattering = 0.88, eta = 1.3;
    const double fresnel = -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
    const double mismatch = (1 + fresnel) / (1 - fresnel), extinction = absorption + scattering;
    const double reducedAlbedo = scattering / extinction, root = std::sqrt(3 * (1 - reducedAlbedo));
    const double total = 0.5 * reducedAlbedo * (1 + std::exp(-4.0 / 3 * mismatch * root)) * std::exp(-root);
    const double zr = 1 / extinction, zv = zr * (1 + 4.0 / 3 * mismatch);
    const double transport = std::sqrt(3 * absorption * extinction), d = 1.3;
    auto pole = [&](double z) {
        const double s = std::sqrt(z * z + d * d);
        return z * (transport * s + 1) * std::exp(-transport * s) / (s * s * s);
    };
    const double printed = reducedAlbedo / (4 * pi) * (pole(zr) + pole(zv));
    EXPECT_NEAR(testDipole()->radial(d).y * total / printed, 1, tolerance::oracleExact);
}

}  // namespace

}  // namespace table_integrals
