// The pass over a screen of folded skin, with several features, against section 6 in double precision.
#include "measure.h"
#include "shading/shade_scene.h"

namespace pellucid::bench {
namespace {

using shade_test::Frame;

constexpr uint32_t mapSide = 1024;  // texels of the shadow map
constexpr float mapDepth = 0.45f;   // everywhere in it

// What a variant of the pass computes.
struct Settings {
    bool scattering = true;   // by the tables of FaceWorks, with shadows and ambient light; else Lambert
    uint32_t taps = 0;        // of thickness; 0: no deep scatter
    uint32_t lights = 1;      // the first one, and others from elsewhere
    uint32_t coverage = 100;  // percent of the rows, from the top, that are skin
};

// A screen of folded skin, 10 pixels per mm; all variants share its images on the device.
struct SkinScreen {
    Device device;
    shade_test::Tables tables;
    Frame frame;  // without material, lights and ids
    shade_test::Image wideShadow;
    std::map<PelImageSlot, Buffer> images;
    Buffer wideShadowImage, map, target;

    SkinScreen(const Device& d, uint32_t width, uint32_t height)
        : device(d),
          tables(shade_test::makeTables(d, 512, 512)),
          map(d, std::vector<float>(mapSide * mapSide, mapDepth)) {
        frame.width = width, frame.height = height;
        wideShadow.components = frame.slots[PEL_SLOT_CURVATURE].components = 1;
        const auto push = [&](PelImageSlot slot, double x, double y, double z) {
            frame.slots[slot].components = 3;
            frame.slots[slot].push({x, y, z});
        };
        const auto pushUnit = [&](PelImageSlot slot, float x, float y) {
            const float length = std::sqrt(x * x + y * y + 1);
            push(slot, x / length, y / length, 1 / length);
        };
        for (uint32_t row = 0; row < height; ++row)
            for (uint32_t column = 0; column < width; ++column) {
                const float x = float(column), y = float(row);
                const float a = 1.6f * std::sin(x / 110), b = 1.2f * std::cos(y / 85);
                push(PEL_SLOT_POSITION, 0.1f * (x - 0.5f * float(width)), 0.1f * (0.5f * float(height) - y),
                     12 * std::sin((x + y) / 150));
                pushUnit(PEL_SLOT_NORMAL_GEOMETRIC, a, b);
                pushUnit(PEL_SLOT_NORMAL_SHADING, a + 0.1f * std::sin(x / 3), b + 0.1f * std::sin(y / 4));
                pushUnit(PEL_SLOT_NORMAL_BLURRED, 0.9f * a, 0.9f * b);
                push(PEL_SLOT_ALBEDO, 0.8f, 0.5f, 0.4f);
                frame.slots[PEL_SLOT_CURVATURE].values.push_back(0.05f +
                                                                 0.02f * float((column / 7 + row / 5) % 10));
                wideShadow.values.push_back(std::clamp(0.5f + 3 * std::sin((x - y) / 140), 0.0f, 1.0f));
            }
        for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot)
            if (const auto& values = frame.slots[slot].values; !values.empty())
                images[PelImageSlot(slot)] = Buffer(device, values);
        wideShadowImage = Buffer(device, wideShadow.values);
        target = Buffer(device, frame.pixels() * 3 * sizeof(float));
        for (int i = 0; i < 9; ++i)
            for (int c = 0; c < 3; ++c) frame.ambient.sh[i][c] = 0.3f / float(1 + i + c);
        frame.camera.position[2] = 600;
    }
    uint32_t rowsOf(const Settings& settings) const { return frame.height * settings.coverage / 100; }

    // The frame of a variant. One texel stands for the map, which is the same everywhere.
    Frame frameOf(const Settings& settings) const {
        constexpr float toLight[3] = {0.8f, 0.36f, 0.48f}, color[3] = {0.9f, 0.4f, 0.3f},
                        rows[16] = {0.004f, 0, 0, 0.5f, 0, 0.004f, 0, 0.5f, 0, 0, -0.004f, 0.5f, 0, 0, 0, 1};
        Frame f = frame;
        PelMaterial& m = f.materials[1] = fixture::faceworksMaterial();
        m.specular = 0.8f;
        m.thicknessTaps = settings.taps;
        if (settings.taps) std::copy_n(color, 3, m.deepScatterColor);
        f.slots[PEL_SLOT_MATERIAL] = {1, std::vector<float>(f.pixels())};
        std::fill_n(f.slots[PEL_SLOT_MATERIAL].values.begin(), size_t(f.width) * rowsOf(settings), 1.0f);
        for (uint32_t i = 0; i < settings.lights; ++i) {
            shade_test::Light& light = f.lights.emplace_back();
            PelLight& l = light.params = pelLightDefaults();
            std::copy_n(toLight, 3, l.toLight);
            if (i > 0) std::swap(l.toLight[i % 3], l.toLight[(i + 1) % 3]);
            std::copy_n(rows, 16, l.worldToShadow);
            l.shadowDepthRange = 250;
            l.shadowFilterTexels = 0;
            if (settings.scattering) light.wide = wideShadow;
            if (settings.taps) light.mapSize = 1, light.map = {1, {mapDepth}};
        }
        if (settings.scattering) return f;
        m.scattering = pelMaterialDefaults().scattering;
        f.curvatureLut = f.shadowLut = false;
        f.ambient = pelAmbientDefaults();
        for (const auto slot : {PEL_SLOT_NORMAL_GEOMETRIC, PEL_SLOT_NORMAL_BLURRED, PEL_SLOT_CURVATURE})
            f.slots[slot] = {};
        return f;
    }
};

// One variant of the pass.
struct Pass {
    std::shared_ptr<SkinScreen> screen;
    Settings settings;
    Shader shader;

    Pass(std::shared_ptr<SkinScreen> on, Settings of)
        : screen(std::move(on)), settings(of), shader(screen->device) {
        const SkinScreen& s = *screen;
        const Frame f = s.frameOf(settings);
        const std::vector<float> black(3 * f.pixels());  // what other passes left is no result
        s.target.write(black.data(), black.size() * sizeof(float));
        const auto described = [&](const Buffer& image, PelFormat format) {
            return imageDesc(image, format, f.width, f.height);
        };
        for (const auto& [slot, image] : s.images)
            if (const shade_test::Image& own = f.slots[slot]; !own.values.empty())
                shader.set(slot, described(image, shade_test::floatFormats[own.components]));
        const std::vector<float>& ids = f.slots[PEL_SLOT_MATERIAL].values;
        shader.set(
            PEL_SLOT_MATERIAL,
            described(Buffer(s.device, std::vector<uint8_t>(ids.begin(), ids.end())), PEL_FORMAT_R8_UINT));
        shader.set(PEL_SLOT_RADIANCE, described(s.target, PEL_FORMAT_RGB32F));
        std::vector<PelLight> lights;
        for (const shade_test::Light& light : f.lights) lights.push_back(light.params);
        shader.set(lights).set(f.camera).set(f.ambient);
        shader.setMaterial(1, f.materials.at(1), f.curvatureLut ? s.tables.curvature : Lut(),
                           f.shadowLut ? s.tables.shadow : Lut());
        for (uint32_t i = 0; i < settings.lights; ++i) {
            if (settings.scattering)
                shader.set(i, PEL_LIGHT_WIDE_SHADOW, described(s.wideShadowImage, PEL_FORMAT_R32F));
            if (settings.taps)
                shader.set(i, PEL_LIGHT_SHADOW_MAP, imageDesc(s.map, PEL_FORMAT_R32F, mapSide, mapSide));
        }
        shader.commit();
    }

    Error error(int samples) const {
        const Frame f = screen->frameOf(settings);
        const std::vector<float> out = screen->target.readAll<float>();
        std::mt19937 random(1);
        ErrorSum sum;
        for (int s = 0; s < samples; ++s) {
            const size_t i = random() % f.pixels();
            const reference::Rgb expected = shade_test::truth(f, screen->tables, i).sum();
            for (int c = 0; c < 3; ++c) sum.add(out[3 * i + size_t(c)] - expected[c]);
        }
        return sum.result();
    }
};

}  // namespace

std::vector<Factory> shadingCases(const Device& device, bool quick) {
    const auto made = std::make_shared<std::shared_ptr<SkinScreen>>();
    const auto screen = [=] {
        if (!*made)
            *made = quick ? std::make_shared<SkinScreen>(device, 480, 270)
                          : std::make_shared<SkinScreen>(device, 1920, 1080);
        return *made;
    };
    const auto variant = [=](const Settings& settings) {
        return [=] {
            const auto pass = std::make_shared<Pass>(screen(), settings);
            const uint32_t width = pass->screen->frame.width, height = pass->screen->frame.height;
            const bool scattering = settings.scattering;
            Case c;
            const double all = double(width) * height,
                         covered = double(width) * pass->screen->rowsOf(settings);
            c.what = std::to_string(width) + "x" + std::to_string(height) + ", " +
                     std::to_string(settings.coverage) + " % skin";
            c.items = all;
            c.unit = "pixels";
            // Id; position, shading normal, albedo, result; two more normals, curvature, wide shadows.
            c.bytes = all + covered * (4 * 12 + (scattering ? 2 * 12 + 4 + 4 * settings.lights : 0));
            // Per light: four cosines, two table look-ups, specular with its half vector; thickness and its
            // taps. Per pixel: normals and nine harmonics of three of them.
            const double perLight = scattering ? 150.0 + (settings.taps ? 40 + 23.0 * settings.taps : 0) : 60;
            c.operations = covered * (settings.lights * perLight + (scattering ? 200 : 15));
            c.run = [=] { pass->shader.execute(); };
            const int samples = quick ? 500 : 4000;
            c.error = [=] { return pass->error(samples); };
            c.truth = "section 6 in double precision with the same tables at drawn pixels; absolute";
            return c;
        };
    };
    return {{"shade-plain", "shading", variant({.scattering = false})},
            {"shade-surface", "shading", variant({})},
            {"shade-8-taps", "shading", variant({.taps = 8})},
            {"shade-32-taps", "shading", variant({.taps = 32})},
            {"shade-4-lights", "shading", variant({.lights = 4})},
            {"shade-10-percent", "shading", variant({.taps = 32, .coverage = 10})},
            {"shade-no-skin", "shading", variant({.taps = 32, .coverage = 0})}};
}

}  // namespace pellucid::bench
