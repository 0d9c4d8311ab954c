// Profiles against the oracle's, and errors of their descriptions.
#include "lut_cases.h"

using namespace pellucid;

TEST(LutProfiles, RadialAndLineSpreadEqualTheOracles) {
    for (const fixture::ProfileCase& pair : fixture::profiles()) {
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
