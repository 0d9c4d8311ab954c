// What the oracle's tables are based on, against published numbers. Other faults of the oracle show where the
// library is compared with it; test_lut_encodings compares with tables that were integrated elsewhere.
#include "test.h"

#include "reference/lut.h"

namespace table_integrals {

using namespace reference;

namespace {

// The published listing: distances on the ring weighed by sums of one-dimensional Gaussians, 1/sqrt(2 pi v)
// exp(-d^2/2v), added up at even angles [Penner, SIGGRAPH 2011]; trapezoids over a circle converge faster
// than any power.
TEST(ReferenceLut, PennerRingIsThePublishedOne) {
    const double sigma[6] = {0.080, 0.220, 0.432, 0.753, 1.411, 2.722},
                 red[6] = {.233, .100, .118, .113, .358, .078};
    const auto skin = skinProfile();
    for (double r : {0.5, 1.0, 5.0})
        for (double u : {-0.9, -0.1, 0.0, 0.3, 1.0}) {
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

TEST(ReferenceLut, BeckmannIsThePrintedOne) {
    EXPECT_NEAR(beckmannEncoded(0.9, 0.3),
                0.5 * std::pow(std::exp(-(1 / 0.81 - 1) / 0.09) / (0.09 * 0.6561), 0.1),
                tolerance::oracleExact);
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
    // Skin1 of Jensen et al. 2001, table 1, per mm.
    const ProfilePtr skin1 = dipoleProfile({0.032, absorption, 0.48}, {0.74, scattering, 1.01}, eta);
    EXPECT_NEAR(skin1->radial(d).y * total / printed, 1, tolerance::oracleExact);
}

}  // namespace

}  // namespace table_integrals
