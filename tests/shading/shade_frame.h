// Random frames for the shading pass.
#pragma once
#include "tools.h"

#include "faceworks_material.h"
#include "reference/shade.h"

namespace shade_test {

using pellucid::Buffer;
using pellucid::Device;
using pellucid::imageDesc;
using pellucid::Shader;
using reference::Rgb;
using reference::Vec3;

// A curvature and a shadow table, on the device and as the oracle takes them.
struct Tables {
    pellucid::Lut curvature, shadow;
    reference::ScatterTable curvatureTruth, shadowTruth;
};

inline reference::Table readTable(const pellucid::Lut& lut, uint32_t width, uint32_t height) {
    const auto texels = lut.read<float>(PEL_LUT_FLOAT);
    reference::Table table{int(width), int(height), {}};
    for (size_t i = 0; i < size_t(width) * height; ++i)
        table.texels.push_back({texels[3 * i], texels[3 * i + 1], texels[3 * i + 2]});
    return table;
}

inline Tables makeTables(const pellucid::Device& device, uint32_t width = 96, uint32_t height = 64) {
    PelCurvatureLutDesc c = pelCurvatureLutDescFaceWorks();
    PelShadowLutDesc s = pelShadowLutDescFaceWorks();
    c.diffusionRadius = s.diffusionRadius = 2.7f;  // skin's own, which the oracle wants to know
    c.width = s.width = width;
    c.height = s.height = height;
    Tables t{pellucid::Lut(device, c), pellucid::Lut(device, s), {}, {}};
    t.curvatureTruth = {readTable(t.curvature, width, height), c.radiusMin, c.radiusMax, c.diffusionRadius,
                        0};
    t.shadowTruth = {readTable(t.shadow, width, height), s.widthMin, s.widthMax, s.diffusionRadius,
                     s.sharpening};
    return t;
}

inline Vec3 vectorOf(const float* three) {
    return {three[0], three[1], three[2]};
}
inline void copyTo(float* three, Vec3 v) {
    for (int c = 0; c < 3; ++c) three[c] = float(v[c]);
}

// One image of a frame: rows of `components` floats, as many as the format has.
struct Image {
    uint32_t components = 0;
    std::vector<float> values;
    double at(size_t pixel, uint32_t c = 0) const { return values[pixel * components + c]; }
    Vec3 vec(size_t pixel) const { return {at(pixel, 0), at(pixel, 1), at(pixel, 2)}; }
    // Of three components.
    void set(size_t pixel, Vec3 v) { copyTo(&values[3 * pixel], v); }
    void push(Vec3 v) {
        values.resize(values.size() + 3);
        copyTo(values.data() + values.size() - 3, v);
    }
};

// With explicit filter parameters, as an oracle takes them, and no wide shadow from a shadow map.
inline PelLight plainLight() {
    PelLight l = pelLightDefaults();
    l.shadowFilterTexels = 0;
    l.shadowBias = 0.5f, l.shadowSoftness = 0.25f, l.shadowConeSlope = 0.5f;
    return l;
}

// Without interpolation, which the oracle does not have. Nearly all tests count pixels, because each choice
// is a separate program, and compiling takes most of the tests' time.
inline PelShaderOptions exactOptions() {
    PelShaderOptions o = pelShaderOptionsDefaults();
    o.everyPixel = o.countPixels = 1;
    return o;
}

// A shadow map of any shape, or one of a light's cascades.
struct MapImage {
    PelLightSlot slot;
    uint32_t width, height, components;
    std::vector<float> values;
};

struct Light {
    PelLight params = plainLight();
    Image wide;  // empty: none
    uint32_t mapSize = 0;
    Image map;                   // a square shadow map, or
    std::vector<MapImage> maps;  // all maps
};

struct Frame {
    uint32_t width = 0, height = 0;
    Image slots[PEL_SLOT_COUNT];  // empty ones are not set
    std::vector<Light> lights;
    std::map<uint32_t, PelMaterial> materials;
    PelAmbient ambient = pelAmbientDefaults();
    reference::CubeMap cube;  // ambient light; size 0: none
    PelCamera camera = pelCameraDefaults();
    PelShaderOptions options = exactOptions();
    bool curvatureLut = true, shadowLut = true;
    size_t pixels() const { return size_t(width) * height; }
};

class Random {
  public:
    explicit Random(uint32_t seed) : engine_(seed) {}
    float uniform(float least = 0, float most = 1) {
        return least + (most - least) * float(engine_() >> 8) * 0x1p-24f;
    }
    uint32_t below(uint32_t count) { return uint32_t(engine_() % count); }
    Vec3 unit() {
        for (;;) {
            const Vec3 v{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
            if (const double length2 = dot(v, v); length2 <= 1 && length2 >= 0.01) return normalized(v);
        }
    }

  private:
    std::mt19937 engine_;
};

// Every input random and valid: normals within a cone of each other and seen from the front, w often 0 or 1,
// curvature also outside the table, ids 0 (background), 1, 2 and 7 in runs as real frames have them.
inline Frame randomFrame(uint32_t seed, uint32_t width, uint32_t height, uint32_t lights = 1) {
    Random random(seed);
    Frame f;
    f.width = width;
    f.height = height = sizedRows(width, height);
    const auto fill = [&](Image& image, uint32_t components, auto value) {
        image.components = components;
        image.values.resize(f.pixels() * components);
        for (float& v : image.values) v = value();
    };
    auto& s = f.slots;
    for (float& p : f.camera.position) p = random.uniform(150, 300);
    fill(s[PEL_SLOT_POSITION], 3, [&] { return random.uniform(-100, 100); });
    for (int slot : {PEL_SLOT_NORMAL_GEOMETRIC, PEL_SLOT_NORMAL_SHADING, PEL_SLOT_NORMAL_BLURRED})
        fill(s[slot], 3, [] { return 0.0f; });
    for (size_t i = 0; i < f.pixels(); ++i) {
        Vec3 base = random.unit();
        if (dot(base, vectorOf(f.camera.position) - s[PEL_SLOT_POSITION].vec(i)) < 0) base = -1 * base;
        for (int slot : {PEL_SLOT_NORMAL_GEOMETRIC, PEL_SLOT_NORMAL_SHADING, PEL_SLOT_NORMAL_BLURRED})
            s[slot].set(i, normalized(base + 0.4 * random.unit()));
    }
    fill(s[PEL_SLOT_CURVATURE], 1, [&] { return random.uniform(-0.1f, 1.2f); });
    fill(s[PEL_SLOT_ALBEDO], 3, [&] { return random.uniform(); });
    fill(s[PEL_SLOT_AMBIENT_OCCLUSION], 1, [&] { return random.uniform(); });
    fill(s[PEL_SLOT_ROUGHNESS], 1, [&] { return random.uniform(0.7f, 1.5f); });
    fill(s[PEL_SLOT_SPECULAR], 1, [&] { return random.uniform(); });
    uint32_t run = 0, id = 0;
    fill(s[PEL_SLOT_MATERIAL], 1, [&] {
        constexpr uint32_t ids[] = {0, 1, 2, 7};
        if (run-- == 0) run = random.below(40), id = ids[random.below(4)];
        return float(id);
    });
    for (uint32_t known : {1u, 2u, 7u}) {
        PelMaterial m = fixture::faceworksMaterial();
        m.diffusionRadius = known == 1 ? 2.7f : random.uniform(1, 5);
        for (float& c : m.deepScatterColor) c = random.uniform(0.1f, 1);
        m.deepScatterRadius = random.uniform(15, 40);  // of the order of the random thickness
        m.specular = random.uniform(0.2f, 1);
        m.thicknessTaps = known == 7 ? 16 : known == 2 ? 8 : 32;
        if (known == 7)
            for (float& b : m.normalBlend) b = random.uniform();
        f.materials[known] = m;
    }
    for (uint32_t i = 0; i < lights; ++i) {
        Light light;
        PelLight& l = light.params;
        l.type = PelLightType(i % 3);
        copyTo(l.toLight, random.unit());
        copyTo(l.spotDirection, random.unit());
        copyTo(l.position, 300 * random.unit());  // light of order 1 in the cube of positions
        const float power = l.type == PEL_LIGHT_DIRECTIONAL ? 1.0f : 20000.0f;
        for (float& c : l.color) c = power * random.uniform(0.2f, 1);
        if (l.type == PEL_LIGHT_POINT) l.range = 280;
        l.spotCosInner = 0.8f;
        l.spotCosOuter = 0.2f;
        fill(light.wide, 1, [&] { return std::clamp(random.uniform(-0.6f, 1.6f), 0.0f, 1.0f); });
        light.mapSize = 61;
        light.map.components = 1;
        light.map.values.resize(61 * 61);
        for (float& z : light.map.values) z = random.uniform(0.4f, 0.52f);
        // (x, y, z) / 200 + 1/2 sheared a little; perspective: w = distance, depth = a + b / w
        const bool perspective = i % 2;
        l.shadowProjection = perspective ? PEL_SHADOW_PERSPECTIVE : PEL_SHADOW_PARALLEL;
        if (perspective) {
            const float n = 100, far = 700, a = far / (far - n);  // left-handed: z = a - n a / w
            const float rows[16] = {1.2f, 0.1f, 0.5f, 150, 0, 1.1f, 0.5f, 150, 0, 0, a, 300 * a - n * a,
                                    0,    0,    1,    300};
            std::copy_n(rows, 16, l.worldToShadow);
            l.shadowDepthA = -(far - n) / (n * far);
            l.shadowDepthB = 1 / n;
            for (float& z : light.map.values) z = a * (1 - n / random.uniform(270, 305));
        } else {
            const float rows[16] = {0.005f, 0,       0.0005f, 0.5f, 0, 0.005f, 0, 0.5f,
                                    0,      0.0001f, 0.005f,  0.5f, 0, 0,      0, 1};
            std::copy_n(rows, 16, l.worldToShadow);
            l.shadowDepthRange = 200;
        }
        f.lights.push_back(std::move(light));
    }
    for (float& c : f.ambient.constant) c = random.uniform(0.1f, 0.4f);
    for (auto& basis : f.ambient.sh)
        for (float& c : basis) c = random.uniform(-0.3f, 0.3f);
    return f;
}

}  // namespace shade_test
