// Error against time of the whole shading pass, over taps, size and type of the look-up tables, and storage formats, on the views
// that `pellucid demo` wrote; bench/plot shade draws it.
//
//     sweep_shade [out/demo]    prints JSON, one object a line
//
// The truth is section 6 in double precision at every 61st pixel of skin: D and T by quadrature instead of tables, thickness by
// 4,096 taps, images in float32. `error` is the RMS over pixels and channels, `largest` the largest, of linear radiance, of which
// white skin in full light gives about 1. `ms`: median device time of nine executions, all settings in turn.
#include <pellucid/pellucid.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <map>

#include "io/image/image_file.h"
#include "io/scene/scene_file.h"
#include "pack_images.h"
#include "reference/lut.h"
#include "reference/shade_pixel.h"
#include "thickness_truth.h"

using namespace pellucid;
using reference::Rgb;
using reference::Vec3;

namespace {

enum class Storage { float32, half, packed };
enum class TableType { float32, half, faceworks8 };

struct Setting {
    uint32_t taps, size;
    PelLutAxis axis = PEL_AXIS_LINEAR;
    TableType type = TableType::float32;
    Storage storage = Storage::float32;
    const char* series;  // what is varied
    const char* label;
};

const Setting settings[] = {
    {.taps = 8, .size = 512, .series = "taps", .label = "8 taps"},
    {.taps = 16, .size = 512, .series = "taps", .label = "16"},
    {.taps = 32, .size = 512, .series = "taps", .label = "32"},
    {.taps = 32, .size = 32, .series = "tables", .label = "32 x 32"},
    {.taps = 32, .size = 128, .series = "tables", .label = "128"},
    {.taps = 32, .size = 2048, .series = "tables", .label = "2048"},
    {.taps = 32, .size = 64, .axis = PEL_AXIS_ROOT, .series = "tables", .label = "64, root axis"},
    {.taps = 32, .size = 512, .type = TableType::half, .series = "table type", .label = "half"},
    {.taps = 32, .size = 512, .type = TableType::faceworks8, .series = "table type", .label = "8 bits"},
    {.taps = 32, .size = 512, .storage = Storage::half, .series = "storage", .label = "half images"},
    {.taps = 32, .size = 512, .storage = Storage::packed, .series = "storage", .label = "packed images"},
};

// A table whose texels went through a smaller type.
Lut through(const Device& device, const Lut& lut, TableType type, uint32_t width) {
    if (type == TableType::float32) return lut;
    std::vector<float> texels;
    if (type == TableType::half) {
        for (const uint16_t h : lut.read<uint16_t>(PEL_LUT_HALF)) texels.push_back(fromHalf(h));
    } else {
        const bool curvature = lut.info().kind == PEL_LUT_CURVATURE;
        const auto bytes = lut.read<uint8_t>(PEL_LUT_FACEWORKS8);
        for (size_t i = 0; i < bytes.size(); ++i) {
            if (i % 4 == 3) continue;
            const double code = bytes[i] / 255.0, column = double(i / 4 % width);
            texels.push_back(float(curvature ? std::max(0.0, (2 * column + 1) / width - 1) + (code - 0.5) / 2
                                             : reference::linearFromSrgb(code)));
        }
    }
    return Lut(device, lut.info(), texels);
}

struct View {
    io::SceneFile scene;
    io::Image image, map;
    const PelLight& light() const { return scene.lights.at(0).light; }
    const PelMaterial& material() const { return scene.materials.at(0).material; }
    const PelLutInfo& table(PelLutKind kind) const {
        const auto& m = scene.materials[0];
        return scene.lut(kind == PEL_LUT_CURVATURE ? m.curvatureLut : m.shadowLut, kind)->info;
    }
    std::vector<float> slot(PelImageSlot s) const { return image.interleaved(scene.channels[s]); }
    std::vector<float> wideShadow() const {
        return image.interleaved(std::vector{scene.lights[0].wideShadow});
    }
};

View readView(const std::string& base) {
    View v{io::readScene(base + ".toml"), io::readImage(base + "_gbuffer.exr"), {}};
    v.map = io::readImage(v.scene.lights.at(0).shadowMapFile);
    return v;
}

std::map<size_t, Rgb> truth(const View& v) {
    const PelLight& light = v.light();
    const PelMaterial& m = v.material();
    const auto position = v.slot(PEL_SLOT_POSITION), ng = v.slot(PEL_SLOT_NORMAL_GEOMETRIC),
               n = v.slot(PEL_SLOT_NORMAL_SHADING), nb = v.slot(PEL_SLOT_NORMAL_BLURRED),
               c = v.slot(PEL_SLOT_CURVATURE), albedo = v.slot(PEL_SLOT_ALBEDO),
               id = v.slot(PEL_SLOT_MATERIAL), wide = v.wideShadow();
    const auto vec = [](const float* p) { return Vec3{p[0], p[1], p[2]}; };
    const auto rgb = [](const float* p) { return Rgb{p[0], p[1], p[2]}; };

    const ThicknessTruth manyTaps(v.map, light, m);
    reference::Ambient ambient{rgb(v.scene.ambient.constant), {}};
    for (size_t i = 0; i < 9; ++i) ambient.harmonics[i] = rgb(v.scene.ambient.sh[i]);

    const PelCurvatureLutDesc curvatureDesc = v.table(PEL_LUT_CURVATURE).curvature;
    const PelShadowLutDesc shadowDesc = v.table(PEL_LUT_SHADOW).shadow;
    const auto skin = reference::skinProfile(), scaled = reference::profileForRadius(skin, 2.7);
    // One texel each: what a table of any size would say if it had no error.
    reference::ScatterTable curvature{{1, 1, {{}}}}, shadow{{1, 1, {{}}}, 1, 100, 2.7, shadowDesc.sharpening};
    reference::Material material{{},
                                 m.diffusionRadius,
                                 rgb(m.normalBlend),
                                 m.shadowFilterWidth,
                                 rgb(m.deepScatterColor),
                                 m.deepScatterRadius,
                                 m.specular,
                                 m.roughness,
                                 m.f0};
    material.curvatureLut = &curvature;
    material.shadowLut = &shadow;

    std::map<size_t, Rgb> result;
    for (size_t i = 0, seen = 0; i < v.image.pixelCount(); ++i) {
        if (id[i] == 0 || seen++ % 61) continue;
        reference::Pixel pixel{vec(&ng[3 * i]), vec(&n[3 * i]), vec(&nb[3 * i]),
                               reference::normalized(vec(v.scene.camera.position) - vec(&position[3 * i])),
                               c[i]};
        reference::PixelLight l{vec(light.toLight), rgb(light.color), wide[i], true, 0};
        l.thickness = manyTaps.at(vec(&position[3 * i]), pixel.geometric);
        const double bend =
            std::clamp(double(c[i]), 1.0 / curvatureDesc.radiusMax, 1.0 / curvatureDesc.radiusMin);
        curvature.table.texels[0] = reference::curvatureD(
            reference::Form::arc, *scaled, std::clamp(dot(pixel.blurred, l.toLight), -1.0, 1.0), 1 / bend);
        const double facing = std::clamp(dot(pixel.geometric, l.toLight), 0.0, 1.0) / m.shadowFilterWidth;
        shadow.table.texels[0] = reference::shadowT(
            *skin, wide[i],
            2.7 / skin->radius() * std::clamp(facing, 1.0 / shadowDesc.widthMax, 1.0 / shadowDesc.widthMin),
            shadowDesc.sharpening);
        material.albedo = rgb(&albedo[3 * i]);
        result[i] = shadePixel(material, pixel, {l}, ambient).sum();
    }
    return result;
}

struct Run {
    Shader shader;
    Buffer target;
    std::vector<double> times;
};

Run prepare(const Device& device, const View& v, const Setting& s) {
    const auto w = uint32_t(v.image.width), h = uint32_t(v.image.height);
    const bool packed = s.storage == Storage::packed, smaller = s.storage != Storage::float32;
    Run run{Shader(device), Buffer(device, size_t(w) * h * 12), {}};
    Shader& shader = run.shader;
    const auto set = [&](PelImageSlot slot, const auto& image, PelFormat format) {
        shader.set(slot, imageDesc(Buffer(device, image), format, w, h));
    };
    const auto setScalar = [&](PelImageSlot slot) {
        smaller ? set(slot, packing::halves(v.slot(slot)), PEL_FORMAT_R16F)
                : set(slot, v.slot(slot), PEL_FORMAT_R32F);
    };
    shader.set(PEL_SLOT_RADIANCE, imageDesc(run.target, smaller ? PEL_FORMAT_RGBA16F : PEL_FORMAT_RGB32F, w, h));
    std::vector<uint8_t> ids;
    for (const float id : v.slot(PEL_SLOT_MATERIAL)) ids.push_back(uint8_t(id));
    set(PEL_SLOT_MATERIAL, ids, PEL_FORMAT_R8_UINT);
    for (const PelImageSlot slot : {PEL_SLOT_NORMAL_GEOMETRIC, PEL_SLOT_NORMAL_SHADING, PEL_SLOT_NORMAL_BLURRED})
        packed    ? set(slot, packing::octahedral(v.slot(slot)), PEL_FORMAT_OCT16X2_SNORM)
        : smaller ? set(slot, packing::halvesOfFour(v.slot(slot)), PEL_FORMAT_RGBA16F)
                  : set(slot, v.slot(slot), PEL_FORMAT_RGB32F);
    setScalar(PEL_SLOT_CURVATURE);
    packed    ? set(PEL_SLOT_ALBEDO, packing::srgb8(v.slot(PEL_SLOT_ALBEDO)), PEL_FORMAT_RGBA8_SRGB)
    : smaller ? set(PEL_SLOT_ALBEDO, packing::halvesOfFour(v.slot(PEL_SLOT_ALBEDO)), PEL_FORMAT_RGBA16F)
              : set(PEL_SLOT_ALBEDO, v.slot(PEL_SLOT_ALBEDO), PEL_FORMAT_RGB32F);
    packed ? set(PEL_SLOT_DEPTH,
                 packing::depths(v.slot(PEL_SLOT_POSITION), v.scene.camera, v.image.width, v.image.height),
                 PEL_FORMAT_R32F)
           : set(PEL_SLOT_POSITION, v.slot(PEL_SLOT_POSITION), PEL_FORMAT_RGB32F);

    shader.set(std::vector<PelLight>{v.light()}).set(v.scene.camera).set(v.scene.ambient);
    const auto setLight = [&](PelLightSlot slot, const auto& image, PelFormat format, uint32_t width,
                              uint32_t height) {
        shader.set(0, slot, imageDesc(Buffer(device, image), format, width, height));
    };
    packed    ? setLight(PEL_LIGHT_WIDE_SHADOW, packing::unorm8(v.wideShadow()), PEL_FORMAT_R8_UNORM, w, h)
    : smaller ? setLight(PEL_LIGHT_WIDE_SHADOW, packing::halves(v.wideShadow()), PEL_FORMAT_R16F, w, h)
              : setLight(PEL_LIGHT_WIDE_SHADOW, v.wideShadow(), PEL_FORMAT_R32F, w, h);
    setLight(PEL_LIGHT_SHADOW_MAP, v.map.channels[0].pixels, PEL_FORMAT_R32F, uint32_t(v.map.width),
             uint32_t(v.map.height));

    PelCurvatureLutDesc curvature = v.table(PEL_LUT_CURVATURE).curvature;
    curvature.width = curvature.height = s.size;
    curvature.axis = s.axis;
    PelShadowLutDesc shadow = v.table(PEL_LUT_SHADOW).shadow;
    shadow.width = shadow.height = s.size;
    PelMaterial material = v.material();
    material.thicknessTaps = s.taps;
    shader.setMaterial(v.scene.materials[0].id, material,
                       through(device, Lut(device, curvature), s.type, s.size),
                       through(device, Lut(device, shadow), s.type, s.size));
    shader.commit().execute();
    return run;
}

void sweep(const Device& device, const std::string& directory, const char* name) {
    const View v = readView(directory + "/" + name);
    const auto exact = truth(v);
    std::deque<Run> runs;
    for (const Setting& s : settings) runs.push_back(prepare(device, v, s));
    for (int round = 0; round < 9; ++round)
        for (Run& run : runs) {
            run.shader.execute();
            run.times.push_back(run.shader.stats().deviceMilliseconds);
        }
    for (size_t k = 0; k < runs.size(); ++k) {
        const Setting& s = settings[k];
        std::vector<float> out;
        if (s.storage == Storage::float32)
            out = runs[k].target.readAll<float>();
        else
            for (const uint16_t half : runs[k].target.readAll<uint16_t>()) out.push_back(fromHalf(half));
        const size_t components = s.storage == Storage::float32 ? 3 : 4;
        double squares = 0, largest = 0;
        for (const auto& [i, color] : exact)
            for (size_t c = 0; c < 3; ++c) {
                const double d = out[components * i + c] - color[int(c)];
                squares += d * d;
                largest = std::max(largest, std::abs(d));
            }
        auto& t = runs[k].times;
        std::nth_element(t.begin(), t.begin() + 4, t.end());
        std::printf(
            "{\"view\": \"%s\", \"series\": \"%s\", \"label\": \"%s\", \"taps\": %u, \"ms\": %.4f, "
            "\"error\": %.4g, \"largest\": %.4g, "
            "\"pixels\": %zu}\n",
            name, s.series, s.label, s.taps, t[4], std::sqrt(squares / double(3 * exact.size())), largest,
            exact.size());
    }
}

}  // namespace

int main(int argc, char** argv) try {
    const std::string directory = argc > 1 ? argv[1] : "out/demo";
    const Device device("");
    std::fprintf(stderr, "%s\n", device.info().name);
    for (const char* view : {"key", "backlit"}) sweep(device, directory, view);
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n(./run demo writes the views)\n", e.what());
    return 1;
}
