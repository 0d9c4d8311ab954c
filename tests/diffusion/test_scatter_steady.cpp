// What a picture does while camera or light move slowly, and between tiles that took different ways:
// nothing that light does not do.
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>

#include "diffusion/lit_scenes.h"
#include "diffusion/scatter_scene.h"
#include "reference/lut.h"
#include "reference/profile.h"
#include "test_size.h"
#include "tolerances.h"

using namespace lit_scenes;

namespace {

std::string headFile(const char* name) {
    const char* folder = std::getenv("PELLUCID_HEADS_DIR");
    return (folder ? std::string(folder) : std::string(PELLUCID_SOURCE_DIR) + "/data/heads") + "/" + name +
           ".obj";
}

std::vector<Body> bodies() {
    const Body ear = closeUp(
        head(headFile("head_male"), "male", sized(1, 0)), "ear", [](Vec3 p) { return p.x; }, 70);
    return {ball(10, sized(96, 8)), relief(sized(96, 10)),
            head(headFile("head_female"), "female", sized(1, 0)), ear};
}

constexpr double lightsFrom[] = {0, 70, 150};  // azimuth, degrees: in front, at the side, behind

// Scattered irradiance of a picture without its shadow map.
std::vector<float> scatteredOf(const LitScene& s, const Profile& profile, bool everywhere,
                               double target = pelScatterParamsDefaults().targetError,
                               uint64_t* taps = nullptr) {
    scatter_scene::Picture p(uint32_t(s.width), uint32_t(s.height));
    p.positions = s.positions, p.irradiance = s.irradiance, p.ids = s.covered;
    p.params.everywhere = everywhere;
    p.params.targetError = float(target);
    const scatter_scene::Result result = scatter_scene::run(p, profile);
    if (taps) *taps = result.stats.taps;
    return result.scattered;
}

// What is left out of a picture, per value.
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

}  // namespace

TEST(ScatterSteady, LeavesOutNoMoreThanTheTargetErrorAnywhere) {
    const Device device("");
    const Profile skin = Profile::skin();
    const double target = pelScatterParamsDefaults().targetError;
    for (const Body& body : bodies()) {
        const Stage stage(device, body, 1);
        for (int size : {sized(96, 16), sized(256, 24), sized(448, 32)})
            for (double azimuth : lightsFrom) {
                SceneRequest request;
                request.size = size, request.mapSize = 16, request.lightAzimuth = azimuth;
                const LitScene s = stage.look(request, skin);
                const LeftOut left = leftOut(s, scatteredOf(s, skin, true), scatteredOf(s, skin, false));
                EXPECT_LE(left.most, tolerance::scatterLeftOut * target)
                    << body.name << ", " << size << " pixels, light from " << azimuth;
                EXPECT_LE(left.acrossTiles, tolerance::scatterSeam * target)
                    << body.name << ", " << size << " pixels, light from " << azimuth;
            }
    }
}

// A larger error that is allowed saves taps, and is kept to.
TEST(ScatterSteady, ALargerTargetErrorTakesFewerTaps) {
    const Device device("");
    const Profile skin = Profile::skin();
    for (const Body& body : bodies()) {
        SceneRequest request;
        request.size = sized(256, 24), request.mapSize = 16, request.lightAzimuth = 70;
        const LitScene s = Stage(device, body, 1).look(request, skin);
        uint64_t before = 0, first = 0;
        const std::vector<float> all = scatteredOf(s, skin, true, 0.002, &before);
        for (double target : {0.002, 0.005, 0.01, 0.02}) {
            uint64_t taps = 0;
            const LeftOut left = leftOut(s, all, scatteredOf(s, skin, false, target, &taps));
            std::printf("%-8s %.3f: %5.1f %% of the taps, %.2f of the error\n", body.name.c_str(), target,
                        100 * double(taps) / double(first ? first : before), left.most / target);
            if (!first) first = before = taps;
            EXPECT_LE(left.most, tolerance::scatterLeftOut * target) << body.name << ", " << target;
            EXPECT_LE(left.acrossTiles, tolerance::scatterSeam * target) << body.name << ", " << target;
            EXPECT_LE(taps, before) << body.name << ", " << target;
            before = taps;
        }
        if (!testsAreSmall()) {
            EXPECT_LT(double(before), tolerance::tapsOfLargeError * double(first)) << body.name;
        }
    }
}

namespace {

// A frame of a picture that moves slowly: what it shows, and its light.
struct Frame {
    LitScene scene;
    std::vector<float> shown, chosen, all,
        light;  // by the shader; without a map, and nothing left out; what light does on a ball
};

// The largest differences of neighbouring frames, where both show the same surface.
struct Steps {
    double irradiance = 0, shown = 0, all = 0, light = 0;
    double odd = 0;  // by which the picture steps more, or less, than one of which nothing is left out
    void add(const Frame& a, const Frame& b) {
        constexpr double farthest = 1;  // mm
        const auto step = [&](const std::vector<float>& before, const std::vector<float>& after, size_t i) {
            return before.empty() ? 0.0 : double(after[i]) - before[i];
        };
        for (size_t i = 0; i < a.scene.covered.size(); ++i) {
            if (!a.scene.covered[i] || !b.scene.covered[i]) continue;
            double way2 = 0;
            for (size_t k = 3 * i; k < 3 * i + 3; ++k)
                way2 += std::pow(step(a.scene.positions, b.scene.positions, k), 2);
            if (way2 > farthest * farthest) continue;
            for (size_t k = 3 * i; k < 3 * i + 3; ++k) {
                irradiance = std::max(irradiance, std::abs(step(a.scene.irradiance, b.scene.irradiance, k)));
                shown = std::max(shown, std::abs(step(a.shown, b.shown, k)));
                all = std::max(all, std::abs(step(a.all, b.all, k)));
                light = std::max(light, std::abs(step(a.light, b.light, k)));
                odd = std::max(odd, std::abs(step(a.chosen, b.chosen, k) - step(a.all, b.all, k)));
            }
        }
    }
};

// 60 frames in steps of a tenth of a pixel of the camera, or of 0.2 degrees of the light. `light`: fills in
// Frame.light, if given.
Steps stepsOf(const Stage& stage, double azimuth, bool cameraMoves,
              const std::function<void(Frame&)>& light) {
    const Device device("");
    const Profile skin = Profile::skin();
    Steps steps;
    Frame before;
    const int frames = sized(60, 3);
    for (int f = 0; f < frames; ++f) {
        SceneRequest request;
        request.size = sized(72, 16), request.mapSize = sized(512, 32);
        request.lightAzimuth = azimuth + (cameraMoves ? 0 : 0.2 * f);
        request.aside = cameraMoves ? 0.1 * f : 0;
        Frame now;
        now.scene = stage.look(request, skin);
        ShadeRequest way;
        way.traced = true;
        now.shown = shade(device, now.scene, skin, 1, nullptr, way);
        now.chosen = scatteredOf(now.scene, skin, false);
        now.all = scatteredOf(now.scene, skin, true);
        if (light) light(now);
        if (f) steps.add(before, now);
        before = std::move(now);
    }
    return steps;
}

void expectSteady(const Steps& s, const std::string& where) {
    std::printf("%-24s E %.4f  shown %.4f  all %.4f  light %.4f  odd %.4f\n", where.c_str(), s.irradiance,
                s.shown, s.all, s.light, s.odd);
    const double reference = s.light > 0 ? s.light : std::max(s.irradiance, s.all);
    EXPECT_LE(s.shown, 1.1 * reference + tolerance::scatterStep) << where;
    EXPECT_LE(s.odd, tolerance::scatterLeftOut * pelScatterParamsDefaults().targetError) << where;
}

}  // namespace

// Tiles that begin to count while the light moves, or cease to.
TEST(ScatterSteady, TilesFadeIn) {
    const Device device("");
    const Profile skin = Profile::skin();
    const Stage stage(device, ball(10, sized(96, 8)), 1);
    const double target = pelScatterParamsDefaults().targetError;
    std::vector<float> chosenBefore, allBefore;
    size_t most = 0, least = size_t(-1);  // pixels that were left as they are
    double odd = 0;
    for (int f = 0; f < sized(20, 2); ++f) {
        SceneRequest request;
        request.size = sized(256, 24), request.mapSize = 16, request.lightAzimuth = 140 + 0.2 * f;
        LitScene s = stage.look(request, skin);
        std::vector<float> chosen = scatteredOf(s, skin, false), all = scatteredOf(s, skin, true);
        size_t kept = 0;
        for (size_t i = 0; i < s.covered.size(); ++i)
            kept += s.covered[i] && std::equal(&chosen[3 * i], &chosen[3 * i] + 3, &s.irradiance[3 * i]);
        most = std::max(most, kept), least = std::min(least, kept);
        for (size_t k = 0; f && k < all.size(); ++k)
            odd = std::max(odd,
                           std::abs((double(chosen[k]) - chosenBefore[k]) - (double(all[k]) - allBefore[k])));
        chosenBefore = std::move(chosen), allBefore = std::move(all);
    }
    std::printf("steps by up to %.5f more; %zu to %zu pixels kept\n", odd, least, most);
    EXPECT_LE(odd, tolerance::scatterFade * target);
    if (!testsAreSmall()) {
        EXPECT_LT(least, most);
    }
}

// Against what light does there.
TEST(ScatterSteady, BallDoesNotPop) {
    const Device device("");
    const Stage stage(device, ball(10, sized(96, 8)), 1);
    const auto skin = reference::skinProfile();
    std::vector<reference::Rgb> curve;  // over N.L from -1 to 1
    const int steps = 200;
    for (int k = 0; k <= steps; ++k)
        curve.push_back(reference::curvatureD(reference::Form::sphere, *skin, -1 + 2.0 * k / steps, 10));
    const auto light = [&](Frame& f) {
        f.light.assign(f.scene.irradiance.size(), 0);
        for (size_t i = 0; i < f.scene.covered.size(); ++i) {
            const float* p = &f.scene.positions[3 * i];
            if (!f.scene.covered[i]) continue;
            const double cosine = dot(normalize(Vec3{p[0], p[1], p[2]}), f.scene.toLight),
                         u = std::clamp((cosine + 1) / 2 * steps, 0.0, steps - 1e-9);
            const reference::Rgb s = mix(curve[size_t(u)], curve[size_t(u) + 1], u - std::floor(u));
            for (size_t c = 0; c < 3; ++c) f.light[3 * i + c] = float(s[int(c)]);
        }
    };
    for (double azimuth : {70.0, 150.0}) {
        expectSteady(stepsOf(stage, azimuth, true, light), "ball, camera, " + std::to_string(int(azimuth)));
        expectSteady(stepsOf(stage, azimuth, false, light), "ball, light, " + std::to_string(int(azimuth)));
    }
}

// Where shadows are hard and pixels wider than blue scatters, irradiance itself steps.
TEST(ScatterSteady, BodiesWithShadowsStepNoMoreThanTheirIrradiance) {
    const Device device("");
    const std::pair<Body, double> scenes[] = {{relief(sized(96, 10)), 70},
                                              {head(headFile("head_female"), "female", sized(1, 0)), 70},
                                              {head(headFile("head_female"), "female", sized(1, 0)), 150}};
    for (const auto& [body, azimuth] : scenes) {
        const Stage stage(device, body, 1);
        for (bool camera : {true, false})
            expectSteady(stepsOf(stage, azimuth, camera, {}),
                         body.name + (camera ? ", camera, " : ", light, ") + std::to_string(int(azimuth)));
    }
}
