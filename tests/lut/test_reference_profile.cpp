// The oracle's profiles: published numbers, energy, and line spread against closed forms and a second
// quadrature.
#include <gtest/gtest.h>

#include <boost/math/quadrature/tanh_sinh.hpp>
#include <boost/math/special_functions/bessel.hpp>

#include "reference/profile.h"
#include "reference/quadrature.h"
#include "tolerances.h"

using namespace reference;
namespace {

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

TEST(ReferenceProfile, SkinHasThePublishedSigmas) {
    // Variances are printed beside the sigmas, both rounded; weights of each channel add up to 1 as printed.
    const double v[6] = {0.0064, 0.0484, 0.187, 0.567, 1.99, 7.41};
    const double sigma[6] = {0.080, 0.220, 0.432, 0.753, 1.411, 2.722};
    const Rgb weight[6] = {{.233, .455, .649}, {.100, .336, .344}, {.118, .198, 0},
                           {.113, .007, .007}, {.358, .004, 0},    {.078, 0, 0}};
    Rgb sum, atZero;
    for (int i = 0; i < 6; ++i) {
        EXPECT_NEAR(std::sqrt(v[i]), sigma[i], tolerance::publishedWidth);
        sum = sum + weight[i];
        atZero = atZero + weight[i] / (2 * pi * sigma[i] * sigma[i]);
    }
    const Rgb actual = skinProfile()->radial(0);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(sum[c], 1, tolerance::publishedWeights);
        EXPECT_NEAR(actual[c] / atZero[c], 1, tolerance::oracleExact);
    }
    EXPECT_EQ(skinProfile()->radius(), 2.7);
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
            auto moment = [&](int power) {
                auto borders = profile->lengths();
                for (double& b : borders) b = std::cbrt(b);
                return 2 * integrate<double>(
                               [&](double x) {
                                   return std::pow(x, 3 * power) * profile->lineSpread(x * x * x)[c] * 3 * x *
                                          x;
                               },
                               panelPoints(0, borders.back(), borders), 0, 1e-12);
            };
            EXPECT_NEAR(moment(0), 1, tolerance::oracleEnergy) << name;
            EXPECT_NEAR(std::sqrt(moment(2)) / width[c], 1, tolerance::oracleEnergy) << name;
        }
    }
}

TEST(ReferenceProfile, BurleyLineSpreadIsAModifiedBesselFunction) {
    const Rgb path{3.67, 1.37, 0.68}, albedo{0.9, 0.6, 0.4};
    for (BurleyFit fit :
         {BurleyFit::searchlight, BurleyFit::diffuseTransmission, BurleyFit::diffuseMeanFreePath}) {
        const auto profile = burleyProfile(path, albedo, fit);
        for (double s : {1e-6, 0.01, 0.3, 2.0, 10.0})
            for (int c = 0; c < 3; ++c) {
                const double d = path[c] / burleyScale(fit, albedo[c]);
                const double closed =
                    (boost::math::cyl_bessel_k(0, s / d) + boost::math::cyl_bessel_k(0, s / (3 * d))) /
                    (4 * pi * d);
                EXPECT_NEAR(profile->lineSpread(s)[c] / closed, 1, tolerance::oracleLineSpread) << "s " << s;
            }
    }
    EXPECT_THROW(burleyProfile(path, albedo)->lineSpread(0), std::domain_error);
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

TEST(ReferenceProfile, DipoleAndTableLineSpreadEqualTanhSinh) {
    boost::math::quadrature::tanh_sinh<double> quadrature;
    for (const auto& profile : {testDipole(), testTable()})
        for (double s : {0.0, 0.2, 1.0, 3.0})
            for (int c = 0; c < 3; ++c) {
                // Each stretch between two lengths apart, since tanh-sinh wants smooth interiors.
                std::vector<double> borders;
                for (double l : profile->lengths())
                    if (l > s) borders.push_back(std::sqrt(l * l - s * s));
                const auto points = panelPoints(0, borders.back(), borders);
                double sum = 0;
                for (size_t i = 0; i + 1 < points.size(); ++i)
                    sum += 2 * quadrature.integrate(
                                   [&](double t) { return profile->radial(std::hypot(s, t))[c]; }, points[i],
                                   points[i + 1]);
                EXPECT_NEAR(profile->lineSpread(s)[c] / sum, 1, tolerance::oracleLineSpread) << "s " << s;
            }
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

TEST(ReferenceProfile, ScalingKeepsEnergyAndStretchesBothViews) {
    for (const auto& [name, profile] : allProfiles()) {
        const auto wide = profileForRadius(profile, 3 * profile->radius());
        EXPECT_NEAR(wide->radius() / profile->radius(), 3, tolerance::oracleExact) << name;
        const Rgb energy = enclosedEnergy(*wide, wide->lengths().back());
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(energy[c], 1, tolerance::oracleEnergy) << name;
            EXPECT_NEAR(wide->radial(1.5)[c] * 9, profile->radial(0.5)[c], tolerance::oracleExact) << name;
            EXPECT_NEAR(wide->lineSpread(1.5)[c] * 3, profile->lineSpread(0.5)[c], tolerance::oracleExact)
                << name;
        }
    }
}

}  // namespace
