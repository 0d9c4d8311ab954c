// Skipped work costs nothing: checked by the counters, and by the calls of OpenCL.
#include "cl/cl_spy.h"
#include "device_lanes.h"
#include "diffusion/lit_ball.h"
#include "diffusion/lit_scenes.h"

using namespace lit_ball;

namespace {

constexpr const char* scatterKernels[] = {"surface_points", "reduce_surface", "classify_scatter",
                                          "scatter_level",  "scatter_bands",  "scatter_screen",
                                          "gather_points",  "scatter_disk",   "filter_rows",
                                          "light_texels",   "light_hidden",   "scatter_light"};
template <class Count>
uint64_t ofScatterKernels(const Count& count) {
    uint64_t sum = 0;
    for (const char* kernel : scatterKernels) sum += count(kernel);
    return sum;
}

// Stripes of light and shadow on a plane, on the first `columns` of it; behind the others there is nothing.
Frame stripes(uint32_t side, uint32_t columns, PelScattering method, uint32_t taps = 0) {
    const auto light = [](double x, double y) {
        const double e = std::fmod(x + y, 20.0) < 10 ? 1 : 0.2;
        return Vec3{e, e, e};
    };
    Frame f(plane(side, side, 0.3, light), method);
    for (size_t i = 0; i < f.picture.pixels(); ++i)
        if (i % side >= columns) f.picture.ids[i] = 0;
    f.material.scatterTaps = taps;
    return f;
}

// Of a plane that is lit by a light.
PelShaderStats statsOf(const Device& on, PelScattering method) {
    Frame f = stripes(64, 64, method);
    f.giveIrradiance = false;
    f.lamps.resize(1);
    ShownImages images(on, 1, 1);
    return f.shade(images).stats;
}

}  // namespace

// Of a head with the light in front of it, how many pixels auto leaves as they are, by default.
TEST(ScatterCost, MuchOfAFrontLitHeadTakesNoTap) {
    namespace scenes = lit_scenes;
    scenes::SceneRequest request;
    request.azimuth = request.elevation = 0, request.lightAzimuth = request.lightElevation = 35;
    request.size = sized(512, 48), request.mapSize = sized(2048, 64);
    const scenes::Body head = scenes::head(scenes::headFile("head_female"), "female", sized(2, 0));
    const scenes::LitScene s = scenes::Stage(device(), head, 1).look(request, Profile::skin());
    const float meanFreePath[] = {0.321f, 0.12f, 0.06f}, albedo[] = {0.8f, 0.8f, 0.8f};
    for (const Profile& profile : {Profile::skin(), Profile::burley(meanFreePath, albedo)}) {
        Frame f(scenes::pictureOf(s), PEL_SCATTERING_AUTO);
        f.images[PEL_SLOT_NORMAL_SHADING] = s.normals;
        f.giveIrradiance = false;
        f.profile = profile;
        f.lamps = s.lamps;
        const PelShaderStats stats = f.shade().stats;
        const double all = double(stats.pixelsScattered + stats.pixelsKept),
                     kept = double(stats.pixelsKept) / all;
        if (!testsAreSmall()) {
            EXPECT_GT(kept, tolerance::keptOfHead);
        }
    }
}

// A tenth of the frame is a tenth of the work.
TEST(ScatterCost, WhatIsNotCoveredCostsNothing) {
    const uint32_t side = sized(320u, 160u);
    for (const auto& [method, taps] : {std::pair{PEL_SCATTERING_AUTO, 0u},
                                       {PEL_SCATTERING_SEPARABLE, 0u},
                                       {PEL_SCATTERING_SCREEN, 0u},
                                       {PEL_SCATTERING_SCREEN, 64u}}) {
        const PelShaderStats a = stripes(side, side / 10, method, taps).shade().stats,
                             b = stripes(side, side, method, taps).shade().stats;
        const PelScattering counted = method == PEL_SCATTERING_AUTO ? PEL_SCATTERING_SCREEN : method;
        const std::pair<uint64_t, uint64_t> counts[] = {
            {a.pixelsShaded, b.pixelsShaded},
            {a.pixelsScattered, b.pixelsScattered},
            {a.scatterTaps, b.scatterTaps},
            {a.tilesByScattering[counted], b.tilesByScattering[counted]}};
        for (size_t k = 0; k < std::size(counts); ++k) {
            EXPECT_GT(counts[k].second, 0u) << k;
            EXPECT_LT(double(counts[k].first), tolerance::costOfTenth * double(counts[k].second))
                << k << ", method " << int(method) << ", " << taps << " taps";
        }
    }
}

// If nothing is lit, every kernel leaves every tile early, and the picture stays. Without any light, no
// kernel of a method is launched.
TEST(ScatterCost, WithoutLightNothingIsDone) {
    // With a shadow map: a ball that the light does not reach has no hidden lit surface either.
    LitBall nothing = makeBall(Form::parallel, {0.3, 0.2, -1}, 64);
    std::ranges::fill(nothing.maps[0], 1.0f);
    const uint32_t side = sized(128u, 64u);
    for (Frame f : {stripes(side, side, PEL_SCATTERING_AUTO), stripes(side, side, PEL_SCATTERING_SCREEN),
                    frameOf({nothing}, 32, PEL_SCATTERING_AUTO)}) {
        std::ranges::fill(f.picture.irradiance, 0.0f);
        const Shown dark = f.shade();
        EXPECT_EQ(dark.stats.pixelsScattered, 0u);
        EXPECT_EQ(dark.stats.scatterTaps, 0u);
        EXPECT_EQ(dark.stats.tilesByScattering[PEL_SCATTERING_SCREEN], 0u);
        if (f.lamps.empty()) {
            EXPECT_EQ(dark.stats.pixelsKept, f.picture.pixels());
        }
        EXPECT_EQ(dark.light, f.picture.irradiance);
    }
    Frame unlit = stripes(side, side, PEL_SCATTERING_AUTO);
    unlit.giveIrradiance = false;
    const uint64_t before = ofScatterKernels(spy::launchesOf);
    unlit.shade();
    EXPECT_GT(before, 0u);
    EXPECT_EQ(ofScatterKernels(spy::launchesOf), before);
}

// Pixels that are much finer than the profile, so that blocks alone are summed, and far from the edge none.
TEST(ScatterCost, OneLaneSumsAsManyBlocksAsSeveral) {
    Frame f(plane(256, 64, 0.05,
                  [](double x, double) {
                      const double e = x < 3 ? 1 : 0.1;
                      return Vec3{e, e, e};
                  }),
            PEL_SCATTERING_SCREEN);
    f.profile = Profile::gaussians({{1, {1, 1, 1}}});
    const auto taps = [&](int lanes) {
        ShownImages shown(lanes::deviceOf(lanes), 1, 1);
        return f.shade(shown).stats.scatterTaps;
    };
    const uint64_t several = taps(8);
    EXPECT_GT(several, 0u);
    EXPECT_EQ(taps(1), several);
}

// The OpenCL commands for skin and an eye under two lights with shadow maps: in a frame like the one before,
// and in a commit and a frame after the lights have changed.
TEST(ScatterCost, AFrameAfterAnotherTakesFewCommands) {
    const Device oneLane = lanes::deviceOf(1);
    const uint32_t side = sized(128u, 64u);
    Frame f =
        frameOf({makeBall(Form::parallel, {0.3, 0.2, 1}, 64), makeBall(Form::parallel, {0.9, 0.2, -0.3}, 64)},
                side, PEL_SCATTERING_AUTO);
    f.giveIrradiance = false;
    f.materials = 2;
    f.material.curvatureGain = 1;
    for (size_t i = 0; i < f.picture.pixels() / 2; ++i) f.picture.ids[i] *= 2;
    ShownImages images(oneLane, 1, 1);
    f.shade(images);
    images.shader.setEye(2, pelEyeDefaults());
    images.execute();
    const auto expectFew = [&](const std::string& what, uint64_t launches, uint64_t fills, auto prepare) {
        const spy::Counts before = spy::counts();
        const uint64_t programs = spy::programsWith("__kernel");
        prepare();
        images.shader.execute();
        const spy::Counts after = spy::counts();
        EXPECT_GT(after.launches, before.launches) << what;
        EXPECT_LE(after.launches - before.launches, launches) << what;
        EXPECT_LE(after.fills - before.fills, fills) << what;
        EXPECT_LE(after.waits - before.waits, 1u) << what;
        EXPECT_EQ(after.buffersMade, before.buffersMade) << what;
        EXPECT_EQ(spy::programsWith("__kernel"), programs) << what;
        return after.transfers - before.transfers;
    };
    EXPECT_EQ(expectFew("the same", 21, 2, [] {}), 0u);
    EXPECT_LE(expectFew("other lights", 21, 2,
                        [&] {
                            std::vector<PelLight> lights{f.lamps[0].light, f.lamps[1].light};
                            lights[0].color[0] = 0.5f;
                            lights[1].toLight[1] = -lights[1].toLight[1];
                            images.shader.set(lights).commit();
                        }),
              3u);
}

// Tables need no program, launch or memory of the methods that gather.
TEST(ScatterCost, PreintegratedBuildsNoProgramOfOtherMethods) {
    const Device fresh("");
    const uint64_t before = ofScatterKernels(spy::programsWith);
    const PelShaderStats tables = statsOf(fresh, PEL_SCATTERING_PREINTEGRATED);
    EXPECT_EQ(ofScatterKernels(spy::programsWith), before);
    EXPECT_EQ(tables.scatterTaps + tables.pixelsScattered + tables.pixelsIrradiance, 0u);
    EXPECT_GT(statsOf(fresh, PEL_SCATTERING_AUTO).scratchBytes, tables.scratchBytes + 40 * 64 * 64);
    if (spy::programsWith("__kernel") > 0) {  // else all came from the disk
        EXPECT_GT(ofScatterKernels(spy::programsWith), before);
    }
}

// Nor does scattering on the screen need tables: their programs are built when a material is shaded by them.
TEST(ScatterCost, ScatteringOnTheScreenMakesNoTables) {
    const auto tables = [] {
        return spy::launchesOf("curvature_rows") + spy::launchesOf("curvature_texels") +
               spy::launchesOf("shadow_texels");
    };
    const Device fresh("");
    const uint64_t before = tables();
    statsOf(fresh, PEL_SCATTERING_AUTO);
    EXPECT_EQ(tables(), before);
    EXPECT_EQ(fresh.stats().programsBuilt, 6u) << "irradiance, three that scatter, classification, shading";
    statsOf(fresh, PEL_SCATTERING_PREINTEGRATED);
    EXPECT_EQ(tables(), before + 3);
}
