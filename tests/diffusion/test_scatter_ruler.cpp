// Methods against the surface integral of a head (mathematics, section 9), made by brute force elsewhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "diffusion/ruler_scene.h"
#include "diffusion/scatter_scene.h"
#include "tolerances.h"

using namespace scatter_scene;

namespace {

const char* folder(const char* name) {
    return std::getenv(name);
}

// All settings at their defaults; shadows from the map, or those traced by ray. Of an albedo of 1.
std::vector<float> shade(const ruler::Head& head, PelScattering scattering, float scale,
                         const std::vector<float>& map) {
    const auto side = uint32_t(head.side);
    ShownImages shown(device(), side, side);
    ruler::setHead(shown, head);
    shown.set(PEL_SLOT_CURVATURE, head.curvature);
    if (map.empty()) shown.set(PEL_SLOT_IRRADIANCE, head.irradiance);
    const Profile profile = ruler::profile(scale);
    shown.shader.setMaterial(1, whiteMaterial(profile, scattering));
    PelLight light = ruler::light();
    light.shadowFilterTexels = 48;
    shown.shader.set(std::vector<PelLight>{light});
    if (!map.empty()) shown.setMap(PEL_LIGHT_SHADOW_MAP, map, 1024, 1024);
    return shown.execute();
}

void print(const char* what, const std::array<double, 3>& e) {
    std::printf("%-40s %4.0f %4.0f %4.0f\n", what, e[0], e[1], e[2]);
}

}  // namespace

TEST(ScatterRuler, HeadLitFromTheSide) {
    const char* directory = folder("PELLUCID_RULER_DIR");
    if (!directory) GTEST_SKIP() << "PELLUCID_RULER_DIR is not set: no surface integral to compare with";
    const ruler::Head head = ruler::load(directory);
    Picture picture(ruler::side, ruler::side);
    picture.positions = head.positions, picture.irradiance = head.irradiance, picture.ids = head.ids;
    ruler::standAt(picture.params.inverseViewProjection);
    const Result result = run(picture, ruler::profile(), 0.1f);
    const auto ours = error(head, result.scattered), lambert = error(head, head.irradiance);
    const double most[] = {tolerance::rulerHeadRed, tolerance::rulerHeadGreen, tolerance::rulerHeadBlue};
    for (int c = 0; c < 3; ++c) {
        RecordProperty("channel" + std::to_string(c),
                       std::to_string(ours[c]) + " of " + std::to_string(lambert[c]));
        EXPECT_LE(ours[c], most[c]);
        EXPECT_LT(ours[c], lambert[c]);
    }
    // Less than half of the pixels are worth a look.
    EXPECT_LT(result.stats.pixelsTapped, result.stats.pixelsCovered / 2);
}

// With nothing but a shadow map, and all settings at their defaults.
TEST(ScatterRuler, HeadLitFromTheSideByItsShadowMap) {
    const char *rulers = folder("PELLUCID_RULER_DIR"), *gbuffers = folder("PELLUCID_GBUFFER_DIR");
    if (!rulers || !gbuffers) GTEST_SKIP() << "PELLUCID_RULER_DIR and PELLUCID_GBUFFER_DIR are not both set";
    const ruler::Head usual = ruler::load(rulers), wide = ruler::fourfold(usual, rulers);
    const std::vector<float> map = ruler::shadowMap(gbuffers);
    for (const auto& [head, scale] : {std::pair{&usual, 1.0f}, {&wide, 4.0f}}) {
        std::printf("radius x %g\n", double(scale));
        const auto lambert = error(*head, head->irradiance);
        print("Lambert, traced", lambert);
        for (auto [name, method] : {std::pair{"none", PEL_SCATTERING_NONE},
                                    {"pre-integrated", PEL_SCATTERING_PREINTEGRATED},
                                    {"auto", PEL_SCATTERING_AUTO}}) {
            if (method != PEL_SCATTERING_NONE)
                print((std::string(name) + ", traced").c_str(), error(*head, shade(*head, method, scale, {})));
            const auto e = error(*head, shade(*head, method, scale, map));
            print(name, e);
            // Blue scatters less far than a texel is wide: there the map's edges are what is wrong.
            if (method == PEL_SCATTERING_AUTO)
                for (int c = 0; c < 3; ++c)
                    EXPECT_LT(e[c], c == 2 ? std::max(lambert[c], double(tolerance::rulerMapBlue)) : lambert[c])
                        << name << ", x " << scale << ", channel " << c;
        }
    }
}
