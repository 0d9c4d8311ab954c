// What lies before and after the methods of scattering: albedo before and after, light from behind thin
// sheets, weights, and adding.
#include <gtest/gtest.h>

#include <functional>

#include "diffusion/scatter_scene.h"
#include "diffusion/shown_images.h"
#include "tolerances.h"

using namespace scatter_scene;

namespace {

// A picture through a shader, and what a test changes of it.
struct Frame {
    Picture picture;
    std::vector<float> normals, albedo, weight, back;
    PelMaterial material = pelMaterialDefaults();
    Profile profile = Profile::skin();
    std::vector<PelLight> lights;
    bool giveIrradiance = true, both = false;  // the material is that of id 2 too

    explicit Frame(Picture p) : picture(std::move(p)), normals(picture.positions.size()) {
        for (size_t i = 0; i < picture.pixels(); ++i) normals[3 * i + 2] = 1;
        material.profile = profile.get();
        std::fill_n(material.albedo, 3, 1.0f);
    }
    std::vector<float> shade(PelShaderStats* stats = nullptr, std::string* said = nullptr) const {
        const Picture& p = picture;
        ShownImages shown(device(), p.width, p.height);
        PelShaderOptions options = pelShaderOptionsDefaults();
        options.countPixels = stats != nullptr;
        shown.shader.set(options);
        shown.set(PEL_SLOT_POSITION, p.positions);
        shown.set(PEL_SLOT_NORMAL_SHADING, normals);
        shown.set(PEL_SLOT_MATERIAL, p.ids);
        if (giveIrradiance) shown.set(PEL_SLOT_IRRADIANCE, p.irradiance);
        if (!albedo.empty()) shown.set(PEL_SLOT_ALBEDO, albedo);
        if (!weight.empty()) shown.set(PEL_SLOT_SCATTER_WEIGHT, weight);
        if (!back.empty()) shown.set(PEL_SLOT_IRRADIANCE_BACK, back);
        shown.shader.setMaterial(1, material);
        if (both) shown.shader.setMaterial(2, material);
        shown.shader.set(lights);
        shown.shader.set(pelCameraDefaults());
        std::vector<float> radiance = shown.execute();
        if (stats) *stats = shown.shader.stats();
        if (said) *said = shown.shader.warnings();
        return radiance;
    }
};

Picture stripes() {
    return plane(96, 48, 0.3, [](double x, double) { return Vec3{x > 14 ? 1.0 : 0.1, 0.5, x / 30}; });
}

const PelScattering methods[] = {PEL_SCATTERING_SEPARABLE, PEL_SCATTERING_SCREEN, PEL_SCATTERING_AUTO};

}  // namespace

TEST(ScatterBlend, AlbedoBeforeAndAfter) {
    for (PelScattering method : methods) {
        Frame f(stripes());
        f.material.scattering = method;
        std::vector<float> albedo;
        for (size_t i = 0; i < f.picture.positions.size(); ++i)
            albedo.push_back(0.25f + 0.5f * float(i / 30 % 2));
        const auto plain = f.shade();
        // One colour: however it is split, the same.
        std::fill_n(f.material.albedo, 3, 0.36f);
        for (float m : {0.0f, 0.5f, 1.0f}) {
            f.material.albedoBefore = m;
            const auto result = f.shade();
            for (size_t i = 0; i < result.size(); ++i) ASSERT_NEAR(result[i], 0.36f * plain[i], 1e-3) << m;
        }
        // All of it before: what scattering alone gives of irradiance times albedo.
        Frame product = f;
        for (size_t i = 0; i < albedo.size(); ++i) product.picture.irradiance[i] *= albedo[i];
        product.material.albedoBefore = 0;
        std::fill_n(product.material.albedo, 3, 1.0f);
        f.albedo = albedo;
        f.material.albedoBefore = 1;
        const auto before = f.shade(), expected = product.shade();
        for (size_t i = 0; i < before.size(); ++i) ASSERT_NEAR(before[i], expected[i], 1e-6) << i;
        // None of it: as ever.
        f.material.albedoBefore = 0;
        const auto after = f.shade();
        for (size_t i = 0; i < after.size(); ++i) ASSERT_NEAR(after[i], albedo[i] * plain[i], 1e-6) << i;
        // Black stays black but for what flows in before.
        std::fill(f.albedo.begin() + 3 * 96 * 20, f.albedo.begin() + 3 * 96 * 24, 0.0f);
        EXPECT_EQ(f.shade()[3 * (96 * 21 + 80)], 0.0f);
        f.material.albedoBefore = 1;
        EXPECT_GT(f.shade()[3 * (96 * 21 + 80)], 0.0f);
    }
}

TEST(ScatterBlend, WeightsMix) {
    for (PelScattering method : methods) {
        Frame f(stripes());
        f.material.scattering = method;
        const auto whole = f.shade();
        for (size_t i = 0; i < f.picture.pixels(); ++i) f.weight.push_back(float(i % 5) / 4);
        const auto some = f.shade();
        for (size_t i = 0; i < some.size(); ++i) {
            const float w = f.weight[i / 3], e = f.picture.irradiance[i];
            ASSERT_NEAR(some[i], e + w * (whole[i] - e), 1e-6) << i;
        }
    }
}

// A leaf with the light behind it: what a slab of its thickness lets through, however it scatters then.
TEST(ScatterBlend, ThinSheetsLetLightThrough) {
    const double thickness = 0.4;
    const auto through = Profile::skin().transmission({thickness});
    for (PelScattering method : {PEL_SCATTERING_NONE, PEL_SCATTERING_SEPARABLE, PEL_SCATTERING_SCREEN}) {
        Frame f(stripes());
        f.giveIrradiance = false;
        f.material.scattering = method;
        f.material.thinThickness = float(thickness);
        PelLight light = pelLightDefaults();
        light.toLight[1] = 0.6f, light.toLight[2] = -0.8f;
        light.color[1] = 2;
        f.lights = {light};
        const auto result = f.shade();
        for (size_t i = 0; i < result.size(); ++i)
            ASSERT_NEAR(result[i], 0.8 * light.color[i % 3] * through[i % 3], 1e-5) << i;
        f.material.transmission = 0.5f;
        EXPECT_NEAR(f.shade()[0], 0.4 * through[0], 1e-5);
        f.material.thinThickness = 0;
        EXPECT_EQ(f.shade()[0], 0.0f);
        // The host's own light of the other side.
        f.giveIrradiance = true;
        f.material.transmission = 1;
        f.material.thinThickness = float(thickness);
        for (float& e : f.picture.irradiance) e = 0.1f;
        f.back.assign(f.picture.irradiance.size(), 0.7f);
        EXPECT_NEAR(f.shade()[0], 0.1 + 0.7 * through[0], 1e-5);
    }
    Frame wrong(stripes());
    wrong.material.thinThickness = 1;
    EXPECT_THROW(wrong.shade(), pellucid::Error);  // by tables
}

TEST(ScatterBlend, AloneAddsAndMultiplies) {
    const Picture p = stripes();
    const auto plain = run(p, Profile::skin()).scattered;
    for (PelScattering method : {PEL_SCATTERING_SCREEN, PEL_SCATTERING_SEPARABLE}) {
        Scatter scatter(device());
        scatter.setMaterial(1, Profile::skin());
        PelScatterControls c = pelScatterControlsDefaults();
        c.scattering = method;
        c.thinThickness = 0.4f;
        scatter.setControls(1, c);
        std::vector<float> albedo(p.irradiance.size(), 0.5f), back(p.irradiance.size(), 0.3f);
        const Buffer e(device(), p.irradiance), x(device(), p.positions), a(device(), albedo),
            b(device(), back), out(device(), std::vector<float>(p.irradiance.size(), 2.0f));
        const auto rgb = [&](const Buffer& buffer) {
            return pellucid::imageDesc(buffer, PEL_FORMAT_RGB32F, p.width, p.height);
        };
        const PelImageDesc positions = rgb(x);
        PelScatterParams params = pelScatterParamsDefaults();
        params.accumulate = 1;
        EXPECT_THROW(scatter.execute(params, rgb(e), &positions, nullptr, nullptr, rgb(out)),
                     pellucid::Error);
        scatter.set(PEL_SLOT_ALBEDO, rgb(a));
        scatter.set(PEL_SLOT_IRRADIANCE_BACK, rgb(b));
        scatter.execute(params, rgb(e), &positions, nullptr, nullptr, rgb(out));
        const auto through = Profile::skin().transmission({double(c.thinThickness)});
        const auto result = out.readAll<float>();
        for (size_t i = 0; i < result.size(); ++i)
            ASSERT_NEAR(result[i], 2 + 0.5 * (plain[i] + 0.3 * through[i % 3]), 5e-2) << i;
        EXPECT_NEAR(result[3 * (96 * 24 + 90)], 2 + 0.5 * (1 + 0.3 * through[0]), 1e-3);
        EXPECT_THROW(scatter.execute(params, rgb(e), &positions, nullptr, nullptr, rgb(e)), pellucid::Error);
        // All of the albedo before is the same where it is one colour.
        c.albedoBefore = 1;
        scatter.setControls(1, c);
        const std::vector<float> two(p.irradiance.size(), 2.0f);
        out.write(two.data(), two.size() * sizeof(float));
        scatter.execute(params, rgb(e), &positions, nullptr, nullptr, rgb(out));
        const auto again = out.readAll<float>();
        for (size_t i = 0; i < again.size(); ++i) ASSERT_NEAR(again[i], result[i], 1e-3) << i;
    }
}

// Alone too: what blocks cannot do is done by a disk.
TEST(ScatterBlend, AloneTakesADiskWhereItHasTo) {
    Picture p = stripes();
    for (size_t i = 0; i < p.pixels(); ++i) p.ids[i] = uint8_t(1 + (i % 96 > 48));
    std::vector<float> radii;
    for (size_t i = 0; i < p.pixels(); ++i) radii.insert(radii.end(), {1, float(i % 96) / 96});
    const Buffer e(device(), p.irradiance), x(device(), p.positions), ids(device(), p.ids),
        r(device(), radii), out(device(), p.irradiance);
    const auto image = [&](const Buffer& buffer, PelFormat format) {
        return pellucid::imageDesc(buffer, format, p.width, p.height);
    };
    const auto scattered = [&](uint32_t taps, bool border, bool withRadii) {
        Scatter scatter(device());
        for (uint32_t id : {1u, 2u}) {
            PelScatterControls c = pelScatterControlsDefaults();
            c.scatterTaps = taps;
            if (border) std::fill_n(c.borderColor, 3, 0.7f);
            scatter.setMaterial(id, Profile::skin());
            scatter.setControls(id, c);
        }
        if (withRadii) scatter.set(PEL_SLOT_SCATTER_WEIGHT, image(r, PEL_FORMAT_RG32F));
        const PelImageDesc positions = image(x, PEL_FORMAT_RGB32F), id = image(ids, PEL_FORMAT_R8_UINT);
        scatter.execute(p.params, image(e, PEL_FORMAT_RGB32F), &positions, nullptr, &id,
                        image(out, PEL_FORMAT_RGB32F));
        return out.readAll<float>();
    };
    for (const auto& [border, withRadii] : {std::pair{true, false}, {false, true}, {true, true}}) {
        EXPECT_EQ(scattered(0, border, withRadii), scattered(64, border, withRadii));
        EXPECT_NE(scattered(0, border, withRadii), scattered(0, false, false));
    }
}

// What blocks of pixels cannot do auto does by a disk of taps, and says so.
TEST(ScatterBlend, AutoTakesADiskWhereItHasTo) {
    const auto shade = [](PelScattering method, uint32_t taps, bool border, bool radii, PelShaderStats* stats,
                          std::string* said) {
        Frame f(stripes());
        for (size_t i = 0; i < f.picture.pixels(); ++i) f.picture.ids[i] = uint8_t(1 + (i % 96 > 48));
        f.material.scattering = method;
        f.material.scatterTaps = taps;
        f.material.specular = 0;
        if (border) std::fill_n(f.material.borderColor, 3, 0.7f);
        if (radii)
            for (size_t i = 0; i < f.picture.pixels(); ++i)
                f.weight.insert(f.weight.end(), {1, float(i % 96) / 96});
        f.both = true;
        const auto result = f.shade(stats, said);
        return result;
    };
    for (const auto& [border, radii] : {std::pair{true, false}, {false, true}, {true, true}}) {
        PelShaderStats stats, disk;
        std::string said, nothing;
        const auto automatic = shade(PEL_SCATTERING_AUTO, 0, border, radii, &stats, &said);
        EXPECT_EQ(automatic, shade(PEL_SCATTERING_SCREEN, 64, border, radii, &disk, &nothing));
        EXPECT_NE(automatic, shade(PEL_SCATTERING_AUTO, 0, false, false, nullptr, nullptr));
        EXPECT_NE(said.find(border ? "64 taps on a disk, for it has a borderColor"
                                   : "64 taps on a disk, for the scatter weight image has radii"),
                  std::string::npos)
            << said;
        EXPECT_EQ(nothing, "");
        EXPECT_EQ(stats.scatterTaps, disk.scatterTaps);
        EXPECT_GT(stats.pixelsByChoice[PEL_SCATTERING_SCREEN], 0u);
        EXPECT_EQ(stats.pixelsByChoice[PEL_SCATTERING_SCREEN], stats.pixelsScattered);
        EXPECT_EQ(stats.pixelsByChoice[PEL_SCATTERING_NONE], stats.pixelsKept);
    }
    // scatterTaps alone is not auto's.
    EXPECT_EQ(shade(PEL_SCATTERING_AUTO, 16, false, false, nullptr, nullptr),
              shade(PEL_SCATTERING_AUTO, 0, false, false, nullptr, nullptr));
}

TEST(ScatterBlend, SaysWhatHasNoEffect) {
    const auto said = [](PelScattering method, const std::function<void(PelMaterial&)>& change) {
        Frame f(stripes());
        f.material.scattering = method;
        change(f.material);
        std::string said;
        f.shade(nullptr, &said);
        return said.find("without effect") == std::string::npos ? std::string() : said;
    };
    const auto taps = [](PelMaterial& m) { m.scatterTaps = 16; };
    const auto border = [](PelMaterial& m) { m.borderColor[1] = 0.5f; };
    const auto before = [](PelMaterial& m) { m.albedoBefore = 0.5f; };
    for (PelScattering method : {PEL_SCATTERING_PREINTEGRATED, PEL_SCATTERING_NONE}) {
        EXPECT_NE(said(method, taps).find("scatterTaps"), std::string::npos);
        EXPECT_NE(said(method, border).find("borderColor"), std::string::npos);
        EXPECT_NE(said(method, before).find("albedoBefore"), std::string::npos);
    }
    EXPECT_NE(said(PEL_SCATTERING_AUTO, taps).find("scatterTaps"), std::string::npos);
    EXPECT_EQ(said(PEL_SCATTERING_AUTO, border), "");
    EXPECT_EQ(said(PEL_SCATTERING_AUTO, before), "");
    for (PelScattering method : {PEL_SCATTERING_SCREEN, PEL_SCATTERING_SEPARABLE}) {
        EXPECT_EQ(said(method, taps), "");
        EXPECT_EQ(said(method, before), "");
    }
    EXPECT_EQ(said(PEL_SCATTERING_SEPARABLE, border), "");
}

TEST(ScatterBlend, SaysWhatItCannot) {
    const auto error = [](const std::function<void(PelMaterial&)>& change, bool radius = false) {
        Frame f(stripes());
        f.material.scattering = PEL_SCATTERING_SCREEN;
        change(f.material);
        if (radius) f.weight.assign(1, 0);
        try {
            f.shade();
        } catch (const pellucid::Error& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    EXPECT_EQ(error([](PelMaterial& m) { m.scatterTaps = 16, m.borderColor[0] = 1; }), "");
    EXPECT_NE(error([](PelMaterial& m) { m.borderColor[0] = 1; }).find("scatterTaps of 8 to 256"),
              std::string::npos);
    EXPECT_NE(error([](PelMaterial& m) { m.thinThickness = 1; }).find("thinThickness"), std::string::npos);
}
