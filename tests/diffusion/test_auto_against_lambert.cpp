// With default settings `auto` is no further from the surface integral than Lambert with a ray-traced
// shadow, in no channel and no sub-set, with a few exceptions, which known_worse.h lists with their size.
// Errors of the methods that read tables or do not scatter are printed beside it, but not tested: these are
// worse in places.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>

#include "lit_scenes.h"
#include "reference/surface_integral.h"
#include "test_size.h"
#include "tolerances.h"

namespace {

using namespace lit_scenes;

struct Contender {
    const char* name;
    bool tested;
    ShadeRequest how;
};

const Contender contenders[] = {
    {"lambert", true, {}},  // irradiance as it is: no scattering, and shadows traced by ray
    {"preintegrated", false, {.scattering = PEL_SCATTERING_PREINTEGRATED}},
    {"none", false, {.scattering = PEL_SCATTERING_NONE}},
    {"auto, traced", true, {.traced = true}},
    {"auto", true, {}},
};

// Where a method is further from light than Lambert, measured, in 1e-4 of white: red, green, blue; 0: it is
// not.
struct Known {
    const char *method, *where, *part;
    double most[3];
};
#include "known_worse.h"

double knownLimit(const std::string& method, const std::string& where, const std::string& part, int channel) {
    const std::string scene = where.substr(0, where.rfind(','));  // in any unit
    for (const Known& k : knownWorse)
        if (method == k.method && scene == k.where && part == k.part) return 1e-4 * 1.05 * k.most[channel];
    return 0;
}

const std::pair<const char*, uint8_t> parts[] = {{"unlit", io::SUBSET_UNLIT},
                                                 {"terminator", io::SUBSET_TERMINATOR},
                                                 {"penumbra", io::SUBSET_PENUMBRA},
                                                 {"rest", io::SUBSET_REST}};

io::ImageDifference within(const LitScene& s, const std::vector<float>& picture, uint8_t part) {
    std::vector<uint8_t> mask(s.covered.size());
    for (size_t i = 0; i < mask.size(); ++i) mask[i] = s.covered[i] && (s.subsets[i] & part);
    return io::compareImages(picture, s.truth, mask);
}

void compare(const LitScene& s, const Profile& profile, const std::string& where) {
    const Device device("");
    for (const Contender& c : contenders) {
        const std::vector<float> picture =
            &c == contenders ? s.irradiance : shade(device, s, profile, 1, nullptr, c.how);
        for (const auto& [name, part] : parts) {
            const io::ImageDifference lambert = within(s, s.irradiance, part), own = within(s, picture, part);
            if (lambert.pixels == 0) continue;
            if (&c != contenders)
                std::printf("%-34s %-14s %-10s %6zu   1e-4: %5.0f %5.0f %5.0f   Lambert %5.0f %5.0f %5.0f\n",
                            where.c_str(), c.name, name, own.pixels, 1e4 * own.rmse[0], 1e4 * own.rmse[1],
                            1e4 * own.rmse[2], 1e4 * lambert.rmse[0], 1e4 * lambert.rmse[1],
                            1e4 * lambert.rmse[2]);
            for (int channel = 0; c.tested && channel < 3; ++channel)
                EXPECT_LE(own.rmse[channel], std::max(lambert.rmse[channel] + tolerance::neverWorse,
                                                      knownLimit(c.name, where, name, channel)))
                    << c.name << ", " << where << ", " << name << ", channel " << channel;
        }
    }
}

struct Light {
    const char* name;
    double azimuth, elevation;
};
constexpr Light lights[] = {{"side", 80, 20}, {"behind", 150, 15}};

void compareBody(const Body& body, int size, double fill = 0.94) {
    const Device device("");
    const Profile skin = Profile::skin();
    const Stage stage(device, body, 1);
    for (const Light& light : lights) {
        SceneRequest request;
        request.lightAzimuth = light.azimuth;
        request.lightElevation = light.elevation;
        request.size = size;
        request.fill = fill;
        LitScene inMm = stage.look(request, skin);
        stage.addTruth(device, inMm, skin, 1);
        for (const auto& [unit, name] : {std::pair{1.0, "mm"}, {10.0, "cm"}, {1000.0, "m"}}) {
            if (unit != 1 && &light != lights) continue;  // the unit is no matter of the light
            compare(inUnit(inMm, unit), skin, body.name + ", " + light.name + ", " + name);
        }
    }
}

// Of data/heads, read once.
const Body& wholeHead(const char* name) {
    static std::map<std::string, Body> known;
    Body& body = known[name];
    if (body.name.empty()) body = head(headFile(std::string("head_") + name), name, sized(2, 0));
    return body;
}

}  // namespace

TEST(AutoAgainstLambert, Ball) {
    compareBody(ball(10, sized(96, 8)), sized(96, 12));
}
TEST(AutoAgainstLambert, Relief) {
    compareBody(relief(sized(160, 10)), sized(96, 12));
}
TEST(AutoAgainstLambert, FemaleHead) {
    compareBody(wholeHead("female"), sized(128, 12));
}
TEST(AutoAgainstLambert, Nose) {
    compareBody(closeUp(
                    wholeHead("female"), "nose", [](Vec3 p) { return p.z - 10 * std::abs(p.x); }, 45),
                sized(112, 12));
}
TEST(AutoAgainstLambert, Ear) {
    compareBody(closeUp(
                    wholeHead("male"), "ear", [](Vec3 p) { return p.x; }, 70),
                sized(112, 12));
}
TEST(AutoAgainstLambert, MaleHead) {
    compareBody(wholeHead("male"), sized(128, 12));
}

// The references of these scenes are right: a ball's has a closed form, whatever the unit.
TEST(AutoAgainstLambert, ReferenceOfTheBallIsTheClosedForm) {
    const Device device("");
    const Profile skin = Profile::skin();
    for (double unit : {1.0, 1000.0}) {
        SceneRequest request;
        request.size = sized(48, 10);
        request.unit = unit;
        const LitScene s = make(device, ball(10, sized(160, 8)), request, skin);
        const auto truth = reference::skinProfile();
        double square = 0;
        size_t count = 0;
        for (size_t i = 0; i < s.covered.size(); ++i) {
            if (!s.covered[i]) continue;
            const Vec3 p{s.positions[3 * i], s.positions[3 * i + 1], s.positions[3 * i + 2]};
            const reference::Rgb S = reference::surfaceIntegralOfSphere(
                *truth, 10, std::acos(std::clamp(dot(normalize(p), s.toLight), -1.0, 1.0)));
            for (int c = 0; c < 3; ++c) square += std::pow(s.truth[3 * i + c] - S[c], 2), ++count;
        }
        EXPECT_LT(std::sqrt(square / double(count)), testsAreSmall() ? 0.1 : tolerance::referenceRms)
            << "unit " << unit;
    }
}
