// What a shader refuses, with which words; and pixels that are no numbers.
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <thread>

#include "cl/cl_spy.h"
#include "shade_scene.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();

struct Ready {
    Frame frame = randomFrame(1, 32, 16, 1);
    Shader shader{device()};
    Buffer target{device(), 32 * 16 * 12};
    Ready() {
        setFrame(device(), shader, frame, tables());
        shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, 32, 16));
    }
};

// The call fails with this code and says all of `words`.
void expectError(PelError code, std::initializer_list<const char*> words, const std::function<void()>& call) {
    try {
        call();
        FAIL() << "no error";
    } catch (const pellucid::Error& e) {
        EXPECT_EQ(e.code(), code) << e.what();
        for (const char* word : words)
            EXPECT_NE(std::string(e.what()).find(word), std::string::npos)
                << "\"" << word << "\" in: " << e.what();
    }
}

TEST(ShadeBadInput, ExecuteNeedsACommit) {
    Ready r;
    expectError(PEL_ERROR_INVALID_STATE, {"pelShaderCommit"}, [&] { r.shader.execute(); });
    r.shader.commit().execute();
    r.shader.set(r.frame.ambient);
    expectError(PEL_ERROR_INVALID_STATE, {"pelShaderCommit"}, [&] { r.shader.execute(); });
    r.shader.commit().execute();
}

TEST(ShadeBadInput, ExecuteNeedsACommitAfterWhateverIsSet) {
    Ready r;
    pellucid::Shader& s = r.shader;
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
    s.commit().execute();
    for (size_t i = 0; i < std::size(setters); ++i) {
        SCOPED_TRACE("setter " + std::to_string(i));
        setters[i]();
        expectError(PEL_ERROR_INVALID_STATE, {"pelShaderCommit"}, [&] { s.execute(); });
        s.commit().execute();
    }
}

TEST(ShadeBadInput, ImagesThatDoNotFit) {
    Ready r;
    const Buffer buffer(device(), 32 * 16 * 16);
    const auto image = [&](PelFormat format) { return imageDesc(buffer, format, 32, 16); };
    const auto invalid = PEL_ERROR_INVALID_ARGUMENT;
    expectError(invalid, {"albedo", "R32F", "three components"},
                [&] { r.shader.set(PEL_SLOT_ALBEDO, image(PEL_FORMAT_R32F)); });
    expectError(invalid, {"radiance", "RGBA8_UNORM", "RGB or RGBA"},
                [&] { r.shader.set(PEL_SLOT_RADIANCE, image(PEL_FORMAT_RGBA8_UNORM)); });
    expectError(invalid, {"shading normal", "RGBA8_SRGB"},
                [&] { r.shader.set(PEL_SLOT_NORMAL_SHADING, image(PEL_FORMAT_RGBA8_SRGB)); });
    expectError(invalid, {"material", "R8_UNORM", "uint"},
                [&] { r.shader.set(PEL_SLOT_MATERIAL, image(PEL_FORMAT_R8_UNORM)); });
    expectError(invalid, {"wide shadow", "R32_UINT"},
                [&] { r.shader.set(0, PEL_LIGHT_WIDE_SHADOW, image(PEL_FORMAT_R32_UINT)); });
    expectError(invalid, {"format 99"}, [&] { r.shader.set(PEL_SLOT_ALBEDO, image(PelFormat(99))); });
    expectError(invalid, {"slot 77"}, [&] { r.shader.set(PelImageSlot(77), image(PEL_FORMAT_R32F)); });
    expectError(invalid, {"light 3"}, [&] { r.shader.set(3, PEL_LIGHT_SHADOW_MAP, image(PEL_FORMAT_R32F)); });

    PelImageDesc desc = image(PEL_FORMAT_RGB32F);
    desc.width = 0;
    expectError(invalid, {"0 x 16"}, [&] { r.shader.set(PEL_SLOT_ALBEDO, desc); });
    desc = image(PEL_FORMAT_RGB32F);
    desc.height = 20000;
    expectError(invalid, {"32 x 20000"}, [&] { r.shader.set(PEL_SLOT_ALBEDO, desc); });
    desc = image(PEL_FORMAT_RGBA32F);
    desc.byteOffset = 4;
    expectError(invalid, {"albedo", "ends at byte"}, [&] { r.shader.set(PEL_SLOT_ALBEDO, desc); });
    desc = image(PEL_FORMAT_R32F);
    desc.byteOffset = 2;
    expectError(invalid, {"byteOffset", "multiple of 4"}, [&] { r.shader.set(PEL_SLOT_CURVATURE, desc); });
    desc = image(PEL_FORMAT_RGB32F);
    desc.pixelStride = 8;
    expectError(invalid, {"pixelStride", "12 bytes"}, [&] { r.shader.set(PEL_SLOT_ALBEDO, desc); });
    desc = image(PEL_FORMAT_R32F);
    desc.rowStride = 64;
    expectError(invalid, {"rowStride", "128"}, [&] { r.shader.set(PEL_SLOT_CURVATURE, desc); });
    desc.rowStride = uint64_t(1) << 62;
    expectError(invalid, {"rowStride"}, [&] { r.shader.set(PEL_SLOT_CURVATURE, desc); });
    desc = image(PEL_FORMAT_R32F);
    desc.buffer = nullptr;
    expectError(invalid, {"PelBuffer"}, [&] { r.shader.set(PEL_SLOT_CURVATURE, desc); });
    const pellucid::Device other("");
    expectError(invalid, {"another PelDevice"}, [&] {
        r.shader.set(PEL_SLOT_CURVATURE, imageDesc(Buffer(other, 4096), PEL_FORMAT_R32F, 32, 16));
    });
    // None of it changed anything.
    r.shader.commit().execute();
    EXPECT_EQ(r.target.readAll<float>(), shade(device(), r.frame, tables()));
}

TEST(ShadeBadInput, WhatCommitMisses) {
    const auto invalid = PEL_ERROR_INVALID_ARGUMENT;
    const auto commit = [](Ready& r) { return [&r] { r.shader.commit(); }; };
    {
        Ready r;
        r.shader.set(PEL_SLOT_ALBEDO, imageDesc(Buffer(device(), 4800), PEL_FORMAT_RGB32F, 20, 20));
        expectError(invalid, {"albedo", "20 x 20", "32 x 16"}, commit(r));
    }
    for (const auto& [slot, word] : {std::pair{PEL_SLOT_RADIANCE, "radiance"},
                                     {PEL_SLOT_NORMAL_SHADING, "shading normal"},
                                     {PEL_SLOT_POSITION, "position"}}) {
        Ready r;
        r.shader.clear(slot);
        expectError(invalid, {word, "needed"}, commit(r));
    }
    {
        Ready r;
        for (uint32_t id : {1, 2, 7})
            pellucid::check(pelShaderSetMaterial(r.shader.get(), id, nullptr, nullptr, nullptr));
        expectError(invalid, {"no material"}, commit(r));
        r.shader.setMaterial(9, fixture::faceworksMaterial());
        r.shader.clear(PEL_SLOT_MATERIAL);
        expectError(invalid, {"material 1"}, commit(r));
    }
    {
        Ready r;
        PelLight light = r.frame.lights[0].params;
        light.shadowDepthRange = 0;
        r.shader.set({light});
        expectError(invalid, {"shadowDepthRange"}, commit(r));
        light = r.frame.lights[0].params;
        light.shadowProjection = PEL_SHADOW_PERSPECTIVE;
        r.shader.set({light});
        expectError(invalid, {"shadowDepthA"}, commit(r));
    }
    {
        Ready r;
        r.shader.set({r.frame.lights[0].params, r.frame.lights[0].params});
        r.shader.set(1, PEL_LIGHT_WIDE_SHADOW, imageDesc(Buffer(device(), 32 * 16), PEL_FORMAT_R8_UNORM, 32, 16));
        expectError(PEL_ERROR_UNSUPPORTED, {"wide shadow", "R32F", "R8_UNORM"}, commit(r));
    }
    {
        Ready r;
        std::vector<PelLight> lights(20, r.frame.lights[0].params);
        r.shader.set(lights);
        for (uint32_t i = 0; i < 20; ++i)
            r.shader.set(i, PEL_LIGHT_WIDE_SHADOW, imageDesc(Buffer(device(), 2048), PEL_FORMAT_R32F, 32, 16));
        expectError(PEL_ERROR_UNSUPPORTED, {"16", "buffers"}, commit(r));
        const Buffer one(device(), 20 * 2048);
        for (uint32_t i = 0; i < 20; ++i)
            r.shader.set(i, PEL_LIGHT_WIDE_SHADOW, imageDesc(one, PEL_FORMAT_R32F, 32, 16, i * 2048));
        EXPECT_NO_THROW(r.shader.commit().execute());
    }
}

TEST(ShadeBadInput, Values) {
    Ready r;
    const auto invalid = PEL_ERROR_INVALID_ARGUMENT;
    const auto material = [&](const char* word, auto change) {
        PelMaterial m = fixture::faceworksMaterial();
        change(m);
        expectError(invalid, {"PelMaterial", word}, [&] { r.shader.setMaterial(1, m); });
    };
    material("diffusionRadius", [](PelMaterial& m) { m.diffusionRadius = -2.7f; });
    material("diffusionRadius", [](PelMaterial& m) { m.diffusionRadius = nan; });
    material("shadowFilterWidth", [](PelMaterial& m) { m.shadowFilterWidth = -1; });
    material("deepScatterRadius", [](PelMaterial& m) { m.deepScatterRadius = 0; });
    material("normalBlend", [](PelMaterial& m) { m.normalBlend[2] = 1.5f; });
    material("albedo", [](PelMaterial& m) { m.albedo[1] = inf; });
    material("thicknessTaps", [](PelMaterial& m) { m.thicknessTaps = 12; });
    material("f0", [](PelMaterial& m) { m.f0 = 2; });
    const PelMaterial good = fixture::faceworksMaterial();
    expectError(invalid, {"material id 0"}, [&] { r.shader.setMaterial(0, good); });
    expectError(invalid, {"material id 256"}, [&] { r.shader.setMaterial(256, good); });
    expectError(invalid, {"curvature LUT", "other kind"},
                [&] { r.shader.setMaterial(1, good, tables().shadow); });

    const auto light = [&](const char* word, auto change) {
        PelLight l = pelLightDefaults();
        change(l);
        expectError(invalid, {"PelLight 0", word}, [&] { r.shader.set({l}); });
    };
    light("unit length", [](PelLight& l) { l.toLight[0] = 1; });
    light("toLight", [](PelLight& l) { l.toLight[0] = nan; });
    light("color", [](PelLight& l) { l.color[2] = -1; });
    light("type", [](PelLight& l) { l.type = PelLightType(9); });
    light("range", [](PelLight& l) { l.type = PEL_LIGHT_POINT, l.range = -1; });
    light("spotCosInner", [](PelLight& l) { l.type = PEL_LIGHT_SPOT, l.spotCosInner = 0.5f; });
    expectError(invalid, {"65 lights"}, [&] { r.shader.set(std::vector<PelLight>(65, pelLightDefaults())); });
    PelAmbient ambient = pelAmbientDefaults();
    ambient.sh[4][1] = inf;
    expectError(invalid, {"sh"}, [&] { r.shader.set(ambient); });
    PelCamera camera = pelCameraDefaults();
    camera.position[0] = nan;
    expectError(invalid, {"position[0]"}, [&] { r.shader.set(camera); });
    r.shader.commit().execute();
}

// --- pixels ---

constexpr PelImageSlot read[] = {
    PEL_SLOT_NORMAL_SHADING,    PEL_SLOT_NORMAL_GEOMETRIC, PEL_SLOT_NORMAL_BLURRED,
    PEL_SLOT_POSITION,          PEL_SLOT_CURVATURE,        PEL_SLOT_ALBEDO,
    PEL_SLOT_AMBIENT_OCCLUSION, PEL_SLOT_ROUGHNESS,        PEL_SLOT_SPECULAR};

TEST(ShadeBadPixels, NanAndInfStayInTheirPixel) {
    Frame f = randomFrame(2, 96, 40, 2);
    f.options.countPixels = 1;
    const float color[3] = {0.5f, 0.25f, 8};
    std::copy_n(color, 3, f.options.invalidColor);
    for (float& id : f.slots[PEL_SLOT_MATERIAL].values) id = 1;
    const auto clean = shade(device(), f, tables());
    std::vector<size_t> bad;
    const size_t step = sized(131, 47);
    size_t pixel = 17;
    for (const float value : {nan, inf, -inf})
        for (size_t k = 0; k <= std::size(read); ++k, pixel += step) {
            Image& image = k < std::size(read) ? f.slots[read[k]] : f.lights[1].wide;
            image.values[pixel * image.components + pixel % image.components] = value;
            bad.push_back(pixel);
        }
    ASSERT_LT(pixel, f.pixels() + step);
    for (const uint32_t disableSkipping : {0u, 1u}) {
        f.options.disableSkipping = disableSkipping;
        PelShaderStats stats = pelShaderStatsDefaults();
        const auto result = shade(device(), f, tables(), &stats);
        EXPECT_EQ(stats.pixelsInvalid, bad.size());
        for (size_t i = 0; i < f.pixels(); ++i)
            for (int c = 0; c < 3; ++c)
                EXPECT_EQ(result[3 * i + c],
                          std::find(bad.begin(), bad.end(), i) != bad.end() ? color[c] : clean[3 * i + c])
                    << "pixel " << i;
    }
}

// Counted without asking, in each way of finding tiles, where nothing else of pixels is.
TEST(ShadeBadPixels, AFrameOfNothingElseIsCountedAlways) {
    for (const float value : {nan, inf, -inf})
        for (const PelTileLists lists : {PEL_TILES_ONE_LIST, PEL_TILES_PER_VARIANT, PEL_TILES_NO_LIST}) {
            Frame f = randomFrame(2, 65, 19, 2);
            f.options.tileLists = lists;
            std::fill(f.slots[PEL_SLOT_NORMAL_SHADING].values.begin(),
                      f.slots[PEL_SLOT_NORMAL_SHADING].values.end(), value);
            uint64_t materials = 0;
            for (const float id : f.slots[PEL_SLOT_MATERIAL].values) materials += id != 0;
            PelShaderStats stats = pelShaderStatsDefaults();
            for (const float shown : shade(device(), f, tables(), &stats)) EXPECT_EQ(shown, 0.0f);
            EXPECT_EQ(stats.pixelsShaded, materials);
            EXPECT_EQ(stats.pixelsInvalid, materials);
            EXPECT_EQ(stats.pixelsSpecular, 0u) << "not asked for";
        }
}

// What stands in the image already is an input too.
TEST(ShadeBadPixels, AccumulatingOntoNanGivesTheInvalidColor) {
    for (const uint32_t components : {3u, 4u}) {
        Frame f = randomFrame(4, 49, 21);
        f.options.accumulate = 1;
        f.options.invalidColor[1] = 0.5f;
        const auto clean = shade(device(), f, tables());
        std::vector<float> before(f.pixels() * components, 0.25f);
        uint64_t bad = 0;
        for (size_t i = 3; i < f.pixels(); i += 7) {
            before[components * i + i % 3] = i % 2 ? nan : i % 4 ? inf : -inf;
            bad += f.slots[PEL_SLOT_MATERIAL].values[i] != 0;
        }
        Shader shader(device());
        setFrame(device(), shader, f, tables());
        const Buffer target(device(), before);
        shader.set(PEL_SLOT_RADIANCE, imageDesc(target, components == 3 ? PEL_FORMAT_RGB32F : PEL_FORMAT_RGBA32F,
                                                f.width, f.height));
        shader.commit().execute();
        const auto after = target.readAll<float>();
        for (size_t i = 0; i < f.pixels(); ++i) {
            const bool material = f.slots[PEL_SLOT_MATERIAL].values[i] != 0, spoilt = i % 7 == 3;
            for (size_t c = 0; c < 3; ++c) {
                const float was = before[components * i + c], is = after[components * i + c];
                if (!material)
                    EXPECT_EQ(std::memcmp(&was, &is, sizeof was), 0) << "background, pixel " << i;
                else
                    EXPECT_EQ(is, spoilt ? f.options.invalidColor[c] : clean[3 * i + c] + 0.25f)
                        << "pixel " << i;
            }
        }
        EXPECT_GT(bad, 20u);
        EXPECT_EQ(shader.stats().pixelsInvalid, bad);
    }
}

TEST(ShadeBadPixels, AnythingGivesFiniteOutput) {
    constexpr float odd[] = {0,      -0.0f, nan,      inf,   -inf, 1e-42f, -1e-42f, 3e38f, -3e38f,
                             1e-20f, 1e20f, 65536.0f, -1e6f, 1.0f, -1.0f,  0.5f,    256.f, 4e9f};
    for (uint32_t seed = 0; seed < 4; ++seed) {
        Frame f = randomFrame(40 + seed, 64, 64, 3);
        Random random(seed);
        const auto spoil = [&](Image& image, uint32_t oneIn) {
            for (float& v : image.values)
                if (random.below(oneIn) == 0) v = odd[random.below(std::size(odd))];
        };
        for (Image& image : f.slots) spoil(image, 6);
        for (Light& light : f.lights) {
            spoil(light.wide, 6);
            spoil(light.map, 3);
            if (seed == 2)
                for (float& m : light.params.worldToShadow) m = 0;  // singular
            if (seed == 3)
                for (int k = 12; k < 16; ++k) light.params.worldToShadow[k] *= -1;  // the other hand
        }
        // A light in the surface.
        std::copy_n(f.slots[PEL_SLOT_POSITION].values.begin(), 3, f.lights[1].params.position);
        for (float& p : f.lights[1].params.position)
            if (!std::isfinite(p)) p = 0;
        for (const PelFormat format : {PEL_FORMAT_RGB32F, PEL_FORMAT_RGB16F}) {
            Shader shader(device());
            setFrame(device(), shader, f, tables());
            const Buffer target(device(), f.pixels() * 12);
            shader.set(PEL_SLOT_RADIANCE, imageDesc(target, format, f.width, f.height)).commit().execute();
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
    const float ids[] = {1, 256, 1e9f, -3, nan, 0.9f, 7, 255};
    for (size_t i = 0; i < f.pixels(); ++i) f.slots[PEL_SLOT_MATERIAL].values[i] = ids[i % 8];
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const Buffer target(device(), std::vector<float>(f.pixels() * 3, 9.0f));
    shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, f.width, f.height)).commit().execute();
    const auto result = target.readAll<float>();
    for (size_t i = 0; i < f.pixels(); ++i)
        EXPECT_EQ(result[3 * i], i % 8 == 0 || i % 8 == 6 ? 0.0f : 9.0f) << "id " << ids[i % 8];
}

TEST(ShadeThreads, EachWithItsOwnShader) {
    const Frame f = randomFrame(5, 120, 60, 2);
    const auto expected = shade(device(), f, tables());
    std::vector<std::thread> threads;
    std::vector<int> equal(4, 0);
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (int k = 0; k < 5; ++k) equal[t] += shade(device(), f, tables()) == expected;
        });
    for (auto& thread : threads) thread.join();
    EXPECT_EQ(equal, std::vector<int>(4, 5));
}

TEST(ShadeSubmit, EventsAndKeptObjects) {
    const Frame f = randomFrame(5, 120, 60, 1);
    const auto expected = shade(device(), f, tables());
    const Buffer target(device(), f.pixels() * 12);
    PelEvent done = nullptr;
    {
        Shader shader(device());
        setFrame(device(), shader, f, tables());  // its images are released here, and kept by the shader
        shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, f.width, f.height)).commit();
        const PelSubmit submit{nullptr, 0, &done};
        shader.execute(&submit);
    }
    pellucid::Event event(done);
    event.wait();
    EXPECT_EQ(target.readAll<float>(), expected);
}

// --- progress and cancelling ---

struct Listener {
    std::vector<double> heard;
    double stopAt = 2;
};
int listen(void* user, double fraction, const char* what) {
    auto& listener = *static_cast<Listener*>(user);
    EXPECT_STREQ(what, "shading");
    listener.heard.push_back(fraction);
    return fraction < listener.stopAt;
}

TEST(ShadeProgress, IsToldAndMayCancel) {
    const pellucid::Device own("");
    const Tables ownTables = makeTables(own);
    Frame f = randomFrame(9, 2100, 1024, 1);  // more than two million pixels
    f.materials.erase(7);
    for (auto& [id, m] : f.materials) m.thicknessTaps = 0;
    const auto right = shade(own, f, ownTables);
    Listener patient, impatient;
    impatient.stopAt = 0.3;
    Shader shader(own);
    setFrame(own, shader, f, ownTables);
    const Buffer target(own, std::vector<float>(f.pixels() * 3, -3));
    shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, f.width, f.height)).commit();
    pellucid::check(pelDeviceSetProgress(own.get(), listen, &impatient));
    expectError(PEL_ERROR_CANCELLED, {"shading"}, [&] { shader.execute(); });
    const auto part = target.readAll<float>();
    size_t done = 0, left = 0;
    for (size_t i = 0; i < part.size(); ++i) {
        if (f.slots[PEL_SLOT_MATERIAL].values[i / 3] == 0 || f.slots[PEL_SLOT_MATERIAL].values[i / 3] == 7)
            continue;
        (part[i] == -3 ? left : done)++;
    }
    EXPECT_GT(done, 0u) << "the first million";
    EXPECT_GT(left, done / 2) << "not the rest";

    pellucid::check(pelDeviceSetProgress(own.get(), listen, &patient));
    shader.execute();
    EXPECT_GE(patient.heard.size(), 4u);
    EXPECT_EQ(patient.heard.front(), 0);
    EXPECT_EQ(patient.heard.back(), 1);
    EXPECT_TRUE(std::is_sorted(patient.heard.begin(), patient.heard.end()));
    // Submitted without waiting there is nobody to ask.
    patient.heard.clear();
    PelEvent done_ = nullptr;
    PelSubmit submit{};
    submit.done = &done_;
    shader.execute(&submit);
    EXPECT_TRUE(patient.heard.empty());
    pellucid::check(pelDeviceSetProgress(own.get(), nullptr, nullptr));
    const auto all = target.readAll<float>();
    pelEventRelease(done_);
    for (size_t i = 0; i < all.size(); ++i)
        if (all[i] != -3) {
            ASSERT_EQ(all[i], right[i]) << "the same bits in parts as at once";
        }
}

TEST(ShadeStats, NothingIsSentOrBuiltTwice) {
    Frame f = randomFrame(5, 120, 60, 1);
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const Buffer target(device(), f.pixels() * 12);
    shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, f.width, f.height)).commit().execute();
    PelShaderStats stats = shader.stats();
    EXPECT_GT(stats.bytesUploaded, 0u);
    EXPECT_EQ(stats.launches, 2u);
    const uint64_t built = stats.programsBuilt;
    const uint64_t sent = device().stats().bytesToDevice, allocated = device().stats().bytesAllocated;
    const spy::Counts asked = spy::counts();
    shader.set(f.ambient).commit().execute();
    shader.execute();
    EXPECT_EQ(spy::counts().transfers, asked.transfers);
    EXPECT_EQ(spy::counts().buffersMade, asked.buffersMade);
    stats = shader.stats();
    EXPECT_EQ(stats.bytesUploaded, 0u);
    EXPECT_EQ(stats.programsBuilt, built);
    EXPECT_EQ(device().stats().bytesToDevice, sent);
    EXPECT_EQ(device().stats().bytesAllocated, allocated);
    f.ambient.constant[0] += 1;
    shader.set(f.ambient).commit().execute();
    EXPECT_GT(shader.stats().bytesUploaded, 0u);
    EXPECT_LT(shader.stats().bytesUploaded, 4096u) << "the tables are not sent again";

    f.slots[PEL_SLOT_MATERIAL].values.assign(f.pixels(), 0.0f);
    shader.set(PEL_SLOT_MATERIAL,
               imageDesc(upload(device(), f.slots[PEL_SLOT_MATERIAL]), PEL_FORMAT_R32F, f.width, f.height));
    shader.commit().execute();
    EXPECT_EQ(shader.stats().tilesShaded, 0u);
}

}  // namespace
