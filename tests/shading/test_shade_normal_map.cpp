// Blurred normals from a normal map.
#include <gtest/gtest.h>

#include <limits>

#include "pass_scene.h"
#include "shader_ready.h"
#include "tolerances.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

struct Mapped {
    Frame frame;
    std::vector<reference::NormalLevel> levels;
    std::vector<float> texels;  // all levels, RGB
    double uvScale = 120;       // length
};

Mapped mappedFrame(uint32_t seed, uint32_t size) {
    Mapped m;
    Random random(seed);
    m.frame = reliefFrame(seed, 90, 40, 0.5f);
    Frame& f = m.frame;
    f.slots[PEL_SLOT_UV].components = 2;
    f.slots[PEL_SLOT_UV_GRADIENT].components = f.slots[PEL_SLOT_TANGENT].components = 4;
    for (size_t i = 0; i < f.pixels(); ++i) {
        const Vec3 n = f.slots[PEL_SLOT_NORMAL_GEOMETRIC].vec(i),
                   t = reference::normalized(Vec3{1, 0, 0} - n.x * n);
        for (float v : {float(t.x), float(t.y), float(t.z), i % 3 ? 1.0f : -1.0f})
            f.slots[PEL_SLOT_TANGENT].values.push_back(v);
        for (float v : {random.uniform(-1.5f, 2.5f), random.uniform(-1.5f, 2.5f)})
            f.slots[PEL_SLOT_UV].values.push_back(v);
        const float footprint = std::exp2(random.uniform(-12, -2));
        for (int c = 0; c < 4; ++c)
            f.slots[PEL_SLOT_UV_GRADIENT].values.push_back(footprint * random.uniform(-1, 1));
    }
    for (uint32_t s = size; s > 0; s /= 2) {
        reference::NormalLevel level{int(s), int(s), {}};
        for (uint32_t i = 0; i < s * s; ++i) {
            float v[3];
            random.unit(v);
            v[2] = std::fabs(v[2]) + 0.3f;
            level.texels.push_back({v[0], v[1], v[2]});
            m.texels.insert(m.texels.end(), v, v + 3);
        }
        m.levels.push_back(std::move(level));
    }
    for (auto& [id, material] : f.materials) material.uvScale = float(m.uvScale);
    showBlurredNormal(f);
    return m;
}

std::vector<PelImageDesc> descriptions(const Mapped& m, const Buffer& buffer) {
    std::vector<PelImageDesc> all;
    uint64_t at = 0;
    for (const auto& level : m.levels) {
        all.push_back(
            imageDesc(buffer, PEL_FORMAT_RGB32F, uint32_t(level.width), uint32_t(level.height), at));
        at += level.texels.size() * 12;
    }
    return all;
}

std::vector<float> shadeMapped(const Mapped& m, std::initializer_list<uint32_t> ids,
                               PelShaderStats* stats = nullptr) {
    const Buffer map(device(), m.texels);
    return shade(device(), m.frame, tables(), stats, [&](Shader& shader) {
        for (uint32_t id : ids) shader.setNormalMap(id, descriptions(m, map));
    });
}

Vec3 mappedTruth(const Mapped& m, size_t i) {
    const Frame& f = m.frame;
    const PelMaterial& material = f.materials.at(uint32_t(f.slots[PEL_SLOT_MATERIAL].at(i)));
    const auto g = [&](uint32_t c) { return f.slots[PEL_SLOT_UV_GRADIENT].at(i, c); };
    double level = reference::blurredNormalMip(m.levels[0].width, material.diffusionRadius, m.uvScale);
    if (!f.slots[PEL_SLOT_UV_GRADIENT].values.empty())
        level = std::max(level, reference::footprintLevel({g(0), g(1), g(2), g(3)}, m.levels[0].width,
                                                          m.levels[0].height));
    const Vec3 texel =
        reference::trilinear(m.levels, f.slots[PEL_SLOT_UV].at(i, 0), f.slots[PEL_SLOT_UV].at(i, 1), level);
    const auto& tangent = f.slots[PEL_SLOT_TANGENT];
    return reference::fromTangentSpace(texel, {tangent.at(i, 0), tangent.at(i, 1), tangent.at(i, 2)},
                                       f.slots[PEL_SLOT_NORMAL_GEOMETRIC].vec(i),
                                       tangent.at(i, 3) < 0 ? -1 : 1);
}

TEST(NormalMap, MatchesTheOracle) {
    for (const bool gradients : {true, false}) {
        Mapped m = mappedFrame(3, 64);
        if (!gradients) m.frame.slots[PEL_SLOT_UV_GRADIENT] = {};
        PelShaderStats stats = pelShaderStatsDefaults();
        const auto shown = shadeMapped(m, {1, 2}, &stats);
        EXPECT_EQ(stats.features, uint32_t(PEL_FEATURE_AMBIENT | PEL_FEATURE_NORMAL_MAP));
        EXPECT_EQ(stats.launches, 4u) << "classify, a map per material, shade";
        double worst = 0;
        for (size_t i = 0; i < m.frame.pixels(); ++i)
            if (m.frame.slots[PEL_SLOT_MATERIAL].values[i] != 0)
                worst = std::max(worst, distance(shownNormal(shown, i), mappedTruth(m, i)));
        EXPECT_LE(worst, tolerance::mappedNormal);
    }
}

TEST(NormalMap, NeverSharperThanTheOrdinaryLevelAndBlurredOverTheRadius) {
    Mapped m = mappedFrame(4, 64);
    for (size_t k = 0; k < m.levels.size(); ++k)  // each level leans further along the tangent
        for (
            size_t i = 0, at =
                              [&] {
                                  size_t a = 0;
                                  for (size_t j = 0; j < k; ++j) a += 3 * m.levels[j].texels.size();
                                  return a;
                              }();
            i < m.levels[k].texels.size(); ++i) {
            m.texels[at + 3 * i] = float(k);
            m.texels[at + 3 * i + 1] = 0;
            m.texels[at + 3 * i + 2] = 1;
        }
    const auto levelSeen = [&] {
        const auto shown = shadeMapped(m, {1, 2});
        const size_t i = 20 * 90 + 60;
        const Vec3 n = m.frame.slots[PEL_SLOT_NORMAL_GEOMETRIC].vec(i), s = shownNormal(shown, i);
        const auto& t = m.frame.slots[PEL_SLOT_TANGENT];
        return reference::dot(s, {t.at(i, 0), t.at(i, 1), t.at(i, 2)}) / reference::dot(s, n);
    };
    auto& gradients = m.frame.slots[PEL_SLOT_UV_GRADIENT].values;
    const auto footprint = [&](float texels) {
        for (size_t i = 0; i < gradients.size(); ++i) gradients[i] = i % 4 == 0 ? texels / 64 : 0;
    };
    const double blurred = std::log2(64 * 2.7 / m.uvScale);
    footprint(0.01f);
    EXPECT_NEAR(levelSeen(), blurred, tolerance::mappedLevel) << "magnified: the diffusion radius alone";
    footprint(9.0f);
    EXPECT_NEAR(levelSeen(), std::log2(9.0), tolerance::mappedLevel)
        << "minified: as sharp as any other texture";
    for (auto& [id, material] : m.frame.materials) material.uvScale = 1e6f;
    footprint(0.01f);
    EXPECT_NEAR(levelSeen(), 0, tolerance::mappedLevel) << "texels longer than the radius: the finest level";
}

TEST(NormalMap, MaterialsWithoutOneKeepTheirNormal) {
    Mapped m = mappedFrame(5, 16);
    PelShaderStats stats = pelShaderStatsDefaults();
    for (const bool blur : {false, true}) {
        m.frame.options.blurNormals = blur;
        const auto shown = shadeMapped(m, {1}, &stats);
        EXPECT_EQ(stats.features, uint32_t(PEL_FEATURE_AMBIENT | PEL_FEATURE_NORMAL_MAP |
                                           (blur ? PEL_FEATURE_BLUR_NORMALS : 0)));
        const auto blurred = reference::blurredNormals(surfaceOf(m.frame));
        size_t close = 0, of = 0;
        for (size_t i = 0; i < m.frame.pixels(); ++i) {
            const float id = m.frame.slots[PEL_SLOT_MATERIAL].values[i];
            if (id == 1) {
                EXPECT_LE(distance(shownNormal(shown, i), mappedTruth(m, i)), tolerance::mappedNormal);
            }
            if (id != 2) continue;
            const Vec3 right = blur ? *blurred[i] : m.frame.slots[PEL_SLOT_NORMAL_GEOMETRIC].vec(i);
            ++of;
            close += distance(shownNormal(shown, i), right) <= tolerance::shadeTerm;
        }
        EXPECT_GT(10 * close, 9 * of);
    }
}

TEST(NormalMap, BadInput) {
    Mapped m = mappedFrame(6, 8);
    m.frame.options.invalidColor[1] = -7;
    m.frame.slots[PEL_SLOT_UV].values[2 * 700] = nan;
    m.frame.slots[PEL_SLOT_UV_GRADIENT].values[4 * 701 + 2] = nan;
    m.frame.slots[PEL_SLOT_TANGENT].values[4 * 702] = nan;
    const auto shown = shadeMapped(m, {1, 2});
    for (size_t i = 0; i < m.frame.pixels(); ++i) {
        EXPECT_TRUE(std::isfinite(shown[3 * i])) << i;
        EXPECT_EQ(shown[3 * i + 1] == -7, i >= 700 && i <= 702) << i;
    }
    const auto refused = [&](PelError code, const char* word, auto change) {
        Mapped bad = mappedFrame(6, 8);
        Shader shader(device());
        const Buffer map(device(), bad.texels), target(device(), bad.frame.pixels() * 12);
        auto levels = descriptions(bad, map);
        uint32_t id = 1;
        change(bad, levels, id);
        expectError(code, {word}, [&] {
            setFrame(device(), shader, bad.frame, tables());
            shader.set(PEL_SLOT_RADIANCE,
                       imageDesc(target, PEL_FORMAT_RGB32F, bad.frame.width, bad.frame.height));
            shader.setNormalMap(id, levels).commit();
        });
    };
    using Levels = std::vector<PelImageDesc>;
    refused(PEL_ERROR_INVALID_ARGUMENT, "material 9", [](Mapped&, Levels&, uint32_t& id) { id = 9; });
    refused(PEL_ERROR_INVALID_ARGUMENT, "4 x 4", [](Mapped&, Levels& l, uint32_t&) { l[1].width = 3; });
    refused(PEL_ERROR_INVALID_ARGUMENT, "another format",
            [](Mapped&, Levels& l, uint32_t&) { l[1].format = PEL_FORMAT_RGBA8_UNORM; });
    refused(PEL_ERROR_INVALID_ARGUMENT, "R32F",
            [](Mapped&, Levels& l, uint32_t&) { l[0].format = PEL_FORMAT_R32F; });
    refused(PEL_ERROR_INVALID_ARGUMENT, "17 levels",
            [](Mapped&, Levels& l, uint32_t&) { l.resize(17, l[0]); });
    refused(PEL_ERROR_INVALID_ARGUMENT, "UV image",
            [](Mapped& b, Levels&, uint32_t&) { b.frame.slots[PEL_SLOT_UV] = {}; });
    refused(PEL_ERROR_INVALID_ARGUMENT, "tangent image",
            [](Mapped& b, Levels&, uint32_t&) { b.frame.slots[PEL_SLOT_TANGENT] = {}; });
}

TEST(NormalMap, ATexelThatIsNoNumberStaysWithThePixelsThatReadIt) {
    Mapped m = mappedFrame(8, 16);
    m.frame.options.invalidColor[1] = -7;
    const auto before = shadeMapped(m, {1, 2});
    m.texels[3 * (16 * 5 + 9)] = m.texels[3 * (16 * 16 + 8 * 3 + 2) + 1] = nan;  // of the two finest levels
    for (size_t k = 0, at = 0; k < 2; at += 3 * m.levels[k].texels.size(), ++k)
        for (size_t i = 0; i < m.levels[k].texels.size(); ++i)
            for (size_t c = 0; c < 3; ++c) m.levels[k].texels[i][int(c)] = m.texels[at + 3 * i + c];
    const auto after = shadeMapped(m, {1, 2});
    size_t invalid = 0;
    for (size_t i = 0; i < m.frame.pixels(); ++i) {
        if (m.frame.slots[PEL_SLOT_MATERIAL].values[i] == 0) continue;
        // The oracle reads with a weight of 0 too.
        const bool mayRead = !std::isfinite(reference::length(mappedTruth(m, i))),
                   bad = after[3 * i + 1] == -7;
        invalid += bad;
        EXPECT_TRUE(mayRead || !bad) << i;
        for (size_t c = 0; c < 3; ++c)
            EXPECT_EQ(after[3 * i + c], !bad ? before[3 * i + c] : c == 1 ? -7 : 0) << i;
    }
    EXPECT_GT(invalid, 20u);
}

TEST(NormalMap, BytesDecodeToTheSame) {
    Mapped m = mappedFrame(7, 16);
    std::vector<uint8_t> bytes;
    for (size_t i = 0, at = 0; i < m.levels.size(); ++i)
        for (Vec3& v : m.levels[i].texels) {
            for (int c = 0; c < 3; ++c, ++at) {
                bytes.push_back(uint8_t(std::lround(std::clamp((v[c] + 1) / 2, 0.0, 1.0) * 255)));
                v[c] = m.texels[at] = float(2 * bytes.back() / 255.0 - 1);
            }
            bytes.push_back(3);
        }
    Shader shader(device());
    setFrame(device(), shader, m.frame, tables());
    const Buffer map(device(), bytes), target(device(), m.frame.pixels() * 12);
    auto levels = descriptions(m, map);
    for (PelImageDesc& level : levels)
        level.format = PEL_FORMAT_RGBA8_UNORM, level.byteOffset = level.byteOffset / 12 * 4;
    shader.setNormalMap(1, levels).setNormalMap(2, levels);
    shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, m.frame.width, m.frame.height));
    shader.commit().execute();
    const auto shown = target.readAll<float>();
    for (size_t i = 0; i < m.frame.pixels(); ++i) {
        if (m.frame.slots[PEL_SLOT_MATERIAL].values[i] == 0) continue;
        EXPECT_LE(distance(shownNormal(shown, i), mappedTruth(m, i)), tolerance::mappedNormal) << i;
    }
}

}  // namespace
