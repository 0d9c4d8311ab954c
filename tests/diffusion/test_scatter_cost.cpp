// What scattering leaves out costs nothing: by the counters, and by what OpenCL was asked for.
#include <gtest/gtest.h>

#include "cl/cl_spy.h"
#include "diffusion/lit_ball.h"
#include "diffusion/lit_scenes.h"
#include "tolerances.h"

using namespace lit_ball;

namespace {

constexpr const char* scatterKernels[] = {"surface_points", "reduce_surface", "classify_scatter",
                                          "scatter_level",  "scatter_screen", "gather_points",
                                          "scatter_disk",   "filter_rows",    "light_texels",
                                          "light_hidden",   "scatter_light"};

struct Shown {
    std::vector<float> light;
    PelShaderStats stats;
};

// A picture with its irradiance, by a material of the usual skin.
Shown shown(const Picture& p, PelScattering scattering, const Device& on,
            const std::vector<PelLight>& lights = {}) {
    ShownImages images(on, p.width, p.height);
    PelShaderOptions options = pelShaderOptionsDefaults();
    options.countPixels = 1;
    images.shader.set(options);
    std::vector<float> normals(p.positions.size());
    for (size_t i = 0; i < p.pixels(); ++i) normals[3 * i + 2] = 1;
    images.set(PEL_SLOT_POSITION, p.positions);
    images.set(PEL_SLOT_NORMAL_SHADING, normals);
    if (lights.empty()) images.set(PEL_SLOT_IRRADIANCE, p.irradiance);
    images.set(PEL_SLOT_MATERIAL, p.ids);
    const Profile skin = Profile::skin();
    PelMaterial material = whiteMaterial(skin, scattering);
    material.specular = 0;
    images.shader.setMaterial(1, material);
    images.shader.set(lights);
    std::vector<float> light = images.execute();
    return {std::move(light), images.shader.stats()};
}

// Stripes of light and shadow on a plane, on the first `columns` of it; behind the others there is nothing.
Picture stripes(uint32_t side, uint32_t columns) {
    Picture p = plane(side, side, 0.3, [](double x, double y) {
        const double e = std::fmod(x + y, 20.0) < 10 ? 1 : 0.2;
        return Vec3{e, e, e};
    });
    for (size_t i = 0; i < p.pixels(); ++i)
        if (i % side >= columns) p.ids[i] = 0;
    return p;
}

}  // namespace

// Of a head with the light in front of it, how many pixels auto leaves as they are, by default.
TEST(ScatterCost, MuchOfAFrontLitHeadTakesNoTap) {
    namespace lit = lit_scenes;
    namespace sample = pellucid::sample;
    const char* data = std::getenv("PELLUCID_HEADS_DIR");
    std::string heads = PELLUCID_SOURCE_DIR "/data/heads";
    if (data) heads = data;
    const lit::Body head = lit::head(heads + "/head_female.obj", "female", sized(2, 0));
    const sample::Scene scene(head.mesh.view());
    const sample::Vec3 toLight = keyLightDirection(head.pose, sample::KeyLight::Front);
    sample::GBufferOptions plain;
    plain.detail.enabled = false;
    const int side = sized(512, 48);
    const sample::GBuffer g =
        renderGBuffer(scene, frameHead(scene.bounds(), head.pose, {}, 1), side, side, plain);
    const sample::ShadowMap map =
        renderShadowMap(scene, sample::DirectionalLight{toLight}, sized(2048, 64), 1);
    PelLight light = pelLightDefaults();
    const double direction[] = {toLight.x, toLight.y, toLight.z};
    std::copy_n(direction, 3, light.toLight);
    std::ranges::copy(map.worldToUvz.toFloats(), light.worldToShadow);
    light.shadowDepthRange = float(map.depthRange);
    const auto w = uint32_t(side);
    std::vector<float> positions(3 * size_t(w) * w), normals(positions.size());
    std::vector<uint8_t> ids;
    for (size_t i = 0; i < size_t(w) * w; ++i) {
        ids.push_back(uint8_t(g.material[i]));
        for (int c = 0; c < 3; ++c) {
            positions[3 * i + size_t(c)] = g.position.plane(c)[i];
            normals[3 * i + size_t(c)] = g.geometricNormal.plane(c)[i];
        }
    }
    const float meanFreePath[] = {0.321f, 0.12f, 0.06f}, albedo[] = {0.8f, 0.8f, 0.8f};
    const Profile skin = Profile::skin(), burley = Profile::burley(meanFreePath, albedo);
    for (const Profile* profile : {&skin, &burley}) {
        ShownImages images(device(), w, w);
        images.set(PEL_SLOT_POSITION, positions);
        images.set(PEL_SLOT_NORMAL_SHADING, normals);
        images.set(PEL_SLOT_MATERIAL, ids);
        images.shader.setMaterial(1, whiteMaterial(*profile, PEL_SCATTERING_AUTO));
        images.shader.set(std::vector<PelLight>{light});
        images.setMap(PEL_LIGHT_SHADOW_MAP, map.depth, uint32_t(map.size), uint32_t(map.size));
        images.execute();
        const PelShaderStats stats = images.shader.stats();
        const double all = double(stats.pixelsScattered + stats.pixelsKept),
                     kept = double(stats.pixelsKept) / all;
        std::printf("%s: %.3f of %.0f pixels take no tap, %.1f taps a pixel\n",
                    profile == &skin ? "skin" : "narrow", kept, all, double(stats.scatterTaps) / all);
        if (!testsAreSmall()) {
            EXPECT_GT(kept, tolerance::keptOfHead);
        }
    }
}

// A tenth of the frame is a tenth of the work.
TEST(ScatterCost, WhatIsNotCoveredCostsNothing) {
    const uint32_t side = sized(320u, 160u), part = side / 10;
    const Device on = device();
    for (PelScattering method : {PEL_SCATTERING_AUTO, PEL_SCATTERING_SEPARABLE, PEL_SCATTERING_SCREEN}) {
        const Shown whole = shown(stripes(side, side), method, on),
                    some = shown(stripes(side, part), method, on);
        const auto holds = [&](uint64_t a, uint64_t b, const char* what) {
            EXPECT_GT(b, 0u) << what;
            EXPECT_LT(double(a), tolerance::costOfTenth * double(b)) << what << ", method " << int(method);
        };
        const PelShaderStats &a = some.stats, &b = whole.stats;
        holds(a.pixelsShaded, b.pixelsShaded, "pixels");
        holds(a.pixelsScattered, b.pixelsScattered, "scattered");
        holds(a.scatterTaps, b.scatterTaps, "taps");
        const PelScattering counted = method == PEL_SCATTERING_AUTO ? PEL_SCATTERING_SCREEN : method;
        holds(a.tilesByScattering[counted], b.tilesByScattering[counted], "tiles");
    }
}

// Nothing is lit: every kernel leaves every tile, and the picture stays. No light at all: no kernel of a
// method is launched.
TEST(ScatterCost, WithoutLightNothingIsDone) {
    Picture p = stripes(sized(128u, 64u), 128);
    std::fill(p.irradiance.begin(), p.irradiance.end(), 0.0f);
    for (PelScattering method : {PEL_SCATTERING_AUTO, PEL_SCATTERING_SCREEN}) {
        const Shown dark = shown(p, method, device());
        EXPECT_EQ(dark.stats.pixelsScattered, 0u);
        EXPECT_EQ(dark.stats.scatterTaps, 0u);
        EXPECT_EQ(dark.stats.tilesByScattering[PEL_SCATTERING_SCREEN], 0u);
        EXPECT_EQ(dark.stats.pixelsKept, p.pixels());
        for (float v : dark.light) ASSERT_EQ(v, 0.0f);
    }
    // With its shadow map: a ball that the light does not reach has nothing hidden that is lit either.
    LitBall ball = makeBall(Form::parallel, normalized(Vec3{0.3, 0.2, -1}), 64);
    std::ranges::fill(ball.maps[0], 1.0f);  // nothing in the map
    Picture night = pictureOf(ball, 32);
    std::fill(night.irradiance.begin(), night.irradiance.end(), 0.0f);
    const PelShaderStats stats = shaded(night, ball, PEL_SCATTERING_AUTO, Profile::skin()).stats;
    EXPECT_EQ(stats.scatterTaps, 0u);
    EXPECT_EQ(stats.pixelsScattered, 0u);

    ShownImages images(device(), p.width, p.height);
    images.set(PEL_SLOT_POSITION, p.positions);
    images.set(PEL_SLOT_NORMAL_SHADING, p.positions);
    const Profile skin = Profile::skin();
    images.shader.setMaterial(1, whiteMaterial(skin, PEL_SCATTERING_AUTO));
    uint64_t before = 0, after = 0;
    for (const char* kernel : scatterKernels) before += spy::launchesOf(kernel);
    images.execute();
    for (const char* kernel : scatterKernels) after += spy::launchesOf(kernel);
    EXPECT_GT(before, 0u);
    EXPECT_EQ(after, before);
}

// Tables need no program, launch or memory of the methods that gather.
TEST(ScatterCost, PreintegratedBuildsNoProgramOfOtherMethods) {
    const Picture p = stripes(64, 64);
    PelLight light = pelLightDefaults();
    const auto programs = [] {
        uint64_t count = 0;
        for (const char* kernel : scatterKernels) count += spy::programsWith(kernel);
        return count;
    };
    {
        const Device fresh("");
        const uint64_t before = programs();
        const Shown tables = shown(p, PEL_SCATTERING_PREINTEGRATED, fresh, {light});
        EXPECT_EQ(programs(), before);
        EXPECT_EQ(tables.stats.scatterTaps + tables.stats.pixelsScattered + tables.stats.pixelsIrradiance,
                  0u);
        const uint64_t own = tables.stats.scratchBytes;
        EXPECT_GT(shown(p, PEL_SCATTERING_AUTO, fresh, {light}).stats.scratchBytes, own + 40 * p.pixels());
        if (spy::programsWith("__kernel") > 0) {  // else all came from the disk
            EXPECT_GT(programs(), before);
        }
    }
}

// Nor does scattering on the screen need tables: their programs are built when a material is shaded by them.
TEST(ScatterCost, ScatteringOnTheScreenMakesNoTables) {
    const Picture p = stripes(64, 64);
    PelLight light = pelLightDefaults();
    const auto tables = [] {
        return spy::launchesOf("curvature_rows") + spy::launchesOf("curvature_texels") +
               spy::launchesOf("shadow_texels");
    };
    const Device fresh("");
    const uint64_t before = tables();
    shown(p, PEL_SCATTERING_AUTO, fresh, {light});
    EXPECT_EQ(tables(), before);
    EXPECT_EQ(fresh.stats().programsBuilt, 4u) << "irradiance, two that scatter, shading";
    shown(p, PEL_SCATTERING_PREINTEGRATED, fresh, {light});
    EXPECT_EQ(tables(), before + 3);
}
