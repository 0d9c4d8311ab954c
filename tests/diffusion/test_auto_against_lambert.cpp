// With default settings, the error of `auto` against random walks is at most that of Lambert with a
// ray-traced shadow, in each channel and sub-set, except for the cases in knownWorse, which lists their size.
// The walks are made here with few paths: the difference of two squared errors is linear in the walks, so
// little noise remains.
#include "diffusion/reference_scenes.h"
#include "lit_scenes.h"
#include "sample/random_walk.h"
#include "test.h"

namespace {

using namespace lit_scenes;

constexpr double reflectance = 0.8, pathOverLength = 1.085;  // mean free path over Burley's d
constexpr size_t pointsOfScene = 1000;
constexpr uint32_t walksOfPoint = 24;  // in each channel and half

struct Contender {
    const char* name;
    ShadeRequest how;
    bool knowing = false;  // PEL_SLOT_THICKNESS is given
};
const Contender contenders[] = {{"auto, traced", {.traced = true, .gain = 1}},
                                {"auto", {.gain = 1}},
                                {"auto, thickness", {.gain = 1}, true},
                                {"light, thickness", {.scattering = PEL_SCATTERING_LIGHT, .gain = 1}, true}};

// Cases in which both are worse than Lambert: root of the difference of the squared errors, 1e-4 of white:
// red, green, blue; 0: not worse.
struct Known {
    const char *where, *part;
    double most[3];
};
// A thin body loses light through its far side, so that the lit side of a leaf is darker than that of a
// half-space, most of all at its rim. Without a thickness image the thickness of the body below the lit
// surface is not known; the gain of curvature also makes the rim brighter.
constexpr Known knownWorse[] = {
    {"leaf, side", "thin", {163, 83, 0}},
    {"leaf, side", "rest", {323, 169, 0}},
    {"leaf, side", "all", {161, 85, 0}},
};

double knownLimit(const Contender& contender, const std::string& where, const std::string& part,
                  int channel) {
    for (const Known& k : knownWorse)
        if (!contender.knowing && where == k.where && part == k.part) return 1e-4 * 1.05 * k.most[channel];
    return tolerance::neverWorse;
}

const std::pair<const char*, uint8_t> parts[] = {
    {"unlit", io::SUBSET_UNLIT},       {"terminator", io::SUBSET_TERMINATOR},
    {"penumbra", io::SUBSET_PENUMBRA}, {"thin", io::SUBSET_THIN},
    {"rest", io::SUBSET_REST},         {"all", 0xff}};

// Radiance of Lambert at points, with two walked estimates of the truth.
struct Compared {
    std::vector<uint8_t> subsets;
    std::vector<float> lambert, first, second;  // RGB
};

void compare(const Compared& c, const std::vector<float>& picture, const Contender& contender,
             const std::string& where) {
    for (const auto& [name, part] : parts) {
        size_t count = 0;
        double worse[3] = {}, square[3] = {};
        for (size_t i = 0; i < c.subsets.size(); ++i) {
            if (!(c.subsets[i] & part)) continue;
            ++count;
            for (size_t k = 0; k < 3; ++k) {
                const size_t v = 3 * i + k;
                const double a = picture[v], b = c.lambert[v], first = c.first[v], second = c.second[v],
                             d = (a - b) * (a + b - first - second);
                worse[k] += d, square[k] += d * d;
            }
        }
        if (count < 20 || testsAreSmall()) continue;
        const auto rms = [&](double sum) { return 1e4 * std::sqrt(std::max(sum, 0.0) / double(count)); };
        for (int k = 0; k < 3; ++k) {
            const double limit = knownLimit(contender, where, name, k), noise = std::sqrt(square[k]);
            EXPECT_LE(worse[k], double(count) * limit * limit + tolerance::walkErrors * noise)
                << contender.name << ", " << where << ", " << name << ", channel " << k << ": worse by "
                << rms(worse[k]) << ", noise " << rms(noise);
        }
    }
}

void compareBody(const Body& body, const std::string& name, const SceneRequest& request) {
    const Profile skin = reference_scenes::profile();
    const Stage stage(device(), body, 1);
    LitScene s = stage.look(request, skin);
    std::array<double, 3> d{0.29205, 0.10902, 0.05411};  // Burley's, mm
    for (double& length : d) length *= request.profileScale;
    const sample::WalkBody medium(stage.scene(), stage.material());
    std::vector<size_t> shown;  // pixels that are compared
    std::vector<sample::SurfacePoint> places;
    const size_t stride = 1 + s.places.size() / sized(pointsOfScene, size_t(20));
    for (size_t i = 0, k = 0; i < s.covered.size(); ++i)
        if (s.covered[i] && k++ % stride == 0) shown.push_back(i), places.push_back(s.places[k - 1]);
    const std::array<double, 3> white{reflectance, reflectance, reflectance};
    const sample::WalkedLight light =
        walkLight(medium, s.lighting, places, sample::burleyMedium(d, white, sample::Boundary::IndexMatched),
                  {sized(walksOfPoint, 2u)});
    const std::vector<float> thickness = thicknessOf(stage, s);
    const auto radiance = [&](const std::vector<float>& all) {
        std::vector<float> some;
        for (const size_t i : shown)
            for (size_t k = 0; k < 3; ++k) some.push_back(float(reflectance) * all[3 * i + k]);
        return some;
    };
    Compared c{{}, radiance(s.irradiance), light.first, light.second};
    for (const size_t i : shown) {
        const bool thin = thickness[i] < io::thin * pathOverLength * d[0];
        c.subsets.push_back(uint8_t(s.subsets[i] | (thin ? io::SUBSET_THIN : 0)));
    }
    for (const Contender& contender : contenders) {
        ShadeRequest how = contender.how;
        if (contender.knowing) how.thickness = thickness;
        compare(c, radiance(shade(device(), s, skin, request.profileScale, how)), contender, name);
    }
}

// For heads the profile is four times as wide, so that it is wider than a pixel.
SceneRequest requestOf(int size, double profileScale = 1, bool fromBehind = false) {
    SceneRequest request;
    request.profileScale = profileScale;
    request.size = sized(size, 12);
    if (fromBehind) request.lightAzimuth = 150, request.lightElevation = 15;
    return request;
}

// Of data/heads, read once.
const Body& wholeHead(const char* name) {
    static std::map<std::string, Body> known;
    Body& body = known[name];
    if (body.name.empty()) body = head(headFile(std::string("head_") + name), name, sized(2, 0));
    return body;
}

const Body& nose() {
    static const Body body = closeUp(
        wholeHead("female"), "nose", [](sample::Vec3 p) { return p.z - 10 * std::abs(p.x); }, 45);
    return body;
}
const Body& ear() {
    static const Body body = closeUp(
        wholeHead("male"), "ear", [](sample::Vec3 p) { return p.x; }, 70);
    return body;
}

}  // namespace

TEST(AutoAgainstLambert, Balls) {
    for (double radius : {1.1, 3.0, 10.0})
        compareBody(ball(radius, sized(96, 8)), "ball of " + std::to_string(int(radius)) + " mm",
                    requestOf(48));
}
// The unit does not change the light.
TEST(AutoAgainstLambert, AnyUnit) {
    const Profile skin = reference_scenes::profile();
    const LitScene s = Stage(device(), ball(3, sized(96, 8)), 1).look(requestOf(48), skin);
    const std::vector<float> inMm = shade(device(), s, skin, 1, {.gain = 1});
    for (double unit : {10.0, 1000.0}) {
        const auto other = shade(device(), inUnit(s, unit), skin, 1, {.gain = 1});
        for (const double rms : io::compareImages(other, inMm, s.covered).rmse)
            EXPECT_LT(rms, 2 * tolerance::neverWorse);
    }
}
TEST(AutoAgainstLambert, Relief) {
    compareBody(relief(sized(160, 10)), "relief", requestOf(64));
}
TEST(AutoAgainstLambert, Heads) {
    for (const bool fromBehind : {false, true})
        for (const char* name : {"female", "male"})
            compareBody(wholeHead(name), std::string(name) + (fromBehind ? ", behind" : ", side"),
                        requestOf(96, 4, fromBehind));
}
TEST(AutoAgainstLambert, NoseEarAndLeaf) {
    compareBody(nose(), "nose, side", requestOf(80, 4));
    for (const bool fromBehind : {false, true}) {
        const std::string light = fromBehind ? ", behind" : ", side";
        compareBody(ear(), "ear" + light, requestOf(80, 4, fromBehind));
        compareBody(leaf(sized(96, 8)), "leaf" + light, requestOf(64, 1, fromBehind));
    }
}
TEST(AutoAgainstLambert, TwoLightsAndAmbient) {
    SceneRequest request = requestOf(96, 4);
    request.more = {{.toLight = sample::normalize(sample::Vec3{-0.8, 0.3, 0.2}), .color = {0.5, 0.5, 0.5}}};
    request.ambient = 0.2;
    compareBody(wholeHead("female"), "two lights", request);
}
TEST(AutoAgainstLambert, PointLightAtTheCheek) {
    SceneRequest request = requestOf(96, 4, true);
    const sample::Vec3 at =
        foremostOf(wholeHead("female"), [](sample::Vec3 p) { return p.z - std::abs(p.x - 35); });
    request.more = {{.type = sample::SurfaceLight::Type::Point,
                     .position = at + sample::Vec3{25, 10, 40},
                     .color = {2000, 2000, 2000}}};
    compareBody(wholeHead("female"), "point light", request);
}
