// The skipped light of a picture: overall, between tiles handled differently, and while the light moves.
#include "diffusion/lit_scenes.h"
#include "test.h"

using namespace lit_scenes;

namespace {

const double target = pelScatterParamsDefaults().targetError;

std::vector<Body> bodies() {
    const Body ear = closeUp(
        head(headFile("head_male"), "male", sized(1, 0)), "ear", [](pellucid::sample::Vec3 p) { return p.x; },
        70);
    return {ball(10, sized(96, 8)), relief(sized(96, 10)),
            head(headFile("head_female"), "female", sized(1, 0)), ear};
}

constexpr double directions[] = {0, 70, 150};  // azimuth, degrees: in front, at the side, behind

LitScene sceneOf(const Stage& stage, int size, double azimuth) {
    SceneRequest request;
    request.size = size, request.mapSize = 16, request.lightAzimuth = azimuth;
    return stage.look(request, Profile::skin());
}

// Scattered irradiance of a picture without its shadow map; with a targetError of 0 nothing is left out.
std::vector<float> scatteredOf(const LitScene& s, double targetError, uint64_t* taps = nullptr) {
    scatter_scene::Picture p = pictureOf(s);
    p.ids = s.covered;
    p.params.everywhere = targetError == 0;
    if (targetError > 0) p.params.targetError = float(targetError);
    const scatter_scene::Result result = scatter_scene::run(p, Profile::skin());
    if (taps) *taps = result.stats.taps;
    return result.scattered;
}

// The skipped light of a picture, per value.
struct LeftOut {
    double most = 0, acrossTiles = 0;  // the second: its largest change over the border of two tiles
};

LeftOut leftOut(const LitScene& s, const std::vector<float>& all, const std::vector<float>& chosen) {
    LeftOut result;
    const auto width = size_t(s.width);
    const auto off = [&](size_t i, int c) {
        return double(chosen[3 * i + size_t(c)]) - all[3 * i + size_t(c)];
    };
    for (size_t i = 0; i < s.covered.size(); ++i)
        for (int c = 0; s.covered[i] && c < 3; ++c) {
            result.most = std::max(result.most, std::abs(off(i, c)));
            const size_t x = i % width, y = i / width;
            if (x % 16 == 0 && x > 0 && s.covered[i - 1])
                result.acrossTiles = std::max(result.acrossTiles, std::abs(off(i, c) - off(i - 1, c)));
            if (y % 16 == 0 && y > 0 && s.covered[i - width])
                result.acrossTiles = std::max(result.acrossTiles, std::abs(off(i, c) - off(i - width, c)));
        }
    return result;
}

void expectLeftOut(const LeftOut& left, double allowed, const std::string& where) {
    EXPECT_LE(left.most, tolerance::scatterLeftOut * allowed) << where;
    EXPECT_LE(left.acrossTiles, tolerance::scatterSeam * allowed) << where;
}

}  // namespace

// The bound holds everywhere; a larger target error saves taps, and is kept as well.
TEST(ScatterSteady, LeavesOutNoMoreThanTheTargetError) {
    for (const Body& body : bodies()) {
        const Stage stage(device(), body, 1);
        for (int size : {sized(96, 16), sized(256, 24)})
            for (double azimuth : directions) {
                const LitScene s = sceneOf(stage, size, azimuth);
                const std::string where = body.name + ", " + std::to_string(size) + " pixels, light from " +
                                          std::to_string(azimuth);
                uint64_t before = 0, first = 0;
                const std::vector<float> all = scatteredOf(s, 0);
                expectLeftOut(leftOut(s, all, scatteredOf(s, target, &first)), target, where);
                if (size != sized(256, 24) || azimuth != 70) continue;
                before = first;
                for (double larger : {2.5 * target, 5 * target, 10 * target}) {
                    uint64_t taps = 0;
                    expectLeftOut(leftOut(s, all, scatteredOf(s, larger, &taps)), larger, where);
                    EXPECT_LE(taps, before) << where << ", " << larger;
                    before = taps;
                }
                if (!testsAreSmall()) {
                    EXPECT_LT(double(before), tolerance::tapsOfLargeError * double(first)) << where;
                }
            }
    }
}

// Tiles that begin to count while the light moves, or cease to.
TEST(ScatterSteady, TilesFadeIn) {
    const Stage stage(device(), ball(10, sized(96, 8)), 1);
    std::vector<float> chosenBefore, allBefore;
    size_t most = 0, least = size_t(-1);  // pixels that were left as they are
    double odd = 0;
    for (int f = 0; f < sized(20, 2); ++f) {
        const LitScene s = sceneOf(stage, sized(160, 24), 140 + 0.2 * f);
        const std::vector<float> chosen = scatteredOf(s, target), all = scatteredOf(s, 0);
        size_t kept = 0;
        for (size_t i = 0; i < s.covered.size(); ++i)
            kept += s.covered[i] && std::equal(&chosen[3 * i], &chosen[3 * i] + 3, &s.irradiance[3 * i]);
        most = std::max(most, kept), least = std::min(least, kept);
        for (size_t k = 0; f && k < all.size(); ++k)
            odd = std::max(odd,
                           std::abs((double(chosen[k]) - chosenBefore[k]) - (double(all[k]) - allBefore[k])));
        chosenBefore = chosen, allBefore = all;
    }
    EXPECT_LE(odd, tolerance::scatterFade * target);
    if (!testsAreSmall()) {
        EXPECT_LT(least, most);
    }
}

// The contrast of a wave grows by steps of 4 %: it is left as it is, then scattered to a part, then wholly.
TEST(ScatterSteady, TilesFadeInWithTheirContrast) {
    scatter_scene::Scatter scatter(device());
    std::vector<double> shares;  // of what scattering changes
    for (double contrast = 0.01; contrast < 1; contrast *= 1.04) {
        scatter_scene::Picture p = scatter_scene::plane(64, 64, 0.3, [&](double x, double) {
            const double e = 0.5 * (1 + contrast * std::cos(x));
            return reference::Vec3{e, e, e};
        });
        p.params.targetError = 0.03f;
        const auto changed = [&] {
            const auto light = scatter_scene::run(scatter, p, {{1, Profile::skin()}}).scattered;
            return scatter_scene::difference(p, light, p.irradiance).most;
        };
        const double chosen = changed();
        p.params.everywhere = 1;
        shares.push_back(chosen / changed());
    }
    EXPECT_EQ(shares.front(), 0);
    EXPECT_GT(shares.back(), 0.9);
    for (size_t k = 1; k < shares.size(); ++k) EXPECT_LT(shares[k] - shares[k - 1], 0.2) << k;
}
