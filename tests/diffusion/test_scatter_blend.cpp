// Steps before and after the methods of scattering: albedo before and after, light from behind thin sheets,
// weights, and accumulation.
#include "diffusion/scatter_scene.h"
#include "io/choice_keys.h"
#include "test.h"

using namespace scatter_scene;

namespace {

Picture stripes(bool two = false) {
    Picture p = plane(96, 48, 0.3, [](double x, double) { return Vec3{x > 14 ? 1.0 : 0.1, 0.5, x / 30}; });
    for (size_t i = 0; two && i < p.pixels(); ++i) p.ids[i] = uint8_t(1 + (i % 96 > 48));
    return p;
}

void expectNear(const std::vector<float>& result, double within,
                const std::function<double(size_t)>& expected) {
    for (size_t i = 0; i < result.size(); ++i) ASSERT_NEAR(result[i], expected(i), within) << i;
}

}  // namespace

TEST(ScatterBlend, IsScatteringAloneTimesAlbedo) {
    const Picture p = ball(100, 10, 0.21, normalized(Vec3{1, 0.3, 0.2}));
    const std::vector<float> alone = run(p, Profile::skin()).scattered;
    for (PelScattering method : {screen, byAuto, PEL_SCATTERING_NONE}) {
        Frame f(p, method, 10);
        if (method != byAuto) f.profile = Profile();  // skin's without one
        std::fill_n(f.material.albedo, 3, 0.5f);
        const std::vector<float>& whole = method == PEL_SCATTERING_NONE ? p.irradiance : alone;
        expectNear(f.shade().light, 1e-6, [&](size_t i) { return p.ids[i / 3] ? 0.5 * whole[i] : 0; });
    }
}

TEST(ScatterBlend, AlbedoBeforeAndAfterAndWeights) {
    for (PelScattering method : {separable, screen, byAuto}) {
        Frame f(stripes(), method);
        const std::vector<float> E = f.picture.irradiance, plain = f.shade().light;
        std::vector<float> albedo, &weights = f.images[PEL_SLOT_SCATTER_WEIGHT];
        for (size_t i = 0; i < f.picture.pixels(); ++i) weights.push_back(float(i % 5) / 4);
        expectNear(f.shade().light, 1e-6,
                   [&](size_t i) { return E[i] + weights[i / 3] * (plain[i] - E[i]); });
        f.images.erase(PEL_SLOT_SCATTER_WEIGHT);
        // With a uniform albedo the result is the same, however the albedo is split.
        std::fill_n(f.material.albedo, 3, 0.36f);
        for (float m : {0.0f, 0.5f, 1.0f}) {
            f.material.albedoBefore = m;
            expectNear(f.shade().light, 1e-3, [&](size_t i) { return 0.36 * plain[i]; });
        }
        // All of the albedo before: equals scattering of irradiance times albedo.
        for (size_t i = 0; i < E.size(); ++i) albedo.push_back(0.25f + 0.5f * float(i / 30 % 2));
        Frame product(stripes(), method);
        for (size_t i = 0; i < E.size(); ++i) product.picture.irradiance[i] *= albedo[i];
        f.images[PEL_SLOT_ALBEDO] = albedo;
        const auto expected = product.shade().light;
        expectNear(f.shade().light, 1e-6, [&](size_t i) { return expected[i]; });
        // None of it: as ever.
        f.material.albedoBefore = 0;
        expectNear(f.shade().light, 1e-6, [&](size_t i) { return albedo[i] * plain[i]; });
        // Black stays black, except for light that flows in with albedo before.
        std::fill_n(f.images[PEL_SLOT_ALBEDO].begin() + 3 * 96 * 20, 3 * 96 * 4, 0.0f);
        EXPECT_EQ(f.shade().light[3 * (96 * 21 + 80)], 0.0f);
        f.material.albedoBefore = 1;
        EXPECT_GT(f.shade().light[3 * (96 * 21 + 80)], 0.0f);
    }
}

TEST(ScatterBlend, EachMaterialHasItsOwnShareOfAlbedo) {
    const Picture p = stripes(true);
    Extra extra;
    for (size_t i = 0; i < 3 * p.pixels(); ++i) extra.albedo.push_back(0.25f + 0.5f * float(i / 30 % 2));
    for (const auto& [first, second] :
         {std::pair{separable, separable}, {screen, screen}, {separable, screen}}) {
        const auto lightOf = [&, first = first, second = second](float one, float two) {
            std::vector<Material> materials{{1, Profile::skin(), 1, controlsOf(first, 0)},
                                            {2, Profile::skin(), 1, controlsOf(second, 0)}};
            materials[0].controls.albedoBefore = one, materials[1].controls.albedoBefore = two;
            return run(p, materials, extra).scattered;
        };
        for (const float share : {0.0f, 1.0f}) {
            const auto one = lightOf(share, share), two = lightOf(0.5f, 0.5f);
            expectNear(lightOf(share, 0.5f), 1e-6,
                       [&](size_t i) { return (p.ids[i / 3] == 1 ? one : two)[i]; });
        }
    }
}

// A leaf with the light behind it: the transmission of a slab of its thickness, whatever the method.
TEST(ScatterBlend, ThinSheetsLetLightThrough) {
    const double thickness = 0.4;
    const auto through = Profile::skin().transmission({thickness});
    for (PelScattering method : {PEL_SCATTERING_NONE, separable, screen}) {
        Frame f(stripes(), method);
        f.giveIrradiance = false;
        f.material.thinThickness = float(thickness);
        f.lamps.resize(1);
        PelLight& light = f.lamps[0].light;
        light.toLight[1] = 0.6f, light.toLight[2] = -0.8f;
        light.color[1] = 2;
        expectNear(f.shade().light, 1e-5,
                   [&](size_t i) { return 0.8 * light.color[i % 3] * through[i % 3]; });
        f.material.transmission = 0.5f;
        EXPECT_NEAR(f.shade().light[0], 0.4 * through[0], 1e-5);
        f.material.thinThickness = 0;
        EXPECT_EQ(f.shade().light[0], 0.0f);
        // The host's own light of the other side.
        f.giveIrradiance = true;
        f.material.transmission = 1;
        f.material.thinThickness = float(thickness);
        std::ranges::fill(f.picture.irradiance, 0.1f);
        f.images[PEL_SLOT_IRRADIANCE_BACK].assign(f.picture.irradiance.size(), 0.7f);
        EXPECT_NEAR(f.shade().light[0], 0.1 + 0.7 * through[0], 1e-5);
    }
}

// A thickness image darkens only bodies: the albedo of a sheet already is its reflectance.
TEST(ScatterBlend, ThicknessLeavesSheetsAlone) {
    Frame f(stripes(), screen);
    f.profile = Profile::burleyDistance({2, 1, 0.5});
    f.giveIrradiance = false;
    f.lamps.resize(1);
    f.material.curvatureGain = 1;
    f.lamps[0].light.toLight[1] = 0.6f, f.lamps[0].light.toLight[2] = 0.8f;
    for (const float sheet : {0.0f, 0.4f}) {
        f.material.thinThickness = sheet;
        f.images.erase(PEL_SLOT_THICKNESS);
        const std::vector<float> before = f.shade().light;
        f.images[PEL_SLOT_THICKNESS].assign(f.picture.pixels(), 0.4f);
        const std::vector<float> after = f.shade().light;
        if (sheet > 0)
            EXPECT_EQ(after, before);
        else
            EXPECT_LT(after[0], 0.9f * before[0]);
    }
}

// The gain of curved bodies of a PelScatter that has normals, or the curvature itself, is that of a shader.
TEST(ScatterBlend, CurvedBodiesGainAsInAShader) {
    const double radius = 10;
    Picture p = ball(100, radius, 0.21, normalized(Vec3{1, 0.3, 0.2}));
    const PelCamera camera = standingAt({0, 0, 400});
    std::copy_n(camera.inverseViewProjection, 16, p.params.inverseViewProjection);
    const Profile known = Profile::burleyDistance({2, 1, 0.5});
    for (uint32_t taps : {0u, 25u})
        for (bool measured : {true, false}) {
            const PelScattering method = taps == 25 ? separable : screen;
            Frame f(p, method, radius);
            f.profile = known;
            f.material.scatterTaps = taps;
            f.material.curvatureGain = 1;
            Extra extra;
            extra.normals = f.images[PEL_SLOT_NORMAL_SHADING];
            if (!measured) {
                for (size_t i = 0; i < p.pixels(); ++i)
                    extra.curvature.push_back(p.ids[i] ? 0.1f + 0.05f * float(i % 7) : notANumber);
                f.images[PEL_SLOT_MEAN_CURVATURE] = extra.curvature;
            }
            ShownImages shown(device(), 1, 1);
            shown.shader.set(camera);
            const auto expected = f.shade(shown).light;
            const std::vector<Material> materials{{1, known, 1, controlsOf(method, taps)}};
            const auto result = run(p, materials, extra).scattered, plain = run(p, materials).scattered;
            double gain = 0, most = 0;
            for (size_t i = 0; i < p.pixels(); ++i)
                for (size_t c = 0; p.ids[i] && c < 3; ++c) {
                    ASSERT_NEAR(result[3 * i + c], expected[3 * i + c], 1e-5) << taps << " " << i;
                    gain += result[3 * i + c], most += plain[3 * i + c];
                }
            EXPECT_GT(gain / most, 1.01) << taps;
            // A medium that is not known gains nothing, and costs nothing.
            const std::vector<Material> unknown{{1, Profile::skin(), 1, controlsOf(method, taps)}};
            const std::vector<float> without = run(p, unknown).scattered;
            const uint64_t built = device().stats().programsBuilt;
            EXPECT_EQ(run(p, unknown, extra).scattered, without);
            EXPECT_EQ(device().stats().programsBuilt, built);
        }
}

TEST(ScatterBlend, AloneAddsAndMultiplies) {
    const Picture p = stripes();
    const auto plain = run(p, Profile::skin()).scattered;
    for (PelScattering method : {screen, separable}) {
        std::vector<Material> materials{{1, Profile::skin(), 1, controlsOf(method, 0)}};
        PelScatterControls& c = materials[0].controls;
        c.thinThickness = 0.4f;
        const size_t values = p.irradiance.size();
        Extra extra;
        extra.ids = false;
        extra.out.assign(values, 2.0f);
        Picture adding = p;
        adding.params.accumulate = 1;
        EXPECT_THROW(run(adding, materials, extra), pellucid::Error);  // no light from behind
        extra.albedo.assign(values, 0.5f);
        extra.back.assign(values, 0.3f);
        const auto through = Profile::skin().transmission({double(c.thinThickness)});
        const auto result = run(adding, materials, extra).scattered;
        expectNear(result, 5e-2, [&](size_t i) { return 2 + 0.5 * (plain[i] + 0.3 * through[i % 3]); });
        EXPECT_NEAR(result[3 * (96 * 24 + 90)], 2 + 0.5 * (1 + 0.3 * through[0]), 1e-3);
        // All of the albedo before is the same where it is one colour.
        c.albedoBefore = 1;
        expectNear(run(adding, materials, extra).scattered, 1e-3, [&](size_t i) { return result[i]; });
        // Where nothing is to scatter, light arrives as it was.
        extra.weights.assign(p.pixels(), 0.0f);
        expectNear(run(adding, materials, extra).scattered, 1e-5,
                   [&](size_t i) { return 2 + 0.5 * (p.irradiance[i] + 0.3 * through[i % 3]); });
        extra.inPlace = true;
        EXPECT_THROW(run(adding, materials, extra), pellucid::Error);
    }
}

// Settings that blocks do not support are handled by a disk of taps, also in a PelScatter; a shader warns.
TEST(ScatterBlend, BlocksBecomeADiskWhereTheyHaveTo) {
    const Picture p = stripes(true);
    const auto alone = [&](uint32_t taps, bool border) {
        const PelScatterControls c = controlsOf(screen, taps, border ? 0.7f : 0);
        return run(p, {{1, Profile::skin(), 1, c}, {2, Profile::skin(), 1, c}}).scattered;
    };
    const auto shaded = [&](PelScattering method, uint32_t taps, bool border) {
        Frame f(p, method);
        f.materials = 2;
        f.material.scatterTaps = taps;
        if (border) std::fill_n(f.material.borderColor, 3, 0.7f);
        return f.shade();
    };
    const Shown usual = shaded(byAuto, 0, false), automatic = shaded(byAuto, 0, true),
                disk = shaded(screen, 64, true);
    EXPECT_EQ(alone(0, true), alone(64, true));
    EXPECT_NE(alone(0, true), alone(0, false));
    EXPECT_EQ(automatic.light, disk.light);
    EXPECT_NE(automatic.light, usual.light);
    EXPECT_NE(automatic.warnings.find("64 taps on a disk, because it has a borderColor"), std::string::npos)
        << automatic.warnings;
    EXPECT_EQ(disk.warnings.find("on a disk"), std::string::npos) << disk.warnings;
    const PelShaderStats& stats = automatic.stats;
    EXPECT_EQ(stats.scatterTaps, disk.stats.scatterTaps);
    EXPECT_GT(stats.pixelsByChoice[screen], 0u);
    EXPECT_EQ(stats.pixelsByChoice[screen], stats.pixelsScattered);
    EXPECT_EQ(stats.pixelsByChoice[PEL_SCATTERING_NONE], stats.pixelsKept);
    // scatterTaps alone is not auto's.
    EXPECT_EQ(shaded(byAuto, 16, false).light, usual.light);
}

TEST(ScatterBlend, EachChannelHasItsShareOverBorders) {
    Picture p = stripes(true);
    for (size_t i = 0; i < p.pixels(); ++i) p.irradiance[3 * i + 1] = p.irradiance[3 * i + 2];
    for (const PelScattering method : {screen, separable}) {
        const auto shaded = [&](float red, float green, float blue) {
            Frame f(p, method);
            f.materials = 2;
            f.material.scatterTaps = 64;
            f.material.borderColor[0] = red, f.material.borderColor[1] = green,
            f.material.borderColor[2] = blue;
            return f.shade().light;
        };
        const std::vector<float> mixed = shaded(0.7f, 0.5f, 0.2f),
                                 each[] = {shaded(0.7f, 0.7f, 0.7f), shaded(0.5f, 0.5f, 0.5f),
                                           shaded(0.2f, 0.2f, 0.2f)};
        std::array<bool, 3> matters{};
        for (size_t i = 0; i < mixed.size(); ++i) {
            ASSERT_EQ(mixed[i], each[i % 3][i]) << i << ", method " << int(method);
            matters[i % 3] |= each[0][i] != each[2][i];
        }
        EXPECT_TRUE(matters[0] && matters[1] && matters[2]) << int(method);
    }
}

TEST(ScatterBlend, SaysWhatHasNoEffect) {
    struct Field {
        const char* name;
        void (*change)(PelMaterial&);
        std::vector<PelScattering> without, with;
    };
    constexpr PelScattering tables = PEL_SCATTERING_PREINTEGRATED, none = PEL_SCATTERING_NONE;
    const Field fields[] = {
        {"scatterTaps",
         [](PelMaterial& m) { m.scatterTaps = 16; },
         {tables, none, byAuto},
         {screen, separable}},
        {"borderColor", [](PelMaterial& m) { m.borderColor[1] = 0.5f; }, {tables, none}, {byAuto, separable}},
        {"albedoBefore",
         [](PelMaterial& m) { m.albedoBefore = 0.5f; },
         {tables, none},
         {byAuto, screen, separable}}};
    for (const Field& field : fields) {
        const auto warned = [&](PelScattering method) {
            Frame f(stripes(), method);
            field.change(f.material);
            const std::string said = f.shade().warnings;
            const std::string key(pellucid::io::scatterings[method]);
            return said.find(field.name + (" without effect: it scatters by \"" + key + "\"")) !=
                   std::string::npos;
        };
        for (PelScattering method : field.without) EXPECT_TRUE(warned(method)) << field.name << int(method);
        for (PelScattering method : field.with) EXPECT_FALSE(warned(method)) << field.name << int(method);
    }
}
