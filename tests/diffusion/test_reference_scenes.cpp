// Methods against the surface integral of reference scenes (docs/mathematics.md, section 9).
#include "diffusion/lit_scenes.h"
#include "diffusion/reference_scenes.h"
#include "test.h"

using namespace reference_scenes;
using scatter_scene::byAuto, scatter_scene::byLight, scatter_scene::screen, scatter_scene::separable;

namespace {

using Errors = std::array<double, 3>;

void print(const char* what, const Errors& e, double milliseconds = 0) {
    std::printf("%-28s 1e-4: %6.1f %6.1f %6.1f   %.1f ms\n", what, e[0], e[1], e[2], milliseconds);
}

// A method on a scene, and its largest error.
struct Case {
    const char* name;
    PelScattering method;
    uint32_t taps;
    bool given, map;  // ray-traced irradiance; a shadow map
    Errors most;
};

Errors valuesOf(const double (&of)[3]) {
    return {of[0], of[1], of[2]};
}

// Returns the error of each case.
std::vector<Errors> compare(const char* scene, const ReferenceScene& r, const std::vector<Case>& cases) {
    const Device device("");
    const Errors lambert = error(r, r.irradiance);
    print(scene, lambert);
    std::vector<Errors> all;
    for (const Case& c : cases) {
        const Shown shown = shade(device, r, c.method, c.given, c.map, c.taps);
        all.push_back(error(r, shown.light));
        print(c.name, all.back(), shown.stats.deviceMilliseconds);
        for (size_t k = 0; k < 3; ++k) EXPECT_LT(all.back()[k], c.most[k]) << scene << ", " << c.name;
        if (!c.taps && c.given && c.method == PEL_SCATTERING_AUTO) {
            for (size_t k = 0; k < 3; ++k) EXPECT_LT(all.back()[k], lambert[k]) << scene << ", " << c.name;
        }
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
    const ReferenceScene usual = head1536(references, gbuffers), wide = headTimesFour(references, gbuffers);
    for (const auto& [scene, r] : {std::pair{"head", &usual}, {"head, radius x 4", &wide}}) {
        const bool first = r == &usual;
        const Errors lambert = error(*r, r->irradiance), traced = {1e4, 1e4, 1e4};
        const std::vector<Errors> e = compare(
            scene, *r,
            {{"auto and map", byAuto, 0, true, true,
              valuesOf(first ? tolerance::lightHead : tolerance::lightFour)},
             {"auto", byAuto, 0, true, false,
              first ? Errors{tolerance::headOnScreenRed, tolerance::headOnScreenGreen,
                             tolerance::headOnScreenBlue}
                    : traced},
             {"light", byLight, 0, true, true,
              valuesOf(first ? tolerance::lightHeadOfLight : tolerance::lightFourOfLight)},
             {"auto, shadows of the map",
              byAuto,
              0,
              false,
              true,
              {lambert[0], lambert[1], std::max(lambert[2], double(tolerance::headByMapBlue))}},
             {"separable, 25 taps", separable, 25, true, false,
              first ? Errors{43, 16, 10} : Errors{227, 92, 54}},
             {"disk, 32 taps", screen, 32, true, false, first ? Errors{41, 14.5, 9.5} : Errors{142, 78, 58}},
             {"disk, 256 taps", screen, 256, true, false, first ? traced : Errors{130, 75, 56}}});
        EXPECT_LT(e[0][0], 0.95 * e[1][0]) << scene << ": much is seen by the light only";
    }
    const Shown shown = shade(Device(""), usual, byAuto, true, false);
    EXPECT_LT(2 * shown.stats.pixelsScattered, shown.stats.pixelsScattered + shown.stats.pixelsKept);
}

TEST(ReferenceScenes, Ball) {
    const char* gbuffers = std::getenv("PELLUCID_GBUFFER_DIR");
    if (!gbuffers) GTEST_SKIP() << "PELLUCID_GBUFFER_DIR is not set: no G-buffer";
    compare("ball", ball(gbuffers),
            {{"auto and map", byAuto, 0, true, true, valuesOf(tolerance::lightBall)},
             {"light", byLight, 0, true, true, valuesOf(tolerance::lightBallOfLight)}});
}
