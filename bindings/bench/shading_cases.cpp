// The pass over a screen of folded skin, by what is switched on, against the sum of section 6 in double
// precision.
#include <random>

#include "case.h"
#include "reference/shade_pixel.h"

namespace pellucid::bench {
namespace {

using reference::Vec3;

constexpr float mapDepth = 0.45f;  // the shadow map is one plane, so that truth needs no taps
constexpr float toLight[3] = {0.8f, 0.36f, 0.48f}, eye[3] = {0, 0, 600};
constexpr float worldToShadow[16] = {0.004f, 0, 0, 0.5f, 0, 0.004f, 0, 0.5f, 0, 0, -0.004f, 0.5f, 0, 0, 0, 1};
constexpr float depthRange = 250;

struct Frame {
    uint32_t width, height;
    std::vector<float> position, geometric, shading, blurred, curvature, albedo, wide;
    Buffer positionBuffer, geometricBuffer, shadingBuffer, blurredBuffer, curvatureBuffer, albedoBuffer,
        wideBuffer, map;
    Lut curvatureLut, shadowLut;
    reference::ScatterTable curvatureTruth, shadowTruth;

    Vec3 at(const std::vector<float>& image, size_t i) const {
        return {image[3 * i], image[3 * i + 1], image[3 * i + 2]};
    }

    Frame(const Device& device, uint32_t w, uint32_t h) : width(w), height(h) {
        const auto unit = [](std::vector<float>& to, float x, float y) {
            const float length = std::sqrt(x * x + y * y + 1);
            to.insert(to.end(), {x / length, y / length, 1 / length});
        };
        for (uint32_t row = 0; row < h; ++row)
            for (uint32_t column = 0; column < w; ++column) {
                const float x = float(column), y = float(row);
                const float a = 1.6f * std::sin(x / 110), b = 1.2f * std::cos(y / 85);
                position.insert(position.end(), {0.1f * (x - 0.5f * float(w)), 0.1f * (0.5f * float(h) - y),
                                                 12 * std::sin((x + y) / 150)});
                unit(geometric, a, b);
                unit(shading, a + 0.1f * std::sin(x / 3), b + 0.1f * std::sin(y / 4));
                unit(blurred, 0.9f * a, 0.9f * b);
                curvature.push_back(0.05f + 0.02f * float((column / 7 + row / 5) % 10));
                albedo.insert(albedo.end(), {0.8f, 0.5f, 0.4f});
                wide.push_back(std::clamp(0.5f + 3 * std::sin((x - y) / 140), 0.0f, 1.0f));
            }
        positionBuffer = Buffer(device, position), geometricBuffer = Buffer(device, geometric);
        shadingBuffer = Buffer(device, shading), blurredBuffer = Buffer(device, blurred);
        curvatureBuffer = Buffer(device, curvature), albedoBuffer = Buffer(device, albedo),
        wideBuffer = Buffer(device, wide);
        map = Buffer(device, std::vector<float>(1024 * 1024, mapDepth));
        const PelCurvatureLutDesc c = pelCurvatureLutDescFaceWorks();
        const PelShadowLutDesc s = pelShadowLutDescFaceWorks();
        curvatureLut = Lut(device, c), shadowLut = Lut(device, s);
        curvatureTruth = {table(curvatureLut), c.radiusMin, c.radiusMax, 2.7, 0};
        shadowTruth = {table(shadowLut), s.widthMin, s.widthMax, 2.7, s.sharpening};
    }

  private:
    static reference::Table table(const Lut& lut) {
        const std::vector<float> texels = lut.read<float>(PEL_LUT_FLOAT);
        reference::Table table{512, 512, {}};
        for (size_t i = 0; i < texels.size(); i += 3)
            table.texels.push_back({texels[i], texels[i + 1], texels[i + 2]});
        return table;
    }
};

struct Variant {
    bool scattering = true;
    uint32_t taps = 0, lights = 1, coverage = 100;  // coverage: percent of the rows, from the top
};

// The settings of a variant, for the device and for the oracle.
struct Pass {
    std::shared_ptr<Frame> frame;
    Variant variant;
    // The oracle takes these unchanged.
    PelMaterial material = [] {
        PelMaterial m = pelMaterialDefaults();
        m.diffusionRadius = 2.7f;
        m.shadowFilterWidth = 8;
        m.normalBlend[0] = 1, m.normalBlend[1] = 0.3f, m.normalBlend[2] = 0;
        return m;
    }();
    PelAmbient ambient = pelAmbientDefaults();
    std::vector<PelLight> lights;
    uint32_t rows = 0;
    Shader shader;
    Buffer target;

    Pass(const Device& device, std::shared_ptr<Frame> f, Variant v)
        : frame(std::move(f)), variant(v), shader(device) {
        const uint32_t w = frame->width, h = frame->height;
        rows = h * v.coverage / 100;
        target = Buffer(device, size_t(w) * h * 12);
        material.specular = 0.8f;
        material.thicknessTaps = v.taps;
        const float color[3] = {0.9f, 0.4f, 0.3f};
        if (v.taps) std::copy_n(color, 3, material.deepScatterColor);
        for (int i = 0; i < 9; ++i)
            for (int c = 0; c < 3; ++c) ambient.sh[i][c] = 0.3f / float(1 + i + c);
        for (uint32_t i = 0; i < v.lights; ++i) {
            PelLight light = pelLightDefaults();
            std::copy_n(toLight, 3, light.toLight);
            if (i) std::swap(light.toLight[i % 3], light.toLight[(i + 1) % 3]);
            std::copy_n(worldToShadow, 16, light.worldToShadow);
            light.shadowDepthRange = depthRange;
            lights.push_back(light);
        }
        std::vector<uint8_t> ids(size_t(w) * h);
        std::fill_n(ids.begin(), size_t(w) * rows, uint8_t(1));
        PelCamera camera = pelCameraDefaults();
        std::copy_n(eye, 3, camera.position);
        const auto set = [&](PelImageSlot slot, const Buffer& image, PelFormat format) {
            shader.set(slot, imageDesc(image, format, w, h));
        };
        set(PEL_SLOT_RADIANCE, target, PEL_FORMAT_RGB32F);
        set(PEL_SLOT_MATERIAL, Buffer(device, ids), PEL_FORMAT_R8_UINT);
        set(PEL_SLOT_POSITION, frame->positionBuffer, PEL_FORMAT_RGB32F);
        set(PEL_SLOT_NORMAL_SHADING, frame->shadingBuffer, PEL_FORMAT_RGB32F);
        set(PEL_SLOT_ALBEDO, frame->albedoBuffer, PEL_FORMAT_RGB32F);
        shader.set(lights).set(camera);
        if (!v.scattering) {
            shader.setMaterial(1, material);
        } else {
            set(PEL_SLOT_NORMAL_GEOMETRIC, frame->geometricBuffer, PEL_FORMAT_RGB32F);
            set(PEL_SLOT_NORMAL_BLURRED, frame->blurredBuffer, PEL_FORMAT_RGB32F);
            set(PEL_SLOT_CURVATURE, frame->curvatureBuffer, PEL_FORMAT_R32F);
            shader.set(ambient).setMaterial(1, material, frame->curvatureLut, frame->shadowLut);
            for (uint32_t i = 0; i < v.lights; ++i) {
                shader.set(i, PEL_LIGHT_WIDE_SHADOW, imageDesc(frame->wideBuffer, PEL_FORMAT_R32F, w, h));
                if (v.taps)
                    shader.set(i, PEL_LIGHT_SHADOW_MAP, imageDesc(frame->map, PEL_FORMAT_R32F, 1024, 1024));
            }
        }
        shader.commit();
    }

    reference::Rgb truth(size_t i) const {
        const auto rgb = [](const float(&v)[3]) { return reference::Rgb{v[0], v[1], v[2]}; };
        reference::Material m;
        m.albedo = frame->at(frame->albedo, i);
        m.diffusionRadius = material.diffusionRadius;
        m.normalBlend = rgb(material.normalBlend);
        m.shadowFilterWidth = material.shadowFilterWidth;
        m.deepScatterColor = rgb(material.deepScatterColor);
        m.deepScatterRadius = material.deepScatterRadius;
        m.specular = material.specular, m.roughness = material.roughness, m.f0 = material.f0;
        const Vec3 position = frame->at(frame->position, i);
        reference::Pixel pixel;
        pixel.shading = pixel.geometric = pixel.blurred = frame->at(frame->shading, i);
        pixel.toViewer = reference::normalized(Vec3{eye[0], eye[1], eye[2]} - position);
        reference::Ambient around;
        if (variant.scattering) {
            m.curvatureLut = &frame->curvatureTruth, m.shadowLut = &frame->shadowTruth;
            pixel.geometric = frame->at(frame->geometric, i), pixel.blurred = frame->at(frame->blurred, i);
            pixel.curvature = frame->curvature[i];
            for (int k = 0; k < 9; ++k) around.harmonics[size_t(k)] = rgb(ambient.sh[k]);
        }
        std::vector<reference::PixelLight> seen;
        for (const PelLight& light : lights) {
            reference::PixelLight one{rgb(light.toLight), rgb(light.color)};
            if (variant.scattering) one.wideShadow = frame->wide[i];
            if (variant.taps) {
                reference::Matrix4 matrix;
                for (size_t k = 0; k < 16; ++k) matrix[k / 4][k % 4] = worldToShadow[k];
                const Vec3 inside = reference::shadowCoordinates(matrix, position, pixel.geometric,
                                                                 material.deepScatterNormalOffset);
                one.hasThickness = true;
                one.thickness = reference::max0(double(depthRange) * (inside.z - double(mapDepth)));
            }
            seen.push_back(one);
        }
        return reference::shadePixel(m, pixel, seen, around).sum();
    }

    Error error(int samples) const {
        const std::vector<float> out = target.readAll<float>();
        std::mt19937 random(1);
        ErrorSum sum;
        for (int s = 0; s < samples; ++s) {
            const size_t i = random() % (out.size() / 3);
            const reference::Rgb expected = i / frame->width < rows ? truth(i) : reference::Rgb{};
            for (int c = 0; c < 3; ++c) sum.add(out[3 * i + size_t(c)] - expected[c]);
        }
        return sum.result();
    }
};

}  // namespace

std::vector<Factory> shadingCases(const Device& device, Size size) {
    const auto made = std::make_shared<std::shared_ptr<Frame>>();
    const auto frame = [=] {
        if (!*made)
            *made = size.quick ? std::make_shared<Frame>(device, 480, 270)
                               : std::make_shared<Frame>(device, 1920, 1080);
        return *made;
    };
    const auto variant = [=](Variant v) {
        return [=] {
            const auto pass = std::make_shared<Pass>(device, frame(), v);
            Case c;
            const double all = double(pass->frame->width) * pass->frame->height,
                         covered = double(pass->frame->width) * pass->rows;
            c.what = std::to_string(pass->frame->width) + "x" + std::to_string(pass->frame->height) + ", " +
                     std::to_string(v.coverage) + " % skin";
            c.items = all;
            c.unit = "pixels";
            // Id; position, shading normal, albedo and result; two more normals, curvature and the wide
            // shadows.
            c.bytes = all + covered * (4 * 12 + (v.scattering ? 2 * 12 + 4 + 4 * v.lights : 0));
            // Per light: four cosines, two table look-ups, specular with its half vector; thickness and its
            // taps. Per pixel: normals and nine harmonics of three of them.
            const double perLight = v.scattering ? 150.0 + (v.taps ? 40 + 23.0 * v.taps : 0) : 60;
            c.operations = covered * (v.lights * perLight + (v.scattering ? 200 : 15));
            c.run = [=] { pass->shader.execute(); };
            const int samples = size.quick ? 500 : 4000;
            c.error = [=] { return pass->error(samples); };
            c.truth = "section 6 in double precision with the same tables at drawn pixels; absolute";
            return c;
        };
    };
    return {{"shade-plain", "shading", variant({false, 0, 1, 100})},
            {"shade-surface", "shading", variant({true, 0, 1, 100})},
            {"shade-8-taps", "shading", variant({true, 8, 1, 100})},
            {"shade-32-taps", "shading", variant({true, 32, 1, 100})},
            {"shade-4-lights", "shading", variant({true, 0, 4, 100})},
            {"shade-10-percent", "shading", variant({true, 32, 1, 10})},
            {"shade-no-skin", "shading", variant({true, 32, 1, 0})}};
}

}  // namespace pellucid::bench
