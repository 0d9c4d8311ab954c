// Inputs that the shader makes itself, against the oracle: normals blurred on screen and from a normal map,
// and ambient light from a cube map.
#include "pass_scene.h"
#include "shader_ready.h"
#include "variable.h"

using namespace shade_test;
using reference::CubeMap;

namespace {

// --- blurred on screen ---

struct WorstPass {
    double error = 0;
    size_t compared = 0, doubtful = 0;
};
WorstPass againstOracle(const Frame& f, const std::vector<float>& radiance) {
    std::vector<bool> doubtful;
    const auto truth = reference::blurredNormals(surfaceOf(f), &doubtful);
    WorstPass worst;
    for (size_t i = 0; i < f.pixels(); ++i) {
        if (!truth[i]) continue;
        if (doubtful[i]) {
            ++worst.doubtful;
            continue;
        }
        ++worst.compared;
        worst.error = std::max(worst.error, magnitude(shownNormal(radiance, i) - *truth[i]));
    }
    return worst;
}

TEST(BlurNormals, MatchesTheOracle) {
    for (const auto& [seed, pixel] : {std::pair{1u, 0.31f}, {2u, 0.9f}, {3u, 0.07f}, {4u, 4.0f}}) {
        Frame f = reliefFrame(seed, 150, 70, pixel);
        showBlurredNormal(f);
        f.options.blurNormals = 1;
        const auto [shown, stats] = shadeCounted(f);
        EXPECT_EQ(stats.features, uint32_t(PEL_FEATURE_AMBIENT | PEL_FEATURE_BLUR_NORMALS));
        EXPECT_EQ(stats.launches, 5u) << "classify, prepare, along x, along y, shade";
        const WorstPass worst = againstOracle(f, shown);
        EXPECT_LE(worst.error, tolerance::shadeTerm) << "pixels " << pixel << " apart";
        EXPECT_GT(worst.compared, 9 * worst.doubtful);
    }
}

TEST(BlurNormals, OffCostsNothingAndAnImageGoesFirst) {
    Frame f = reliefFrame(1, 64, 32, 0.5f);
    showBlurredNormal(f);
    PelShaderStats off = pelShaderStatsDefaults(), on = off, given = off;
    const auto plain = shade(f, &off);
    EXPECT_EQ(off.launches, 2u);
    f.options.blurNormals = 1;
    EXPECT_NE(plain, shade(f, &on));
    EXPECT_GE(on.scratchBytes, off.scratchBytes + 40 * f.pixels());
    f.slots[PEL_SLOT_NORMAL_BLURRED] = f.slots[PEL_SLOT_NORMAL_GEOMETRIC];
    EXPECT_EQ(plain, shade(f, &given));
    EXPECT_EQ(given.launches, off.launches);
    EXPECT_EQ(given.scratchBytes, off.scratchBytes);
}

TEST(BlurNormals, BadPixelsStayAlone) {
    Frame f = reliefFrame(5, 120, 60, 0.3f);
    showBlurredNormal(f);
    f.options.blurNormals = 1;
    f.options.invalidColor[0] = -7;
    const auto before = shade(f);
    Frame bad = f;
    const size_t normal = sized(20, 2) * 120 + 30, position = sized(40, 9) * 120 + 90;
    bad.slots[PEL_SLOT_NORMAL_SHADING].values[3 * normal] = NAN;
    bad.slots[PEL_SLOT_POSITION].values[3 * position + 1] = INFINITY;
    const auto [after, stats] = shadeCounted(bad);
    EXPECT_EQ(stats.pixelsInvalid, 2u);
    for (size_t i = 0; i < f.pixels(); ++i) EXPECT_EQ(after[3 * i] == -7, i == normal || i == position) << i;
    EXPECT_TRUE(farOnesAreSame(f, before, after, {normal, position}, 12));  // six taps of two pixels at most
    EXPECT_LE(againstOracle(bad, after).error, tolerance::shadeTerm);
}

TEST(BlurNormals, OddFrames) {
    const Variable fence("PELLUCID_FENCE", "begin");
    for (const auto& [width, height] : {std::pair{1u, 1u}, {1u, 9u}, {17u, 1u}, {129u, 3u}, {450u, 2u}}) {
        Frame f = reliefFrame(2, width, height, 0.5f);
        f.slots[PEL_SLOT_MATERIAL] = {};
        showBlurredNormal(f);
        f.options.blurNormals = 1;
        EXPECT_LE(againstOracle(f, shade(f)).error, tolerance::shadeTerm) << width << " x " << height;
        f.slots[PEL_SLOT_POSITION].values.assign(f.pixels() * 3, 0.0f);  // all in one place
        for (float value : shade(f)) EXPECT_TRUE(std::isfinite(value));
        f.slots[PEL_SLOT_POSITION] = {};
        EXPECT_THROW(shade(f), pellucid::Error) << "positions are needed";
    }
}

// --- from a normal map ---

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
        const Vec3 n = f.slots[PEL_SLOT_NORMAL_GEOMETRIC].vec(i), t = normalized(Vec3{1, 0, 0} - n.x * n);
        f.slots[PEL_SLOT_TANGENT].push(t);
        f.slots[PEL_SLOT_TANGENT].values.push_back(i % 3 ? 1.0f : -1.0f);
        for (int c = 0; c < 2; ++c) f.slots[PEL_SLOT_UV].values.push_back(random.uniform(-1.5f, 2.5f));
        const float footprint = std::exp2(random.uniform(-12, -2));
        for (int c = 0; c < 4; ++c)
            f.slots[PEL_SLOT_UV_GRADIENT].values.push_back(footprint * random.uniform(-1, 1));
    }
    for (uint32_t s = size; s > 0; s /= 2) {
        reference::NormalLevel level{int(s), int(s), {}};
        for (uint32_t i = 0; i < s * s; ++i) {
            const Vec3 v = random.unit();
            for (double c : {v.x, v.y, std::abs(v.z) + 0.3}) m.texels.push_back(float(c));
            level.texels.push_back(vectorOf(m.texels.data() + m.texels.size() - 3));
        }
        m.levels.push_back(std::move(level));
    }
    for (auto& [id, material] : f.materials) material.uvScale = float(m.uvScale);
    showBlurredNormal(f);
    return m;
}

std::vector<PelImageDesc> descriptions(const Mapped& m, const Buffer& buffer, bool bytes = false) {
    std::vector<PelImageDesc> all;
    uint64_t at = 0;
    for (const auto& level : m.levels) {
        all.push_back(imageDesc(buffer, bytes ? PEL_FORMAT_RGBA8_UNORM : PEL_FORMAT_RGB32F,
                                uint32_t(level.width), uint32_t(level.height), at));
        at += level.texels.size() * (bytes ? 4 : 12);
    }
    return all;
}

std::vector<float> shadeMapped(const Mapped& m, std::initializer_list<uint32_t> ids,
                               PelShaderStats* stats = nullptr, const Buffer& bytes = {}) {
    const Buffer map = bytes.get() ? bytes : Buffer(device(), m.texels);
    const auto levels = descriptions(m, map, bytes.get());
    return shade(m.frame, stats, [&](Shader& shader) {
        for (uint32_t id : ids) shader.setNormalMap(id, levels);
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

TEST(NormalMap, MatchesTheOracleAndMaterialsWithoutOneKeepTheirNormal) {
    for (const bool gradients : {true, false})
        for (const bool blur : {false, true})  // of what has no map
            for (const bool both : {true, false}) {
                Mapped m = mappedFrame(3, blur ? 64 : 20);  // and no power of two
                if (!gradients) m.frame.slots[PEL_SLOT_UV_GRADIENT] = {};
                m.frame.options.blurNormals = blur;
                PelShaderStats stats = pelShaderStatsDefaults();
                const auto shown = both ? shadeMapped(m, {1, 2}, &stats) : shadeMapped(m, {1}, &stats);
                const bool blurs = blur && !both;
                EXPECT_EQ(stats.features, uint32_t(PEL_FEATURE_AMBIENT | PEL_FEATURE_NORMAL_MAP |
                                                   (blurs ? PEL_FEATURE_BLUR_NORMALS : 0)));
                EXPECT_EQ(stats.launches, 3u + both + 3 * blurs) << "classify, a map per material, shade";
                const auto blurred = reference::blurredNormals(surfaceOf(m.frame));
                size_t close = 0, of = 0;
                for (size_t i = 0; i < m.frame.pixels(); ++i) {
                    const float id = m.frame.slots[PEL_SLOT_MATERIAL].values[i];
                    if (id == 1 || (id == 2 && both)) {
                        ASSERT_LE(magnitude(shownNormal(shown, i) - mappedTruth(m, i)),
                                  tolerance::mappedNormal)
                            << i;
                    } else if (id == 2) {
                        const Vec3 right =
                            blur ? *blurred[i] : m.frame.slots[PEL_SLOT_NORMAL_GEOMETRIC].vec(i);
                        ++of, close += magnitude(shownNormal(shown, i) - right) <= tolerance::shadeTerm;
                    }
                }
                EXPECT_GE(10 * close, 9 * of);
            }
}

TEST(NormalMap, BadInput) {
    Mapped m = mappedFrame(6, 8);
    m.frame.options.invalidColor[1] = -7;
    m.frame.slots[PEL_SLOT_UV].values[2 * 700] = NAN;
    m.frame.slots[PEL_SLOT_UV_GRADIENT].values[4 * 701 + 2] = NAN;
    m.frame.slots[PEL_SLOT_TANGENT].values[4 * 702] = NAN;
    const auto shown = shadeMapped(m, {1, 2});
    for (size_t i = 0; i < m.frame.pixels(); ++i) {
        EXPECT_TRUE(std::isfinite(shown[3 * i])) << i;
        EXPECT_EQ(shown[3 * i + 1] == -7, i >= 700 && i <= 702) << i;
    }
    using Levels = std::vector<PelImageDesc>;
    const auto refused = [&](const char* word, auto change) {
        Mapped bad = mappedFrame(6, 8);
        const Buffer map(device(), bad.texels);
        Levels levels = descriptions(bad, map);
        uint32_t id = 1;
        change(bad, levels, id);
        expectRefused(word,
                      [&] { shade(bad.frame, nullptr, [&](Shader& s) { s.setNormalMap(id, levels); }); });
    };
    refused("material 9", [](Mapped&, Levels&, uint32_t& id) { id = 9; });
    refused("4 x 4", [](Mapped&, Levels& l, uint32_t&) { l[1].width = 3; });
    refused("another format", [](Mapped&, Levels& l, uint32_t&) { l[1].format = PEL_FORMAT_RGBA8_UNORM; });
    refused("R32F", [](Mapped&, Levels& l, uint32_t&) { l[0].format = PEL_FORMAT_R32F; });
    refused("17 levels", [](Mapped&, Levels& l, uint32_t&) { l.resize(17, l[0]); });
    refused("UV image", [](Mapped& b, Levels&, uint32_t&) { b.frame.slots[PEL_SLOT_UV] = {}; });
    refused("tangent image", [](Mapped& b, Levels&, uint32_t&) { b.frame.slots[PEL_SLOT_TANGENT] = {}; });
}

TEST(NormalMap, ATexelOfNanStaysWithThePixelsThatReadIt) {
    Mapped m = mappedFrame(8, 16);
    m.frame.options.invalidColor[1] = -7;
    const auto before = shadeMapped(m, {1, 2});
    m.texels[3 * (16 * 5 + 9)] = m.texels[3 * (16 * 16 + 8 * 3 + 2) + 1] = NAN;  // of the two finest levels
    for (size_t k = 0, at = 0; k < 2; at += 3 * m.levels[k].texels.size(), ++k)
        for (size_t i = 0; i < m.levels[k].texels.size(); ++i)
            m.levels[k].texels[i] = vectorOf(&m.texels[at + 3 * i]);
    const auto after = shadeMapped(m, {1, 2});
    size_t invalid = 0;
    for (size_t i = 0; i < m.frame.pixels(); ++i) {
        if (m.frame.slots[PEL_SLOT_MATERIAL].values[i] == 0) continue;
        // The oracle reads with a weight of 0 too.
        const bool mayRead = !std::isfinite(length(mappedTruth(m, i))), bad = after[3 * i + 1] == -7;
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
    const auto shown = shadeMapped(m, {1, 2}, nullptr, Buffer(device(), bytes));
    for (size_t i = 0; i < m.frame.pixels(); ++i) {
        if (m.frame.slots[PEL_SLOT_MATERIAL].values[i] == 0) continue;
        EXPECT_LE(magnitude(shownNormal(shown, i) - mappedTruth(m, i)), tolerance::mappedNormal) << i;
    }
}

// --- ambient light from a cube map ---

CubeMap randomCube(uint32_t seed, int size) {
    Random random(seed);
    CubeMap cube{size, {}};
    for (int i = 0; i < 6 * size * size; ++i)
        cube.texels.push_back({random.uniform(0, 1), random.uniform(-0.2f, 1), random.uniform(0, 0.5f)});
    return cube;
}

// A cube whose texels are light(direction).
template <class Light>
CubeMap cubeOf(int size, Light&& light) {
    CubeMap cube{size, {}};
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                cube.texels.push_back(light(
                    reference::cubeDirection(face, (2 * x + 1.0) / size - 1, (2 * y + 1.0) / size - 1)));
    return cube;
}

// Only ambient light on a white surface of these normals.
Frame ambientFrame(const std::vector<Vec3>& normals) {
    Frame f;
    f.width = uint32_t(normals.size());
    f.height = 1;
    Image& n = f.slots[PEL_SLOT_NORMAL_SHADING];
    n.components = 3;
    for (const Vec3& v : normals) n.push(v);
    f.materials[1] = fixture::faceworksMaterial();
    std::fill_n(f.materials[1].albedo, 3, 1.0f);
    return f;
}

std::vector<Vec3> randomNormals(uint32_t seed, size_t count) {
    Random random(seed);
    std::vector<Vec3> normals;
    if (count > 1000) count = sized<size_t>(count, 600);
    while (normals.size() < count) normals.push_back(random.unit());
    return normals;
}

// Alone, and beside harmonics, lights and what comes through.
TEST(ShadeCube, MatchesTheOracle) {
    for (const int size : {1, 2, 5, 16})
        for (const bool alone : {true, false}) {
            Frame f = randomFrame(uint32_t(size), 203, 40, alone ? 0 : 2);
            f.cube = randomCube(uint32_t(size), size);
            if (alone) f.ambient = pelAmbientDefaults();
            for (auto& [id, m] : f.materials) m.deepScatterAmbient = alone ? 0 : 0.6f;
            if (!alone) f.slots[PEL_SLOT_THICKNESS] = f.slots[PEL_SLOT_AMBIENT_OCCLUSION];
            for (float& t : f.slots[PEL_SLOT_THICKNESS].values)
                t *= 300;  // some beyond the cutoff, where terms are skipped
            const auto [result, stats] = shadeCounted(f);
            EXPECT_TRUE(stats.features & PEL_FEATURE_AMBIENT_CUBE);
            EXPECT_EQ(bool(stats.features & PEL_FEATURE_AMBIENT_SCATTER), !alone);
            EXPECT_LE(worstError(f, result), alone ? tolerance::shadeTerm : tolerance::shadeSum) << size;
            EXPECT_GT(*std::max_element(result.begin(), result.end()), 0.1f);
            if (alone) continue;
            // Skipping changes no bit, also beside texels of NaN.
            f.cube.texels[f.cube.texels.size() / 2].y = NAN;
            const auto skipped = shade(f);
            f.options.disableSkipping = 1;
            EXPECT_EQ(skipped, shade(f));
        }
}

TEST(ShadeCube, ABadTexelStaysWhereItIsRead) {
    auto normals = randomNormals(13, 5000);
    normals[0] = {0, 0, 0};
    Frame f = ambientFrame(normals);
    f.cube = randomCube(14, 8);
    f.options.invalidColor[0] = -3;
    const auto good = shade(f);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(good[c], 0) << "a normal of 0 gets nothing";
    for (const double bad : {double(NAN), double(INFINITY)}) {
        Frame g = f;
        const int face = 3, x = 0, y = 5;  // on an edge
        g.cube.texels[(face * 8 + y) * 8 + x].x = bad;
        const auto [result, stats] = shadeCounted(g);
        const Vec3 place =
            normalized(reference::cubeDirection(face, (2 * x + 1) / 8.0 - 1, (2 * y + 1) / 8.0 - 1));
        uint64_t invalid = 0;
        for (size_t i = 0; i < normals.size(); ++i) {
            const bool lost = result[3 * i] == -3;
            invalid += lost;
            EXPECT_TRUE(lost || std::memcmp(&result[3 * i], &good[3 * i], 12) == 0) << i;
            // Two texels away, of 14 degrees at most each; and well inside the texel.
            EXPECT_FALSE(lost && dot(normals[i], place) < std::cos(0.5)) << i;
            EXPECT_TRUE(lost || dot(normals[i], place) < std::cos(0.04)) << i;
        }
        EXPECT_EQ(stats.pixelsInvalid, invalid);
        EXPECT_GT(invalid, sized(20u, 3u));
    }
}

TEST(ShadeCube, AZeroNormalGetsNothing) {
    std::vector<Vec3> normals(16, Vec3{0, 0, 1});
    normals[0] = {0, 0, 0};
    Frame f = ambientFrame(normals);
    f.cube = cubeOf(2, [](Vec3) { return Rgb{1, 1, 1}; });
    std::vector<float> expected(48, 1.0f);
    std::fill_n(expected.begin(), 3, 0.0f);
    EXPECT_EQ(shade(f), expected);
}

TEST(ShadeCube, ComesInAnyColourFormatAndBothShapes) {
    const uint32_t n = 5;
    Frame f = ambientFrame(randomNormals(15, 700)), plain = f;
    // Values that every format holds exactly: 0 and 1.
    f.cube = cubeOf(int(n), [&](Vec3 d) {
        return Rgb{double(d.x > 0.3), double(d.y > d.z), double(d.x + d.z < 0)};
    });
    const auto expected = shade(f);
    const auto texel = [&](size_t i, size_t c) { return float(f.cube.texels[i][int(c)]); };
    const size_t texels = 6 * n * n;
    std::vector<uint8_t> bytes;
    std::vector<uint16_t> halves;
    std::vector<float> planes(3 * texels), wide(texels * 3);
    for (size_t i = 0; i < texels; ++i) {
        for (size_t c = 0; c < 3; ++c) {
            bytes.push_back(uint8_t(255 * texel(i, c)));
            halves.push_back(texel(i, c) > 0 ? 0x3c00 : 0);
            planes[c * texels + i] = texel(i, c);
            const size_t face = i / (n * n), y = i / n % n, x = i % n;
            wide[3 * (y * 6 * n + face * n + x) + c] = texel(i, c);
        }
        bytes.push_back(7);
    }
    const auto expectSame = [&](const auto& data, PelFormat format, uint32_t w, uint32_t h) {
        EXPECT_EQ(expected, shade(plain, nullptr, [&](Shader& shader) {
                      shader.setAmbientCube(imageDesc(Buffer(device(), data), format, w, h));
                  }));
    };
    expectSame(bytes, PEL_FORMAT_RGBA8_UNORM, n, 6 * n);
    expectSame(bytes, PEL_FORMAT_RGBA8_SRGB, n, 6 * n);
    expectSame(halves, PEL_FORMAT_RGB16F, n, 6 * n);
    expectSame(planes, PEL_FORMAT_PLANAR_RGB32F, n, 6 * n);
    expectSame(wide, PEL_FORMAT_RGB32F, 6 * n, n);
}

TEST(ShadeCube, ChangesAreSeenWithoutACommit) {
    Frame f = ambientFrame(std::vector<Vec3>(16, Vec3{0, 1, 0}));
    Shader shader(device());
    const Buffer target(device(), 16 * 12), faces(device(), std::vector<float>(18, 0.5f));
    setFrame(shader, f, target).setAmbientCube(imageDesc(faces, PEL_FORMAT_RGB32F, 1, 6)).commit().execute();
    EXPECT_EQ(target.readAll<float>()[0], 0.5f);
    const std::vector<float> other(18, 0.25f);
    faces.write(other.data(), 72);
    shader.execute();
    EXPECT_EQ(target.readAll<float>()[0], 0.25f);
    EXPECT_EQ(shader.stats().bytesUploaded, 0u);
    EXPECT_GE(shader.stats().scratchBytes, 18u * 9 * 4);
}

TEST(ShadeCube, BadInput) {
    Shader shader(device());
    const Buffer b(device(), 6 * 16 * 16 * 16);
    const auto refused = [&](PelFormat format, uint32_t w, uint32_t h, const char* words) {
        expectRefused(words, [&] { shader.setAmbientCube(imageDesc(b, format, w, h)); });
    };
    refused(PEL_FORMAT_RGB32F, 8, 8, "8 x 8; six square faces");
    refused(PEL_FORMAT_RGB32F, 8, 47, "n x 6n");
    refused(PEL_FORMAT_R32F, 8, 48, "three components");
    refused(PEL_FORMAT_R32_UINT, 8, 48, "three components");
    refused(PEL_FORMAT_RGBA32F, 32, 192, "ends at byte");
    EXPECT_EQ(pelShaderSetAmbientCube(nullptr, nullptr), PEL_ERROR_INVALID_ARGUMENT);

    const Frame f = ambientFrame(randomNormals(1, 32));
    setFrame(shader, f, b);
    shader.setAmbientCube(imageDesc(b, PEL_FORMAT_RGB32F, 4, 24));
    expectRefused("ambient cube", [&] { shader.commit(); });
}

}  // namespace
