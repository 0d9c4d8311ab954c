// The shading pass against the oracle: each term alone, their sum, and what must not change a bit of it.
#include <gtest/gtest.h>

#include <cstring>
#include <functional>

#include "shade_scene.h"
#include "tolerances.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::Device;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

void darken(Frame& f) {
    f.ambient = pelAmbientDefaults();
    for (auto& [id, m] : f.materials) {
        m.specular = 0;
        for (float& c : m.deepScatterColor) c = 0;
    }
    for (Light& light : f.lights) light.wide = {};
}

struct Term {
    const char* name;
    uint32_t features;
    std::function<void(Frame&, const Frame&)> light;  // darkened frame, the full one
};
void PrintTo(const Term& term, std::ostream* out) {
    *out << term.name;
}

class ShadeTerm : public testing::TestWithParam<Term> {};

TEST_P(ShadeTerm, MatchesTheOracle) {
    const Frame full = randomFrame(11, 203, 77, 3);
    Frame f = full;
    darken(f);
    GetParam().light(f, full);
    PelShaderStats stats = pelShaderStatsDefaults();
    const auto result = shade(device(), f, tables(), &stats);
    EXPECT_EQ(stats.features, GetParam().features);
    EXPECT_LE(worstError(f, result), tolerance::shadeTerm);
    EXPECT_GT(*std::max_element(result.begin(), result.end()), 0.01f) << "the term is there at all";
}

void noCurvature(Frame& f) {
    f.slots[PEL_SLOT_CURVATURE] = {};
}
void onlyAmbient(Frame& f, const Frame& full) {
    f.ambient = full.ambient;
    f.lights.clear();
}
void black(Frame& f) {
    f.slots[PEL_SLOT_ALBEDO].values.assign(f.pixels() * 3, 0.0f);
}

INSTANTIATE_TEST_SUITE_P(
    Terms, ShadeTerm,
    testing::Values(Term{"Lambert", 0, [](Frame& f, const Frame&) { noCurvature(f); }},
                    Term{"Direct", PEL_FEATURE_DIRECT_SCATTER, [](Frame&, const Frame&) {}},
                    Term{"PlainShadow", PEL_FEATURE_DIRECT_SCATTER | PEL_FEATURE_SHADOW,
                         [](Frame& f, const Frame& full) {
                             f.shadowLut = false;
                             for (size_t i = 0; i < f.lights.size(); ++i)
                                 f.lights[i].wide = full.lights[i].wide;
                         }},
                    Term{"ShadowLut", PEL_FEATURE_SHADOW | PEL_FEATURE_SHADOW_LUT,
                         [](Frame& f, const Frame& full) {
                             noCurvature(f);
                             for (size_t i = 0; i < f.lights.size(); ++i)
                                 f.lights[i].wide = full.lights[i].wide;
                         }},
                    Term{"Ambient", PEL_FEATURE_AMBIENT, onlyAmbient},
                    Term{"AmbientConstant", PEL_FEATURE_AMBIENT,
                         [](Frame& f, const Frame& full) {
                             onlyAmbient(f, full);
                             std::memset(f.ambient.sh, 0, sizeof f.ambient.sh);
                         }},
                    Term{"DeepScatterTaps", PEL_FEATURE_DEEP_SCATTER | PEL_FEATURE_THICKNESS_TAPS,
                         [](Frame& f, const Frame& full) {
                             noCurvature(f);
                             f.materials = full.materials;
                             for (auto& [id, m] : f.materials) m.specular = 0;
                         }},
                    Term{"DeepScatterImage", PEL_FEATURE_DEEP_SCATTER,
                         [](Frame& f, const Frame& full) {
                             noCurvature(f);
                             f.materials = full.materials;
                             for (auto& [id, m] : f.materials) m.specular = 0;
                             f.slots[PEL_SLOT_THICKNESS] = f.slots[PEL_SLOT_AMBIENT_OCCLUSION];
                             for (float& t : f.slots[PEL_SLOT_THICKNESS].values) t *= 20;
                         }},
                    Term{"DeepScatterAmbient", PEL_FEATURE_AMBIENT | PEL_FEATURE_AMBIENT_SCATTER,
                         [](Frame& f, const Frame& full) {
                             onlyAmbient(f, full);
                             f.materials = full.materials;
                             for (auto& [id, m] : f.materials)
                                 m.deepScatterAmbient = 0.1f * float(id), m.specular = 0;
                             f.slots[PEL_SLOT_THICKNESS] = f.slots[PEL_SLOT_AMBIENT_OCCLUSION];
                             for (float& t : f.slots[PEL_SLOT_THICKNESS].values) t *= 60;
                         }},
                    Term{"SpecularGgx", PEL_FEATURE_SPECULAR | PEL_FEATURE_SHADOW | PEL_FEATURE_GGX,
                         [](Frame& f, const Frame& full) {
                             noCurvature(f);
                             f.shadowLut = false;
                             black(f);
                             f.materials = full.materials;
                             for (auto& [id, m] : f.materials) {
                                 for (float& c : m.deepScatterColor) c = 0;
                                 if (id == 2) continue;  // one material of the other model
                                 m.specularModel = PEL_SPECULAR_GGX;
                                 m.roughness2 = 0.1f * float(id);
                             }
                             for (size_t i = 0; i < f.lights.size(); ++i)
                                 f.lights[i].wide = full.lights[i].wide;
                         }},
                    Term{"Specular", PEL_FEATURE_SPECULAR | PEL_FEATURE_SHADOW,
                         [](Frame& f, const Frame& full) {
                             noCurvature(f);
                             f.shadowLut = false;
                             black(f);
                             f.materials = full.materials;
                             for (auto& [id, m] : f.materials)
                                 for (float& c : m.deepScatterColor) c = 0;
                             for (size_t i = 0; i < f.lights.size(); ++i)
                                 f.lights[i].wide = full.lights[i].wide;
                         }}),
    [](const auto& info) { return info.param.name; });

TEST(Shade, EverythingAMillionPixels) {
#ifdef __SANITIZE_ADDRESS__
    constexpr uint32_t height = 20;  // the oracle is many times as slow there, and kernels are not looked at
#else
    constexpr uint32_t height = 400;
#endif
    double worst = 0;
    for (uint32_t seed = 1; seed <= 4; ++seed) {
        const Frame f = randomFrame(seed, 640, height, seed);
        worst = std::max(worst, worstError(f, shade(device(), f, tables())));
    }
    std::printf("worst error of the sum: %.2e\n", worst);
    EXPECT_LE(worst, tolerance::shadeSum);
}

TEST(Shade, SkippingChangesNoBitAndIsCounted) {
    for (uint32_t seed = 20; seed < 26; ++seed) {
        Frame f = randomFrame(seed, 150 + seed, 90, seed % 4);
        f.options.countPixels = 1;
        PelShaderStats with = pelShaderStatsDefaults(), without = with;
        const auto skipped = shade(device(), f, tables(), &with);
        f.options.disableSkipping = 1;
        EXPECT_EQ(skipped, shade(device(), f, tables(), &without)) << "seed " << seed;
        uint64_t materials = 0;
        for (float id : f.slots[PEL_SLOT_MATERIAL].values) materials += id != 0;
        EXPECT_EQ(with.pixelsShaded, materials);
        EXPECT_EQ(without.pixelsShaded, materials);
        EXPECT_LE(with.tilesShaded, with.tilesTotal);
        EXPECT_EQ(without.tilesShaded, without.tilesTotal);
        if (f.lights.empty()) continue;
        EXPECT_LT(with.pixelsThickness, without.pixelsThickness);
        EXPECT_GT(with.pixelsThickness, 0u);
        EXPECT_GT(with.pixelsShadowLut, 0u);
        EXPECT_LT(with.pixelsShadowLut, f.lights.size() * materials);
    }
}

TEST(Shade, BackgroundIsLeftAlone) {
    Frame f = randomFrame(31, 64, 48);
    for (size_t i = 0; i < f.pixels(); ++i)
        f.slots[PEL_SLOT_MATERIAL].values[i] = i == 40 * 64 + 5 ? 2.0f : i % 2 * 9.0f;
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const std::vector<float> before(f.pixels() * 4, -3.5f);
    const Buffer target(device(), before);
    shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGBA32F, 64, 48));
    shader.commit().execute();
    const auto after = target.readAll<float>();
    for (size_t i = 0; i < f.pixels(); ++i) {
        EXPECT_EQ(after[4 * i + 3], -3.5f) << "alpha is kept";
        EXPECT_EQ(after[4 * i] != -3.5f, i == 40 * 64 + 5) << i;
    }
    EXPECT_EQ(shader.stats().tilesShaded, 1u);
}

TEST(Shade, EveryWidthAndHeight) {
    for (const auto& [width, height] : std::vector<std::pair<uint32_t, uint32_t>>{
             {1, 1}, {1, 9}, {7, 1}, {8, 2}, {9, 3}, {15, 17}, {16, 16}, {17, 33}, {31, 5}}) {
        Frame f = randomFrame(width, width, height, 2);
        f.slots[PEL_SLOT_MATERIAL] = {};
        EXPECT_LE(worstError(f, shade(device(), f, tables())), tolerance::shadeSum)
            << width << " x " << height;
    }
}

TEST(Shade, AccumulateAddsOnce) {
    Frame f = randomFrame(8, 45, 20);
    const auto once = shade(device(), f, tables());
    f.options.accumulate = 1;
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const Buffer target(device(), std::vector<float>(f.pixels() * 3, 0.25f));
    shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, f.width, f.height));
    shader.commit().execute();
    const auto sum = target.readAll<float>();
    for (size_t i = 0; i < sum.size(); ++i) {
        const bool material = f.slots[PEL_SLOT_MATERIAL].values[i / 3] != 0;
        EXPECT_EQ(sum[i], material ? once[i] + 0.25f : 0.25f);
    }
}

}  // namespace
