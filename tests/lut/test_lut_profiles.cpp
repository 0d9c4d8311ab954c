// Every form with every profile against the oracle, and profiles against the oracle's.
#include <random>

#include "lut_cases.h"
#include "test_size.h"

using namespace pellucid;
using fixture::forms;

namespace {

struct Pair {
    const char* name;
    Profile ours;
    reference::ProfilePtr truth;
    double tolerance;
};

// The absorption and reduced scattering of marble and ketchup, 1/mm (Jensen et al. 2001).
const float marbleAbsorption[3] = {0.0021f, 0.0041f, 0.0071f}, marbleScattering[3] = {2.19f, 2.62f, 3.00f};
const float ketchupAbsorption[3] = {0.061f, 0.97f, 1.45f}, ketchupScattering[3] = {0.18f, 0.07f, 0.03f};

reference::Rgb rgb(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

std::vector<Pair> pairs() {
    std::vector<Pair> all;
    all.push_back({"skin", Profile::skin(), reference::skinProfile(), tolerance::lutTexelGaussians});
    const std::vector<PelGaussian> three{{0.01f, {1, 2, 3}}, {0.5f, {2, 0, 1}}, {9, {1, 1, 0}}};
    std::vector<reference::Gaussian> same;
    for (const PelGaussian& g : three) same.push_back({g.variance, {g.weight[0], g.weight[1], g.weight[2]}});
    all.push_back({"three Gaussians", Profile::gaussians(three), reference::gaussiansProfile(same),
                   tolerance::lutTexelGaussians});
    all.push_back({"one Gaussian", Profile::gaussians({{4, {1, 1, 1}}}),
                   reference::gaussiansProfile({{4, {1, 1, 1}}}), tolerance::lutTexelGaussians});
    const float path[3] = {3.67f, 1.37f, 0.68f}, albedo[3] = {0.9f, 0.6f, 0.45f};
    all.push_back({"burley", Profile::burley(path, albedo), reference::burleyProfile(rgb(path), rgb(albedo)),
                   tolerance::lutTexelOther});
    all.push_back({"marble", Profile::dipole(marbleAbsorption, marbleScattering, 1.5f),
                   reference::dipoleProfile(rgb(marbleAbsorption), rgb(marbleScattering), 1.5),
                   tolerance::lutTexelOther});
    all.push_back({"ketchup", Profile::dipole(ketchupAbsorption, ketchupScattering, 1.3f),
                   reference::dipoleProfile(rgb(ketchupAbsorption), rgb(ketchupScattering), 1.3f),
                   tolerance::lutTexelOther});
    return all;
}

void compare(const Device& device, const Pair& pair, PelCurvatureForm form, reference::Form trueForm,
             double least, double most, PelLutAxis axis) {
    PelCurvatureLutDesc desc =
        fixture::curvatureTable(pair.ours, form, sized(48u, 7u), sized(12u, 3u), least, most);
    desc.axis = axis;
    const Lut lut(device, desc);
    const auto texels = lut.read<float>(PEL_LUT_FLOAT);
    std::mt19937 random(3);
    for (int i = 0; i < 24; ++i) {
        const int x = int(random() % desc.width), y = i < int(desc.height) ? i : int(random() % desc.height);
        double u = -1 + (x + 0.5) * 2 / desc.width, c;
        const double c0 = 1 / double(desc.radiusMax), c1 = 1 / double(desc.radiusMin),
                     t = (y + 0.5) / desc.height;
        if (axis == PEL_AXIS_ROOT) {
            const double s = -1 + 2.0 * x / (desc.width - 1);
            u = s * std::abs(s);
            c = std::pow(std::sqrt(c0) + y / (desc.height - 1.0) * (std::sqrt(c1) - std::sqrt(c0)), 2);
        } else {
            c = c0 + t * (c1 - c0);
        }
        const reference::Rgb truth = reference::curvatureD(trueForm, *pair.truth, u, 1 / c);
        for (int k = 0; k < 3; ++k) {
            const double error = std::abs(texels[(size_t(y) * desc.width + x) * 3 + k] - truth[k]);
            EXPECT_LT(error, pair.tolerance)
                << pair.name << " form " << int(form) << " axis " << int(axis) << " u " << u << " r/radius "
                << 1 / c / pair.truth->radius() << " channel " << k << " truth " << truth[k];
        }
    }
}

}  // namespace

TEST(LutProfiles, EveryFormEqualsTheIntegral) {
    const Device device("");
    for (const Pair& pair : pairs())
        for (const auto& [form, trueForm] : forms) {
            compare(device, pair, form, trueForm, 0.3, 40, PEL_AXIS_LINEAR);
            compare(device, pair, form, trueForm, 0.05, 1e4, PEL_AXIS_ROOT);
        }
}

TEST(LutProfiles, ShadowEqualsTheIntegral) {
    const Device device("");
    for (const Pair& pair : pairs())
        for (float sharpening : {1.0f, 10.0f}) {
            const PelShadowLutDesc desc = fixture::shadowTable(pair.ours, 40, 8, 2, 40, sharpening);
            const auto texels = Lut(device, desc).read<float>(PEL_LUT_FLOAT);
            const reference::ShadowLutSpec spec{
                40, 8, desc.widthMin, desc.widthMax, pair.truth->radius(), sharpening};
            for (int y = 0; y < 8; y += 2)
                for (int x = y % 3; x < 40; x += 5) {
                    const auto truth = reference::shadowTexel(spec, *pair.truth, x, y);
                    for (int k = 0; k < 3; ++k)
                        EXPECT_NEAR(texels[(size_t(y) * 40 + x) * 3 + k], truth[k], pair.tolerance)
                            << pair.name << " (" << x << ", " << y << ")";
                }
        }
}

TEST(LutProfiles, MeanOverTheSphereIsAQuarter) {
    const Device device("");
    for (const Pair& pair : pairs()) {
        const auto desc = fixture::curvatureTable(pair.ours, PEL_FORM_SPHERE, 2049, sized(16u, 2u), 0.05, 1000);
        fixture::expectMeansOfAQuarter(Lut(device, desc).read<float>(PEL_LUT_FLOAT), desc.width, pair.name);
    }
}

TEST(LutProfiles, RadialAndLineSpreadEqualTheOracles) {
    for (const Pair& pair : pairs()) {
        const double radius = pair.truth->radius();
        EXPECT_NEAR(pair.ours.info().radius / radius, 1, tolerance::profileEvaluation) << pair.name;
        const std::vector<double> at{0.01 * radius, 0.1 * radius, 0.5 * radius,
                                     radius,        2 * radius,   4 * radius};
        const auto radial = pair.ours.radial(at), lineSpread = pair.ours.lineSpread(at);
        for (size_t i = 0; i < at.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                const double R = pair.truth->radial(at[i])[k], P = pair.truth->lineSpread(at[i])[k];
                const double peak = pair.truth->lineSpread(0.01 * radius)[k];
                EXPECT_NEAR(radial[3 * i + k], R, tolerance::profileEvaluation * (R + 1e-9))
                    << pair.name << " d " << at[i];
                EXPECT_NEAR(lineSpread[3 * i + k], P, tolerance::profileEvaluation * peak)
                    << pair.name << " s " << at[i];
            }
    }
}

TEST(LutProfiles, NormalBlendOfSkinIsThePublishedOne) {
    const PelProfileInfo info = Profile::skin().info();
    EXPECT_NEAR(info.normalBlend[0], 1, tolerance::normalBlend);
    EXPECT_NEAR(info.normalBlend[1], 0.3, tolerance::normalBlend);
    EXPECT_NEAR(info.normalBlend[2], 0, tolerance::normalBlend);
    EXPECT_STREQ(info.name, "skin");
}

TEST(LutProfiles, RefusesWhatMakesNoSense) {
    const float nan3[3] = {NAN, 1, 1}, ones[3] = {1, 1, 1}, negative[3] = {1, -1, 1},
                half[3] = {0.5f, 0.5f, 0.5f};
    auto refused = [](auto make, const char* word) {
        try {
            make();
            ADD_FAILURE() << "accepted a wrong " << word;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), PEL_ERROR_INVALID_ARGUMENT);
            EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
        }
    };
    refused([] { Profile::gaussians({}); }, "1 to 256");
    refused([] { Profile::gaussians({{0, {1, 1, 1}}}); }, "variance");
    refused([] { Profile::gaussians({{NAN, {1, 1, 1}}}); }, "variance");
    refused([] { Profile::gaussians({{1, {1, -1, 1}}}); }, "green weight");
    refused([] { Profile::gaussians({{1, {1, 1, NAN}}}); }, "blue weight");
    refused([] { Profile::gaussians({{1, {1, 1, 0}}}); }, "blue weights");
    refused([&] { Profile::burley(nan3, half); }, "red mean free path");
    refused([&] { Profile::burley(ones, negative); }, "green albedo");
    refused([&] { Profile::burley(ones, half, PelBurleyFit(9)); }, "fit");
    refused([&] { Profile::dipole(negative, ones, 1.3f); }, "green absorption");
    refused([&] { Profile::dipole(ones, ones, 1); }, "eta");
    refused([&] { Profile::table({0}, {1, 1, 1}); }, "2 to");
    refused([&] { Profile::table({0, 0}, {1, 1, 1, 1, 1, 1}); }, "distance 1");
    refused([&] { Profile::table({0, 1}, {1, 1, 1, 1, 1, -1}); }, "blue value");
    for (const float wrong : {-1.0f, NAN, INFINITY}) {
        refused([&] { Profile::table({wrong, 1}, {1, 1, 1, 1, 1, 1}); }, "distance 0");
        refused([&] { Profile::table({0, 1}, {1, wrong, 1, 1, 1, 1}); }, "green value");
    }
    refused([&] { Profile::table({0, 1}, {0, 1, 1, 0, 1, 1}); }, "red");
    refused([&] { Profile::skin().setName(std::string(64, 'x')); }, "63");
}

TEST(SpecularLut, EqualsBeckmann) {
    PelSpecularLutDesc desc = pelSpecularLutDescDefaults();
    desc.width = 61;
    desc.height = 40;
    const Lut lut(Device(""), desc);
    EXPECT_EQ(lut.info().kind, PEL_LUT_SPECULAR);
    const auto texels = lut.read<float>(PEL_LUT_FLOAT);
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 61; ++x)
            for (int k = 0; k < 3; ++k)
                ASSERT_NEAR(texels[(size_t(y) * 61 + x) * 3 + k],
                            reference::beckmannEncoded((x + 0.5) / 61, (y + 0.5) / 40),
                            tolerance::lutTexelGaussians)
                    << x << ", " << y;
    desc.width = 0;
    EXPECT_THROW(Lut(Device(""), desc), Error);
}
