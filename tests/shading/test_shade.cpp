// The shading pass against the oracle: each term alone, their sum, outputs besides radiance, irradiance per
// pixel. Layouts of images, and the content of the target, must not change a bit.
#include "device_lanes.h"
#include "shade_scene.h"

using namespace shade_test;

namespace {

// What is in the frame; else only Lambert's light.
enum Part : uint32_t {
    CURVATURE = 1,
    WIDE = 2,
    LUT = 4,
    AMBIENT = 8,
    DEEP = 16,
    SPECULAR = 32,
    THICKNESS = 64
};

struct Term {
    const char* name;
    uint32_t features, parts;
    std::function<void(Frame&)> change = [](Frame&) {};
};
void PrintTo(const Term& term, std::ostream* out) {
    *out << term.name;
}

void scaleThickness(Frame& f, float most) {
    f.slots[PEL_SLOT_THICKNESS] = f.slots[PEL_SLOT_AMBIENT_OCCLUSION];
    for (float& t : f.slots[PEL_SLOT_THICKNESS].values) t *= most;
}
void blacken(float (&color)[3]) {
    std::fill_n(color, 3, 0.0f);
}

constexpr uint32_t tapped = PEL_FEATURE_DEEP_SCATTER | PEL_FEATURE_THICKNESS_TAPS;
const Term terms[] = {
    {"Lambert", 0, 0},
    {"Direct", PEL_FEATURE_DIRECT_SCATTER, CURVATURE},
    {"PlainShadow", PEL_FEATURE_DIRECT_SCATTER | PEL_FEATURE_SHADOW, CURVATURE | WIDE},
    {"ShadowLut", PEL_FEATURE_SHADOW | PEL_FEATURE_SHADOW_LUT, WIDE | LUT},
    {"Ambient", PEL_FEATURE_AMBIENT, AMBIENT},
    {"Indirect", PEL_FEATURE_AMBIENT, AMBIENT,
     [](Frame& f) { f.slots[PEL_SLOT_INDIRECT] = f.slots[PEL_SLOT_ALBEDO]; }},
    {"IndirectAlone", PEL_FEATURE_AMBIENT, AMBIENT,
     [](Frame& f) {
         f.ambient = pelAmbientDefaults();
         f.slots[PEL_SLOT_INDIRECT] = f.slots[PEL_SLOT_ALBEDO];
     }},
    {"AmbientConstantWithoutIds", PEL_FEATURE_AMBIENT, AMBIENT,
     [](Frame& f) {
         std::memset(f.ambient.sh, 0, sizeof f.ambient.sh);
         f.slots[PEL_SLOT_MATERIAL] = {};
     }},
    {"DeepScatterTaps", tapped, DEEP},
    {"DeepScatterTurnedTaps", tapped, DEEP, [](Frame& f) { f.options.rotateTaps = 1; }},
    {"DeepScatterImage", PEL_FEATURE_DEEP_SCATTER, DEEP | THICKNESS},
    {"DeepScatterAmbient", PEL_FEATURE_AMBIENT | PEL_FEATURE_AMBIENT_SCATTER, AMBIENT | DEEP | THICKNESS,
     [](Frame& f) {
         for (auto& [id, m] : f.materials) m.deepScatterAmbient = 0.1f * float(id);
     }},
    // There are shadow maps and taps, but they measure along the lights.
    {"NoAmbientScatterWithoutAThicknessImage", PEL_FEATURE_AMBIENT | tapped, DEEP,
     [](Frame& f) {
         f.ambient.constant[0] = 0.3f;
         for (auto& [id, m] : f.materials) m.deepScatterAmbient = 0.7f;
     }},
    {"SpecularGgx", PEL_FEATURE_SPECULAR | PEL_FEATURE_SHADOW | PEL_FEATURE_GGX, SPECULAR | WIDE,
     [](Frame& f) {
         for (auto& [id, m] : f.materials) {
             if (id == 2) continue;  // one material of the other model
             m.specularModel = PEL_SPECULAR_GGX;
             m.roughness2 = 0.1f * float(id);
         }
     }},
    {"Specular", PEL_FEATURE_SPECULAR | PEL_FEATURE_SHADOW, SPECULAR | WIDE}};

class ShadeTerm : public testing::TestWithParam<Term> {};

TEST_P(ShadeTerm, MatchesTheOracle) {
    Frame f = randomFrame(11, 203, 77, 3);
    const auto has = [](Part part) { return (GetParam().parts & part) != 0; };
    if (!has(CURVATURE)) f.slots[PEL_SLOT_CURVATURE] = {};
    f.shadowLut = has(LUT);
    if (has(AMBIENT))
        f.lights.clear();
    else
        f.ambient = pelAmbientDefaults();
    for (Light& light : f.lights)
        if (!has(WIDE)) light.wide = {};
    if (has(THICKNESS)) scaleThickness(f, 60);
    if (has(SPECULAR)) f.slots[PEL_SLOT_ALBEDO].values.assign(f.pixels() * 3, 0.0f);
    for (auto& [id, m] : f.materials) {
        if (!has(SPECULAR)) m.specular = 0;
        if (!has(DEEP)) blacken(m.deepScatterColor);
    }
    GetParam().change(f);
    const auto [result, stats] = shadeCounted(f);
    EXPECT_EQ(stats.features, GetParam().features);
    EXPECT_LE(worstError(f, result), tolerance::shadeTerm);
    EXPECT_GT(*std::max_element(result.begin(), result.end()), 0.01f) << "the term is there at all";
}

INSTANTIATE_TEST_SUITE_P(Terms, ShadeTerm, testing::ValuesIn(terms),
                         [](const auto& info) { return info.param.name; });

TEST(Shade, EverythingTogether) {
    for (uint32_t seed = 1; seed <= 4; ++seed) {
        const Frame f = randomFrame(seed, 640, 60, seed);
        EXPECT_LE(worstError(f, shade(f)), tolerance::shadeSum);
    }
}

// --- outputs beside radiance ---

struct ShadedParts {
    std::vector<float> radiance, diffuse, deepScatter, specular, thickness;
    PelShaderStats stats = pelShaderStatsDefaults();
};

// RGB float32 over zeros; -1 in the thickness of pixels that are left alone.
ShadedParts shadeParts(const Frame& f) {
    ShadedParts parts;
    Buffer diffuse, deepScatter, specular;
    const Buffer thickness(device(), std::vector<float>(f.pixels(), -1));
    parts.radiance = shade(f, &parts.stats, [&](Shader& shader) {
        diffuse = setTarget(device(), shader, f, PEL_SLOT_OUT_DIFFUSE);
        deepScatter = setTarget(device(), shader, f, PEL_SLOT_OUT_DEEP_SCATTER);
        specular = setTarget(device(), shader, f, PEL_SLOT_OUT_SPECULAR);
        shader.set(PEL_SLOT_OUT_THICKNESS, imageDesc(thickness, PEL_FORMAT_R32F, f.width, f.height));
    });
    parts.diffuse = diffuse.readAll<float>(), parts.deepScatter = deepScatter.readAll<float>();
    parts.specular = specular.readAll<float>(), parts.thickness = thickness.readAll<float>();
    return parts;
}

Frame partsFrame(uint32_t seed) {
    Frame f = randomFrame(seed, 211, 60, 2);
    for (auto& [id, m] : f.materials) {
        m.deepScatterAmbient = 0.3f;
        m.specularModel = id == 2 ? PEL_SPECULAR_GGX : PEL_SPECULAR_KSK;
    }
    if (seed % 2) scaleThickness(f, 60);
    f.options.rotateTaps = 1;
    return f;
}

TEST(ShadeOutputs, EachMatchesTheOracleAndRadianceStaysWhatItIs) {
    for (uint32_t seed : {1u, 2u}) {
        const Frame f = partsFrame(seed);
        const ShadedParts shaded = shadeParts(f);
        if (seed == 2) {
            expectSameBits(device(), shaded.radiance, shade(f));
        }
        EXPECT_TRUE(shaded.stats.features & PEL_FEATURE_OUTPUTS);
        for (size_t i = 0; i < f.pixels(); ++i) {
            if (f.slots[PEL_SLOT_MATERIAL].values[i] == 0) {
                EXPECT_EQ(shaded.thickness[i], -1) << "background is left alone";
                continue;
            }
            const reference::Shaded truth = shade_test::truth(f, tables(), i);
            const Rgb diffuse = truth.scattered + truth.ambient;
            const PelMaterial& m = f.materials.at(uint32_t(f.slots[PEL_SLOT_MATERIAL].at(i)));
            EXPECT_NEAR(shaded.thickness[i], truthLight(f, m, f.lights[0], i).thickness,
                        tolerance::shadeThickness)
                << i;
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(shaded.diffuse[3 * i + c], diffuse[c], tolerance::shadeSum);
                EXPECT_NEAR(shaded.deepScatter[3 * i + c], truth.deepScatter[c], tolerance::shadeTerm);
                EXPECT_NEAR(shaded.specular[3 * i + c], truth.specular[c], tolerance::shadeTerm);
            }
        }
    }
}

TEST(ShadeOutputs, OneAloneInHalf) {
    const Frame f = partsFrame(2);
    const ShadedParts all = shadeParts(f);
    const Buffer specular(device(), f.pixels() * 8), thickness(device(), f.pixels() * 2);
    const auto radiance = shade(f, nullptr, [&](Shader& shader) {
        shader.set(PEL_SLOT_OUT_SPECULAR, imageDesc(specular, PEL_FORMAT_RGBA16F, f.width, f.height));
        shader.set(PEL_SLOT_OUT_THICKNESS, imageDesc(thickness, PEL_FORMAT_R16F, f.width, f.height));
    });
    expectSameBits(device(), radiance, all.radiance);
    const auto s = specular.readAll<uint16_t>(), t = thickness.readAll<uint16_t>();
    for (size_t i = 0; i < f.pixels(); ++i) {
        EXPECT_EQ(s[4 * i], toHalf(all.specular[3 * i]));
        EXPECT_EQ(t[i], f.slots[PEL_SLOT_MATERIAL].values[i] == 0 ? 0 : toHalf(all.thickness[i]));
    }
}

TEST(ShadeOutputs, OfBadPixelsAndWithoutAThickness) {
    Frame f = partsFrame(2);
    for (auto& light : f.lights) light.mapSize = 0, light.map.values.clear();
    f.options.invalidColor[2] = -7;
    const size_t bad = f.height / 2 * f.width + 50;
    f.slots[PEL_SLOT_MATERIAL].values[bad] = 1;
    f.slots[PEL_SLOT_NORMAL_SHADING].values[3 * bad] = NAN;
    const ShadedParts shaded = shadeParts(f);
    for (const auto* part : {&shaded.radiance, &shaded.diffuse, &shaded.deepScatter, &shaded.specular}) {
        EXPECT_EQ((*part)[3 * bad + 2], -7);
        for (float v : *part) EXPECT_TRUE(std::isfinite(v));
    }
    for (size_t i = 0; i < f.pixels(); ++i)
        EXPECT_EQ(shaded.thickness[i], f.slots[PEL_SLOT_MATERIAL].values[i] == 0 ? -1 : 0) << i;
}

// --- irradiance per pixel: made here, or the host's ---

// Without tables and with unblurred normals the pre-integrated method is Lambert's, too, and has an oracle.
Frame lambert(uint32_t seed, uint32_t lights = 2) {
    Frame f = randomFrame(seed, 211, 60, lights);
    f.curvatureLut = f.shadowLut = false;
    for (auto& [id, m] : f.materials)
        for (float& blend : m.normalBlend) blend = 0;
    return f;
}

void setScattering(Frame& f, PelScattering scattering) {
    for (auto& [id, m] : f.materials) m.scattering = scattering;
}

// With the device's own lanes, and others: a vector may be one pixel, which is the last of a tile, too.
TEST(ShadeIrradiance, UnscatteredIsLambert) {
    for (int count : {0, 1, 8, 16})
        for (const bool beside : {false, true}) {  // other materials, which are not changed
            const Device narrow = count ? lanes::deviceOf(count) : device();
            Frame f = lambert(uint32_t(1 + count));
            setScattering(f, PEL_SCATTERING_NONE);
            if (beside) f.materials[2].scattering = PEL_SCATTERING_PREINTEGRATED;
            f.options.tileLists = beside ? PEL_TILES_PER_VARIANT : PEL_TILES_ONE_LIST;
            PelShaderStats stats = pelShaderStatsDefaults();
            const std::vector<float> result = shade(narrow, f, makeTables(narrow, 8, 8), &stats);
            EXPECT_LT(worstError(f, result), tolerance::shadeSum) << count;
            EXPECT_EQ(stats.features & (PEL_FEATURE_IRRADIANCE | PEL_FEATURE_MAKE_IRRADIANCE),
                      uint32_t(PEL_FEATURE_IRRADIANCE | PEL_FEATURE_MAKE_IRRADIANCE));
            const auto& ids = f.slots[PEL_SLOT_MATERIAL].values;
            const auto others = beside ? uint64_t(std::count(ids.begin(), ids.end(), 2.0f)) : 0;
            EXPECT_EQ(stats.pixelsIrradiance, stats.pixelsShaded - others) << count;
            EXPECT_EQ(stats.pixelsByScattering[PEL_SCATTERING_NONE], stats.pixelsShaded - others);
            EXPECT_EQ(stats.pixelsByScattering[PEL_SCATTERING_PREINTEGRATED], others);
        }
}

// The host's irradiance replaces lights and ambient only in the diffuse part.
TEST(ShadeIrradiance, TheHostsIsUsedAsItIs) {
    Frame f = lambert(7);
    setScattering(f, PEL_SCATTERING_NONE);
    f.slots[PEL_SLOT_ALBEDO] = {};
    for (auto& [id, m] : f.materials) blacken(m.deepScatterColor);
    Frame dark = f;  // specular light alone
    for (auto& [id, m] : dark.materials) blacken(m.albedo);
    Random random(9);
    Image& e = f.slots[PEL_SLOT_IRRADIANCE] = {3, std::vector<float>(f.pixels() * 3)};
    for (float& v : e.values) v = random.uniform(0, 3);
    PelShaderStats stats = pelShaderStatsDefaults();
    const std::vector<float> result = shade(f, &stats), rest = shade(dark);
    EXPECT_FALSE(stats.features & PEL_FEATURE_MAKE_IRRADIANCE);
    for (size_t i = 0; i < f.pixels(); ++i) {
        const auto id = uint32_t(f.slots[PEL_SLOT_MATERIAL].at(i));
        for (int c = 0; id && c < 3; ++c)
            EXPECT_NEAR(result[3 * i + c], f.materials[id].albedo[c] * e.values[3 * i + c] + rest[3 * i + c],
                        tolerance::shadeSum)
                << i;
    }
    // A NaN in the irradiance gives the invalid colour in its own pixel alone; materials that scatter by
    // tables do not read it.
    e.values[3 * 1000 + 1] = NAN;
    f.slots[PEL_SLOT_MATERIAL].values[1000] = 2;
    f.options.invalidColor[1] = 7;
    std::vector<float> corrupted = shade(f);
    EXPECT_EQ(corrupted[3 * 1000 + 1], 7);
    EXPECT_EQ(corrupted[3 * 999 + 1], result[3 * 999 + 1]);
    f.materials[2].scattering = PEL_SCATTERING_PREINTEGRATED;
    corrupted = shade(f);
    EXPECT_NE(corrupted[3 * 1000 + 1], 7);
}

// --- layouts of images (packed formats: test_format_codes.cpp) ---

std::vector<float> shadeInto(Shader& shader, const Frame& f) {
    const auto target = setTarget(device(), shader, f);
    shader.commit().execute();
    return target.readAll<float>();
}
void setDepth(Shader& shader, const Frame& f, const Image& depth) {
    shader.set(PEL_SLOT_DEPTH, imageDesc(upload(device(), depth), PEL_FORMAT_R32F, f.width, f.height));
}

TEST(ShadeLayouts, OutputOverAnInput) {
    const Frame f = randomFrame(6, 75, 30, 1);
    const auto expected = shade(f);
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const Buffer both = upload(device(), f.slots[PEL_SLOT_ALBEDO]);
    const PelImageDesc desc = imageDesc(both, PEL_FORMAT_RGB32F, f.width, f.height);
    shader.set(PEL_SLOT_ALBEDO, desc).set(PEL_SLOT_RADIANCE, desc).commit().execute();
    const auto result = both.readAll<float>();
    for (size_t i = 0; i < result.size(); ++i)
        EXPECT_EQ(result[i], f.slots[PEL_SLOT_MATERIAL].values[i / 3] != 0
                                 ? expected[i]
                                 : f.slots[PEL_SLOT_ALBEDO].values[i]);
}

// Depth of a perspective camera, ordinary and reversed, instead of positions.
TEST(ShadeLayouts, PositionsFromDepth) {
    for (const bool reversed : {false, true}) {
        Frame f = randomFrame(14, 64, 40, 2);
        // Camera at z = 500 looking down -z: x_clip = 4 x / w, w = 500 - z, depth = A + B / w.
        const float nearPlane = reversed ? 1000 : 100, farPlane = reversed ? 100 : 1000;
        const float a = farPlane / (farPlane - nearPlane), b = -nearPlane * a;
        const float inverse[16] = {0.25f, 0, 0,     0,     0, 0.25f, 0, 0, 0, 0, 500 / b, -500 * a / b - 1,
                                   0,     0, 1 / b, -a / b};
        std::copy_n(inverse, 16, f.camera.inverseViewProjection);
        Image depth{1, std::vector<float>(f.pixels())};
        for (size_t i = 0; i < f.pixels(); ++i) {
            const double d = depth.values[i] = float(a + b / (500 - f.slots[PEL_SLOT_POSITION].at(i, 2))),
                         w = b / (d - a);
            f.slots[PEL_SLOT_POSITION].set(
                i, {((double(i % f.width) + 0.5) * 2 / f.width - 1) * w / 4,
                    (1 - (double(i / f.width) + 0.5) * 2 / f.height) * w / 4, 500 - w});
        }
        Shader shader(device());
        setFrame(device(), shader, f, tables());
        setDepth(shader.clear(PEL_SLOT_POSITION), f, depth);
        const auto result = shadeInto(shader, f);
        EXPECT_LE(worstError(f, result), tolerance::shadeFromDepth) << "reversed " << reversed;
        PelCamera flat = f.camera;  // one row is another's multiple
        for (int k = 0; k < 4; ++k) flat.inverseViewProjection[4 + k] = 3 * flat.inverseViewProjection[k];
        shader.set(flat);
        expectRefused(PEL_ERROR_INVALID_ARGUMENT, {"singular"},
                      [&] { return pelShaderCommit(shader.get()); });
        shader.set(f.camera);
        // A NaN in the depth makes its own pixel invalid and no other.
        size_t at = 0;
        while (f.slots[PEL_SLOT_MATERIAL].values[at] == 0) ++at;
        for (const float bad : {NAN, INFINITY}) {
            depth.values[at] = bad;
            f.options.invalidColor[2] = -7;
            setDepth(shader.set(f.options), f, depth);
            const auto corrupted = shadeInto(shader, f);
            for (size_t i = 0; i < result.size(); ++i)
                EXPECT_EQ(corrupted[i], i / 3 != at ? result[i] : i % 3 == 2 ? -7 : 0) << i;
        }
    }
}

}  // namespace
