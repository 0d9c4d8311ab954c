// Inputs that a shader refuses, and the messages; pixels with NaN, Inf or no material do not change their
// neighbours.
#include "cl/cl_spy.h"
#include "shader_ready.h"

using namespace shade_test;

namespace {

TEST(ShadeBadInput, ExecuteNeedsACommit) {
    Ready r;
    Shader& s = r.shader;
    const Buffer texels(device(), std::vector<float>(6 * 4 * 4 * 3, 0.5f));
    const std::function<void()> setters[] = {
        [&] { s.set(r.frame.options); },
        [&] { s.set(PEL_SLOT_RADIANCE, imageDesc(r.target, PEL_FORMAT_RGB32F, 32, 16)); },
        [&] { pellucid::check(pelShaderSetImage(s.get(), PEL_SLOT_AMBIENT_OCCLUSION, nullptr)); },
        [&] { s.setMaterial(1, r.frame.materials.at(1), tables().curvature, tables().shadow); },
        [&] { pellucid::check(pelShaderSetMaterial(s.get(), 9, nullptr, nullptr, nullptr)); },
        [&] { s.setNormalMap(1, {}); },
        [&] { s.set(std::vector<PelLight>{r.frame.lights[0].params}); },
        [&] { pellucid::check(pelShaderSetLightImage(s.get(), 0, PEL_LIGHT_WIDE_SHADOW, nullptr)); },
        [&] { s.set(r.frame.ambient); },
        [&] { s.setAmbientCube(imageDesc(texels, PEL_FORMAT_RGB32F, 4, 24)); },
        [&] { pellucid::check(pelShaderSetAmbientCube(s.get(), nullptr)); },
        [&] { s.set(r.frame.camera); }};
    for (size_t i = 0; i <= std::size(setters); ++i) {
        SCOPED_TRACE("setter " + std::to_string(i));
        if (i > 0) setters[i - 1]();  // before the first one nothing was ever committed
        expectRefused(PEL_ERROR_INVALID_STATE, {"pelShaderCommit"}, [&] { s.execute(); });
        s.commit().execute();
    }
}

TEST(ShadeBadInput, ImagesThatDoNotFit) {
    Ready r;
    for (const uint32_t light : {1u, 2u, UINT32_MAX})
        expectRefused(PEL_ERROR_INVALID_ARGUMENT,
                      {"is not set, only the first 1", "pelShaderSetLights comes first"},
                      [&] { r.shader.set(light, PEL_LIGHT_WIDE_SHADOW, nullptr); });
    static const Buffer buffer(device(), 32 * 16 * 16), foreign(Device(""), 4096);
    for (const PelFormat format : {PEL_FORMAT_OCT16X2_SNORM, PEL_FORMAT_RGBA8_SRGB})
        expectRefused(PEL_ERROR_INVALID_ARGUMENT, {"normal map 0", "averaged"},
                      [&] { r.shader.setNormalMap(1, {imageDesc(buffer, format, 8, 8)}); });
    const struct {
        PelImageSlot slot;
        PelFormat format;
        std::vector<const char*> words;
        void (*change)(PelImageDesc&) = [](PelImageDesc&) {};
    } rows[] = {
        {PEL_SLOT_ALBEDO, PEL_FORMAT_R32F, {"albedo", "R32F", "three components"}},
        {PEL_SLOT_RADIANCE, PEL_FORMAT_RGBA8_UNORM, {"radiance", "RGBA8_UNORM", "RGB or RGBA"}},
        {PEL_SLOT_NORMAL_SHADING, PEL_FORMAT_RGBA8_SRGB, {"shading normal", "RGBA8_SRGB"}},
        {PEL_SLOT_MATERIAL, PEL_FORMAT_R8_UNORM, {"material", "R8_UNORM", "uint"}},
        {PEL_SLOT_OUT_THICKNESS, PEL_FORMAT_R8_UNORM, {"R8_UNORM"}},
        {PEL_SLOT_OUT_DIFFUSE, PEL_FORMAT_RG32F, {"RG32F"}},
        {PEL_SLOT_ALBEDO, PelFormat(99), {"format 99"}},
        {PelImageSlot(77), PEL_FORMAT_R32F, {"slot 77"}},
        {PEL_SLOT_ALBEDO, PEL_FORMAT_RGB32F, {"0 x 16"}, [](auto& d) { d.width = 0; }},
        {PEL_SLOT_ALBEDO, PEL_FORMAT_RGB32F, {"32 x 20000"}, [](auto& d) { d.height = 20000; }},
        {PEL_SLOT_ALBEDO, PEL_FORMAT_RGBA32F, {"albedo", "ends at byte"}, [](auto& d) { d.byteOffset = 4; }},
        {PEL_SLOT_CURVATURE, PEL_FORMAT_R32F, {"byteOffset", "of 4"}, [](auto& d) { d.byteOffset = 2; }},
        {PEL_SLOT_ALBEDO, PEL_FORMAT_RGB32F, {"pixelStride", "12 bytes"}, [](auto& d) { d.pixelStride = 8; }},
        {PEL_SLOT_CURVATURE, PEL_FORMAT_R32F, {"rowStride", "128"}, [](auto& d) { d.rowStride = 64; }},
        {PEL_SLOT_CURVATURE,
         PEL_FORMAT_R32F,
         {"rowStride"},
         [](auto& d) { d.rowStride = uint64_t(1) << 62; }},
        {PEL_SLOT_CURVATURE,
         PEL_FORMAT_R32F,
         {"below 4 GiB and 1 TiB"},
         [](auto& d) { d.planeStride = (uint64_t(1) << 40) + 1; }},
        {PEL_SLOT_ALBEDO,
         PEL_FORMAT_PLANAR_RGB32F,
         {"ends at byte 2199"},  // which is possible, but not this long
         [](auto& d) { d.planeStride = uint64_t(1) << 40; }},
        {PEL_SLOT_CURVATURE, PEL_FORMAT_R32F, {"PelBuffer"}, [](auto& d) { d.buffer = nullptr; }},
        {PEL_SLOT_CURVATURE,
         PEL_FORMAT_R32F,
         {"another PelDevice"},
         [](auto& d) { d.buffer = foreign.get(); }},
    };
    for (const auto& row : rows) {
        PelImageDesc desc = imageDesc(buffer, row.format, 32, 16);
        row.change(desc);
        expectRefused(row.words, [&] { r.shader.set(row.slot, desc); });
    }
    const auto light = [&](uint32_t i, PelLightSlot slot, PelFormat format) {
        r.shader.set(i, slot, imageDesc(buffer, format, 32, 16));
    };
    expectRefused({"wide shadow", "R32_UINT"}, [&] { light(0, PEL_LIGHT_WIDE_SHADOW, PEL_FORMAT_R32_UINT); });
    expectRefused("light 3", [&] { light(3, PEL_LIGHT_SHADOW_MAP, PEL_FORMAT_R32F); });
    // The refused calls changed nothing.
    r.shader.commit().execute();
    EXPECT_EQ(r.target.readAll<float>(), shade(r.frame));
}

TEST(ShadeBadInput, WhatCommitMisses) {
    const auto missed = [](const std::vector<const char*>& words, const std::function<void(Ready&)>& change,
                           PelError code = PEL_ERROR_INVALID_ARGUMENT) {
        Ready r;
        change(r);
        expectRefused(code, words, [&] { r.shader.commit(); });
    };
    const auto set = [](Ready& r, PelImageSlot slot, PelFormat format, uint32_t width = 32,
                        uint64_t offset = 0) {
        static const Buffer buffer(device(), 32 * 16 * 12);
        r.shader.set(slot, imageDesc(buffer, format, width, 16, offset));
    };
    const auto wideShadows = [](Ready& r, const std::vector<Buffer>& buffers, PelFormat format) {
        r.shader.set(std::vector<PelLight>(20, r.frame.lights[0].params));
        for (uint32_t i = 0; i < buffers.size(); ++i)
            r.shader.set(i, PEL_LIGHT_WIDE_SHADOW, imageDesc(buffers[i], format, 32, 16));
    };
    const auto noMaterials = [](Ready& r) {
        for (uint32_t id : {1, 2, 7})
            pellucid::check(pelShaderSetMaterial(r.shader.get(), id, nullptr, nullptr, nullptr));
    };
    const auto light = [](Ready& r, auto change) {
        PelLight l = r.frame.lights[0].params;
        change(l);
        r.shader.set({l});
    };
    const auto scattering = [](Ready& r, int method) {
        PelMaterial m = fixture::faceworksMaterial();
        m.scattering = PelScattering(method);
        r.shader.setMaterial(1, m);
    };
    missed({"albedo", "20 x 16", "32 x 16"},
           [&](Ready& r) { set(r, PEL_SLOT_ALBEDO, PEL_FORMAT_RGB32F, 20); });
    missed({"31 x 16"}, [&](Ready& r) { set(r, PEL_SLOT_OUT_DIFFUSE, PEL_FORMAT_RGB32F, 31); });
    missed({"overlap"}, [&](Ready& r) {
        set(r, PEL_SLOT_OUT_SPECULAR, PEL_FORMAT_RGB32F);
        set(r, PEL_SLOT_OUT_THICKNESS, PEL_FORMAT_R32F, 32, 4);
    });
    for (const auto& [slot, word] : {std::pair{PEL_SLOT_RADIANCE, "radiance"},
                                     {PEL_SLOT_NORMAL_SHADING, "shading normal"},
                                     {PEL_SLOT_POSITION, "position"}})
        missed({word, "needed"}, [slot = slot](Ready& r) { r.shader.clear(slot); });
    missed({"no material"}, noMaterials);
    missed({"material 1"}, [&](Ready& r) {
        noMaterials(r);
        r.shader.setMaterial(9, fixture::faceworksMaterial()).clear(PEL_SLOT_MATERIAL);
    });
    missed({"shadowDepthRange"}, [&](Ready& r) { light(r, [](PelLight& l) { l.shadowDepthRange = 0; }); });
    missed({"shadowDepthA"},
           [&](Ready& r) { light(r, [](PelLight& l) { l.shadowProjection = PEL_SHADOW_PERSPECTIVE; }); });
    missed({"texture"}, [&](Ready& r) { scattering(r, PEL_SCATTERING_TEXTURE); });
    expectRefused("scattering is 9", [&] {
        Ready r;
        scattering(r, 9);
        r.shader.commit();
    });
    const auto unsupported = PEL_ERROR_UNSUPPORTED;
    missed(
        {"wide shadow", "R32F", "R8_UNORM"},
        [&](Ready& r) {
            wideShadows(r, {Buffer(device(), 2048)}, PEL_FORMAT_R32F);
            r.shader.set(1, PEL_LIGHT_WIDE_SHADOW,
                         imageDesc(Buffer(device(), 512), PEL_FORMAT_R8_UNORM, 32, 16));
        },
        unsupported);
    std::vector<Buffer> each;
    for (int i = 0; i < 20; ++i) each.emplace_back(device(), 2048);
    missed(
        {"16", "buffers"}, [&](Ready& r) { wideShadows(r, each, PEL_FORMAT_R32F); }, unsupported);
    Ready r;
    wideShadows(r, std::vector<Buffer>(20, each[0]), PEL_FORMAT_R32F);
    EXPECT_NO_THROW(r.shader.commit().execute());
    // No positions where no term reads them.
    Shader plain(device());
    PelMaterial matt = pelMaterialDefaults();
    matt.specular = 0;
    matt.scattering = PEL_SCATTERING_NONE;
    plain.setMaterial(1, matt).set(std::vector{pelLightDefaults()});
    plain.set(PEL_SLOT_RADIANCE, imageDesc(r.target, PEL_FORMAT_RGB32F, 32, 16));
    plain.set(PEL_SLOT_NORMAL_SHADING, imageDesc(Buffer(device(), 32 * 16 * 12), PEL_FORMAT_RGB32F, 32, 16));
    EXPECT_NO_THROW(plain.commit().execute());
}

TEST(ShadeBadInput, Values) {
    Ready r;
    const auto material = [&](const char* word, auto change) {
        PelMaterial m = fixture::faceworksMaterial();
        change(m);
        expectRefused({"PelMaterial", word}, [&] { r.shader.setMaterial(1, m); });
    };
    material("thicknessTaps", [](PelMaterial& m) { m.thicknessTaps = 12; });
    const PelMaterial good = fixture::faceworksMaterial();
    expectRefused("material id 0", [&] { r.shader.setMaterial(0, good); });
    expectRefused("material id 256", [&] { r.shader.setMaterial(256, good); });
    expectRefused({"curvature LUT", "another kind"}, [&] { r.shader.setMaterial(1, good, tables().shadow); });

    const auto light = [&](const char* word, auto change) {
        PelLight l = pelLightDefaults();
        change(l);
        expectRefused({"PelLight 0", word}, [&] { r.shader.set({l}); });
    };
    material("specularModel", [](PelMaterial& m) { m.specularModel = PelSpecularModel(2); });
    light("unit length", [](PelLight& l) { l.toLight[0] = 1; });
    light("toLight", [](PelLight& l) { l.toLight[0] = NAN; });
    light("type", [](PelLight& l) { l.type = PelLightType(9); });
    light("spotCosInner", [](PelLight& l) { l.type = PEL_LIGHT_SPOT, l.spotCosInner = 0.5f; });
    expectRefused("65 lights", [&] { r.shader.set(std::vector<PelLight>(65, pelLightDefaults())); });
    PelAmbient ambient = pelAmbientDefaults();
    ambient.sh[4][1] = INFINITY;
    expectRefused("sh", [&] { r.shader.set(ambient); });
    PelCamera camera = pelCameraDefaults();
    camera.position[0] = NAN;
    expectRefused("position[0]", [&] { r.shader.set(camera); });
    camera.position[0] = -1e19f;
    expectRefused("1e18 is the most", [&] { r.shader.set(camera); });
    r.shader.commit().execute();
}

// --- pixels ---

constexpr PelImageSlot read[] = {
    PEL_SLOT_NORMAL_SHADING, PEL_SLOT_NORMAL_GEOMETRIC, PEL_SLOT_NORMAL_BLURRED,    PEL_SLOT_POSITION,
    PEL_SLOT_CURVATURE,      PEL_SLOT_ALBEDO,           PEL_SLOT_AMBIENT_OCCLUSION, PEL_SLOT_ROUGHNESS,
    PEL_SLOT_SPECULAR,       PEL_SLOT_INDIRECT};

TEST(ShadeBadPixels, NanAndInfStayInTheirPixel) {
    Frame f = randomFrame(2, 96, 40, 2);
    f.slots[PEL_SLOT_INDIRECT] = f.slots[PEL_SLOT_ALBEDO];
    const float color[3] = {0.5f, 0.25f, 8};
    std::copy_n(color, 3, f.options.invalidColor);
    for (float& id : f.slots[PEL_SLOT_MATERIAL].values) id = 1;
    const auto clean = shade(f);
    std::vector<size_t> bad;
    const size_t step = sized(113, 41);
    size_t pixel = 17;
    for (const float value : {NAN, INFINITY, -INFINITY})
        for (size_t k = 0; k <= std::size(read); ++k, pixel += step) {
            Image& image = k < std::size(read) ? f.slots[read[k]] : f.lights[1].wide;
            image.values[pixel * image.components + pixel % image.components] = value;
            bad.push_back(pixel);
        }
    ASSERT_LT(pixel, f.pixels() + step);
    // Invalid pixels are always counted, by each kind of tile list, also where other pixels are not counted.
    for (const PelTileLists lists : {PEL_TILES_ONE_LIST, PEL_TILES_PER_VARIANT, PEL_TILES_NO_LIST}) {
        f.options.tileLists = lists;
        f.options.countPixels = lists == PEL_TILES_NO_LIST;
        const auto [result, stats] = shadeCounted(f);
        EXPECT_EQ(stats.pixelsInvalid, bad.size());
        EXPECT_EQ(stats.pixelsSpecular > 0, bool(f.options.countPixels));
        for (size_t i = 0; i < f.pixels(); ++i)
            for (int c = 0; c < 3; ++c)
                EXPECT_EQ(result[3 * i + c],
                          std::find(bad.begin(), bad.end(), i) != bad.end() ? color[c] : clean[3 * i + c])
                    << "pixel " << i;
    }
}

// With `accumulate` the values that are in the image are an input, too.
TEST(ShadeBadPixels, AccumulatingOntoNanGivesTheInvalidColor) {
    for (const uint32_t components : {3u, 4u}) {
        Frame f = randomFrame(4, 49, 21);
        f.options.accumulate = 1;
        f.options.invalidColor[1] = 0.5f;
        const auto clean = shade(f);
        std::vector<float> before(f.pixels() * components, 0.25f);
        uint64_t bad = 0;
        for (size_t i = 3; i < f.pixels(); i += 7) {
            before[components * i + i % 3] = i % 2 ? NAN : i % 4 ? INFINITY : -INFINITY;
            bad += f.slots[PEL_SLOT_MATERIAL].values[i] != 0;
        }
        Shader shader(device());
        setFrame(device(), shader, f, tables());
        const Buffer target(device(), before);
        shader.set(
            PEL_SLOT_RADIANCE,
            imageDesc(target, components == 3 ? PEL_FORMAT_RGB32F : PEL_FORMAT_RGBA32F, f.width, f.height));
        shader.commit().execute();
        const auto after = target.readAll<float>();
        for (size_t i = 0; i < f.pixels(); ++i) {
            const bool material = f.slots[PEL_SLOT_MATERIAL].values[i] != 0, corrupted = i % 7 == 3;
            for (size_t c = 0; c < 3; ++c) {
                const float was = before[components * i + c], is = after[components * i + c];
                if (!material)
                    EXPECT_EQ(std::memcmp(&was, &is, sizeof was), 0) << "background, pixel " << i;
                else
                    EXPECT_EQ(is, corrupted ? f.options.invalidColor[c] : clean[3 * i + c] + 0.25f)
                        << "pixel " << i;
            }
        }
        EXPECT_GT(bad, 20u);
        EXPECT_EQ(shader.stats().pixelsInvalid, bad);
    }
}

TEST(ShadeBadPixels, AnythingGivesFiniteOutput) {
    constexpr float odd[] = {0,      -0.0f, NAN,      INFINITY, -INFINITY, 1e-42f, -1e-42f, 3e38f, -3e38f,
                             1e-20f, 1e20f, 65536.0f, -1e6f,    1.0f,      -1.0f,  0.5f,    256.f, 4e9f};
    for (uint32_t seed = 0; seed < 4; ++seed) {
        Frame f = randomFrame(40 + seed, 64, 64, 3);
        Random random(seed);
        const auto corrupt = [&](Image& image, uint32_t oneIn) {
            for (float& v : image.values)
                if (random.below(oneIn) == 0) v = odd[random.below(std::size(odd))];
        };
        for (Image& image : f.slots) corrupt(image, 6);
        for (Light& light : f.lights) {
            corrupt(light.wide, 6);
            corrupt(light.map, 3);
            if (seed == 2)
                for (float& m : light.params.worldToShadow) m = 0;  // singular
            if (seed == 3)
                for (int k = 12; k < 16; ++k) light.params.worldToShadow[k] *= -1;  // the other hand
        }
        // A point light that lies in the surface.
        std::copy_n(f.slots[PEL_SLOT_POSITION].values.begin(), 3, f.lights[1].params.position);
        for (float& p : f.lights[1].params.position)
            if (!std::isfinite(p)) p = 0;
        for (const PelFormat format : {PEL_FORMAT_RGB32F, PEL_FORMAT_RGB16F}) {
            Shader shader(device());
            const Buffer target(device(), f.pixels() * 12);
            setFrame(shader, f, target, format).commit().execute();
            if (format == PEL_FORMAT_RGB32F) {
                for (float v : target.readAll<float>()) ASSERT_TRUE(std::isfinite(v));
            } else {
                for (uint16_t h : target.readAll<uint16_t>()) ASSERT_NE(h & 0x7c00, 0x7c00);
            }
        }
    }
}

TEST(ShadeBadPixels, ZeroNormalsAndIdsBeyondTheTable) {
    Frame f = randomFrame(3, 32, 8, 1);
    f.ambient = pelAmbientDefaults();
    f.slots[PEL_SLOT_NORMAL_SHADING].values.assign(f.pixels() * 3, 0);
    f.slots[PEL_SLOT_CURVATURE] = {};
    for (auto& [id, m] : f.materials)
        for (float& c : m.deepScatterColor) c = 0;
    const float ids[] = {1, 256, 1e9f, -3, NAN, 0.9f, 7, 255};
    for (size_t i = 0; i < f.pixels(); ++i) f.slots[PEL_SLOT_MATERIAL].values[i] = ids[i % 8];
    Shader shader(device());
    const Buffer target(device(), std::vector<float>(f.pixels() * 4, 9.0f));
    setFrame(shader, f, target, PEL_FORMAT_RGBA32F);
    shader.commit().execute();
    const auto result = target.readAll<float>();
    for (size_t i = 0; i < f.pixels(); ++i) {
        EXPECT_EQ(result[4 * i], i % 8 == 0 || i % 8 == 6 ? 0.0f : 9.0f) << "id " << ids[i % 8];
        EXPECT_EQ(result[4 * i + 3], 9.0f) << "alpha is kept";
    }
}

}  // namespace
