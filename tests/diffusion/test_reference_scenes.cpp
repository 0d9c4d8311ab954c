// Methods against the surface integral of reference scenes (docs/mathematics.md, section 9).
#include "diffusion/reference_scenes.h"
#include "test.h"

using namespace reference_scenes;
using scatter_scene::byAuto, scatter_scene::byLight, scatter_scene::screen, scatter_scene::separable;

namespace {

using Errors = std::array<double, 3>;

// A method on a scene, and its largest error.
struct Case {
    const char* name;
    PelScattering method;
    uint32_t taps;
    bool given, map;  // ray-traced irradiance; a shadow map
    Errors most;
};
struct Measured {
    Errors errors;
    PelShaderStats stats;
};

std::vector<Measured> compare(const char* scene, const ReferenceScene& r, const std::vector<Case>& cases) {
    const Errors lambert = error(r, r.irradiance);
    std::vector<Measured> all;
    for (const Case& c : cases) {
        const Shown shown = shade(device(), r, c.method, c.given, c.map, c.taps);
        all.push_back({error(r, shown.light), shown.stats});
        const bool beatsLambert = !c.taps && c.given && c.method == byAuto;
        for (size_t k = 0; k < 3; ++k)
            EXPECT_LT(all.back().errors[k], beatsLambert ? std::min(c.most[k], lambert[k]) : c.most[k])
                << scene << ", " << c.name;
    }
    return all;
}

}  // namespace

// Taps are as accurate as in other prototypes. With shadows only from the map, blue, which scatters less far
// than a texel is wide, is wrong at the map's edges.
TEST(ReferenceScenes, Head) {
    const char *references = std::getenv("PELLUCID_RULER_DIR"),
               *gbuffers = std::getenv("PELLUCID_GBUFFER_DIR");
    if (!references || !gbuffers)
        GTEST_SKIP() << "PELLUCID_RULER_DIR or PELLUCID_GBUFFER_DIR is not set: no data";
    // With shadows from the map: not worse than Lambert, whose shadows are traced.
    const auto byMap = [](const ReferenceScene& r) {
        Errors most = error(r, r.irradiance);
        most[2] = std::max(most[2], tolerance::headByMapBlue);
        return Case{"auto, shadows of the map", byAuto, 0, false, true, most};
    };
    const auto expectMapHelps = [](const std::vector<Measured>& of) {
        EXPECT_LT(of[0].errors[0], 0.95 * of[1].errors[0]) << "much is seen by the light only";
    };
    const ReferenceScene usual = head1536(references, gbuffers);
    const std::vector<Measured> narrow =
        compare("head", usual,
                {{"auto and map", byAuto, 0, true, true, tolerance::lightHead},
                 {"auto", byAuto, 0, true, false, tolerance::headOnScreen},
                 {"light", byLight, 0, true, true, tolerance::lightHeadOfLight},
                 byMap(usual),
                 {"separable, 25 taps", separable, 25, true, false, {43, 16, 10}},
                 {"disk, 32 taps", screen, 32, true, false, {41, 14.5, 9.5}}});
    expectMapHelps(narrow);
    EXPECT_LT(narrow[1].stats.pixelsScattered, narrow[1].stats.pixelsKept);
    const ReferenceScene wide = headTimesFour(references, gbuffers);
    expectMapHelps(compare("head, radius x 4", wide,
                           {{"auto and map", byAuto, 0, true, true, tolerance::lightFour},
                            {"auto", byAuto, 0, true, false, {1e4, 1e4, 1e4}},
                            {"light", byLight, 0, true, true, tolerance::lightFourOfLight},
                            byMap(wide),
                            {"separable, 25 taps", separable, 25, true, false, {227, 92, 54}},
                            {"disk, 32 taps", screen, 32, true, false, {142, 78, 58}},
                            {"disk, 256 taps", screen, 256, true, false, {130, 75, 56}}}));
}

TEST(ReferenceScenes, Ball) {
    const char* gbuffers = std::getenv("PELLUCID_GBUFFER_DIR");
    if (!gbuffers) GTEST_SKIP() << "PELLUCID_GBUFFER_DIR is not set: no G-buffer";
    compare("ball", ball(gbuffers),
            {{"auto and map", byAuto, 0, true, true, tolerance::lightBall},
             {"light", byLight, 0, true, true, tolerance::lightBallOfLight}});
}
