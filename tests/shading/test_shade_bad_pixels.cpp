// Pixels with NaN, Inf or no material do not change their neighbours.
#include <cstring>
#include <limits>

#include "shader_ready.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();

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

// Invalid pixels are always counted, by each kind of tile list, also where other pixels are not counted.
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

// With `accumulate` the values that are in the image are an input, too.
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
    constexpr float odd[] = {0,      -0.0f, nan,      inf,   -inf, 1e-42f, -1e-42f, 3e38f, -3e38f,
                             1e-20f, 1e20f, 65536.0f, -1e6f, 1.0f, -1.0f,  0.5f,    256.f, 4e9f};
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

}  // namespace
