// The materials of the library have the numbers of their sources, which stand here a second time.
#include <gtest/gtest.h>

#include <pellucid/pellucid.hpp>

#include <algorithm>
#include <set>

using namespace pellucid;

namespace {

struct Measured {
    const char* name;
    float scattering[3], absorption[3], eta;  // reduced scattering and absorption, 1/mm
};

// Jensen, Marschner, Levoy, Hanrahan, SIGGRAPH 2001, figure 5: columns sigma_s' and sigma_a.
constexpr Measured measured[] = {
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
};

struct Shaped {
    const char* name;
    float meanFreePath[3], albedo[3];  // mm
};
constexpr Shaped shaped[] = {
    // 1 / (absorption + reduced scattering) of skin1 above, to three digits, and its diffuse reflectance in
    // the same table.
    {"skin-burley", {1.295f, 0.952f, 0.671f}, {0.44f, 0.22f, 0.13f}},
    {"paraffin", {4.0f, 3.2f, 2.2f}, {0.92f, 0.89f, 0.80f}},
    {"jade", {1.2f, 2.6f, 1.5f}, {0.35f, 0.70f, 0.42f}},
};

void expectSame(const Profile& is, const Profile& wanted, const char* name) {
    const std::vector<double> distances = {0.01, 0.1, 0.5, 1, 2, 5, 12}, a = is.radial(distances),
                              b = wanted.radial(distances);
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i)
        EXPECT_DOUBLE_EQ(a[i], b[i]) << name << ", channel " << i % 3 << " at " << distances[i / 3];
}

}  // namespace

TEST(ProfileLibrary, HasTheNumbersOfItsSources) {
    std::set<std::string> known{"skin"};
    for (const Measured& m : measured) {
        expectSame(Profile::named(m.name), Profile::dipole(m.absorption, m.scattering, m.eta), m.name);
        known.insert(m.name);
    }
    for (const Shaped& s : shaped) {
        expectSame(Profile::named(s.name), Profile::burley(s.meanFreePath, s.albedo), s.name);
        known.insert(s.name);
    }
    expectSame(Profile::named("skin"), Profile::skin(), "skin");
    // None that this test does not know.
    try {
        Profile::named("none of them");
        FAIL();
    } catch (const Error& e) {
        const std::string message = e.what();
        for (const std::string& name : known) EXPECT_NE(message.find(name), std::string::npos) << message;
        EXPECT_EQ(size_t(std::count(message.begin(), message.end(), ',')), known.size() - 1) << message;
    }
}
