// Invariants of a frame's bits: skipping, lists of tiles, bands of rows within a budget of scratch memory, a
// second run, and earlier frames of the shader. Also the changes that interpolation may make.
#include "eye/eye_frame.h"
#include "scattering_frame.h"
#include "shader_ready.h"
#include "shadow_forms.h"

using namespace shade_test;

namespace {

enum Part : uint32_t {
    NORMAL_MAP = 1 << 0,
    OUTPUTS = 1 << 1,    // beside radiance
    THICKNESS = 1 << 2,  // an image; else taps
    BLUR = 1 << 3,
    FILTER = 1 << 4,      // wide shadows from shadow maps; else images
    HALF = 1 << 5,        // half output, added to
    PLAIN = 1 << 6,       // a material without specular light and deep scatter
    BETWEEN = 1 << 7,     // interpolation between pixels, and between nodes of taps
    IRRADIANCE = 1 << 8,  // a material that does not scatter, with sharp shadows
    CUBE = 1 << 9,        // ambient light from a cube map
    TURNED = 1 << 10,     // taps, from pixel to pixel
};

struct Scene {
    Frame frame;
    uint32_t parts;
    std::vector<float> texels, target;
    bool has(Part part) const { return parts & part; }
};

Light sceneLight(Random& random, const Frame& f, uint32_t seed, uint32_t parts, bool spot) {
    Light light = mapLight(seed, spot, false, {0.5, spot ? 0.4 : -0.2, 0.9}).light;
    PelLight& l = light.params;
    if (!(parts & FILTER)) {
        l.shadowFilterTexels = 0;
        light.wide.components = 1;
        for (size_t i = 0; i < f.pixels(); ++i)
            light.wide.values.push_back(std::clamp(random.uniform(-0.5f, 1.5f), 0.0f, 1.0f));
        // Whole vectors in full shadow or full light, as most of a frame is.
        auto& wide = light.wide.values;
        for (size_t i = 0; i + 70 < wide.size(); i += 70)
            if (const uint32_t kind = random.below(3); kind > 0)
                std::fill_n(wide.begin() + ptrdiff_t(i), 70, kind == 1 ? 0.0f : 1.0f);
    }
    if (spot) {  // whose cone and range miss a part of the frame
        l.type = PEL_LIGHT_SPOT;
        for (int c = 0; c < 3; ++c) l.position[c] = float(c == 2 ? 150 : 20), l.color[c] = 9000;
        l.spotDirection[0] = l.spotDirection[1] = 0, l.spotDirection[2] = -1;
        l.spotCosInner = 0.999f, l.spotCosOuter = 0.99f;
        l.range = 170;
    }
    return light;
}

Scene randomScene(uint32_t seed, uint32_t parts, uint32_t width, uint32_t height) {
    Random random(seed);
    Scene s{reliefFrame(seed, width, height, 0.5f), parts, {}, {}};
    Frame& f = s.frame;
    f.curvatureLut = f.shadowLut = true;
    f.options.blurNormals = s.has(BLUR);
    f.options.accumulate = s.has(HALF);
    f.options.everyPixel = !s.has(BETWEEN);
    f.options.rotateTaps = s.has(TURNED);
    f.options.invalidColor[2] = 9;
    const auto fill = [&](PelImageSlot slot, float least, float most) {
        f.slots[slot].components = 1;
        for (size_t i = 0; i < f.pixels(); ++i) f.slots[slot].values.push_back(random.uniform(least, most));
    };
    fill(PEL_SLOT_CURVATURE, -0.1f, 1);
    fill(PEL_SLOT_ROUGHNESS, 0.7f, 1.4f);
    if (s.has(THICKNESS)) fill(PEL_SLOT_THICKNESS, 0, 60);
    for (const bool spot : {false, true}) f.lights.push_back(sceneLight(random, f, seed, parts, spot));
    for (float& c : f.ambient.constant) c = random.uniform(0.1f, 0.4f);
    if (s.has(CUBE)) {
        f.cube.size = 4;
        for (int i = 0; i < 6 * 16; ++i) f.cube.texels.push_back({random.uniform(), random.uniform(), 0.3});
    }
    for (size_t i = 0; s.has(PLAIN) && i < f.pixels(); ++i)  // whole tiles of that material
        if (i / f.width / 4 % 3 == 1) f.slots[PEL_SLOT_MATERIAL].values[i] = 2;
    for (auto& [id, m] : f.materials) {
        const bool plain = s.has(PLAIN) && id == 2;
        m.specular = plain ? 0.0f : 0.5f;
        m.specularModel = id == 1 ? PEL_SPECULAR_GGX : PEL_SPECULAR_KSK;
        if (!plain)
            for (float& c : m.deepScatterColor) c = random.uniform(0.1f, 0.9f);
        m.deepScatterRadius = 12;
        m.deepScatterAmbient = id == 1 ? 0.3f : 0.0f;
        m.thicknessTaps = 8;
        if (s.has(BETWEEN)) m.thicknessFilterRadius = 0.4f;  // few nodes: they pay in small frames too
        if (s.has(IRRADIANCE) && id == 1) m.scattering = PEL_SCATTERING_NONE;
    }
    for (int i = 0; i < 64 * 64 * 3; ++i) s.texels.push_back(random.uniform());
    for (size_t i = 0; i < f.pixels() * 3; ++i) s.target.push_back(random.uniform());
    for (int slot = PEL_SLOT_POSITION; slot < PEL_SLOT_OUT_DIFFUSE; ++slot)
        for (float& v : f.slots[slot].values)
            if (random.below(900) == 0) v = random.below(2) ? std::nanf("") : 1e38f;
    f.slots[PEL_SLOT_UV].components = 2, f.slots[PEL_SLOT_TANGENT].components = 3;
    for (size_t i = 0; s.has(NORMAL_MAP) && i < f.pixels(); ++i) {
        f.slots[PEL_SLOT_TANGENT].push({1, 0, 0});
        for (int k = 0; k < 2; ++k) f.slots[PEL_SLOT_UV].values.push_back(random.uniform(-2, 2));
    }
    return s;
}

using OutputBytes = std::vector<std::vector<unsigned char>>;

// The images that a shader makes, which may have made others before.
OutputBytes run(const Scene& s, const PelShaderOptions& options, PelShaderStats* stats = nullptr,
                Shader shader = Shader(device())) {
    const Frame& f = s.frame;
    clearFrame(shader);
    setFrame(device(), shader, f, tables());
    shader.set(options);
    if (s.has(PLAIN)) shader.setMaterial(2, f.materials.at(2));  // without tables
    if (s.has(NORMAL_MAP))
        shader.setNormalMap(2, {imageDesc(Buffer(device(), s.texels), PEL_FORMAT_RGB32F, 64, 64)});
    std::vector<Buffer> targets;
    for (const PelImageSlot slot : {PEL_SLOT_RADIANCE, PEL_SLOT_OUT_DIFFUSE, PEL_SLOT_OUT_DEEP_SCATTER,
                                    PEL_SLOT_OUT_SPECULAR, PEL_SLOT_OUT_THICKNESS}) {
        if (slot != PEL_SLOT_RADIANCE && !s.has(OUTPUTS)) break;
        targets.emplace_back(device(), s.target);
        const bool scalar = slot == PEL_SLOT_OUT_THICKNESS;
        const PelFormat format = s.has(HALF) ? (scalar ? PEL_FORMAT_R16F : PEL_FORMAT_RGB16F)
                                             : (scalar ? PEL_FORMAT_R32F : PEL_FORMAT_RGB32F);
        shader.set(slot, imageDesc(targets.back(), format, f.width, f.height));
    }
    shader.commit().execute();
    if (stats) *stats = shader.stats();
    OutputBytes bytes;
    for (const Buffer& target : targets) bytes.push_back(target.readAll<unsigned char>());
    return bytes;
}

// Scratch memory for about ten rows of the images that passes make; 0 where a pass needs the whole frame.
uint64_t budgetOf(const Scene& s) {
    if (s.has(BLUR) || !(s.parts & (FILTER | NORMAL_MAP))) return 0;
    return uint64_t(s.frame.width) * (12 * s.has(NORMAL_MAP) + 8 * s.has(FILTER) + 12 * s.has(IRRADIANCE)) *
               (8 + 4 * s.has(BETWEEN)) +
           2 * 400 * 12 * (s.has(NORMAL_MAP) + s.has(IRRADIANCE));
}

struct Kind {
    const char* name;
    uint32_t parts;
};
const Kind kinds[] = {{"MapOutputsThickness", NORMAL_MAP | OUTPUTS | THICKNESS},
                      {"BlurAndMapHalfPlainCube", NORMAL_MAP | BLUR | HALF | PLAIN | CUBE},
                      {"FilteredShadowsTurnedOutputs", OUTPUTS | FILTER | PLAIN | TURNED},
                      {"InterpolatedCubeIrradiance", FILTER | BETWEEN | IRRADIANCE | CUBE | HALF}};

class ShadeInvariants : public testing::TestWithParam<Kind> {};

TEST_P(ShadeInvariants, SkippingListsBandsAndRunsChangeNoBit) {
    for (uint32_t seed : {1u, 2u}) {  // of different sizes
        const Scene s = randomScene(seed, GetParam().parts, 141 + seed, 50);
        PelShaderOptions options = s.frame.options;
        PelShaderStats stats = pelShaderStatsDefaults();
        const OutputBytes right = run(s, options, &stats);
        EXPECT_EQ(run(s, options), right) << "again";
        EXPECT_EQ(bool(stats.features & PEL_FEATURE_NORMAL_MAP), s.has(NORMAL_MAP));
        EXPECT_EQ(bool(stats.features & PEL_FEATURE_OUTPUTS), s.has(OUTPUTS));
        EXPECT_EQ(bool(stats.features & PEL_FEATURE_THICKNESS_TAPS), !s.has(THICKNESS));
        EXPECT_EQ(bool(stats.features & PEL_FEATURE_FILTER_SHADOW), s.has(FILTER));
        EXPECT_EQ(bool(stats.features & PEL_FEATURE_MAKE_IRRADIANCE), s.has(IRRADIANCE));
        for (const PelTileLists lists : {PEL_TILES_PER_VARIANT, PEL_TILES_NO_LIST}) {
            options.tileLists = lists;
            PelShaderStats tiles = stats;
            EXPECT_EQ(run(s, options, &tiles), right) << "tile lists " << int(lists);
            EXPECT_EQ(tiles.pixelsShaded, stats.pixelsShaded);
            EXPECT_EQ(tiles.pixelsInvalid, stats.pixelsInvalid);
            if (s.has(PLAIN) && !s.has(OUTPUTS) && lists == PEL_TILES_PER_VARIANT) {
                EXPECT_GT(tiles.tilesPartial, 0u);
            }
        }
        options = s.frame.options;
        if ((options.scratchBudget = budgetOf(s))) {
            PelShaderStats bands = stats;
            EXPECT_EQ(run(s, options, &bands), right) << "in bands";
            EXPECT_GT(bands.bands, 1u);
        }
        options = s.frame.options;
        options.disableSkipping = 1;
        PelShaderStats all = stats;
        EXPECT_EQ(run(s, options, &all), right) << "without skipping";
        if (!s.has(FILTER)) continue;
        EXPECT_LT(stats.pixelsWideShadow, all.pixelsWideShadow) << "pixels outside the cone";
        if (!s.has(IRRADIANCE)) {
            EXPECT_LT(stats.pixelsShadowTexels, stats.pixelsWideShadow) << "bounds decide some filters";
        }
        EXPECT_EQ(all.pixelsShadowTexels, all.pixelsWideShadow);
    }
}

// One shader, whose frames change their size, ids, materials, lights, camera and features: each is that of a
// fresh shader.
TEST(ShadeSequences, EachFrameIsThatOfAFreshShader) {
    constexpr uint32_t sizes[][2] = {{140, 50}, {70, 100}, {128, 2}, {129, 3}, {256, 2}, {64, 7}, {257, 1}};
    Shader shader(device());
    Random random(7);
    for (uint32_t step = 0; step < sized(14u, 8u); ++step) {
        const Kind& kind = kinds[step % 2 ? random.below(std::size(kinds)) : step / 2 % std::size(kinds)];
        const auto& [width, height] = sizes[random.below(std::size(sizes))];
        const Scene s = randomScene(step + 3, kind.parts, width, height);
        PelShaderOptions options = s.frame.options;
        if (step % 3 == 0 && height > 20) options.scratchBudget = budgetOf(s);
        options.tileLists = PelTileLists(random.below(3));
        const std::string where = std::string(kind.name) + " of " + std::to_string(width) + " x " +
                                  std::to_string(height) + ", step " + std::to_string(step);
        EXPECT_EQ(run(s, options, nullptr, shader), run(s, options)) << where;
    }
}

// The same scene with one thing changed, and then changed back.
TEST(ShadeSequences, OneChangeIsSeenAndForgotten) {
    const auto base = [] { return randomScene(1, FILTER | OUTPUTS | PLAIN, 142, 50); };
    Shader shader(device());
    const Scene first = base();
    const OutputBytes right = run(first, first.frame.options, nullptr, shader);
    const std::pair<const char*, std::function<void(Frame&)>> changes[] = {
        {"ids",
         [](Frame& f) {
             for (float& id : f.slots[PEL_SLOT_MATERIAL].values) id = 2 - (id == 2);
         }},
        {"all background but one",
         [](Frame& f) {
             auto& ids = f.slots[PEL_SLOT_MATERIAL].values;
             std::fill(ids.begin(), ids.end(), 0.0f), ids[700] = 1;
         }},
        {"a radius", [](Frame& f) { f.materials[1].diffusionRadius = 1; }},
        {"a filter", [](Frame& f) { f.materials[1].shadowFilterWidth = 2; }},
        {"a disk of taps", [](Frame& f) { f.materials[1].thicknessFilterRadius = 0.05f; }},
        {"another light", [](Frame& f) { f.lights.pop_back(); }},
        {"the map of a light",
         [](Frame& f) {
             for (float& z : f.lights[0].map.values) z *= 0.9f;
         }},
        {"its direction",
         [](Frame& f) { std::swap(f.lights[0].params.toLight[0], f.lights[0].params.toLight[1]); }},
        {"its matrix", [](Frame& f) { f.lights[0].params.worldToShadow[3] += 0.1f; }},
        {"the camera", [](Frame& f) { f.camera.position[2] = 40; }},
        {"ambient light", [](Frame& f) { f.ambient.sh[2][1] = 0.3f; }},
        {"no curvature", [](Frame& f) { f.slots[PEL_SLOT_CURVATURE] = {}; }}};
    for (const auto& [what, change] : changes) {
        Scene other = base();
        change(other.frame);
        const OutputBytes fresh = run(other, other.frame.options);
        EXPECT_NE(fresh, right) << what << " makes a difference";
        EXPECT_EQ(run(other, other.frame.options, nullptr, shader), fresh) << what;
        EXPECT_EQ(run(first, first.frame.options, nullptr, shader), right) << what << ", changed back";
    }
}

// Irises that have not changed are made again where another eye moves all to larger memory.
TEST(ShadeSequences, AnotherEyeLeavesTheFirstAsItWas) {
    eye_test::EyeFrame frame(96, 64, 0.5f, 48, 32);
    const Buffer texture(frame.device, std::vector<float>(3 * 64 * 64, 0.5f));
    const auto first = [](Shader& shader) { shader.setEye(2, pelEyeDefaults()); };
    const auto second = [&](Shader& shader) {
        shader.setMaterial(3, pelMaterialDefaults()).setEye(3, pelEyeDefaults());
        shader.setIrisTexture(3, imageDesc(texture, PEL_FORMAT_RGB32F, 64, 64));
    };
    Shader kept(frame.device);
    frame.prepare(kept), first(kept);
    frame.execute(kept);
    second(kept);
    EXPECT_EQ(frame.execute(kept), frame.shade([&](Shader& shader) { first(shader), second(shader); }));
}

INSTANTIATE_TEST_SUITE_P(Scenes, ShadeInvariants, testing::ValuesIn(kinds),
                         [](const auto& info) { return info.param.name; });

// A table whose dark end is below 2^-20 leaves no light in full shadow; one just above does.
TEST(ShadeSkipping, TracesOfLightInFullShadowAreNone) {
    Frame f = reliefFrame(3, 100, 8, 0.5f);
    f.slots[PEL_SLOT_CURVATURE] = {1, std::vector<float>(f.pixels(), 0.1f)};
    Light light;
    light.wide = {1, std::vector<float>(f.pixels(), 0.0f)};
    f.lights = {light};
    f.curvatureLut = f.shadowLut = true;
    for (const bool trace : {true, false}) {
        const std::vector<float> texels(size_t(3) * 96 * 64, trace ? 9e-7f : 1e-6f);
        const pellucid::Lut shadow(device(), tables().shadow.info(), texels);
        for (f.options.disableSkipping = 0; f.options.disableSkipping < 2; ++f.options.disableSkipping) {
            const auto radiance = shade(f, nullptr, [&](Shader& shader) {
                for (const auto& [id, m] : f.materials) shader.setMaterial(id, m, tables().curvature, shadow);
            });
            const auto some = size_t(std::ranges::count_if(radiance, [](float r) { return r > 0; }));
            if (trace)
                EXPECT_EQ(some, 0u);
            else
                EXPECT_GT(some, f.pixels());
        }
    }
}

// One light's shadow is filtered wide for the material with tables, the other's only sharply for the one that
// scatters on screen.
TEST(ShadeSum, LightsAddUp) {
    const pellucid::Profile skin = pellucid::Profile::skin();
    Frame f = scatteringFrame(PEL_SCATTERING_SCREEN, 96, 64);
    for (auto& [id, m] : f.materials) m.profile = skin.get(), m.specular = 0.3f;
    f.materials.at(1).scattering = PEL_SCATTERING_PREINTEGRATED;
    f.ambient = pelAmbientDefaults();
    Light other = f.lights[0];
    other.params.shadowFilterTexels = 0;
    other.params.toLight[0] = -0.6f;
    f.lights.push_back(other);
    const std::vector<float> all = shade(f), sum = sumOfLights(f);
    for (size_t i = 0; i < sum.size(); ++i) {
        if (f.slots[PEL_SLOT_MATERIAL].at(i / 3) == 2) continue;  // summed more finely under uneven light
        ASSERT_NEAR(all[i], sum[i], 1e-5) << i;
    }
}

// --- bands ---

// Blurred normals, two wide shadows to filter; lit by both lights.
Frame passesFrame(uint32_t seed, uint32_t width, uint32_t height) {
    Frame f = reliefFrame(seed, width, height, 0.4f);
    for (const bool perspective : {false, true}) f.lights.push_back(mapLight(seed, perspective).light);
    f.options.blurNormals = 1;
    f.curvatureLut = f.shadowLut = true;
    f.slots[PEL_SLOT_CURVATURE] = f.slots[PEL_SLOT_MATERIAL];
    std::fill_n(f.ambient.constant, 3, 0.2f);
    return f;
}

// The blur reads up to 384 rows to each side: the frame is taller than that, and seen from far enough for
// wide steps.
TEST(ShadeBands, BlurredNormalsWithTheirHalo) {
    Scene s{passesFrame(2, 70, 1000), BLUR | FILTER, {}, {}};
    for (float& p : s.frame.slots[PEL_SLOT_POSITION].values) p *= 0.02f;  // a close-up: steps of many pixels
    s.target.resize(3 * s.frame.pixels());
    PelShaderOptions options = s.frame.options;
    PelShaderStats whole = pelShaderStatsDefaults(), some = whole;
    const OutputBytes right = run(s, options, &whole);
    EXPECT_TRUE(whole.features & PEL_FEATURE_BLUR_NORMALS);
    const uint64_t rowBytes = 70 * (40 + 8),
                   guards = 2 * 400 * 40;  // of PEL_PLANE_GUARD values round each plane
    for (const auto& [rows, bands] : {std::pair{770u, 500u}, {786u, 56u}, {968u, 5u}}) {
        options.scratchBudget = rows * rowBytes + guards;
        Shader shader(device());
        EXPECT_EQ(run(s, options, &some, shader), right) << rows;
        EXPECT_EQ(some.bands, bands) << rows;
        EXPECT_EQ(some.tilesShaded, whole.tilesShaded);
        EXPECT_EQ(some.pixelsShaded, whole.pixelsShaded);
        EXPECT_EQ(some.pixelsShadowLut, whole.pixelsShadowLut);
        EXPECT_EQ(some.pixelsWideShadow, whole.pixelsWideShadow);
        EXPECT_EQ(some.tilesTotal, whole.tilesTotal);
        EXPECT_EQ(run(s, options, &some, shader), right) << "what the bands left behind does not matter";
        shader.set(s.frame.options).commit();
        EXPECT_EQ(shader.stats().bands, 0u) << "nothing was executed since";
    }
}

TEST(ShadeBands, ABudgetThatIsTooSmallSaysWhatWouldDo) {
    Frame f = passesFrame(1, 150, 61);
    f.options.scratchBudget = 1000;
    FrameShader made = shaderOf(f);
    Shader& shader = made.shader;
    expectRefused(PEL_ERROR_OUT_OF_MEMORY,
                  {("at least " + std::to_string(150 * 48 * 61 + 2 * 400 * 40)).c_str()},
                  [&] { shader.commit(); });
    f.options.scratchBudget = 150 * 48 * 61 + 2 * 400 * 40;
    shader.set(f.options).commit().execute();
    // Filters across bands would read what the band before has overwritten.
    Frame tall = passesFrame(1, 70, 1000);
    tall.options.scratchBudget = 968 * 70 * 48 + 2 * 400 * 40;
    FrameShader over = shaderOf(tall);
    over.shader.commit();
    const Buffer both(device(), tall.slots[PEL_SLOT_NORMAL_SHADING].values);
    for (const auto slot : {PEL_SLOT_NORMAL_SHADING, PEL_SLOT_RADIANCE})
        over.shader.set(slot, imageDesc(both, PEL_FORMAT_RGB32F, 70, 1000));
    expectRefused(PEL_ERROR_OUT_OF_MEMORY, {"1000 rows"}, [&] { over.shader.commit(); });
    // Without passes there is no scratch memory to limit.
    f.options.blurNormals = 0;
    f.options.scratchBudget = 1;
    for (Light& light : f.lights) light.params.shadowFilterTexels = 0;
    setFrame(device(), shader, f, tables());
    shader.commit().execute();
    EXPECT_EQ(shader.stats().bands, 1u);
}

// --- wide shadows at every second pixel, with interpolation between them ---

struct Difference {
    double rms = 0, share = 0;  // share of pixels more than a hundredth off
};
Difference between(const Frame& f, const std::vector<float>& a, const std::vector<float>& b,
                   double scale = 1) {
    double sum = 0, off = 0, count = 0;
    for (size_t i = 0; i < f.pixels(); ++i) {
        if (f.materials.count(uint32_t(f.slots[PEL_SLOT_MATERIAL].at(i))) == 0) continue;
        double d2 = 0;
        for (int c = 0; c < 3; ++c) d2 += std::pow(scale * (double(a[3 * i + c]) - b[3 * i + c]), 2) / 3;
        sum += d2, off += d2 > 1e-4, count += 1;
    }
    return {std::sqrt(sum / count), off / count};
}

Frame shadowed(uint32_t seed, const Light& light, uint32_t width = 230, uint32_t height = 91,
               float pixel = 0.21f) {
    Frame f = reliefFrame(seed, width, height, pixel);
    f.lights = {light};
    showWideShadow(f);
    return f;
}

TEST(BetweenPixels, WideShadowsAreThoseOfEveryPixel) {
    double filtered = 0, all = 0;
    for (uint32_t seed = 0; seed < 8; ++seed) {
        const MapLight from =
            mapLight(seed, seed & 1, seed & 2, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, 97 + 50 * seed);
        const Frame f = shadowed(seed, from.light);
        PelShaderStats every = pelShaderStatsDefaults(), some = every;
        const auto exact = shade(f, &every), shown = shade(device(), interpolated(f), tables(), &some);
        const Difference d = between(f, exact, shown);
        EXPECT_LE(d.rms, tolerance::betweenShadowRms) << seed;
        EXPECT_LE(d.share, tolerance::betweenShadowShare) << seed;
        EXPECT_EQ(some.launches, every.launches + 1);
        filtered += double(some.pixelsWideShadow), all += double(every.pixelsWideShadow);
    }
    EXPECT_LT(filtered, 0.5 * all) << "most pixels are interpolated";
}

TEST(BetweenPixels, BadPixelsStayAlone) {
    Frame f = interpolated(shadowed(5, mapLight(5).light));
    const auto before = shade(f);
    const size_t normal = 22 * f.width + 60, position = sized(41, 9) * f.width + 121;
    f.slots[PEL_SLOT_NORMAL_GEOMETRIC].values[3 * normal] = NAN;
    f.slots[PEL_SLOT_POSITION].values[3 * position + 1] = INFINITY;
    const auto after = shade(f);
    EXPECT_TRUE(farOnesAreSame(f, before, after, {normal, position}, 3));
}

TEST(BetweenPixels, SharpShadowsAndNarrowFramesAreComputedEverywhere) {
    const MapLight from = mapLight(2);
    Frame sharp = shadowed(2, from.light);
    for (auto& [id, m] : sharp.materials) m.scattering = PEL_SCATTERING_NONE;
    EXPECT_EQ(shade(sharp), shade(device(), interpolated(sharp), tables()));
    for (const auto& [width, height] : {std::pair{1u, 1u}, {17u, 40u}, {63u, 9u}}) {
        const Frame f = shadowed(2, from.light, width, height);
        EXPECT_EQ(shade(f), shade(device(), interpolated(f), tables())) << width;
    }
    for (const auto& [width, height] : {std::pair{64u, 1u}, {65u, 2u}, {97u, 5u}, {128u, 7u}}) {
        const Frame f = shadowed(2, from.light, width, height);
        EXPECT_LE(between(f, shade(f), shade(device(), interpolated(f), tables())).rms,
                  tolerance::betweenShadowRms)
            << width;
    }
}

}  // namespace
