// The pass over a screen of folded skin, with several features, against section 6 in double precision.
#include <random>

#include "measure.h"
#include "reference/shade.h"

namespace pellucid::bench {
namespace {

using reference::Vec3;

constexpr uint32_t mapSide = 1024;  // texels of the shadow map
constexpr float mapDepth = 0.45f;   // everywhere in it, so that the truth needs no taps

// What a variant of the pass computes.
struct Settings {
    bool scattering = true;   // by the tables of FaceWorks, with shadows and ambient light; else Lambert
    uint32_t taps = 0;        // of thickness; 0: no deep scatter
    uint32_t lights = 1;      // the first one, and others from elsewhere
    uint32_t coverage = 100;  // percent of the rows, from the top, that are skin
};

struct Picture {
    std::vector<float> values;
    Buffer buffer;
};

// A screen of folded skin, 10 pixels per mm.
struct SkinScreen {
    Device device;
    uint32_t width, height;
    Picture position, geometric, shading, blurred, albedo;  // 3 per pixel; mm
    Picture curvature, wideShadow;                          // 1 per pixel; 1/mm
    Buffer map, target;
    PelAmbient ambient = pelAmbientDefaults();
    PelCamera camera = pelCameraDefaults();
    Lut curvatureLut, shadowLut;
    reference::ScatterTable curvatureTruth, shadowTruth;

    SkinScreen(const Device& d, uint32_t w, uint32_t h)
        : device(d), width(w), height(h), map(d, std::vector<float>(mapSide * mapSide, mapDepth)) {
        const auto append = [](Picture& to, std::initializer_list<float> values) {
            to.values.insert(to.values.end(), values);
        };
        const auto appendUnit = [&](Picture& to, float x, float y) {
            const float length = std::sqrt(x * x + y * y + 1);
            append(to, {x / length, y / length, 1 / length});
        };
        for (uint32_t row = 0; row < height; ++row)
            for (uint32_t column = 0; column < width; ++column) {
                const float x = float(column), y = float(row);
                const float a = 1.6f * std::sin(x / 110), b = 1.2f * std::cos(y / 85);
                append(position, {0.1f * (x - 0.5f * float(width)), 0.1f * (0.5f * float(height) - y),
                                  12 * std::sin((x + y) / 150)});
                appendUnit(geometric, a, b);
                appendUnit(shading, a + 0.1f * std::sin(x / 3), b + 0.1f * std::sin(y / 4));
                appendUnit(blurred, 0.9f * a, 0.9f * b);
                append(curvature, {0.05f + 0.02f * float((column / 7 + row / 5) % 10)});
                append(albedo, {0.8f, 0.5f, 0.4f});
                append(wideShadow, {std::clamp(0.5f + 3 * std::sin((x - y) / 140), 0.0f, 1.0f)});
            }
        for (Picture* p : {&position, &geometric, &shading, &blurred, &albedo, &curvature, &wideShadow})
            p->buffer = Buffer(device, p->values);
        target = Buffer(device, position.values.size() * sizeof(float));
        for (int i = 0; i < 9; ++i)
            for (int c = 0; c < 3; ++c) ambient.sh[i][c] = 0.3f / float(1 + i + c);
        camera.position[2] = 600;
        const PelCurvatureLutDesc c = pelCurvatureLutDescFaceWorks();
        const PelShadowLutDesc s = pelShadowLutDescFaceWorks();
        curvatureLut = Lut(device, c), shadowLut = Lut(device, s);
        curvatureTruth = {table(curvatureLut), c.radiusMin, c.radiusMax, 2.7, 0};
        shadowTruth = {table(shadowLut), s.widthMin, s.widthMax, 2.7, s.sharpening};
    }

    static reference::Table table(const Lut& lut) {
        const std::vector<float> texels = lut.read<float>(PEL_LUT_FLOAT);
        reference::Table table{512, 512, {}};
        for (size_t i = 0; i < texels.size(); i += 3)
            table.texels.push_back({texels[i], texels[i + 1], texels[i + 2]});
        return table;
    }
};

// With the numbers of FaceWorks, which the oracle takes unchanged.
PelMaterial materialOf(const Settings& settings) {
    constexpr float blend[3] = {1, 0.3f, 0}, color[3] = {0.9f, 0.4f, 0.3f};
    PelMaterial m = pelMaterialDefaults();
    m.diffusionRadius = 2.7f;
    m.shadowFilterWidth = 8;
    std::copy_n(blend, 3, m.normalBlend);
    m.specular = 0.8f;
    m.thicknessTaps = settings.taps;
    if (settings.taps) std::copy_n(color, 3, m.deepScatterColor);
    if (settings.scattering) m.scattering = PEL_SCATTERING_PREINTEGRATED;
    return m;
}

std::vector<PelLight> lightsOf(const Settings& settings) {
    constexpr float toLight[3] = {0.8f, 0.36f, 0.48f},
                    rows[16] = {0.004f, 0, 0, 0.5f, 0, 0.004f, 0, 0.5f, 0, 0, -0.004f, 0.5f, 0, 0, 0, 1};
    PelLight first = pelLightDefaults();
    std::copy_n(toLight, 3, first.toLight);
    std::copy_n(rows, 16, first.worldToShadow);
    first.shadowDepthRange = 250;
    first.shadowFilterTexels = 0;
    std::vector<PelLight> lights(settings.lights, first);
    for (uint32_t i = 1; i < settings.lights; ++i)
        std::swap(lights[i].toLight[i % 3], lights[i].toLight[(i + 1) % 3]);
    return lights;
}

// One variant of the pass.
struct Pass {
    std::shared_ptr<SkinScreen> screen;
    Settings settings;
    uint32_t rows;  // of skin
    Shader shader;

    Pass(std::shared_ptr<SkinScreen> on, Settings of)
        : screen(std::move(on)),
          settings(of),
          rows(screen->height * of.coverage / 100),
          shader(screen->device) {
        const SkinScreen& s = *screen;
        const std::vector<float> black(s.position.values.size());  // what other passes left is no result
        s.target.write(black.data(), black.size() * sizeof(float));
        std::vector<uint8_t> ids(size_t(s.width) * s.height);
        std::fill_n(ids.begin(), size_t(s.width) * rows, uint8_t(1));
        const auto described = [&](const Buffer& image, PelFormat format) {
            return imageDesc(image, format, s.width, s.height);
        };
        const auto set = [&](PelImageSlot slot, const Buffer& image, PelFormat format) {
            shader.set(slot, described(image, format));
        };
        set(PEL_SLOT_RADIANCE, s.target, PEL_FORMAT_RGB32F);
        set(PEL_SLOT_MATERIAL, Buffer(s.device, ids), PEL_FORMAT_R8_UINT);
        set(PEL_SLOT_POSITION, s.position.buffer, PEL_FORMAT_RGB32F);
        set(PEL_SLOT_NORMAL_SHADING, s.shading.buffer, PEL_FORMAT_RGB32F);
        set(PEL_SLOT_ALBEDO, s.albedo.buffer, PEL_FORMAT_RGB32F);
        shader.set(lightsOf(settings)).set(s.camera);
        if (settings.scattering) {
            set(PEL_SLOT_NORMAL_GEOMETRIC, s.geometric.buffer, PEL_FORMAT_RGB32F);
            set(PEL_SLOT_NORMAL_BLURRED, s.blurred.buffer, PEL_FORMAT_RGB32F);
            set(PEL_SLOT_CURVATURE, s.curvature.buffer, PEL_FORMAT_R32F);
            shader.set(s.ambient).setMaterial(1, materialOf(settings), s.curvatureLut, s.shadowLut);
        } else {
            shader.setMaterial(1, materialOf(settings));
        }
        for (uint32_t i = 0; i < settings.lights; ++i) {
            if (settings.scattering)
                shader.set(i, PEL_LIGHT_WIDE_SHADOW, described(s.wideShadow.buffer, PEL_FORMAT_R32F));
            if (settings.taps)
                shader.set(i, PEL_LIGHT_SHADOW_MAP, imageDesc(s.map, PEL_FORMAT_R32F, mapSide, mapSide));
        }
        shader.commit();
    }

    reference::Rgb truth(size_t i) const {
        const auto rgb = [](const float(&v)[3]) { return reference::Rgb{v[0], v[1], v[2]}; };
        const auto at = [i](const Picture& picture) {
            const float* p = &picture.values[3 * i];
            return Vec3{p[0], p[1], p[2]};
        };
        const SkinScreen& s = *screen;
        const PelMaterial material = materialOf(settings);
        reference::Material m;
        m.albedo = at(s.albedo);
        m.diffusionRadius = material.diffusionRadius;
        m.normalBlend = rgb(material.normalBlend);
        m.shadowFilterWidth = material.shadowFilterWidth;
        m.deepScatterColor = rgb(material.deepScatterColor);
        m.deepScatterRadius = material.deepScatterRadius;
        m.specular = material.specular, m.roughness = material.roughness, m.f0 = material.f0;
        const Vec3 position = at(s.position);
        reference::Pixel pixel;
        pixel.shading = pixel.geometric = pixel.blurred = at(s.shading);
        pixel.toViewer = reference::normalized(rgb(s.camera.position) - position);
        reference::Ambient around;
        if (settings.scattering) {
            m.curvatureLut = &s.curvatureTruth, m.shadowLut = &s.shadowTruth;
            pixel.geometric = at(s.geometric), pixel.blurred = at(s.blurred);
            pixel.curvature = s.curvature.values[i];
            for (int k = 0; k < 9; ++k) around.harmonics[size_t(k)] = rgb(s.ambient.sh[k]);
        }
        std::vector<reference::PixelLight> seen;
        for (const PelLight& light : lightsOf(settings)) {
            reference::PixelLight one{rgb(light.toLight), rgb(light.color)};
            if (settings.scattering) one.wideShadow = s.wideShadow.values[i];
            if (settings.taps) {
                reference::Matrix4 matrix;
                for (size_t k = 0; k < 16; ++k) matrix[k / 4][k % 4] = light.worldToShadow[k];
                const Vec3 inside = reference::shadowCoordinates(matrix, position, pixel.geometric,
                                                                 material.deepScatterNormalOffset);
                one.hasThickness = true;
                one.thickness =
                    reference::max0(double(light.shadowDepthRange) * (inside.z - double(mapDepth)));
            }
            seen.push_back(one);
        }
        return reference::shadePixel(m, pixel, seen, around).sum();
    }

    Error error(int samples) const {
        const std::vector<float> out = screen->target.readAll<float>();
        std::mt19937 random(1);
        ErrorSum sum;
        for (int s = 0; s < samples; ++s) {
            const size_t i = random() % (out.size() / 3);
            const reference::Rgb expected = i / screen->width < rows ? truth(i) : reference::Rgb{};
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
            const uint32_t width = pass->screen->width, height = pass->screen->height;
            const bool scattering = settings.scattering;
            Case c;
            const double all = double(width) * height, covered = double(width) * pass->rows;
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
