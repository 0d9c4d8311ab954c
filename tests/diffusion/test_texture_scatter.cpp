// Scattering in texture space, against sums over the surface.
#include "cl/refused_buffer.h"
#include "diffusion/scatter_scene.h"
#include "reference/shade_passes.h"
#include "sample/mesh.h"
#include "test.h"

using namespace scatter_scene;
using pellucid::TextureScatter;
using TexturedMesh = pellucid::sample::Mesh;

namespace {

uint32_t verticesOf(const TexturedMesh& m) {
    return uint32_t(m.positions.size() / 3);
}

// Adds a rectangle of the plane, in a rectangle of the texture.
void addPlate(TexturedMesh& m, float x0, float y0, float x1, float y1, float u0, float v0, float u1,
              float v1) {
    const uint32_t first = verticesOf(m);
    m.positions.insert(m.positions.end(), {x0, y0, 0, x1, y0, 0, x1, y1, 0, x0, y1, 0});
    m.uvs.insert(m.uvs.end(), {u0, v0, u1, v0, u1, v1, u0, v1});
    for (uint32_t v : {0, 1, 2, 0, 2, 3}) m.triangles.push_back(first + v);
}
TexturedMesh plate(float width, float height, float u = 1, float v = 1) {
    TexturedMesh m;
    addPlate(m, 0, 0, width, height, 0, 0, u, v);
    return m;
}

struct Texture {
    uint32_t width, height;
    TextureScatter scatter;
    Texture(const TexturedMesh& m, uint32_t w, uint32_t h) : width(w), height(h) {
        PelTextureScatterDesc desc = pelTextureScatterDescDefaults();
        desc.width = w, desc.height = h;
        desc.numVertices = verticesOf(m), desc.numIndices = m.triangles.size();
        desc.indices = m.triangles.data(), desc.uvs = m.uvs.data();
        scatter = TextureScatter(device(), desc);
        scatter.setPositions(vertexView(Buffer(device(), m.positions), verticesOf(m)));
    }
    size_t texels() const { return size_t(width) * height; }
    PelImageDesc image(const Buffer& b) const {
        return pellucid::imageDesc(b, PEL_FORMAT_RGB32F, width, height);
    }
    std::vector<float> draw(const std::vector<float>& values) {
        const Buffer out(device(), std::vector<float>(3 * texels(), -1.0f));
        scatter.draw(vertexView(Buffer(device(), values), uint32_t(values.size() / 3)), false, image(out));
        return out.readAll<float>();
    }
    std::vector<float> run(const std::vector<float>& irradiance, const Profile& profile,
                           PelTextureScatterParams params = pelTextureScatterParamsDefaults(),
                           const std::vector<float>& albedo = {}) {
        const Buffer e(device(), irradiance), a(device(), albedo.empty() ? std::vector<float>(1) : albedo),
            out(device(), std::vector<float>(3 * texels(), -1.0f));
        params.profile = profile.get();
        const PelImageDesc colors = image(a);
        scatter.execute(params, image(e), albedo.empty() ? nullptr : &colors, image(out));
        return out.readAll<float>();
    }
};

}  // namespace

// A step, where texels become three times as long: error functions of lengths on the surface.
TEST(TextureScatter, TexelsOfSeveralLengthsInOneIsland) {
    const double variances[] = {0.05, 0.5, 4};
    std::vector<PelGaussian> gaussians;
    for (double v : variances) gaussians.push_back({float(v), {1, 1, 1}});
    const Profile profile = Profile::gaussians(gaussians);
    for (int axis : {0, 1}) {
        const auto pair = [axis](float along, float across) {
            return axis ? std::array{across, along} : std::array{along, across};
        };
        TexturedMesh m;
        const float places[] = {0, 20, 40}, us[] = {0, 0.75f, 1};
        for (int i = 0; i < 3; ++i)
            for (float across : {0.0f, 1.0f}) {
                const auto p = pair(places[i], 40 * across), uv = pair(us[i], across);
                m.positions.insert(m.positions.end(), {p[0], p[1], 0});
                m.uvs.insert(m.uvs.end(), {uv[0], uv[1]});
            }
        m.triangles = {0, 1, 2, 1, 2, 3, 2, 3, 4, 3, 4, 5};
        const auto size = pair(512, 32);
        Texture t(m, uint32_t(size[0]), uint32_t(size[1]));
        const auto positions = t.draw(m.positions);
        std::vector<float> e;
        for (size_t i = 0; i < t.texels(); ++i)
            e.insert(e.end(), 3, positions[3 * i + axis] < 20 ? 0.0f : 1.0f);
        const auto s = t.run(e, profile);
        double worst = 0;
        for (size_t i = 0; i < t.texels(); ++i) {
            const double d = positions[3 * i + axis] - 20;
            double expected = 0;
            for (double v : variances) expected += std::erfc(-d / std::sqrt(2 * v)) / 6;
            if (std::abs(d) < 10) worst = std::max(worst, std::abs(s[3 * i] - expected));
        }
        EXPECT_LT(worst, tolerance::textureDensities) << "axis " << axis;
    }
}

// Two arms of one island, a texel apart in the texture and far away on the surface: no light crosses.
TEST(TextureScatter, LightDoesNotCrossASlit) {
    TexturedMesh m;
    const auto vertex = [&](float x, float y, float u, float v) {
        m.positions.insert(m.positions.end(), {x, y, 0}), m.uvs.insert(m.uvs.end(), {u, v});
    };
    constexpr float texel = 1 / 128.0f;
    const float sides[] = {0, 64 * texel, 65 * texel, 1};  // of the arms in the texture
    const float places[] = {0, 10, 110, 120};              // mm
    for (float y : {0.0f, 0.1f, 1.0f})
        for (int i = 0; i < 4; ++i) vertex(places[i], 20 * y, sides[i], y);
    const auto quad = [&](uint32_t a) {
        for (uint32_t v : {a, a + 1, a + 4, a + 1, a + 5, a + 4}) m.triangles.push_back(v);
    };
    quad(0), quad(1), quad(2), quad(4), quad(6);  // a bridge between the arms
    Texture t(m, 128, 128);
    std::vector<float> e;
    for (size_t i = 0; i < t.texels(); ++i) e.insert(e.end(), 3, i % 128 < 64 ? 1.0f : 0.0f);
    const auto s = t.run(e, Profile::skin());
    for (size_t y = 100; y < 128; ++y)  // away from the bridge
        for (size_t x : {60, 61, 62, 63, 65, 66, 67, 68})
            ASSERT_NEAR(s[3 * (128 * y + x)], x < 64 ? 1 : 0, 1e-5) << x << " " << y;
}

// Vertices that are split where the texture is not, as at hard edges, are no seam. Parts of the mesh that
// touch only in the texture have one.
TEST(TextureScatter, SplitVerticesAreNoSeam) {
    for (float gap : {0.0f, 50.0f})
        for (bool down : {false, true}) {
            TexturedMesh m;
            addPlate(m, 0, 0, down ? 20 : 10, down ? 10 : 20, 0, 0, down ? 1 : 0.5f, down ? 0.5f : 1);
            addPlate(m, down ? 0 : 10 + gap, down ? 10 + gap : 0, 20 + gap * !down, 20 + gap * down,
                     down ? 0 : 0.5f, down ? 0.5f : 0, 1, 1);
            Texture t(m, 128, 128);
            std::vector<float> e;
            for (size_t i = 0; i < t.texels(); ++i)
                e.insert(e.end(), 3, (down ? i / 128 : i % 128) < 64 ? 1.0f : 0.0f);
            const auto s = t.run(e, Profile::skin()),
                       whole = Texture(plate(20, 20), 128, 128).run(e, Profile::skin());
            for (size_t i = 0; i < e.size(); ++i) ASSERT_NEAR(s[i], gap > 0 ? e[i] : whole[i], 1e-5) << i;
        }
}

TEST(TextureScatter, VariancesAddToTheProfile) {
    Texture t(plate(16, 16), 48, 48);
    Picture p(48, 48);
    p.positions = t.draw(plate(16, 16).positions);
    for (size_t i = 0; i < p.pixels(); ++i) {
        const Vec3 at = p.place(i);
        const double v = 0.5 + 0.3 * std::sin(at.x) * std::cos(0.7 * at.y) + 0.2 * (at.x > 8);
        p.set(i, at, {v, 1 - v, 0.5 * v});
    }
    const Difference d = difference(p, t.run(p.irradiance, Profile::skin()),
                                    reference::scatterOnScreen(p.exact(), *reference::skinProfile()));
    EXPECT_LT(d.rms, tolerance::texturePlane);
    EXPECT_EQ(t.scatter.stats().gaussians, 6u);
}

// Against the surface integral over the mesh, a sphere lit from the side.
TEST(TextureScatter, ASphereIsNearItsSurfaceIntegral) {
    const TexturedMesh m = pellucid::sample::makeSphere(10, 96, 192);
    Texture t(m, 512, 256);
    const Vec3 toLight = normalized(Vec3{0.3, 1, 0.2});
    std::vector<float> lit;
    for (uint32_t i = 0; i < verticesOf(m); ++i) {
        const Vec3 n{m.normals[3 * i], m.normals[3 * i + 1], m.normals[3 * i + 2]};
        lit.insert(lit.end(), 3, float(reference::max0(dot(n, toLight))));
    }
    const Profile profile = Profile::skin();
    const auto drawn = t.draw(lit), positions = t.draw(m.positions), s = t.run(drawn, profile);
    // At texels away from poles and from the seam at u = 0.
    std::vector<float> points, scattered, lambert;
    for (uint32_t y = 50; y < 206; y += 7)
        for (uint32_t x = 90; x < 430; x += 7)
            for (size_t k = 3 * (y * 512 + x), c = 0; c < 3; ++c) {
                points.push_back(positions[k + c]);
                scattered.push_back(s[k + c]), lambert.push_back(drawn[k + c]);
            }
    const auto count = uint32_t(points.size() / 3);
    PelSurfaceIntegralDesc desc = pelSurfaceIntegralDescDefaults();
    desc.numVertices = verticesOf(m), desc.numIndices = m.triangles.size();
    desc.positions = m.positions.data(), desc.indices = m.triangles.data(), desc.irradiance = lit.data();
    desc.profile = profile.get();
    const Buffer at(device(), points), integral(device(), points.size() * sizeof(float));
    desc.points = vertexView(at, count);
    desc.result = vertexView(integral, count);
    pellucid::surfaceIntegral(device(), desc);
    Picture all(count, 1);  // only to compare
    std::ranges::fill(all.ids, 1);
    const auto truth = integral.readAll<float>();
    const double rms = difference(all, scattered, truth).rms, without = difference(all, lambert, truth).rms;
    EXPECT_LT(rms, tolerance::textureSphere);
    EXPECT_LT(rms, 0.35 * without);
}

TEST(TextureScatter, SeamsNeitherDarkenNorLeak) {
    TexturedMesh m;
    addPlate(m, 0, 0, 10, 10, 0.05f, 0.05f, 0.45f, 0.95f);
    addPlate(m, 50, 0, 60, 10, 0.46f, 0.05f, 0.95f,
             0.95f);  // one texel away in the texture, far away on the surface
    Texture t(m, 100, 100);
    std::vector<float> e;
    for (size_t i = 0; i < t.texels(); ++i) e.insert(e.end(), 3, i % 100 < 45 ? 1.0f : 0.25f);
    const auto s = t.run(e, Profile::skin());
    size_t padded = 0;
    for (size_t y = 5; y < 95; ++y)
        for (size_t x = 0; x < 100; ++x) {
            const float v = s[3 * (100 * y + x)];
            padded += x == 95 && v > 0;
            if (x == 45 || (x >= 3 && x < 5) || (x >= 95 && x < 98)) continue;
            ASSERT_NEAR(v,
                        x < 3 || x > 97 ? 0
                        : x < 45        ? 1
                                        : 0.25,
                        x < 3 || x > 97 ? 0 : 1e-5)
                << x << " " << y;
        }
    EXPECT_EQ(padded, 90u);  // what samples bilinearly finds light there
    const PelTextureScatterStats stats = t.scatter.stats();
    EXPECT_EQ(stats.texelsCovered, 40u * 90 + 49 * 90);
    EXPECT_EQ(stats.tilesBlurred, 6u * 36);  // of 49
    // Slivers leave no holes: a fan of them covers what one triangle does.
    const auto covered = [](uint32_t slivers) {
        TexturedMesh fan;
        fan.uvs = {0.1237f, 0.3713f};
        for (uint32_t i = 0; i <= slivers; ++i) {
            fan.uvs.insert(fan.uvs.end(), {1, 0.3f + 0.08f * float(i) / float(slivers)});
            if (i > 0) fan.triangles.insert(fan.triangles.end(), {0, i, i + 1});
        }
        fan.positions.resize(fan.uvs.size() / 2 * 3);
        Texture drawn(fan, 2000, 1000);
        drawn.run(std::vector<float>(3 * drawn.texels(), 0.5f), Profile::skin());
        return drawn.scatter.stats().texelsCovered;
    };
    EXPECT_EQ(covered(1000), covered(1));
    // A corner of the texture costs a corner.
    Texture small(plate(4, 4, 0.125f, 0.125f), 256, 256);
    small.run(std::vector<float>(3 * small.texels(), 0.5f), Profile::skin());
    EXPECT_EQ(small.scatter.stats().tilesBlurred, 6u * 4);
}

TEST(TextureScatter, AlbedoBeforeAndAfter) {
    const TexturedMesh m = plate(10, 10);
    Texture t(m, 40, 40);
    std::vector<float> e, albedo;
    for (size_t i = 0; i < t.texels(); ++i)
        e.insert(e.end(), 3, i % 40 < 20 ? 1.0f : 0.2f), albedo.insert(albedo.end(), 3, i % 7 ? 0.6f : 0.1f);
    const auto plain = t.run(e, Profile::skin());
    std::vector<float> product = e;
    for (size_t i = 0; i < e.size(); ++i) product[i] *= albedo[i];
    PelTextureScatterParams params = pelTextureScatterParamsDefaults();
    params.albedoAfter = 1;
    const auto after = t.run(e, Profile::skin(), params, albedo);
    params.albedoBefore = 1;
    const auto before = t.run(e, Profile::skin(), params, albedo), expected = t.run(product, Profile::skin());
    for (size_t i = 0; i < e.size(); ++i) {
        ASSERT_NEAR(after[i], albedo[i] * plain[i], 1e-6);
        ASSERT_NEAR(before[i], expected[i], 1e-6);
    }
}

TEST(TextureScatter, OtherProfilesAreAFewGaussians) {
    const TexturedMesh m = plate(10, 10);
    Texture t(m, 16, 16);
    const std::vector<float> e(3 * t.texels(), 1.0f);
    const Profile burley = Profile::burleyDistance({1.0f, 0.4f, 0.2f}),
                  table = Profile::table({0.1f, 1, 2}, {1, 1, 1, 0.5f, 0.3f, 0.2f, 0.01f, 0.01f, 0.01f});
    double before = 1;
    // Measured errors: the fit is optimal, so another fit would have a larger error.
    for (const auto& [count, measured] : {std::pair{3u, 0.0824}, {6u, 0.0187}, {12u, 0.0029}}) {
        PelTextureScatterParams params = pelTextureScatterParamsDefaults();
        params.gaussians = count;
        for (float v : t.run(e, burley, params)) ASSERT_NEAR(v, 1, 1e-4);
        EXPECT_EQ(t.scatter.stats().gaussians, count);
        const double error = t.scatter.stats().profileError;
        EXPECT_LT(error, before);
        EXPECT_NEAR(error, measured, 1e-4);
        before = error;
        t.run(e, table, params);
    }
    EXPECT_LT(before, 0.02);
}

TEST(TextureScatter, BadInput) {
    TexturedMesh m;
    addPlate(m, 0, 0, 10, 10, 0.2f, 0.2f, 0.8f, 0.8f);
    PelTextureScatterDesc desc = pelTextureScatterDescDefaults();
    desc.width = desc.height = 16;
    TextureScatter unplaced(device(), desc);
    Texture t(m, 16, 16);
    const Buffer e(device(), std::vector<float>(3 * 256, 1.0f)), out(device(), 3 * 256 * sizeof(float));
    const auto rgb = [&](const Buffer& b, uint32_t side = 16) {
        return pellucid::imageDesc(b, PEL_FORMAT_RGB32F, side, side);
    };
    const PelTextureScatterParams defaults = pelTextureScatterParamsDefaults();
    EXPECT_THROW(unplaced.execute(defaults, rgb(e), nullptr, rgb(out)), pellucid::Error);
    EXPECT_THROW(t.scatter.execute(defaults, rgb(e, 8), nullptr, rgb(out)), pellucid::Error);
    EXPECT_THROW(t.scatter.execute(defaults, rgb(e), nullptr, rgb(out, 8)), pellucid::Error);
    for (auto change : {+[](PelTextureScatterParams& p) { p.scale = 0; },
                        +[](PelTextureScatterParams& p) { p.scale = NAN; },
                        +[](PelTextureScatterParams& p) { p.scale = 1e16f; },
                        +[](PelTextureScatterParams& p) { p.scale = 1e-16f; },
                        +[](PelTextureScatterParams& p) { p.albedoBefore = 2; },
                        +[](PelTextureScatterParams& p) { p.albedoAfter = 1; },
                        +[](PelTextureScatterParams& p) { p.gaussians = 1; },
                        +[](PelTextureScatterParams& p) { p.gaussians = 13; }}) {
        PelTextureScatterParams params = defaults;
        change(params);
        EXPECT_THROW(t.scatter.execute(params, rgb(e), nullptr, rgb(out)), pellucid::Error);
    }
    // NaN stays where it is, and is counted; positions that are none leave light as it is.
    std::vector<float> corrupted(3 * 256, 1.0f);
    corrupted[3 * (16 * 8 + 8)] = NAN;
    for (float v : t.run(corrupted, Profile::skin())) ASSERT_TRUE(std::isfinite(v));
    EXPECT_EQ(t.scatter.stats().texelsInvalid, 1u);
    std::ranges::fill(m.positions, infinity);
    t.scatter.setPositions(vertexView(Buffer(device(), m.positions), verticesOf(m)));
    for (float v : t.run(std::vector<float>(3 * 256, 0.5f), Profile::skin()))
        ASSERT_TRUE(v == 0.5f || v == 0);
    // Texels too long along one axis alone.
    std::vector<float> step(3 * 256, 0.5f);
    std::fill_n(step.begin(), 3 * 100, 0.25f);
    for (float x : {1e38f, 8.0f})
        for (float y : {1e38f, 8.0f})
            for (float v : Texture(plate(x, y), 16, 16).run(step, Profile::skin()))
                ASSERT_TRUE(v >= 0.25f && v <= 0.5f) << v;
    // Over the irradiance itself.
    Texture again(plate(5, 5), 64, 32);
    std::vector<float> light;
    for (size_t i = 0; i < 3 * again.texels(); ++i) light.push_back(float(i % 11) / 10);
    const Buffer place(device(), light);
    again.scatter.execute(defaults, again.image(place), nullptr, again.image(place));
    EXPECT_EQ(place.readAll<float>(), again.run(light, Profile::skin()));
}

// Each buffer in turn cannot be made; then the same call works.
TEST(TextureScatter, AfterAFailure) {
    const TexturedMesh mesh = plate(30, 20);
    Texture t(mesh, 48, 32);
    const std::vector<float> light(3 * t.texels(), 0.25f), albedo(3 * t.texels(), 0.5f);
    const Profile skin = Profile::skin();
    PelTextureScatterParams params = pelTextureScatterParamsDefaults();
    params.albedoAfter = 1;
    const std::vector<float> right = Texture(mesh, 48, 32).run(light, skin, params, albedo);
    for (int n = 1; n < 100; ++n) {
        t.run(light, skin);
        const auto [struck, code] = refuseBuffer(n, [&] { t.run(light, skin, params, albedo); });
        EXPECT_TRUE(code == PEL_SUCCESS || code == PEL_ERROR_OUT_OF_MEMORY) << code;
        EXPECT_EQ(t.run(light, skin, params, albedo), right) << n;
        if (!struck) break;
    }
}

// A shader samples it bilinearly at the pixel's coordinates, repeated, times albedo.
TEST(TextureScatter, ShadersSampleIt) {
    const uint32_t side = 24;
    std::vector<float> texture, uvs, normals, irradiance(3 * side * side, 9.0f);
    reference::NormalLevel exact{8, 8, {}};
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
            const bool covered = y > 2;  // else an island narrower than a texel
            exact.texels.push_back(covered ? Vec3{double(x), double(y), 1} : Vec3{});
            texture.insert(texture.end(), {covered * float(x), covered * float(y), float(covered)});
        }
    std::vector<uint8_t> ids;
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            uvs.insert(uvs.end(), {float(x) / 10 - 1, float(y) / 30 + 0.1f});
            normals.insert(normals.end(), {0, 0, 1});
            ids.push_back(x < 16 ? 1 : 2);
        }
    ShownImages shown(device(), side, side);
    pellucid::Shader& shader = shown.shader;
    shown.set(PEL_SLOT_NORMAL_SHADING, normals);
    shown.set(PEL_SLOT_IRRADIANCE, irradiance);
    shown.set(PEL_SLOT_MATERIAL, ids);
    for (uint32_t id : {1u, 2u}) {
        PelMaterial m = whiteMaterial(Profile(), id == 1 ? PEL_SCATTERING_TEXTURE : PEL_SCATTERING_NONE);
        std::fill_n(m.albedo, 3, 0.5f);
        shader.setMaterial(id, m);
    }
    EXPECT_THROW(shader.commit(), pellucid::Error);  // no texture
    shader.setScatteredTexture(1, pellucid::imageDesc(Buffer(device(), texture), PEL_FORMAT_RGB32F, 8, 8));
    EXPECT_THROW(shader.commit(), pellucid::Error);  // no coordinates
    shown.set(PEL_SLOT_UV, uvs);
    const auto result = shown.execute();
    uint32_t taken = 0;
    for (size_t k = 0; k < ids.size(); ++k) {
        const Vec3 sampled = reference::sampleRepeated(exact, uvs[2 * k], uvs[2 * k + 1]);
        const bool takes = ids[k] == 1 && length(sampled) > 0;
        taken += takes;
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(result[3 * k + c], 0.5 * (takes ? sampled[c] : 9), 1e-4) << k;
    }
    EXPECT_GT(taken, 100u);
    EXPECT_LT(taken, 300u);
    const PelShaderStats stats = shader.stats();
    EXPECT_EQ(stats.tilesByScattering[PEL_SCATTERING_TEXTURE], 2u);
    EXPECT_EQ(stats.pixelsScattered, taken);
    EXPECT_EQ(stats.scatterTaps, 4 * taken);
}
