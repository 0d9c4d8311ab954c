// Profiles against the oracle's, the numbers of the library's materials, which stand here a second time, and
// errors of descriptions.
#include "lut_cases.h"

using namespace pellucid;

namespace {

struct Material {
    const char* name;
    float a[3], b[3];  // reduced scattering and absorption, 1/mm; or mean free path, mm, and albedo
    float eta;         // 0: Burley's profile
};

constexpr Material materials[] = {
    // Jensen, Marschner, Levoy, Hanrahan, SIGGRAPH 2001, figure 5: columns sigma_s' and sigma_a.
    {"apple", {2.29f, 2.39f, 1.97f}, {0.0030f, 0.0034f, 0.046f}, 1.3f},
    {"chicken", {0.15f, 0.21f, 0.38f}, {0.015f, 0.077f, 0.19f}, 1.3f},
    {"cream", {7.38f, 5.47f, 3.15f}, {0.0002f, 0.0028f, 0.0163f}, 1.3f},
    {"ketchup", {0.18f, 0.07f, 0.03f}, {0.061f, 0.97f, 1.45f}, 1.3f},
    {"marble", {2.19f, 2.62f, 3.00f}, {0.0021f, 0.0041f, 0.0071f}, 1.5f},
    {"potato", {0.68f, 0.70f, 0.55f}, {0.0024f, 0.0090f, 0.12f}, 1.3f},
    {"skim-milk", {0.70f, 1.22f, 1.90f}, {0.0014f, 0.0025f, 0.0142f}, 1.3f},
    {"skin-dark", {0.74f, 0.88f, 1.01f}, {0.032f, 0.17f, 0.48f}, 1.3f},
    {"skin-pale", {1.09f, 1.59f, 1.79f}, {0.013f, 0.070f, 0.145f}, 1.3f},
    {"whole-milk", {2.55f, 3.21f, 3.77f}, {0.0011f, 0.0024f, 0.014f}, 1.3f},
    // 1 / (absorption + reduced scattering) of skin1 above, to three digits, and its diffuse reflectance in
    // the same table.
    {"skin-burley", {1.295f, 0.952f, 0.671f}, {0.44f, 0.22f, 0.13f}, 0},
    {"paraffin", {4.0f, 3.2f, 2.2f}, {0.92f, 0.89f, 0.80f}, 0},
    {"jade", {1.2f, 2.6f, 1.5f}, {0.35f, 0.70f, 0.42f}, 0},
};

}  // namespace

TEST(LutProfiles, LibraryHasTheNumbersOfItsSources) {
    const std::vector<double> distances = {0.01, 0.1, 0.5, 1, 2, 5, 12};
    std::string message;
    try {
        Profile::named("none of them");
    } catch (const Error& e) {
        message = e.what();
    }
    for (const Material& m : materials) {
        const Profile wanted = m.eta > 0 ? Profile::dipole(m.b, m.a, m.eta) : Profile::burley(m.a, m.b);
        EXPECT_EQ(Profile::named(m.name).radial(distances), wanted.radial(distances)) << m.name;
        EXPECT_NE(message.find(m.name), std::string::npos) << message;
    }
    EXPECT_EQ(Profile::named("skin").radial(distances), Profile::skin().radial(distances));
    EXPECT_EQ(size_t(std::count(message.begin(), message.end(), ',')), std::size(materials))
        << "none that this test does not know: " << message;
}

TEST(LutProfiles, RadialAndLineSpreadEqualTheOracles) {
    for (const fixture::ProfileCase& pair : fixture::profiles()) {
        const double radius = pair.truth->radius();
        EXPECT_NEAR(pair.ours.info().radius / radius, 1, tolerance::profileEvaluation) << pair.name;
        std::vector<double> at;
        for (double radii : {0.01, 0.1, 0.5, 1.0, 2.0, 4.0}) at.push_back(radii * radius);
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

// All but a thousandth of the light of each channel leaves within its reach.
TEST(LutProfiles, ReachLeavesAThousandth) {
    for (const fixture::ProfileCase& pair : fixture::profiles()) {
        const double reach = pair.ours.info().reach;
        EXPECT_NEAR(std::ranges::max(pair.ours.transmission({reach})), 1e-3, 2e-6) << pair.name;
    }
}

TEST(LutProfiles, NormalBlendOfSkinIsThePublishedOne) {
    const PelProfileInfo info = Profile::skin().info();
    for (auto [c, blend] : {std::pair(0, 1.0), {1, 0.3}, {2, 0.0}})
        EXPECT_NEAR(info.normalBlend[c], blend, tolerance::normalBlend);
    EXPECT_STREQ(info.name, "skin");
}

TEST(LutProfiles, AGaussianWithoutWeightDoesNotWidenAProfile) {
    const PelProfileInfo info = Profile::gaussians({{2, {1, 1, 1}}, {100, {0, 0, 0}}, {9, {0, 1, 0}}}).info();
    EXPECT_FLOAT_EQ(info.radius, 3);
}

// Each fit is a scale of the mean free path.
TEST(LutProfiles, BurleysFitsDifferByTheirScale) {
    using reference::BurleyFit;
    const float path[3] = {2, 1, 0.5f}, albedo[3] = {0.9f, 0.4f, 0.1f};
    const std::pair<PelBurleyFit, BurleyFit> fits[] = {
        {PEL_BURLEY_SEARCHLIGHT, BurleyFit::searchlight},
        {PEL_BURLEY_DIFFUSE_TRANSMISSION, BurleyFit::diffuseTransmission},
        {PEL_BURLEY_DIFFUSE_MEAN_FREE_PATH, BurleyFit::diffuseMeanFreePath}};
    for (const auto& [fit, of] : fits) {
        float distance[3];
        for (int c = 0; c < 3; ++c) distance[c] = float(path[c] / reference::burleyScale(of, albedo[c]));
        const std::vector<double> at{0.1, 1, 3};
        const auto made = Profile::burley(path, albedo, fit).radial(at),
                   wanted = Profile::burleyDistance(distance).radial(at);
        for (size_t i = 0; i < made.size(); ++i)
            EXPECT_NEAR(made[i], wanted[i], tolerance::profileEvaluation * wanted[i]) << fit << ", " << i;
    }
}

TEST(LutProfiles, RefusesWhatMakesNoSense) {
    const float nan3[3] = {NAN, 1, 1}, ones[3] = {1, 1, 1}, negative[3] = {1, -1, 1},
                half[3] = {0.5f, 0.5f, 0.5f}, most = std::numeric_limits<float>::max();
    const auto gaussian = [](const char* word, float variance, float r, float g, float b) {
        expectRefused(word, [&] { Profile::gaussians({{variance, {r, g, b}}}); });
    };
    for (const double bad : {0.0, -1.0, double(NAN), double(INFINITY)})
        for (const char* word : {"distance 0 is", "distance 1 is", "distance 2 is"}) {
            std::vector<double> distances(3, 1.0);
            distances[size_t(word[9] - '0')] = bad;
            expectRefused(word, [&] { Profile::skin().radial(distances); });
        }
    for (float variance : {0.0f, NAN, INFINITY}) gaussian("variance", variance, 1, 1, 1);
    gaussian("green weight", 1, 1, -1, 1);
    gaussian("green weight", 1, most, INFINITY, 1);
    gaussian("blue weight", 1, 1, 1, NAN);
    gaussian("blue weights", 1, 1, 1, 0);
    gaussian("weights", 1, 0, 0, 0);
    expectRefused("1 to 256", [] { Profile::gaussians({}); });
    expectRefused("red mean free path", [&] { Profile::burley(nan3, half); });
    expectRefused("green albedo", [&] { Profile::burley(ones, negative); });
    expectRefused("fit", [&] { Profile::burley(ones, half, PelBurleyFit(9)); });
    expectRefused("green absorption", [&] { Profile::dipole(negative, ones, 1.3f); });
    expectRefused("eta", [&] { Profile::dipole(ones, ones, 1); });
    const auto table = [](const char* word, const std::vector<float>& distances,
                          const std::vector<float>& values) {
        expectRefused(word, [&] { Profile::table(distances, values); });
    };
    table("2 to", {0}, {1, 1, 1});
    table("distance 1", {0, 0}, {1, 1, 1, 1, 1, 1});
    table("blue value", {0, 1}, {1, 1, 1, 1, 1, -1});
    table("red", {0, 1}, {0, 1, 1, 0, 1, 1});
    for (const float wrong : {-1.0f, NAN, INFINITY}) {
        table("distance 0", {wrong, 1}, {1, 1, 1, 1, 1, 1});
        table("green value", {0, 1}, {1, wrong, 1, 1, 1, 1});
    }
    expectRefused("63", [&] { Profile::skin().setName(std::string(64, 'x')); });
}
