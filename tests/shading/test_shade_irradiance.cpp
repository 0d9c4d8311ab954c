// Materials whose diffuse light comes from irradiance per pixel: made here, or the host's.
#include <gtest/gtest.h>

#include <limits>

#include "lanes.h"
#include "shade_scene.h"
#include "tolerances.h"

using namespace shade_test;

namespace {

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

TEST(ShadeIrradiance, UnscatteredIsLambert) {
    for (uint32_t seed : {1u, 2u, 3u}) {
        Frame f = lambert(seed);
        setScattering(f, PEL_SCATTERING_NONE);
        f.options.countPixels = 1;
        PelShaderStats stats = pelShaderStatsDefaults();
        const std::vector<float> result = shade(device(), f, tables(), &stats);
        EXPECT_LT(worstError(f, result), tolerance::shadeSum) << "against the oracle";
        EXPECT_EQ(stats.features & (PEL_FEATURE_IRRADIANCE | PEL_FEATURE_MAKE_IRRADIANCE),
                  uint32_t(PEL_FEATURE_IRRADIANCE | PEL_FEATURE_MAKE_IRRADIANCE));
        EXPECT_EQ(stats.pixelsIrradiance, stats.pixelsShaded);
        EXPECT_EQ(stats.pixelsByScattering[PEL_SCATTERING_NONE], stats.pixelsShaded);
        EXPECT_EQ(stats.pixelsByScattering[PEL_SCATTERING_PREINTEGRATED], 0u);
    }
}

// The last pixel of a tile too, where a vector is one pixel.
TEST(ShadeIrradiance, UnscatteredIsLambertWithAnyLanes) {
    for (int lanes : {1, 8, 16}) {
        const pellucid::Device narrow = deviceOf(lanes);
        const Tables none = makeTables(narrow, 8, 8);
        Frame f = lambert(1);
        setScattering(f, PEL_SCATTERING_NONE);
        f.options.countPixels = 1;
        PelShaderStats stats = pelShaderStatsDefaults();
        EXPECT_LT(worstError(f, shade(narrow, f, none, &stats)), tolerance::shadeSum) << lanes;
        EXPECT_EQ(stats.pixelsIrradiance, stats.pixelsShaded) << lanes;
    }
}

// A material beside others does not change them, and is not changed.
TEST(ShadeIrradiance, MaterialsKeepToThemselves) {
    Frame f = randomFrame(5, 211, 60, 2);
    const std::vector<float> tablesAlone = shade(device(), f, tables());
    Frame none = f;
    setScattering(none, PEL_SCATTERING_NONE);
    const std::vector<float> noneAlone = shade(device(), none, tables());
    Frame mixed = f;
    mixed.materials[2].scattering = PEL_SCATTERING_NONE;
    mixed.options.countPixels = 1;
    for (PelTileLists lists : {PEL_TILES_ONE_LIST, PEL_TILES_PER_VARIANT}) {
        mixed.options.tileLists = lists;
        PelShaderStats stats = pelShaderStatsDefaults();
        const std::vector<float> result = shade(device(), mixed, tables(), &stats);
        uint64_t second = 0;
        for (size_t i = 0; i < f.pixels(); ++i) {
            const bool isSecond = f.slots[PEL_SLOT_MATERIAL].values[i] == 2;
            second += isSecond;
            const auto& expected = isSecond ? noneAlone : tablesAlone;
            for (int c = 0; c < 3; ++c) EXPECT_EQ(result[3 * i + c], expected[3 * i + c]) << i;
        }
        EXPECT_GT(second, 100u);
        EXPECT_EQ(stats.pixelsIrradiance, second);
        EXPECT_EQ(stats.pixelsByScattering[PEL_SCATTERING_NONE], second);
        EXPECT_EQ(stats.pixelsByScattering[PEL_SCATTERING_PREINTEGRATED], stats.pixelsShaded - second);
    }
}

// The host's irradiance takes the place of lights and ambient in the diffuse part, and in no other.
TEST(ShadeIrradiance, TheHostsIsUsedAsItIs) {
    Frame f = lambert(7);
    setScattering(f, PEL_SCATTERING_NONE);
    Frame dark = f;  // specular and deep scatter alone
    for (auto& [id, m] : dark.materials)
        for (float& a : m.albedo) a = 0;
    Random random(9);
    Image& e = f.slots[PEL_SLOT_IRRADIANCE];
    e.components = 3;
    e.values.resize(f.pixels() * 3);
    for (float& v : e.values) v = random.uniform(0, 3);
    for (auto& [id, m] : f.materials)
        for (float& c : m.deepScatterColor) c = 0;
    f.slots[PEL_SLOT_ALBEDO] = {};
    dark.slots[PEL_SLOT_ALBEDO] = {};
    for (auto& [id, m] : dark.materials)
        for (float& c : m.deepScatterColor) c = 0;
    PelShaderStats stats = pelShaderStatsDefaults();
    const std::vector<float> result = shade(device(), f, tables(), &stats),
                             rest = shade(device(), dark, tables());
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
    e.values[3 * 1000 + 1] = std::numeric_limits<float>::quiet_NaN();
    f.slots[PEL_SLOT_MATERIAL].values[1000] = 2;
    f.options.invalidColor[1] = 7;
    std::vector<float> corrupted = shade(device(), f, tables());
    EXPECT_EQ(corrupted[3 * 1000 + 1], 7);
    EXPECT_EQ(corrupted[3 * 999 + 1], result[3 * 999 + 1]);
    f.materials[2].scattering = PEL_SCATTERING_PREINTEGRATED;
    corrupted = shade(device(), f, tables());
    EXPECT_NE(corrupted[3 * 1000 + 1], 7);
}

TEST(ShadeIrradiance, SaysWhatIsWrong) {
    Frame f = lambert(1);
    const auto message = [&](auto&& code) {
        try {
            shade(device(), f, tables());
        } catch (const pellucid::Error& e) {
            EXPECT_EQ(e.code(), code);
            return std::string(e.what());
        }
        return std::string("no error");
    };
    setScattering(f, PelScattering(9));
    EXPECT_NE(message(PEL_ERROR_INVALID_ARGUMENT).find("scattering is 9"), std::string::npos);
    setScattering(f, PEL_SCATTERING_TEXTURE);
    const std::string missing = message(PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_NE(missing.find("texture"), std::string::npos) << missing;
}

}  // namespace
