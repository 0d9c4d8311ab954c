// Skipping changes no bit: random scenes with everything that may be there, each shaded with skipping and without, by each kind
// of tile list, and in bands.
#include <gtest/gtest.h>

#include "pass_scene.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

constexpr PelImageSlot outputs[] = {PEL_SLOT_RADIANCE, PEL_SLOT_OUT_DIFFUSE, PEL_SLOT_OUT_DEEP_SCATTER,
                                    PEL_SLOT_OUT_SPECULAR, PEL_SLOT_OUT_THICKNESS};

// What a scene has beside what all have; drawn at random, but so that two scenes have each.
struct Choices {
    bool normalMap, parts, thicknessImage, blur, filter, half, plain;
};

struct Scene {
    Frame frame;
    Choices choices;
    std::vector<float> texels, uv, tangent, target;
};

Scene randomScene(uint32_t seed, const Choices& choices) {
    Random random(seed);
    Scene s{reliefFrame(seed, 141 + seed, 50, 0.5f), choices, {}, {}, {}, {}};
    Frame& f = s.frame;
    f.curvatureLut = f.shadowLut = true;
    f.options.blurNormals = choices.blur;
    f.options.accumulate = choices.half;
    f.options.invalidColor[2] = 9;
    const auto fill = [&](Image& image, uint32_t components, float least, float most) {
        image.components = components;
        for (size_t i = 0; i < f.pixels() * components; ++i)
            image.values.push_back(random.uniform(least, most));
    };
    fill(f.slots[PEL_SLOT_CURVATURE], 1, -0.1f, 1);
    fill(f.slots[PEL_SLOT_ROUGHNESS], 1, 0.7f, 1.4f);
    if (choices.thicknessImage) fill(f.slots[PEL_SLOT_THICKNESS], 1, 0, 60);
    for (const bool spot : {false, true}) {
        Light light = mapLight(seed, spot, false, {0.5, spot ? 0.4 : -0.2, 0.9}, {24, 10, 5}, 70, 61).light;
        PelLight& l = light.params;
        if (!choices.filter) {
            l.shadowFilterTexels = 0;
            fill(light.wide, 1, -0.5f, 1.5f);
            for (float& w : light.wide.values) w = std::clamp(w, 0.0f, 1.0f);
            // Whole vectors in full shadow or full light, as most of a frame is.
            auto& wide = light.wide.values;
            for (size_t i = 0; i + 70 < wide.size(); i += 70)
                if (const uint32_t kind = random.below(3); kind > 0)
                    std::fill_n(wide.begin() + ptrdiff_t(i), 70, kind == 1 ? 0.0f : 1.0f);
        }
        if (spot) {
            l.type = PEL_LIGHT_SPOT;
            for (int c = 0; c < 3; ++c) l.position[c] = float(c == 2 ? 150 : 20), l.color[c] = 9000;
            l.spotDirection[0] = l.spotDirection[1] = 0, l.spotDirection[2] = -1;
            l.spotCosInner = 0.999f, l.spotCosOuter = 0.99f;
            l.range = 170;
        }
        f.lights.push_back(light);
    }
    for (float& c : f.ambient.constant) c = random.uniform(0.1f, 0.4f);
    for (auto& [id, m] : f.materials) {
        m.specular = choices.plain && id == 2 ? 0.0f : 0.5f;
        m.specularModel = id == 1 ? PEL_SPECULAR_GGX : PEL_SPECULAR_KSK;
        if (!(choices.plain && id == 2))
            for (float& c : m.deepScatterColor) c = random.uniform(0.1f, 0.9f);
        m.deepScatterRadius = 12;
        m.deepScatterAmbient = id == 1 ? 0.3f : 0.0f;
        m.thicknessTaps = 8;
    }
    for (int i = 0; i < 64 * 64 * 3; ++i) s.texels.push_back(random.uniform());
    for (size_t i = 0; i < f.pixels(); ++i) {
        s.uv.insert(s.uv.end(), {random.uniform(-2, 2), random.uniform(-2, 2)});
        s.tangent.insert(s.tangent.end(), {1, 0, 0});
    }
    for (size_t i = 0; i < f.pixels() * 3; ++i) s.target.push_back(random.uniform());
    for (int slot = PEL_SLOT_POSITION; slot < PEL_SLOT_OUT_DIFFUSE; ++slot)
        for (float& v : f.slots[slot].values)
            if (random.below(900) == 0) v = random.below(2) ? std::nanf("") : 1e38f;
    return s;
}

std::vector<std::vector<unsigned char>> run(const Scene& s, const PelShaderOptions& options,
                                            PelShaderStats* stats) {
    const Frame& f = s.frame;
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    shader.set(options);
    if (s.choices.plain) shader.setMaterial(2, f.materials.at(2));
    if (s.choices.normalMap) {
        shader.setNormalMap(2, {imageDesc(Buffer(device(), s.texels), PEL_FORMAT_RGB32F, 64, 64)});
        shader.set(PEL_SLOT_UV, imageDesc(Buffer(device(), s.uv), PEL_FORMAT_RG32F, f.width, f.height));
        shader.set(PEL_SLOT_TANGENT,
                   imageDesc(Buffer(device(), s.tangent), PEL_FORMAT_RGB32F, f.width, f.height));
    }
    std::vector<Buffer> targets;
    for (const PelImageSlot slot : outputs) {
        if (slot != PEL_SLOT_RADIANCE && !s.choices.parts) break;
        targets.emplace_back(device(), s.target);
        const bool scalar = slot == PEL_SLOT_OUT_THICKNESS;
        const PelFormat format = s.choices.half ? (scalar ? PEL_FORMAT_R16F : PEL_FORMAT_RGB16F)
                                                : (scalar ? PEL_FORMAT_R32F : PEL_FORMAT_RGB32F);
        shader.set(slot, imageDesc(targets.back(), format, f.width, f.height));
    }
    shader.commit().execute();
    if (stats) *stats = shader.stats();
    std::vector<std::vector<unsigned char>> bytes;
    for (const Buffer& target : targets) bytes.push_back(target.readAll<unsigned char>());
    return bytes;
}

class ShadeSkipping : public testing::TestWithParam<std::pair<const char*, Choices>> {};

TEST_P(ShadeSkipping, ChangesNoBit) {
    for (uint32_t seed : {1u, 2u}) {  // of different sizes
        const Scene s = randomScene(seed, GetParam().second);
        PelShaderOptions options = s.frame.options;
        PelShaderStats stats = pelShaderStatsDefaults();
        const auto right = run(s, options, &stats);
        EXPECT_EQ(bool(stats.features & PEL_FEATURE_NORMAL_MAP), s.choices.normalMap);
        EXPECT_EQ(bool(stats.features & PEL_FEATURE_OUTPUTS), s.choices.parts);
        EXPECT_EQ(bool(stats.features & PEL_FEATURE_THICKNESS_TAPS), !s.choices.thicknessImage);
        EXPECT_EQ(bool(stats.features & PEL_FEATURE_FILTER_SHADOW), s.choices.filter);
        for (const PelTileLists lists : {PEL_TILES_PER_VARIANT, PEL_TILES_NO_LIST}) {
            options.tileLists = lists;
            EXPECT_EQ(run(s, options, nullptr), right) << "tile lists " << int(lists);
        }
        options = s.frame.options;
        if (stats.features & (PEL_FEATURE_FILTER_SHADOW | PEL_FEATURE_NORMAL_MAP) && !s.choices.blur) {
            options.scratchBudget =
                uint64_t(s.frame.width) * (12 * s.choices.normalMap + 8 * s.choices.filter) * 8 +
                2 * 400 * 12 * s.choices.normalMap;
            PelShaderStats bands = stats;
            EXPECT_EQ(run(s, options, &bands), right) << "in bands";
            EXPECT_EQ(bands.bands, sized(7u, 2u));
        }
        options = s.frame.options;
        options.disableSkipping = 1;
        EXPECT_EQ(run(s, options, nullptr), right) << "without skipping";
    }
}

std::string nameOf(const testing::TestParamInfo<std::pair<const char*, Choices>>& info) {
    return info.param.first;
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, ShadeSkipping,
    testing::Values(std::pair{"MapOutputsThickness", Choices{true, true, true, false, false, false, false}},
                    std::pair{"BlurAndMapHalfPlain", Choices{true, false, false, true, false, true, true}},
                    std::pair{"FilteredShadowsOutputs", Choices{true, true, false, false, true, false, true}}),
    nameOf);

TEST(ShadeSkipping, TracesOfLightInFullShadowAreNone) {
    Frame f = reliefFrame(3, 100, 8, 0.5f);
    f.slots[PEL_SLOT_CURVATURE].components = 1;
    f.slots[PEL_SLOT_CURVATURE].values.assign(f.pixels(), 0.1f);
    Light light;
    light.wide.components = 1;
    light.wide.values.assign(f.pixels(), 0.0f);
    f.lights = {light};
    f.curvatureLut = f.shadowLut = true;
    for (const bool trace : {true, false}) {
        const std::vector<float> texels(size_t(3) * 96 * 64, trace ? 9e-7f : 1e-6f);
        const pellucid::Lut shadow(device(), tables().shadow.info(), texels);
        for (const uint32_t all : {0u, 1u}) {
            Shader shader(device());
            f.options.disableSkipping = all;
            setFrame(device(), shader, f, tables());
            for (const auto& [id, m] : f.materials) shader.setMaterial(id, m, tables().curvature, shadow);
            const Buffer target(device(), f.pixels() * 12);
            shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, f.width, f.height));
            shader.commit().execute();
            const auto radiance = target.readAll<float>();
            size_t some = 0;
            for (const float r : radiance) some += r > 0;
            if (trace)
                EXPECT_EQ(some, 0u);
            else
                EXPECT_GT(some, f.pixels());
        }
    }
}

}  // namespace
