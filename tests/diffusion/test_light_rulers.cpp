// Scattering with the shadow map of the light, against rulers made elsewhere: what the camera does not see is in the map.
#include <gtest/gtest.h>

#include <array>

#include "diffusion/light_rulers.h"
#include "diffusion/lit_scenes.h"
#include "test_size.h"
#include "tolerances.h"

using namespace light_rulers;

namespace {

using Errors = std::array<double, 3>;

void print(const char* what, const Errors& e, double milliseconds = 0) {
    std::printf("%-28s 1e-4: %6.1f %6.1f %6.1f   %.1f ms\n", what, e[0], e[1], e[2], milliseconds);
}

// With visibility given: screen and maps keep to `most`, and, where much is hidden (`lacksMass`), are nearer than the screen alone; maps alone to `mostOfLight`.
void hold(const Ruler& r, const tolerance::Tolerance (&most)[3], const tolerance::Tolerance (&mostOfLight)[3],
          bool lacksMass) {
    const Device device("");
    const Shown both = shade(device, r, PEL_SCATTERING_AUTO, true),
                screen = shade(device, r, PEL_SCATTERING_AUTO, true, false),
                light = shade(device, r, PEL_SCATTERING_LIGHT, true),
                mapAlone = shade(device, r, PEL_SCATTERING_AUTO, false);
    const Errors lambert = error(r, r.irradiance), withMap = error(r, both.light),
                 without = error(r, screen.light), ofLight = error(r, light.light);
    print("Lambert", lambert);
    print("auto", without, screen.milliseconds);
    print("auto and map", withMap, both.milliseconds);
    print("light", ofLight, light.milliseconds);
    print("auto, irradiance of the map", error(r, mapAlone.light), mapAlone.milliseconds);
    for (int c = 0; c < 3; ++c) {
        EXPECT_LT(withMap[c], most[c]);
        EXPECT_LT(withMap[c], lambert[c]);
        EXPECT_LT(ofLight[c], mostOfLight[c]);
    }
    if (!lacksMass) return;
    EXPECT_LT(withMap[0], 0.95 * without[0]);
    EXPECT_LT(error(r, both.light, true)[0], error(r, screen.light, true)[0]);
}

const char* folder(const char* name) {
    return std::getenv(name);
}

}  // namespace

TEST(LightRulers, HeadLitFromTheSide) {
    const char *rulers = folder("PELLUCID_RULER_DIR"), *gbuffers = folder("PELLUCID_GBUFFER_DIR");
    if (!rulers || !gbuffers)
        GTEST_SKIP() << "PELLUCID_RULER_DIR or PELLUCID_GBUFFER_DIR is not set: no ruler";
    hold(head1536(rulers, gbuffers), tolerance::lightHead, tolerance::lightHeadOfLight, true);
}

TEST(LightRulers, HeadOfFourTimesTheRadius) {
    const char *rulers = folder("PELLUCID_RULER_DIR"), *gbuffers = folder("PELLUCID_GBUFFER_DIR");
    if (!rulers || !gbuffers)
        GTEST_SKIP() << "PELLUCID_RULER_DIR or PELLUCID_GBUFFER_DIR is not set: no ruler";
    hold(headTimesFour(rulers, gbuffers), tolerance::lightFour, tolerance::lightFourOfLight, true);
}

TEST(LightRulers, Ball) {
    const char* gbuffers = folder("PELLUCID_GBUFFER_DIR");
    if (!gbuffers) GTEST_SKIP() << "PELLUCID_GBUFFER_DIR is not set: no G-buffer";
    hold(ball(gbuffers), tolerance::lightBall, tolerance::lightBallOfLight, false);
}

// What comes through an ear that is lit from behind, against the library's own surface integral.
TEST(LightRulers, EarFromBehind) {
    namespace lit = lit_scenes;
    const Device device("");
    const char* data = folder("PELLUCID_HEADS_DIR");
    const std::string heads = data ? data : std::string(PELLUCID_SOURCE_DIR) + "/data/heads";
    const lit::Body whole = lit::head(heads + "/head_male.obj", "male", sized(2, 0));
    const lit::Body ear = lit::closeUp(
        whole, "ear", [](lit::Vec3 p) { return p.x; }, 80);
    lit::SceneRequest request;
    request.azimuth = 70;
    request.lightAzimuth = 200, request.lightElevation = 10;
    request.size = sized(192, 16);
    request.mapSize = sized(2048, 64);
    const lit::LitScene s = lit::make(device, ear, request, profile());
    const auto rms = [&](const std::vector<float>& picture) {
        Errors sum{};
        size_t count = 0;
        for (size_t i = 0; i < s.covered.size(); ++i) {
            if (!s.covered[i] || !(s.subsets[i] & lit::io::SUBSET_UNLIT)) continue;
            ++count;
            for (int c = 0; c < 3; ++c) sum[c] += std::pow(picture[3 * i + c] - s.truth[3 * i + c], 2);
        }
        for (double& v : sum) v = 1e4 * albedo * std::sqrt(v / double(std::max<size_t>(count, 1)));
        return sum;
    };
    const Errors lambert = rms(s.irradiance);
    print("Lambert", lambert);
    for (PelScattering scattering : {PEL_SCATTERING_AUTO, PEL_SCATTERING_LIGHT}) {
        lit::ShadeRequest way;
        way.scattering = scattering;
        way.traced = true;
        const Errors e = rms(lit::shade(device, s, profile(), 1, nullptr, way));
        print(scattering == PEL_SCATTERING_AUTO ? "auto and map" : "light", e);
        if (testsAreSmall()) continue;
        for (int c = 0; c < 3; ++c)
            EXPECT_LT(e[c], scattering == PEL_SCATTERING_LIGHT ? tolerance::lightEarOfLight[c]
                                                               : tolerance::lightEar[c]);
        if (scattering != PEL_SCATTERING_AUTO) continue;
        way.traced = false;
        const Errors byMap = rms(lit::shade(device, s, profile(), 1, nullptr, way));
        print("auto, irradiance of the map", byMap);
        for (int c = 0; c < 3; ++c) EXPECT_LT(byMap[c], 1.25 * e[c] + 2);
    }
}
