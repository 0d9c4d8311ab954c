// Random frames for the shading pass, the device's answer to them, and the oracle's.
#pragma once
#include "reference/area_light.h"
#include "shade_frame.h"

namespace shade_test {

// --- the device's answer ---

inline const Tables& tables() {
    static const Tables t = makeTables(device());
    return t;
}

inline Buffer upload(const Device& device, const Image& image) {
    return Buffer(device, image.values);
}

constexpr PelFormat floatFormats[] = {PEL_FORMAT_UNDEFINED, PEL_FORMAT_R32F, PEL_FORMAT_RG32F,
                                      PEL_FORMAT_RGB32F, PEL_FORMAT_RGBA32F};

// `padded`: NaNs lie behind each pixel and each row.
inline pellucid::OwnedImage imageOf(const Device& device, const std::vector<float>& values,
                                    uint32_t components, uint32_t width, uint32_t height, bool padded) {
    if (!padded) return imageDesc(Buffer(device, values), floatFormats[components], width, height);
    const size_t pixel = components + 1, row = width * pixel + 3;
    std::vector<float> wide(row * height, std::numeric_limits<float>::quiet_NaN());
    for (size_t i = 0; i < size_t(width) * height; ++i)
        std::copy_n(&values[i * components], components, &wide[i / width * row + i % width * pixel]);
    Buffer buffer(device, wide);
    PelImageDesc desc = imageDesc(buffer, floatFormats[components], width, height);
    desc.pixelStride = uint32_t(pixel * sizeof(float)), desc.rowStride = row * sizeof(float);
    return pellucid::OwnedImage(std::move(buffer), desc);
}

// Sets everything but the output, in float32.
inline void setFrame(const Device& device, Shader& shader, const Frame& f, const Tables& tables,
                     bool padded = false) {
    const auto image = [&](const std::vector<float>& values, uint32_t components, uint32_t width,
                           uint32_t height) {
        return imageOf(device, values, components, width, height, padded);
    };
    shader.set(f.options).set(f.ambient).set(f.camera);
    if (const uint32_t size = uint32_t(f.cube.size)) {
        std::vector<float> texels;
        for (const Rgb& t : f.cube.texels) texels.insert(texels.end(), {float(t.x), float(t.y), float(t.z)});
        shader.setAmbientCube(image(texels, 3, size, 6 * size));
    }
    for (int slot = 1; slot < PEL_SLOT_COUNT; ++slot)
        if (const Image& own = f.slots[slot]; !own.values.empty())
            shader.set(PelImageSlot(slot), image(own.values, own.components, f.width, f.height));
    for (const auto& [id, material] : f.materials)
        shader.setMaterial(id, material, f.curvatureLut ? tables.curvature : pellucid::Lut(),
                           f.shadowLut ? tables.shadow : pellucid::Lut());
    std::vector<PelLight> lights;
    for (const Light& light : f.lights) lights.push_back(light.params);
    shader.set(lights);
    for (uint32_t i = 0; i < lights.size(); ++i) {
        const Light& light = f.lights[i];
        if (!light.wide.values.empty())
            shader.set(i, PEL_LIGHT_WIDE_SHADOW, image(light.wide.values, 1, f.width, f.height));
        if (!light.map.values.empty())
            shader.set(i, PEL_LIGHT_SHADOW_MAP, image(light.map.values, 1, light.mapSize, light.mapSize));
        for (const MapImage& map : light.maps)
            shader.set(i, map.slot, image(map.values, map.components, map.width, map.height));
    }
}

// Takes back all that setFrame sets.
inline void clearFrame(Shader& shader) {
    for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot) shader.clear(PelImageSlot(slot));
    for (uint32_t id = 1; id < 256; ++id)
        pellucid::check(pelShaderSetMaterial(shader.get(), id, nullptr, nullptr, nullptr));
    shader.clearAmbientCube().set(std::vector<PelLight>());
}

// An image of zeros that the shader writes: three float32 components, or one.
inline Buffer setTarget(const Device& device, Shader& shader, const Frame& f,
                        PelImageSlot slot = PEL_SLOT_RADIANCE) {
    const uint32_t components = slot == PEL_SLOT_OUT_THICKNESS ? 1 : 3;
    Buffer target(device, f.pixels() * components * sizeof(float));
    shader.set(slot, imageDesc(target, floatFormats[components], f.width, f.height));
    return target;
}

// A shader of the whole frame, and the radiance that it writes.
struct FrameShader {
    Shader shader;
    Buffer target;
};
inline FrameShader shaderOf(const Frame& f, const Device& on, const Tables& tables) {
    FrameShader made{Shader(on), {}};
    setFrame(on, made.shader, f, tables);
    made.target = setTarget(on, made.shader, f);
    return made;
}
inline FrameShader shaderOf(const Frame& f) {
    return shaderOf(f, device(), tables());
}

// On the tests' own device, with radiance into a buffer.
inline Shader& setFrame(Shader& shader, const Frame& f, const Buffer& target,
                        PelFormat format = PEL_FORMAT_RGB32F) {
    setFrame(device(), shader, f, tables());
    return shader.set(PEL_SLOT_RADIANCE, imageDesc(target, format, f.width, f.height));
}

// RGB float32 over zeros. `stats`, if given, is filled; `change` sets more on the shader before its commit.
inline std::vector<float> shade(const Device& device, const Frame& f, const Tables& tables,
                                PelShaderStats* stats = nullptr,
                                const std::function<void(Shader&)>& change = {}) {
    FrameShader made = shaderOf(f, device, tables);
    if (change) change(made.shader);
    made.shader.commit().execute();
    if (stats) *stats = made.shader.stats();
    return made.target.readAll<float>();
}

// On the tests' own device, and with the counts.
inline std::vector<float> shade(const Frame& f, PelShaderStats* stats = nullptr,
                                const std::function<void(Shader&)>& change = {}) {
    return shade(device(), f, tables(), stats, change);
}
inline std::pair<std::vector<float>, PelShaderStats> shadeCounted(const Frame& f) {
    PelShaderStats stats = pelShaderStatsDefaults();
    std::vector<float> radiance = shade(f, &stats);
    return {std::move(radiance), stats};
}
// What each light gives alone, added up.
inline std::vector<float> sumOfLights(Frame f) {
    std::vector<float> sum(3 * f.pixels());
    for (const Light& light : std::exchange(f.lights, {})) {
        f.lights = {light};
        std::ranges::transform(sum, shade(f), sum.begin(), std::plus<>());
    }
    return sum;
}

// --- the oracle's ---

inline std::string& diskFile() {
    static std::string file = PELLUCID_SOURCE_DIR "/kernels/lib/shading/poisson_disk.clh";
    return file;
}
// The kernels' table of taps, read from their source: oracle and kernel must use the same disk.
inline std::vector<reference::Vec2> diskTaps(uint32_t count) {
    static std::map<uint32_t, std::vector<reference::Vec2>> disks;
    auto& taps = disks[count];
    if (!taps.empty()) return taps;
    std::ifstream file(diskFile());
    const std::string start = "pelDisk" + std::to_string(count) + "[";
    std::string word;
    while (file >> word && word.find(start) == std::string::npos) {
    }
    double x = NAN, y = NAN;
    while (taps.size() < count && std::getline(file, word, ')') && std::getline(file, word, ')') &&
           std::sscanf(word.c_str(), "(%lff, %lff", &x, &y) == 2)
        taps.push_back({x, y});
    if (taps.size() != count) throw std::runtime_error(start + " was not found in poisson_disk.clh");
    return taps;
}

inline reference::Matrix4 matrixOf(const float (&m)[16]) {
    reference::Matrix4 out;
    for (int i = 0; i < 16; ++i) out[i / 4][i % 4] = m[i];
    return out;
}

inline reference::PixelLight truthLight(const Frame& f, const PelMaterial& material, const Light& light,
                                        size_t i) {
    const PelLight& l = light.params;
    reference::PixelLight out;
    if (l.type == PEL_LIGHT_DIRECTIONAL) {
        out.toLight = vectorOf(l.toLight);
        out.color = vectorOf(l.color);
    } else {
        out = reference::lampAt({vectorOf(l.position), vectorOf(l.color), l.range, l.type == PEL_LIGHT_SPOT,
                                 vectorOf(l.spotDirection), l.spotCosInner, l.spotCosOuter},
                                f.slots[PEL_SLOT_POSITION].vec(i));
    }
    if (!light.wide.values.empty()) out.wideShadow = light.wide.at(i);
    if (!f.slots[PEL_SLOT_THICKNESS].values.empty()) {
        out.hasThickness = true;
        out.thickness = f.slots[PEL_SLOT_THICKNESS].at(i);
    } else if (!light.map.values.empty() && material.thicknessTaps) {
        out.hasThickness = true;
        const reference::DepthDecoding decoding{l.shadowProjection == PEL_SHADOW_PERSPECTIVE,
                                                l.shadowDepthRange, l.shadowDepthA, l.shadowDepthB};
        reference::ShadowMap map{
            int(light.mapSize), int(light.mapSize), {light.map.values.begin(), light.map.values.end()}};
        const int normal = f.slots[PEL_SLOT_NORMAL_GEOMETRIC].values.empty() ? PEL_SLOT_NORMAL_SHADING
                                                                             : PEL_SLOT_NORMAL_GEOMETRIC;
        out.thickness = reference::thickness(
            map,
            reference::shadowCoordinates(matrixOf(l.worldToShadow), f.slots[PEL_SLOT_POSITION].vec(i),
                                         f.slots[normal].vec(i), material.deepScatterNormalOffset),
            f.options.rotateTaps ? reference::turnedTaps(diskTaps(material.thicknessTaps),
                                                         uint32_t(i % f.width), uint32_t(i / f.width))
                                 : diskTaps(material.thicknessTaps),
            material.thicknessFilterRadius, decoding);
    }
    return out;
}

// The light, or the parts of one with a size.
inline std::vector<reference::PixelLight> truthLights(const Frame& f, const PelMaterial& material,
                                                      const Light& light, size_t i) {
    const reference::PixelLight whole = truthLight(f, material, light, i);
    const PelLight& l = light.params;
    if (l.type < PEL_LIGHT_SPHERE) return {whole};
    reference::AreaLamp lamp{vectorOf(l.position), vectorOf(l.color), l.radius, {}, {}};
    if (l.type == PEL_LIGHT_RECTANGLE)
        lamp.halfWidth = vectorOf(l.halfWidth), lamp.halfHeight = vectorOf(l.halfHeight);
    constexpr int partsPerSide = 32;
    auto parts = reference::areaLights(lamp, f.slots[PEL_SLOT_POSITION].vec(i), partsPerSide);
    for (reference::PixelLight& part : parts) {
        part.wideShadow = whole.wideShadow;
        part.hasThickness = whole.hasThickness, part.thickness = whole.thickness;
    }
    return parts;
}

// Background pixels give nothing.
inline reference::Shaded truth(const Frame& f, const Tables& tables, size_t i) {
    const auto& s = f.slots;
    const uint32_t id = s[PEL_SLOT_MATERIAL].values.empty() ? 1 : uint32_t(s[PEL_SLOT_MATERIAL].at(i));
    const auto found = f.materials.find(id);
    if (found == f.materials.end()) return {};
    const PelMaterial& m = found->second;
    const auto value = [&](PelImageSlot slot, double otherwise) {
        return s[slot].values.empty() ? otherwise : s[slot].at(i);
    };
    reference::Material material;
    material.albedo = s[PEL_SLOT_ALBEDO].values.empty() ? vectorOf(m.albedo) : s[PEL_SLOT_ALBEDO].vec(i);
    material.diffusionRadius = m.diffusionRadius;
    material.normalBlend = vectorOf(m.normalBlend);
    material.shadowFilterWidth = m.shadowFilterWidth;
    material.deepScatterColor = vectorOf(m.deepScatterColor);
    material.deepScatterRadius = m.deepScatterRadius;
    material.specular = m.specular * value(PEL_SLOT_SPECULAR, 1);
    material.roughness = m.roughness * value(PEL_SLOT_ROUGHNESS, 1);
    material.f0 = m.f0;
    material.ggx = m.specularModel == PEL_SPECULAR_GGX;
    material.roughness2 = m.roughness2 * value(PEL_SLOT_ROUGHNESS, 1);
    material.lobeMix = m.lobeMix;
    material.deepScatterAmbient = m.deepScatterAmbient;
    const bool scatters = f.curvatureLut && !s[PEL_SLOT_CURVATURE].values.empty();
    material.curvatureLut = scatters ? &tables.curvatureTruth : nullptr;
    const bool wide = !f.lights.empty() && !f.lights[0].wide.values.empty();
    material.shadowLut = f.shadowLut && wide ? &tables.shadowTruth : nullptr;
    reference::Pixel pixel;
    // Unit to double precision: 6e-8 of length would be seen as an angle by sharp lobes.
    const auto unit = [&](PelImageSlot slot) { return normalized(s[slot].vec(i)); };
    pixel.shading = unit(PEL_SLOT_NORMAL_SHADING);
    pixel.geometric =
        s[PEL_SLOT_NORMAL_GEOMETRIC].values.empty() ? pixel.shading : unit(PEL_SLOT_NORMAL_GEOMETRIC);
    pixel.blurred =
        s[PEL_SLOT_NORMAL_BLURRED].values.empty() ? pixel.geometric : unit(PEL_SLOT_NORMAL_BLURRED);
    if (material.specular > 0) {
        pixel.toViewer = normalized(vectorOf(f.camera.position) - s[PEL_SLOT_POSITION].vec(i));
    }
    pixel.curvature = value(PEL_SLOT_CURVATURE, 0);
    pixel.ambientOcclusion = value(PEL_SLOT_AMBIENT_OCCLUSION, 1);
    if (!s[PEL_SLOT_INDIRECT].values.empty()) pixel.indirect = s[PEL_SLOT_INDIRECT].vec(i);
    pixel.hasThickness = !s[PEL_SLOT_THICKNESS].values.empty();
    pixel.thickness = value(PEL_SLOT_THICKNESS, 0);
    std::vector<reference::PixelLight> lights;
    for (const Light& light : f.lights) {
        const auto parts = truthLights(f, m, light, i);
        lights.insert(lights.end(), parts.begin(), parts.end());
    }
    reference::Ambient ambient{vectorOf(f.ambient.constant), {}};
    if (f.cube.size) ambient.cube = &f.cube;
    for (int k = 0; k < 9; ++k) ambient.harmonics[k] = vectorOf(f.ambient.sh[k]);
    reference::Shaded shaded = reference::shadePixel(material, pixel, lights, ambient);
    if (!scatters) {
        // Without a curvature table direct light is Lambert's, of the shading normal.
        reference::Pixel plain = pixel;
        plain.blurred = plain.shading;
        shaded.scattered = reference::shadePixel(material, plain, lights, ambient).scattered;
    }
    return shaded;
}

// Largest difference from the oracle of RGB float32 pixels.
inline double worstError(const Frame& f, const std::vector<float>& result) {
    double worst = 0;
    for (size_t i = 0; i < f.pixels(); ++i) {
        const Rgb sum = truth(f, tables(), i).sum();
        for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(sum[c] - result[3 * i + c]));
    }
    return worst;
}

}  // namespace shade_test
