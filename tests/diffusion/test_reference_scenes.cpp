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

std::vector<Errors> compare(const ReferenceScene& r, const std::vector<Case>& cases) {
    const Errors lambert = error(r, r.irradiance);
    std::vector<Errors> all;
    for (const Case& c : cases) {
        all.push_back(error(r, shade(device(), r, c.method, c.given, c.map, c.taps).light));
        const bool beatsLambert = !c.taps && c.given && c.method == byAuto;
        for (size_t k = 0; k < 3; ++k)
            EXPECT_LT(all.back()[k], beatsLambert ? std::min(c.most[k], lambert[k]) : c.most[k]) << c.name;
    }
    return all;
}

}  // namespace

// Taps are as accurate as in other prototypes. With shadows only from the map, blue, which scatters less far
// than a texel is wide, may be wrong at the map's edges.
TEST(ReferenceScenes, Head) {
    const char *references = std::getenv("PELLUCID_RULER_DIR"),
               *gbuffers = std::getenv("PELLUCID_GBUFFER_DIR");
    if (!references || !gbuffers)
        GTEST_SKIP() << "PELLUCID_RULER_DIR or PELLUCID_GBUFFER_DIR is not set: no data";
    const ReferenceScene head = headTimesFour(references, gbuffers);
    const std::vector<Errors> e =
        compare(head, {{"auto and map", byAuto, 0, true, true, tolerance::lightFour},
                       {"auto", byAuto, 0, true, false, {1e4, 1e4, 1e4}},
                       {"light", byLight, 0, true, true, tolerance::lightFourOfLight},
                       {"auto, shadows of the map", byAuto, 0, false, true, error(head, head.irradiance)},
                       {"separable, 25 taps", separable, 25, true, false, {227, 92, 54}},
                       {"disk, 32 taps", screen, 32, true, false, {142, 78, 58}},
                       {"disk, 256 taps", screen, 256, true, false, {130, 75, 56}}});
    EXPECT_LT(e[0][0], 0.95 * e[1][0]) << "much is seen by the light only";
}

TEST(ReferenceScenes, Ball) {
    const char* gbuffers = std::getenv("PELLUCID_GBUFFER_DIR");
    if (!gbuffers) GTEST_SKIP() << "PELLUCID_GBUFFER_DIR is not set: no G-buffer";
    compare(ball(gbuffers), {{"auto and map", byAuto, 0, true, true, tolerance::lightBall},
                             {"light", byLight, 0, true, true, tolerance::lightBallOfLight}});
}
