// The pass over a screen of folded skin, by what is switched on, against the sum of section 6 in double
// precision.
#include <random>

#include "frames.h"
#include "measure.h"
#include "reference/shade.h"

namespace pellucid::bench {
namespace {

using reference::Vec3;

// The shadow map is flat, so that the truth needs no taps.
struct SkinFrame : Frame {
    reference::ScatterTable curvatureTruth, shadowTruth;

    SkinFrame(const Device& device, uint32_t width, uint32_t height)
        : Frame(device, foldedSkin(width, height, 0)) {
        const PelCurvatureLutDesc c = pelCurvatureLutDescFaceWorks();
        const PelShadowLutDesc s = pelShadowLutDescFaceWorks();
        curvatureTruth = {table(curvatureLut()), c.radiusMin, c.radiusMax, 2.7, 0};
        shadowTruth = {table(shadowLut()), s.widthMin, s.widthMax, 2.7, s.sharpening};
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

// One variant of the pass. `coverage`: percent of the rows, from the top, that are skin.
struct Pass {
    std::shared_ptr<SkinFrame> frame;
    FrameSettings settings;
    uint32_t rows;
    Shader shader;

    Pass(std::shared_ptr<SkinFrame> f, FrameSettings s, uint32_t coverage)
        : frame(std::move(f)),
          settings(std::move(s)),
          rows(images().height * coverage / 100),
          shader(make()) {}

    const FrameImages& images() const { return frame->images(); }
    bool scattering() const { return settings.terms == Terms::scattering; }

    Shader make() {
        settings.ids.assign(images().id.size(), 0);
        std::fill_n(settings.ids.begin(), size_t(images().width) * rows, uint8_t(1));
        const std::vector<float> black(images().position.size());  // what other passes left is no result
        frame->target().write(black.data(), black.size() * sizeof(float));
        return frame->shader(settings);
    }

    reference::Rgb truth(size_t i) const {
        const auto rgb = [](const float(&v)[3]) { return reference::Rgb{v[0], v[1], v[2]}; };
        const auto at = [i](const std::vector<float>& image) {
            return Vec3{image[3 * i], image[3 * i + 1], image[3 * i + 2]};
        };
        const FrameImages& f = images();
        const PelMaterial material = frame->material(settings);
        reference::Material m;
        m.albedo = at(f.albedo);
        m.diffusionRadius = material.diffusionRadius;
        m.normalBlend = rgb(material.normalBlend);
        m.shadowFilterWidth = material.shadowFilterWidth;
        m.deepScatterColor = rgb(material.deepScatterColor);
        m.deepScatterRadius = material.deepScatterRadius;
        m.specular = material.specular, m.roughness = material.roughness, m.f0 = material.f0;
        const Vec3 position = at(f.position);
        reference::Pixel pixel;
        pixel.shading = pixel.geometric = pixel.blurred = at(f.shading);
        pixel.toViewer = reference::normalized(rgb(f.camera.position) - position);
        reference::Ambient around;
        if (scattering()) {
            m.curvatureLut = &frame->curvatureTruth, m.shadowLut = &frame->shadowTruth;
            pixel.geometric = at(f.geometric), pixel.blurred = at(f.blurred);
            pixel.curvature = f.curvature[i];
            for (int k = 0; k < 9; ++k) around.harmonics[size_t(k)] = rgb(f.ambient.sh[k]);
        }
        std::vector<reference::PixelLight> seen;
        for (const PelLight& light : frame->lights(settings)) {
            reference::PixelLight one{rgb(light.toLight), rgb(light.color)};
            if (scattering()) one.wideShadow = f.wideShadow[i];
            if (settings.taps) {
                reference::Matrix4 matrix;
                for (size_t k = 0; k < 16; ++k) matrix[k / 4][k % 4] = light.worldToShadow[k];
                const Vec3 inside = reference::shadowCoordinates(matrix, position, pixel.geometric,
                                                                 material.deepScatterNormalOffset);
                one.hasThickness = true;
                one.thickness =
                    reference::max0(double(light.shadowDepthRange) * (inside.z - double(flatMapDepth)));
            }
            seen.push_back(one);
        }
        return reference::shadePixel(m, pixel, seen, around).sum();
    }

    Error error(int samples) const {
        const std::vector<float> out = frame->target().readAll<float>();
        std::mt19937 random(1);
        ErrorSum sum;
        for (int s = 0; s < samples; ++s) {
            const size_t i = random() % (out.size() / 3);
            const reference::Rgb expected = i / images().width < rows ? truth(i) : reference::Rgb{};
            for (int c = 0; c < 3; ++c) sum.add(out[3 * i + size_t(c)] - expected[c]);
        }
        return sum.result();
    }
};

}  // namespace

std::vector<Factory> shadingCases(const Device& device, bool quick) {
    const auto made = std::make_shared<std::shared_ptr<SkinFrame>>();
    const auto frame = [=] {
        if (!*made)
            *made = quick ? std::make_shared<SkinFrame>(device, 480, 270)
                          : std::make_shared<SkinFrame>(device, 1920, 1080);
        return *made;
    };
    const auto variant = [=](const FrameSettings& settings, uint32_t coverage = 100) {
        return [=] {
            const auto pass = std::make_shared<Pass>(frame(), settings, coverage);
            const FrameImages& f = pass->images();
            const bool scattering = pass->scattering();
            Case c;
            const double all = double(f.width) * f.height, covered = double(f.width) * pass->rows;
            c.what = std::to_string(f.width) + "x" + std::to_string(f.height) + ", " +
                     std::to_string(coverage) + " % skin";
            c.items = all;
            c.unit = "pixels";
            // Id; position, shading normal, albedo and result; two more normals, curvature and the wide
            // shadows.
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
    return {{"shade-plain", "shading", variant({.terms = Terms::plain})},
            {"shade-surface", "shading", variant({})},
            {"shade-8-taps", "shading", variant({.taps = 8})},
            {"shade-32-taps", "shading", variant({.taps = 32})},
            {"shade-4-lights", "shading", variant({.lights = 4})},
            {"shade-10-percent", "shading", variant({.taps = 32}, 10)},
            {"shade-no-skin", "shading", variant({.taps = 32}, 0)}};
}

}  // namespace pellucid::bench
