// A radius per pixel in sums by levels and over shadow maps, and maps of melanin and blood (PEL_SLOT_SKIN).
#include "test.h"

#include "diffusion/lit_ball.h"
#include "fields/color_difference.h"
#include "fields/field_ranges.h"

using namespace lit_ball;

namespace {

using Factor = std::function<double(double, double)>;  // of the radius, over shares of the picture

std::vector<float> weightsOf(const Picture& p, const Factor& factor) {
    std::vector<float> weights;
    for (size_t i = 0; i < p.pixels(); ++i)
        weights.insert(weights.end(),
                       {1.0f, float(factor(double(i % p.width) / p.width, double(i / p.width) / p.height))});
    return weights;
}

// A small ball under a light with a map; light from elsewhere is not there.
Frame ballFrame(PelScattering method, uint32_t side) {
    const Vec3 toLight = normalized(Vec3{1, 0.4, 0.6});
    Frame f(ball(side, radius, 2.2 * radius / side, toLight), method, radius);
    f.lamps = {makeBall(Form::parallel, toLight, 64)};
    f.options.targetError = 0;
    return f;
}

PelSkin skinOf(float melanin, float blood, float oxygenation = 0.75f) {
    PelSkin skin = pelSkinDefaults();
    skin.melanin = melanin, skin.blood = blood, skin.oxygenation = oxygenation;
    return skin;
}

}  // namespace

// As close to the sum over every pixel as with a uniform radius as large as the largest.
TEST(SkinMaps, SumsTakeARadiusPerPixel) {
    const uint32_t side = sized(72u, 24u);
    const Factor even = [](double, double) { return 1.5; },
                 cases[] = {
                     even, [](double, double) { return 0.5; }, [](double x, double) { return 0.4 + 1.1 * x; },
                     [](double x, double y) { return std::hypot(x - 0.5, y - 0.5) < 0.15 ? 0.4 : 1.5; }};
    Picture p = ball(side, 10, 21.0 / side, normalized(Vec3{1, 0.3, 0.2}));
    for (size_t i = 0; i < p.pixels(); ++i)  // stripes of shadow
        if (int(p.positions[3 * i + 1] + 20) / 3 % 2) std::fill_n(&p.irradiance[3 * i], 3, 0.0f);
    p.params.everywhere = 1;
    const std::vector<float> plain = run(p, Profile::skin()).scattered;
    double widest = 0;
    for (const Factor& factor : cases) {
        const std::vector<float> weights = weightsOf(p, factor);
        reference::ScatterPicture exact = p.exact();
        for (size_t i = 0; i < p.pixels(); ++i) exact.radii.push_back(weights[2 * i + 1]);
        const auto truth = reference::scatterOnScreen(exact, *reference::skinProfile());
        const double rms =
            difference(p, run(p, std::vector<Material>{{1, Profile::skin()}}, {weights}).scattered, truth)
                .rms;
        if (!(widest > 0)) widest = rms;
        EXPECT_LT(rms, tolerance::radiusPerPixelRms);
        EXPECT_LE(rms, 1.1 * widest);
        EXPECT_LT(rms, 0.7 * difference(p, plain, truth).rms);
    }
}

// An even factor is a smaller profile, by each method, and none of them becomes a disk.
TEST(SkinMaps, AnEvenRadiusIsASmallerProfile) {
    for (PelScattering method : {screen, byAuto, byLight}) {
        Frame f = ballFrame(method, sized(64u, 24u)), small = f;
        const double whole = f.profile.info().radius;
        f.material.diffusionRadius = 0.08f * float(whole),
        small.material.diffusionRadius = 0.04f * float(whole);
        const Shown plain = f.shade(), expected = small.shade();
        f.images[PEL_SLOT_SCATTER_WEIGHT] = weightsOf(f.picture, [](double, double) { return 0.5; });
        const Shown shown = f.shade();
        EXPECT_EQ(shown.warnings, expected.warnings);
        EXPECT_EQ(shown.stats.pixelsScattered, expected.stats.pixelsScattered);
        const Difference d = difference(f.picture, shown.light, expected.light);
        EXPECT_LT(d.most, 1e-3) << int(method);
        EXPECT_GT(difference(f.picture, plain.light, expected.light).most, 5e-3) << int(method);
    }
}

// Smaller factors count as a 64th.
TEST(SkinMaps, TheRadiusHasALeastFactor) {
    for (PelScattering method : {byAuto, byLight}) {
        Frame f = ballFrame(method, sized(64u, 24u));
        f.material.diffusionRadius = 40;
        const auto lightBy = [&](double factor) {
            f.images[PEL_SLOT_SCATTER_WEIGHT] = weightsOf(f.picture, [=](double, double) { return factor; });
            return f.shade().light;
        };
        const std::vector<float> least = lightBy(1 / 64.0);
        EXPECT_EQ(lightBy(1e-3), least) << int(method);
        EXPECT_GT(difference(f.picture, lightBy(1 / 60.0), least).most, 1e-4) << int(method);
    }
}

// Skipped light stays below the target error, whatever the radius of a pixel.
TEST(SkinMaps, TheTargetErrorHolds) {
    Frame f = ballFrame(byAuto, sized(128u, 32u));
    f.images[PEL_SLOT_SCATTER_WEIGHT] =
        weightsOf(f.picture, [](double x, double y) { return (int(16 * x) + int(16 * y)) % 2 ? 0.05 : 3; });
    f.material.diffusionRadius = 0.15f;
    const std::vector<float> all = f.shade().light;
    f.options.targetError = 0.02f;
    const Shown some = f.shade();
    const Difference d = difference(f.picture, some.light, all);
    EXPECT_GT(some.stats.pixelsKept, 0u);
    EXPECT_LT(d.most, 1.45 * 0.02);
}

TEST(SkinMaps, AlbedoAndRadiusAreThoseOfTheSkin) {
    const uint32_t width = 64, height = 32;
    const PelSkin own = skinOf(0.02f, 0.01f);
    for (const bool oxygen : {false, true}) {
        Frame f(plane(width, height, 1, [](double, double) { return Vec3{1, 1, 1}; }), byAuto);
        f.profile = Profile::skinLayers(own);
        f.material.albedo[0] = 0.123f;
        for (size_t i = 0; i < f.picture.pixels(); ++i)
            if (i % width >= 60) f.picture.ids[i] = 2;  // no material
        std::vector<float>& maps = f.images[PEL_SLOT_SKIN];
        for (size_t i = 0; i < f.picture.pixels(); ++i) {
            const float m = float(i % width) / width, b = float(i / width) / height;
            maps.insert(maps.end(), {0.5f * m * m, 0.2f * b * b});
            if (oxygen) maps.push_back(float(i % 7) / 6);
        }
        const std::vector<float> light = f.shade().light;
        const size_t each = oxygen ? 3 : 2;
        for (size_t i = 0; i < f.picture.pixels(); i += 37) {
            if (f.picture.ids[i] != 1) continue;
            const PelSkin at =
                skinOf(maps[each * i], maps[each * i + 1], oxygen ? maps[each * i + 2] : 0.75f);
            const PelSkinInfo exact = pellucid::skinInfo(at);
            const auto lab = [](const float* rgb) { return pel::labFromLinear({rgb[0], rgb[1], rgb[2]}); };
            EXPECT_LT(pel::deltaE2000(lab(&light[3 * i]), lab(exact.albedo)), tolerance::skinRoundTrip)
                << at.melanin << ' ' << at.blood << ' ' << at.oxygenation;
        }
    }
}

// Even maps are a material of that skin: of the profile's own exactly but for the table, of another as near
// as one factor for three channels can be.
TEST(SkinMaps, EvenMapsAreAPlainMaterial) {
    for (const auto& [melanin, within] : {std::pair{0.02f, 2e-4}, {0.12f, 4e-3}}) {
        Picture p = plane(96, 96, 0.4, [](double x, double) { return x > 19 ? Vec3{1, 1, 1} : Vec3{}; });
        Frame maps(p, byAuto), plain = maps;
        maps.profile = Profile::skinLayers(skinOf(0.02f, 0.01f));
        for (size_t i = 0; i < p.pixels(); ++i)
            maps.images[PEL_SLOT_SKIN].insert(maps.images[PEL_SLOT_SKIN].end(), {melanin, 0.01f});
        plain.profile = Profile::skinLayers(skinOf(melanin, 0.01f));
        std::copy_n(pellucid::skinInfo(skinOf(melanin, 0.01f)).albedo, 3, plain.material.albedo);
        const std::vector<float> light = maps.shade().light;
        const Difference d = difference(p, light, plain.shade().light);
        EXPECT_LT(d.most, within);
        maps.picture.ids.clear();  // all pixels are of material 1 then
        EXPECT_EQ(maps.shade().light, light);
    }
}

TEST(SkinMaps, AStrokeChangesItsSurroundings) {
    const uint32_t side = 160;
    Picture p = plane(side, side, 0.3, [](double x, double y) {
        const double e = (int(x / 4) + int(y / 4)) % 2 ? 1 : 0.2;
        return Vec3{e, e, e};
    });
    Frame f(p, byAuto);
    f.profile = Profile::skinLayers(skinOf(0.02f, 0.01f));
    std::vector<float>& maps = f.images[PEL_SLOT_SKIN];
    for (size_t i = 0; i < p.pixels(); ++i) maps.insert(maps.end(), {0.02f, 0.01f});
    const std::vector<float> before = f.shade().light;
    const auto inside = [&](size_t i, int more) {
        const int x = int(i % side), y = int(i / side);
        return std::abs(x - 80) < 12 + more && std::abs(y - 72) < 12 + more;
    };
    for (size_t i = 0; i < p.pixels(); ++i)
        if (inside(i, 0)) maps[2 * i + 1] = 0.1f;  // a blush
    const std::vector<float> after = f.shade().light;
    for (size_t i = 0; i < 3 * p.pixels(); ++i) {
        if (i % 3 == 1 && inside(i / 3, -2)) {
            EXPECT_LT(after[i], 0.9f * before[i]);
        }
        if (!inside(i / 3, 4)) {
            ASSERT_NEAR(after[i], before[i], 2e-3) << i / 3 % side << ' ' << i / 3 / side;
        }
    }
}

TEST(SkinMaps, WhatIsNotUsedCostsNoBit) {
    Frame f = ballFrame(byAuto, 32);
    const Shown plain = f.shade();
    f.images[PEL_SLOT_SKIN].assign(2 * f.picture.pixels(), 0.3f);
    const Shown idle = f.shade();
    EXPECT_EQ(idle.light, plain.light);
    EXPECT_NE(idle.warnings.find("the skin image is without effect"), std::string::npos) << idle.warnings;
}

TEST(SkinMaps, BadInput) {
    Frame f = ballFrame(byAuto, 32);
    f.profile = Profile::skinLayers(skinOf(0.02f, 0.01f));
    const float bad[] = {notANumber, -1, 2, infinity, -infinity, 0.1f};
    for (size_t i = 0; i < 3 * f.picture.pixels(); ++i)
        f.images[PEL_SLOT_SKIN].push_back(bad[i * 7 % 11 % 6]);
    f.images[PEL_SLOT_SCATTER_WEIGHT].clear();
    for (size_t i = 0; i < 2 * f.picture.pixels(); ++i)
        f.images[PEL_SLOT_SCATTER_WEIGHT].push_back(i % 2 ? bad[i * 5 % 13 % 6] : 1.0f);
    for (PelScattering method : {byAuto, byLight, PEL_SCATTERING_SEPARABLE, PEL_SCATTERING_PREINTEGRATED}) {
        f.material.scattering = method;
        for (float v : f.shade().light) ASSERT_TRUE(std::isfinite(v)) << int(method);
    }
    ShownImages shown(device(), 32, 32);
    expectRefused({"skin", "two components"}, [&] { shown.set(PEL_SLOT_SKIN, std::vector<float>(32 * 32)); });
    shown.set(PEL_SLOT_NORMAL_SHADING, std::vector<float>(3 * 32 * 32, 0.577f));
    shown.shader.set(PEL_SLOT_SKIN, imageOf(shown.device, std::vector<float>(2 * 16 * 16), 16, 16));
    expectRefused({"skin", "16 x 16"}, [&] { shown.shader.commit(); });
}
