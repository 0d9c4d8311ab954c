// Light of the surroundings: ambient, specular and in eyes, against integrals over the sphere in doubles.

#include "cl/cl_spy.h"
#include "shader_ready.h"

using namespace shade_test;
using reference::Rgb;
using reference::Vec3;

namespace {

using Sky = std::function<Rgb(Vec3)>;
constexpr double pi = reference::pi;

struct SkyTexel {
    Vec3 direction;
    double solidAngle;
};
// Of six faces below one another, n high each; or equirectangular and n high: the upper edge +y, the middle
// column +z, +x left of it.
std::vector<SkyTexel> texelsOf(bool faces, uint32_t n) {
    std::vector<SkyTexel> texels;
    for (uint32_t y = 0; y < (faces ? 6 : 1) * n; ++y)
        for (uint32_t x = 0; x < (faces ? 1 : 2) * n; ++x)
            if (faces) {
                const Vec3 d =
                    reference::cubeDirection(int(y / n), (2 * x + 1.0) / n - 1, (2 * (y % n) + 1.0) / n - 1);
                texels.push_back({normalized(d), 4 / (double(n) * n * std::pow(dot(d, d), 1.5))});
            } else {
                const double down = pi * (y + 0.5) / n, turn = pi * (1 - (x + 0.5) / n), s = std::sin(down);
                texels.push_back(
                    {{s * std::sin(turn), std::cos(down), s * std::cos(turn)}, s * pi / n * pi / n});
            }
    return texels;
}

// The integral of sky times `weight` over all directions.
Rgb integral(const Sky& sky, const std::function<double(Vec3)>& weight) {
    constexpr int rows = 200, columns = 400;
    Rgb sum;
    for (int i = 0; i < rows; ++i)
        for (int k = 0; k < columns; ++k) {
            const double z = 1 - 2 * (i + 0.5) / rows, across = std::sqrt(1 - z * z),
                         turn = 2 * pi * (k + 0.5) / columns;
            const Vec3 d{across * std::cos(turn), z, across * std::sin(turn)};
            if (const double w = weight(d); w > 0) sum = sum + w * sky(d);
        }
    return (4 * pi / (rows * columns)) * sum;
}

// Normals all round, each seen at another angle by a camera at the origin of the positions' coordinates.
struct Pixels {
    std::vector<Vec3> normals, views;
    Image n{3, {}}, p{3, {}};
    explicit Pixels(int count) {
        for (int i = 0; i < count; ++i) {
            const double z = 1 - 2 * (i + 0.5) / count, turn = 2.4 * i, across = std::sqrt(1 - z * z);
            normals.push_back({across * std::cos(turn), z, across * std::sin(turn)});
            const Vec3 side =
                normalized(cross(normals.back(), std::abs(z) < 0.9 ? Vec3{0, 1, 0} : Vec3{1, 0, 0}));
            const double cosine = 0.25 + 0.75 * (i * 7 % count) / count;
            views.push_back(cosine * normals.back() + std::sqrt(1 - cosine * cosine) * side);
            n.push(normals.back()), p.push(-10 * views.back());
        }
    }
};

class Environment : public testing::Test {
  protected:
    static constexpr uint32_t count = 48;
    Pixels pixels_{count};
    Shader shader_{device()};
    Buffer target_{device(), count * 12}, specular_{device(), count * 12};

    PelMaterial material_ = [] {
        PelMaterial m = pelMaterialDefaults();
        for (float& a : m.albedo) a = 0.5f;
        m.scattering = PEL_SCATTERING_NONE;
        m.specular = 1;
        m.specularModel = PEL_SPECULAR_GGX;
        m.lobeMix = 0;
        return m;
    }();

    void SetUp() override {
        shader_.set(PEL_SLOT_RADIANCE, imageDesc(target_, PEL_FORMAT_RGB32F, count, 1))
            .set(PEL_SLOT_OUT_SPECULAR, imageDesc(specular_, PEL_FORMAT_RGB32F, count, 1))
            .set(PEL_SLOT_NORMAL_SHADING, imageDesc(upload(device(), pixels_.n), PEL_FORMAT_RGB32F, count, 1))
            .set(PEL_SLOT_POSITION, imageDesc(upload(device(), pixels_.p), PEL_FORMAT_RGB32F, count, 1))
            .setMaterial(1, material_);
    }
    void surround(const Sky& sky, const float* axes = nullptr, uint32_t height = 128) {
        Image image{3, {}};
        for (const SkyTexel& t : texelsOf(false, height)) image.push(sky(t.direction));
        shader_.setEnvironment(imageDesc(upload(device(), image), PEL_FORMAT_RGB32F, 2 * height, height),
                               axes);
    }
    Rgb at(const Buffer& buffer, size_t i) const { return vectorOf(&buffer.readAll<float>()[3 * i]); }
    Rgb diffuse(size_t i) const { return at(target_, i) - at(specular_, i); }
    // Radiance with this image of the surroundings.
    std::vector<float> seen(const Image& image, uint32_t width, uint32_t height) {
        shader_.setEnvironment(imageDesc(upload(device(), image), PEL_FORMAT_RGB32F, width, height));
        return seen();
    }
    std::vector<float> seen() {
        shader_.commit().execute();
        return target_.readAll<float>();
    }
    // Of the material's first lobe, over pi: to the view of pixel i.
    double lobe(size_t i, Vec3 d) const {
        const PelMaterial& m = material_;
        const Vec3 n = pixels_.normals[i], v = pixels_.views[i];
        return (m.specularModel == PEL_SPECULAR_GGX
                    ? reference::specularGgx(n, d, v, m.roughness, m.roughness, 0, 1, m.f0)
                    : reference::specular(n, d, v, m.roughness, 1, m.f0)) /
               pi;
    }
};

// Bright above, a warm side, a soft lamp.
Rgb studio(Vec3 d) {
    const double lamp = std::exp(8 * (dot(d, normalized(Vec3{1, 1, 1})) - 1));
    return Rgb{0.3, 0.35, 0.4} + (0.25 * d.y) * Rgb{1, 1, 1} + lamp * Rgb{3, 2.5, 2};
}

TEST_F(Environment, AmbientLightIsTheIntegralOverTheHemisphere) {
    surround(studio);
    shader_.commit().execute();
    EXPECT_TRUE(shader_.stats().features & PEL_FEATURE_ENVIRONMENT);
    for (size_t i = 0; i < count; i += 5) {
        const Vec3 n = pixels_.normals[i];
        const Rgb expected = integral(studio, [&](Vec3 d) { return std::max(dot(n, d), 0.0) / pi; });
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(diffuse(i)[c], 0.5 * expected[c], tolerance::environmentAmbient) << i;
    }
}

TEST_F(Environment, SpecularLightIsTheIntegralOverTheLobe) {
    for (const PelSpecularModel model : {PEL_SPECULAR_GGX, PEL_SPECULAR_KSK})
        for (const float roughness : {0.1f, 0.3f, 0.6f}) {
            material_.specularModel = model, material_.roughness = roughness, material_.f0 = 0.5f;
            shader_.setMaterial(1, material_);
            surround(studio);
            shader_.commit().execute();
            double squares = 0, whole = 0;
            for (size_t i = 0; i < count; i += 3) {
                const Rgb expected = integral(studio, [&](Vec3 d) { return lobe(i, d); });
                for (int c = 0; c < 3; ++c) {
                    squares += std::pow(at(specular_, i)[c] - expected[c], 2);
                    whole += expected[c] * expected[c];
                }
            }
            EXPECT_LT(std::sqrt(squares / whole), tolerance::environmentSpecular)
                << model << ' ' << roughness;
        }
}

TEST_F(Environment, EvenLightIsReflectedEvenly) {
    const Sky even = [](Vec3) { return Rgb{1, 1, 1}; };
    for (const PelSpecularModel model : {PEL_SPECULAR_GGX, PEL_SPECULAR_KSK}) {
        material_.specularModel = model;
        shader_.setMaterial(1, material_);
        surround(even);
        shader_.commit().execute();
        for (size_t i = 0; i < count; i += 5) {
            const Rgb share = integral(even, [&](Vec3 d) { return lobe(i, d); });
            EXPECT_NEAR(diffuse(i).x, 0.5, 1e-4);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(at(specular_, i)[c], share.x, tolerance::environmentShare) << model << ' ' << i;
        }
    }
}

TEST_F(Environment, AxesTurnTheImage) {
    surround(studio);
    const auto plain = seen();
    // The image's x axis is the world's y, its y the world's z, its z the world's x.
    const float axes[9] = {0, 1, 0, 0, 0, 1, 1, 0, 0};
    surround([](Vec3 d) { return studio({d.z, d.x, d.y}); }, axes);
    const auto turned = seen();
    for (size_t i = 0; i < plain.size(); ++i) EXPECT_NEAR(plain[i], turned[i], 0.01) << i;
}

TEST_F(Environment, SixFacesAreTheSameLight) {
    surround(studio);
    const auto round = seen();
    constexpr uint32_t n = 64;
    Image faces{3, {}}, beside{3, std::vector<float>(size_t(3) * 6 * n * n)};
    for (const SkyTexel& t : texelsOf(true, n)) {
        const auto i = faces.values.size() / 3, face = i / (n * n), y = i / n % n, x = i % n;
        faces.push(studio(t.direction));
        beside.set((y * 6 + face) * n + x, studio(t.direction));
    }
    const auto below = seen(faces, n, 6 * n);
    for (size_t i = 0; i < round.size(); ++i) EXPECT_NEAR(below[i], round[i], 0.01) << i;
    EXPECT_EQ(below, seen(beside, 6 * n, n));
}

// What a lamp gives to all normals together, wherever it is. A lamp of radius 0 is one texel.
TEST_F(Environment, ASmallLampKeepsItsLight) {
    const auto expectLight = [&](bool faces, uint32_t n, const std::vector<SkyTexel>& texels, Vec3 lamp,
                                 double degrees) {
        const auto far = [&](const SkyTexel& t) { return -dot(t.direction, lamp); };
        const SkyTexel* const nearest = &*std::ranges::min_element(texels, {}, far);
        Image image{3, std::vector<float>(3 * texels.size())};
        double expected = 0, sum = 0;
        for (size_t i = 0; i < texels.size(); ++i) {
            const SkyTexel& t = texels[i];
            if (&t != nearest && far(t) > -std::cos(degrees * pi / 180)) continue;
            image.set(i, Rgb{100, 100, 100});
            for (const Vec3& normal : pixels_.normals)
                expected += 50 * t.solidAngle / pi * std::max(dot(normal, t.direction), 0.0);
        }
        const auto all = seen(image, faces ? n : 2 * n, faces ? 6 * n : n),
                   shine = specular_.readAll<float>();
        for (size_t i = 0; i < all.size(); i += 3) sum += double(all[i]) - double(shine[i]);
        EXPECT_NEAR(sum / expected, 1, tolerance::environmentLamp)
            << (faces ? "faces, " : "") << n << " high, " << degrees << " degrees at " << lamp.x << ' '
            << lamp.y << ' ' << lamp.z;
    };
    for (const bool faces : {false, true})
        for (const uint32_t n : {32u, 100u, 300u}) {
            const std::vector<SkyTexel> texels = texelsOf(faces, n);
            for (const Vec3& place : {Vec3{0, 0, 1}, {1, 0.2, 0.1}, {0.3, 0.6, 0.7}, {1, 1, 1}, {0.1, 1, 0}})
                for (const double degrees : {0.0, 1.0})
                    expectLight(faces, n, texels, normalized(place), degrees);
        }
}

TEST_F(Environment, ItIsReducedOnceAndTakenAwayAgain) {
    shader_.set(pellucid::directionalLight({0, 1, 0}, {1, 1, 1}));
    const auto without = seen();
    surround(studio);
    const auto with = seen();
    const uint64_t before = spy::launchesOf("environment_level");
    shader_.set(pellucid::directionalLight({0, 1, 0}, {1, 1, 1})).commit().execute();
    shader_.execute();
    EXPECT_EQ(spy::launchesOf("environment_level"), before);
    EXPECT_EQ(target_.readAll<float>(), with);
    shader_.clearEnvironment();
    EXPECT_EQ(seen(), without);
    EXPECT_FALSE(shader_.stats().features & (PEL_FEATURE_ENVIRONMENT | PEL_FEATURE_AMBIENT_CUBE));
}

TEST_F(Environment, OcclusionAndRoughnessImagesCount) {
    surround(studio);
    std::vector<float> open(count), rough(count);
    for (size_t i = 0; i < count; ++i) open[i] = i % 2 ? 1.0f : 0.0f, rough[i] = i % 3 ? 1.0f : 2.0f;
    shader_.commit().execute();
    const auto plain = specular_.readAll<float>();
    shader_.set(PEL_SLOT_AMBIENT_OCCLUSION, imageDesc(Buffer(device(), open), PEL_FORMAT_R32F, count, 1))
        .set(PEL_SLOT_ROUGHNESS, imageDesc(Buffer(device(), rough), PEL_FORMAT_R32F, count, 1))
        .commit()
        .execute();
    const auto changed = specular_.readAll<float>();
    for (size_t i = 0; i < count; ++i) {
        if (!(i % 2))
            EXPECT_LT(changed[3 * i], 0.6f * plain[3 * i]) << i;
        else if (i % 3)
            EXPECT_NEAR(changed[3 * i], plain[3 * i], 1e-5) << i;
        else
            EXPECT_NE(changed[3 * i], plain[3 * i]) << i;
    }
}

TEST_F(Environment, WhatIsNoLightCountsAsNone) {
    const auto holes = [](Vec3 d) { return d.x > 0.2 ? Rgb{NAN, -1, INFINITY} : Rgb{0.5, 0.5, 0.5}; };
    surround(holes);
    const auto first = seen();
    surround([&](Vec3 d) { return d.x > 0.2 ? Rgb{0, 0, 0} : Rgb{0.5, 0.5, 0.5}; });
    EXPECT_EQ(seen(), first);
    surround([](Vec3) { return Rgb{1, 1, 1}; }, nullptr, 1);
    seen();
    for (size_t i = 0; i < count; ++i) EXPECT_NEAR(diffuse(i).x, 0.5, 1e-4) << "two texels, pixel " << i;
    surround([](Vec3) { return Rgb{3e38, 1e30, 1e-40}; }, nullptr, 1);
    for (const float v : seen()) EXPECT_TRUE(std::isfinite(v));
}

TEST_F(Environment, BadInput) {
    const Buffer b(device(), 4096 * 16);
    const auto refused = [&](PelFormat format, uint32_t w, uint32_t h, const char* words) {
        expectRefused(words, [&] { shader_.setEnvironment(imageDesc(b, format, w, h)); });
    };
    refused(PEL_FORMAT_RGB32F, 8, 8, "8 x 8; an equirectangular one is 2n x n");
    refused(PEL_FORMAT_R32F, 8, 4, "three components");
    const PelImageDesc good = imageDesc(b, PEL_FORMAT_RGB32F, 8, 4);
    const float none[9] = {}, skew[9] = {1, 0.1f, 0, 0, 1, 0, 0, 0, 1},
                nan[9] = {NAN, 0, 0, 0, 1, 0, 0, 0, 1};
    for (const float* axes : {none, skew, nan})
        expectRefused("unit vectors at right angles", [&] { shader_.setEnvironment(good, axes); });
    EXPECT_EQ(pelShaderSetEnvironment(nullptr, nullptr, nullptr), PEL_ERROR_INVALID_ARGUMENT);
    shader_.setEnvironment(good).clear(PEL_SLOT_POSITION);
    expectRefused("position image", [&] { shader_.commit(); });
}

}  // namespace
