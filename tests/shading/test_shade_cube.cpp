// Ambient light from a cube map: against the oracle, against what it stands for, at its edges, and with bad
// texels.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "sample/sky.h"
#include "shade_scene.h"
#include "tolerances.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::imageDesc;
using pellucid::Shader;
using reference::CubeMap;
using reference::sampleCube;

namespace {

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
    for (const Vec3& v : normals) n.values.insert(n.values.end(), {float(v.x), float(v.y), float(v.z)});
    f.materials[1] = fixture::faceworksMaterial();
    std::fill_n(f.materials[1].albedo, 3, 1.0f);
    return f;
}

std::vector<Vec3> randomNormals(uint32_t seed, size_t count) {
    Random random(seed);
    std::vector<Vec3> normals;
    if (count > 1000) count = sized<size_t>(count, 600);
    for (float v[3]; normals.size() < count;) random.unit(v), normals.push_back({v[0], v[1], v[2]});
    return normals;
}

// All inputs of a pixel, but lit only by ambient light.
Frame randomAmbient(uint32_t seed, int size) {
    Frame f = randomFrame(seed, 203, 40, 0);
    f.cube = randomCube(seed, size);
    f.ambient = pelAmbientDefaults();
    return f;
}

// Irradiance of random harmonics, positive everywhere.
reference::Ambient randomHarmonics(uint32_t seed) {
    Random random(seed);
    reference::Ambient ambient{{0.8, 0.8, 0.8}, {}};
    for (Rgb& h : ambient.harmonics)
        h = {random.uniform(-0.15f, 0.15f), random.uniform(-0.15f, 0.15f), random.uniform(-0.15f, 0.15f)};
    return ambient;
}

double worstOf(const std::vector<float>& result, const std::vector<Vec3>& normals,
               const reference::Ambient& truth) {
    double worst = 0;
    for (size_t i = 0; i < normals.size(); ++i)
        for (int c = 0; c < 3; ++c)
            worst = std::max(
                worst, std::abs(result[3 * i + c] - irradiance(truth, reference::normalized(normals[i]))[c]));
    return worst;
}

TEST(ShadeCube, MatchesTheOracle) {
    for (int size : {1, 2, 5, 16}) {
        const Frame f = randomAmbient(uint32_t(size), size);
        PelShaderStats stats = pelShaderStatsDefaults();
        const auto result = shade(device(), f, tables(), &stats);
        EXPECT_EQ(stats.features, uint32_t(PEL_FEATURE_AMBIENT | PEL_FEATURE_AMBIENT_CUBE));
        EXPECT_LE(worstError(f, result), tolerance::shadeTerm) << size;
        EXPECT_GT(*std::max_element(result.begin(), result.end()), 0.1f);
    }
}

TEST(ShadeCube, AddsToHarmonicsAndComesThrough) {
    for (uint32_t seed : {3u, 4u}) {
        Frame f = randomFrame(seed, 203, 40, 2);
        f.cube = randomCube(seed, 7);
        for (auto& [id, m] : f.materials) m.deepScatterAmbient = 0.6f;
        f.slots[PEL_SLOT_THICKNESS] = f.slots[PEL_SLOT_AMBIENT_OCCLUSION];
        for (float& t : f.slots[PEL_SLOT_THICKNESS].values)
            t *= 300;  // some beyond the cutoff, where terms are skipped
        PelShaderStats stats = pelShaderStatsDefaults();
        const auto result = shade(device(), f, tables(), &stats);
        EXPECT_TRUE(stats.features & PEL_FEATURE_AMBIENT_SCATTER);
        EXPECT_LE(worstError(f, result), tolerance::shadeSum);
        // Skipping changes no bit, also beside texels of NaN.
        f.cube.texels[3 + 20 * seed].y = std::numeric_limits<double>::quiet_NaN();
        f.options.disableSkipping = 1;
        const auto all = shade(device(), f, tables());
        f.options.disableSkipping = 0;
        EXPECT_EQ(all, shade(device(), f, tables()));
    }
}

TEST(ShadeCube, KernelsThatDoLessGiveTheSameBits) {
    // One material lets ambient light through and shines, the others do neither: tiles of those alone get a
    // kernel of their own.
    Frame f = randomFrame(8, 400, 24, 1);
    f.cube = randomCube(8, 7);
    f.slots[PEL_SLOT_THICKNESS] = f.slots[PEL_SLOT_AMBIENT_OCCLUSION];
    for (auto& [id, m] : f.materials) {
        m.deepScatterAmbient = id == 1 ? 0.6f : 0.0f;
        m.specular = id == 1 ? m.specular : 0;
        if (id != 1) std::fill_n(m.deepScatterColor, 3, 0.0f);
    }
    for (size_t i = 0; i < f.pixels(); ++i) f.slots[PEL_SLOT_MATERIAL].values[i] = i % f.width < 128 ? 1 : 2;
    PelShaderStats stats = pelShaderStatsDefaults();
    f.options.tileLists = PEL_TILES_PER_VARIANT;
    const auto apart = shade(device(), f, tables(), &stats);
    EXPECT_GT(stats.tilesPartial, 0u);
    f.options.tileLists = PEL_TILES_ONE_LIST;
    EXPECT_EQ(shade(device(), f, tables()), apart);
}

TEST(ShadeCube, AConstantCubeIsTheConstant) {
    Frame f = ambientFrame(randomNormals(1, 5000)), g = f;
    const Rgb light{0.25, 0.5, 0.125};
    f.cube = cubeOf(9, [&](Vec3) { return light; });
    for (int c = 0; c < 3; ++c) g.ambient.constant[c] = float(light[c]);
    EXPECT_EQ(shade(device(), f, tables()), shade(device(), g, tables()))
        << "texels of powers of two: to the bit";
}

TEST(ShadeCube, SampledFromHarmonicsItIsThoseToSecondOrder) {
    const auto normals = randomNormals(2, 6000);
    Frame f = ambientFrame(normals);
    const reference::Ambient truth = randomHarmonics(5);
    double errors[3];
    for (int i = 0; i < 3; ++i) {
        f.cube = cubeOf(8 << i, [&](Vec3 d) { return irradiance(truth, reference::normalized(d)); });
        errors[i] = worstOf(shade(device(), f, tables()), normals, truth);
        RecordProperty("error_" + std::to_string(8 << i), std::to_string(errors[i]));
    }
    EXPECT_LE(errors[2], tolerance::cubeOfHarmonics);
    EXPECT_LE(errors[1], 4.5 * errors[2]) << "a quarter of the error with twice the texels";
    EXPECT_GE(errors[1], 3 * errors[2]);
    EXPECT_LE(errors[0], 4.5 * errors[1]);
}

// Irradiance / pi of a sky by a midpoint rule of `rings` x 2 `rings` directions.
struct SkyIrradiance {
    std::vector<std::pair<Vec3, Rgb>> light;  // direction, radiance times solid angle over pi
    explicit SkyIrradiance(const pellucid::sample::Sky& sky, int rings = 48) {
        for (int i = 0; i < rings; ++i)
            for (int j = 0; j < 2 * rings; ++j) {
                const double z = (2 * i + 1.0) / rings - 1, phi = M_PI * (j + 0.5) / rings,
                             r = std::sqrt(1 - z * z);
                const auto l = sky.radiance({r * std::cos(phi), r * std::sin(phi), z});
                light.push_back({{r * std::cos(phi), r * std::sin(phi), z},
                                 (2.0 / (rings * rings)) * Rgb{l[0], l[1], l[2]}});
            }
    }
    Rgb operator()(Vec3 n) const {
        Rgb sum;
        for (const auto& [d, l] : light) sum = sum + std::max(0.0, dot(d, n)) * l;
        return sum;
    }
};

TEST(ShadeCube, OfASkyItIsNearerThanHarmonics) {
    const pellucid::sample::Sky sky;
    const SkyIrradiance truth(sky);
    const auto normals = randomNormals(21, 800);
    Frame f = ambientFrame(normals), g = f;
    const auto harmonics = pellucid::sample::projectIrradiance(sky);
    for (size_t i = 0; i < 9; ++i)
        for (size_t c = 0; c < 3; ++c) g.ambient.sh[i][c] = float(harmonics[i][c]);
    f.cube = cubeOf(16, [&](Vec3 d) { return truth(reference::normalized(d)); });
    const auto cube = shade(device(), f, tables()), nine = shade(device(), g, tables());
    double errors[2] = {}, most = 0;
    for (size_t i = 0; i < normals.size(); ++i) {
        const Rgb exact = truth(normals[i]);
        for (int c = 0; c < 3; ++c) {
            errors[0] = std::max(errors[0], std::abs(cube[3 * i + c] - exact[c]));
            errors[1] = std::max(errors[1], std::abs(nine[3 * i + c] - exact[c]));
            most = std::max(most, exact[c]);
        }
    }
    RecordProperty("cube", std::to_string(errors[0] / most));
    RecordProperty("harmonics", std::to_string(errors[1] / most));
    EXPECT_LE(errors[0], 0.25 * errors[1]);
}

TEST(ShadeCube, HasNoSeams) {
    // Pairs of directions on both sides of each of the twelve edges, along its whole length. White noise
    // would show any step.
    Random random(9);
    std::vector<Vec3> normals;
    for (int i = 0; i < 4000; ++i) {
        const int axis = i % 3;
        double v[3];
        for (int c = 0; c < 3; ++c) v[c] = random.below(2) ? 1 : -1;
        v[axis] = random.uniform(-1, 1);
        for (double step : {-2e-6, 2e-6}) {
            double w[3] = {v[0], v[1], v[2]};
            w[(axis + 1) % 3] *= 1 + step;
            normals.push_back({w[0], w[1], w[2]});
        }
    }
    Frame f = ambientFrame(normals);
    f.cube = randomCube(10, 6);
    const auto result = shade(device(), f, tables());
    for (size_t i = 0; i < result.size(); i += 6)
        for (size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(result[i + c], result[i + 3 + c], tolerance::cubeSeam) << i / 6;
}

TEST(ShadeCube, TurnsWithTheNormals) {
    const auto turnX = [](Vec3 v) { return Vec3{v.x, -v.z, v.y}; };
    const auto turnZ = [](Vec3 v) { return Vec3{-v.y, v.x, v.z}; };
    const auto backX = [](Vec3 v) { return Vec3{v.x, v.z, -v.y}; };
    const auto backZ = [](Vec3 v) { return Vec3{v.y, -v.x, v.z}; };
    const CubeMap cube = randomCube(11, 4);
    const auto normals = randomNormals(12, 3000);
    Frame f = ambientFrame(normals);
    f.cube = cube;
    const auto straight = shade(device(), f, tables());
    std::vector<Vec3> turned;
    for (const Vec3& n : normals) turned.push_back(turnZ(turnX(n)));
    Frame g = ambientFrame(turned);
    g.cube = cubeOf(4, [&](Vec3 d) { return sampleCube(cube, backX(backZ(d))); });
    const auto result = shade(device(), g, tables());
    for (size_t i = 0; i < result.size(); ++i) EXPECT_NEAR(result[i], straight[i], tolerance::shadeTerm);
}

TEST(ShadeCube, ABadTexelStaysWhereItIsRead) {
    const auto normals = randomNormals(13, 5000);
    Frame f = ambientFrame(normals);
    f.cube = randomCube(14, 8);
    f.options.invalidColor[0] = -3;
    f.options.countPixels = 1;
    const auto good = shade(device(), f, tables());
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        Frame g = f;
        const int face = 3, x = 0, y = 5;  // on an edge
        g.cube.texels[(face * 8 + y) * 8 + x].x = bad;
        PelShaderStats stats = pelShaderStatsDefaults();
        const auto result = shade(device(), g, tables(), &stats);
        const Vec3 place = reference::normalized(
            reference::cubeDirection(face, (2 * x + 1) / 8.0 - 1, (2 * y + 1) / 8.0 - 1));
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
    Frame f = ambientFrame({{0, 0, 0}, {0, 0, 1}});
    f.cube = cubeOf(2, [](Vec3) { return Rgb{1, 1, 1}; });
    EXPECT_EQ(shade(device(), f, tables()), (std::vector<float>{0, 0, 0, 1, 1, 1}));
}

// The same cube in another layout: bytes, and how to describe them.
std::vector<float> shadeCube(const Frame& f, const PelImageDesc& faces) {
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const auto target = setTarget(device(), shader, f);
    shader.setAmbientCube(faces).commit().execute();
    return target.readAll<float>();
}

TEST(ShadeCube, ComesInAnyColourFormatAndBothShapes) {
    const uint32_t n = 5;
    Frame f = ambientFrame(randomNormals(15, 700)), plain = f;
    // Values that every format holds exactly: 0 and 1.
    f.cube = cubeOf(int(n), [&](Vec3 d) {
        return Rgb{double(d.x > 0.3), double(d.y > d.z), double(d.x + d.z < 0)};
    });
    const auto expected = shade(device(), f, tables());
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
    std::vector<Buffer> buffers;
    const auto desc = [&](const auto& data, PelFormat format, uint32_t w, uint32_t h) {
        buffers.emplace_back(device(), data);
        return imageDesc(buffers.back(), format, w, h);
    };
    EXPECT_EQ(shadeCube(plain, desc(bytes, PEL_FORMAT_RGBA8_UNORM, n, 6 * n)), expected);
    EXPECT_EQ(shadeCube(plain, desc(bytes, PEL_FORMAT_RGBA8_SRGB, n, 6 * n)), expected);
    EXPECT_EQ(shadeCube(plain, desc(halves, PEL_FORMAT_RGB16F, n, 6 * n)), expected);
    EXPECT_EQ(shadeCube(plain, desc(planes, PEL_FORMAT_PLANAR_RGB32F, n, 6 * n)), expected);
    EXPECT_EQ(shadeCube(plain, desc(wide, PEL_FORMAT_RGB32F, 6 * n, n)), expected);
}

TEST(ShadeCube, ChangesAreSeenWithoutACommit) {
    Frame f = ambientFrame({{0, 1, 0}});
    Shader shader(device());
    setFrame(device(), shader, f, tables());
    const Buffer target(device(), 12), faces(device(), std::vector<float>(18, 0.5f));
    shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, 1, 1));
    shader.setAmbientCube(imageDesc(faces, PEL_FORMAT_RGB32F, 1, 6)).commit().execute();
    EXPECT_EQ(target.readAll<float>()[0], 0.5f);
    const std::vector<float> other(18, 0.25f);
    faces.write(other.data(), 72);
    shader.execute();
    EXPECT_EQ(target.readAll<float>()[0], 0.25f);
    EXPECT_EQ(shader.stats().bytesUploaded, 0u);
    EXPECT_GE(shader.stats().scratchBytes, 18u * 9 * 4);
    shader.clearAmbientCube().commit().execute();
    EXPECT_EQ(target.readAll<float>()[0], 0.0f);
    EXPECT_EQ(shader.stats().features, 0u);
}

TEST(ShadeCube, BadInput) {
    Shader shader(device());
    const Buffer b(device(), 6 * 16 * 16 * 16);
    const auto refused = [&](const PelImageDesc& faces, const char* words) {
        EXPECT_THROW(shader.setAmbientCube(faces), pellucid::Error);
        EXPECT_NE(std::string(pelGetErrorMessage()).find(words), std::string::npos) << pelGetErrorMessage();
    };
    refused(imageDesc(b, PEL_FORMAT_RGB32F, 8, 8), "8 x 8; six square faces");
    refused(imageDesc(b, PEL_FORMAT_RGB32F, 8, 47), "n x 6n");
    refused(imageDesc(b, PEL_FORMAT_R32F, 8, 48), "three components");
    refused(imageDesc(b, PEL_FORMAT_R32_UINT, 8, 48), "three components");
    refused(imageDesc(b, PEL_FORMAT_RGBA32F, 32, 192), "ends at byte");
    EXPECT_EQ(pelShaderSetAmbientCube(nullptr, nullptr), PEL_ERROR_INVALID_ARGUMENT);

    const Frame f = ambientFrame(randomNormals(1, 32));
    setFrame(device(), shader, f, tables());
    shader.set(PEL_SLOT_RADIANCE, imageDesc(b, PEL_FORMAT_RGB32F, f.width, f.height));
    shader.setAmbientCube(imageDesc(b, PEL_FORMAT_RGB32F, 4, 24));
    EXPECT_THROW(shader.commit(), pellucid::Error);
    EXPECT_NE(std::string(pelGetErrorMessage()).find("ambient cube"), std::string::npos)
        << pelGetErrorMessage();
}

}  // namespace
