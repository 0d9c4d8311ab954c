// Frames that are shaded in bands of rows, within a budget of scratch memory: the same bits as in one piece.
#include <gtest/gtest.h>

#include "pass_scene.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

// Blurred normals of one material, a normal map for the other, two wide shadows to filter; lit by both
// lights.
Frame passesFrame(uint32_t seed, uint32_t width, uint32_t height) {
    Frame f = reliefFrame(seed, width, height, 0.4f);
    for (const bool perspective : {false, true})
        f.lights.push_back(mapLight(seed, perspective, false, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, 61).light);
    f.options.blurNormals = f.options.countPixels = 1;
    f.curvatureLut = f.shadowLut = true;
    f.slots[PEL_SLOT_CURVATURE] = f.slots[PEL_SLOT_MATERIAL];
    for (int c = 0; c < 3; ++c) f.ambient.constant[c] = 0.2f;
    return f;
}

struct Result {
    std::vector<float> radiance;
    PelShaderStats stats;
};

Result run(const Frame& f, uint64_t budget, bool normalMap = false) {
    Shader shader(device());
    Frame limited = f;
    limited.options.scratchBudget = budget;
    setFrame(device(), shader, limited, tables());
    Random random(5);
    std::vector<float> texels(64 * 64 * 3), uv(f.pixels() * 2), tangent;
    for (float& t : texels) t = random.uniform();
    for (size_t i = 0; i < uv.size(); ++i) uv[i] = float(i % 977) / 400;
    for (size_t i = 0; i < f.pixels(); ++i) tangent.insert(tangent.end(), {1, 0, 0});
    if (normalMap) {
        shader.setNormalMap(2, {imageDesc(Buffer(device(), texels), PEL_FORMAT_RGB32F, 64, 64)});
        shader.set(PEL_SLOT_UV, imageDesc(Buffer(device(), uv), PEL_FORMAT_RG32F, f.width, f.height));
        shader.set(PEL_SLOT_TANGENT,
                   imageDesc(Buffer(device(), tangent), PEL_FORMAT_RGB32F, f.width, f.height));
    }
    const auto target = setTarget(device(), shader, f);
    shader.commit().execute();
    Result result{target.readAll<float>(), shader.stats()};
    if (f.options.accumulate) return result;
    shader.execute();  // what the bands left behind does not matter
    EXPECT_EQ(target.readAll<float>(), result.radiance);
    return result;
}

void expectSame(const Result& bands, const Result& whole) {
    EXPECT_EQ(bands.radiance, whole.radiance);
    EXPECT_EQ(bands.stats.tilesShaded, whole.stats.tilesShaded);
    EXPECT_EQ(bands.stats.pixelsShaded, whole.stats.pixelsShaded);
    EXPECT_EQ(bands.stats.pixelsShadowLut, whole.stats.pixelsShadowLut);
    EXPECT_EQ(bands.stats.pixelsWideShadow, whole.stats.pixelsWideShadow);
    EXPECT_EQ(bands.stats.tilesTotal, whole.stats.tilesTotal);
}

TEST(ShadeBands, WideShadowsOfEveryBudget) {
    Frame f = passesFrame(1, 150, 61);
    f.options.blurNormals = 0;
    const Result whole = run(f, 0);
    EXPECT_EQ(whole.stats.bands, 1u);
    const uint64_t rowBytes = 150 * 8;  // two lights
    for (const auto& [rows, bands] : {std::pair{2u, 31u}, {3u, 31u}, {10u, 7u}, {60u, 2u}, {61u, 1u}}) {
        const Result some = run(f, rows * rowBytes);
        EXPECT_EQ(some.stats.bands, bands) << rows;
        EXPECT_LT(some.stats.scratchBytes, whole.stats.scratchBytes + (bands == 1));
        expectSame(some, whole);
    }
}

// The blur reads up to 384 rows to each side: the frame is taller than that, and seen from far enough for
// wide steps.
TEST(ShadeBands, BlurredNormalsAndMapsWithTheirHalo) {
    Frame f = passesFrame(2, 70, 1000);
    for (size_t i = 0; i < f.pixels(); ++i)
        for (int c = 0; c < 3; ++c)
            f.slots[PEL_SLOT_POSITION].values[3 * i + c] *= 0.02f;  // a close-up: steps of many pixels
    for (const bool map : {false, true}) {
        const Result whole = run(f, 0, map);
        EXPECT_TRUE(whole.stats.features & PEL_FEATURE_BLUR_NORMALS);
        EXPECT_EQ(bool(whole.stats.features & PEL_FEATURE_NORMAL_MAP), map);
        const uint64_t rowBytes = 70 * (40 + 8),
                       guards = 2 * 400 * 40;  // of PEL_PLANE_GUARD values round each plane
        for (const auto& [rows, bands] : {std::pair{770u, 500u}, {786u, 56u}, {968u, 5u}}) {
            if (map && bands > 100) continue;
            const Result some = run(f, rows * rowBytes + guards, map);
            EXPECT_EQ(some.stats.bands, bands) << rows;
            expectSame(some, whole);
        }
    }
}

TEST(ShadeBands, WithoutMaterialImageAddedToTheTarget) {
    Frame f = passesFrame(3, 90, 40);
    f.options.blurNormals = 0;
    f.options.accumulate = 1;
    f.slots[PEL_SLOT_MATERIAL] = {};
    const Result whole = run(f, 0), some = run(f, 90 * 8 * 6);
    EXPECT_EQ(some.stats.bands, 7u);
    expectSame(some, whole);
}

TEST(ShadeBands, ABudgetThatIsTooSmallSaysWhatWouldDo) {
    Frame f = passesFrame(1, 150, 61);
    f.options.scratchBudget = 1000;
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const auto target = setTarget(device(), shader, f);
    try {
        shader.commit();
        FAIL() << "it fitted";
    } catch (const pellucid::Error& e) {
        EXPECT_EQ(e.code(), PEL_ERROR_OUT_OF_MEMORY);
        EXPECT_NE(std::string(e.what()).find("at least " + std::to_string(150 * 48 * 61 + 2 * 400 * 40)),
                  std::string::npos)
            << e.what();
    }
    f.options.scratchBudget = 150 * 48 * 61 + 2 * 400 * 40;
    shader.set(f.options).commit().execute();
    // Without passes there is no scratch memory to limit.
    f.options.blurNormals = 0;
    f.options.scratchBudget = 1;
    for (Light& light : f.lights) light.params.shadowFilterTexels = 0;
    setFrame(device(), shader, f, tables());
    shader.commit().execute();
    EXPECT_EQ(shader.stats().bands, 1u);
}

// Bands that come one after another tell how far they are, and a cancelled run leaves the next one whole.
TEST(ShadeBands, TellProgressAndStop) {
    struct Telling {
        double last = -1;
        int calls = 0, stopAt = -1;
    } telling;
    const pellucid::Device own("");
    const Tables ownTables = makeTables(own, 32, 32);
    Frame f = passesFrame(4, 64, 40);
    f.options.blurNormals = 0;
    f.options.scratchBudget = 64 * 8 * 8;
    Shader shader(own);
    setFrame(own, shader, f, ownTables);
    const auto target = setTarget(own, shader, f);
    shader.commit().execute();
    const auto right = target.readAll<float>();
    const auto callback = [](void* user, double fraction, const char*) {
        auto& t = *static_cast<Telling*>(user);
        EXPECT_GT(fraction, t.last);
        t.last = fraction;
        return int(++t.calls != t.stopAt);
    };
    pellucid::check(pelDeviceSetProgress(own.get(), callback, &telling));
    shader.execute();
    EXPECT_EQ(telling.calls, 6);
    EXPECT_EQ(telling.last, 1);
    telling = {-1, 0, 3};
    EXPECT_THROW(shader.execute(), pellucid::Error);
    telling = {};
    shader.execute();
    EXPECT_EQ(target.readAll<float>(), right);
}

}  // namespace
