// The sample renderer's shadow maps of all forms, wide shadow filter and sky.
#include <gtest/gtest.h>

#include <numbers>

#include "sample/sky.h"
#include "sample/wide_shadow.h"
#include "tolerances.h"

namespace sample = pellucid::sample;
using sample::Vec3;

namespace {

constexpr double radius = 50;
constexpr int rings = 256;
const double facetSag = radius * (1 - std::pow(std::cos(std::numbers::pi / (2 * rings)), 2));

sample::Mesh sphere() {
    return sample::makeSphere(radius, rings, 2 * rings);
}

// A G-buffer of one row along x on the plane z = 0, as the filter needs it.
sample::GBuffer rowOnPlane(double x0, double x1, int count) {
    sample::GBuffer g;
    g.width = count;
    g.height = 1;
    g.position = sample::Image(count, 1, 3);
    g.geometricNormal = sample::Image(count, 1, 3);
    g.coverage = sample::Image(count, 1, 1, 1);
    for (int i = 0; i < count; ++i) {
        g.position.at(0, i, 0) = float(x0 + (x1 - x0) * (i + 0.5) / count);
        g.geometricNormal.at(2, i, 0) = 1;
    }
    return g;
}

// Checks the map's matrix, depth decoding and texels against the sphere of `radius` at the origin.
void checkMapOfSphere(const sample::ShadowMap& map, Vec3 lightPosition, bool parallel) {
    const sample::Matrix4 back = map.worldToUvz.inverse();
    int hit = 0;
    for (int y = 0; y < map.size; y += 7)
        for (int x = 0; x < map.size; x += 7) {
            const double z = map.depth[size_t(y) * map.size + x];
            if (z == 1) continue;
            ++hit;
            // The texel's centre and depth, taken back to the world, lie on the sphere's lit side.
            const Vec3 p = back.project({(x + 0.5) / map.size, (y + 0.5) / map.size, z});
            EXPECT_NEAR(length(p), radius, facetSag + tolerance::samplePosition);
            const Vec3 toLight = parallel ? -map.forward : lightPosition - p;
            EXPECT_GT(dot(p, toLight), -tolerance::samplePosition * radius);
            const double along = dot(p - (parallel ? Vec3{} : lightPosition), map.forward);
            EXPECT_NEAR(map.distance(z), along, tolerance::samplePosition);
            const double step = 1e-5;
            EXPECT_NEAR(
                map.zPerLength(along) * (map.distance(z + step) - map.distance(z - step)) / (2 * step), 1,
                tolerance::sampleDerivative);
        }
    EXPECT_GT(hit, 200);
}

}  // namespace

TEST(SampleShadowMap, OfASphere) {
    const sample::Scene scene(sphere().view());
    const Vec3 toLight = sample::normalize({0.4, -0.5, 0.77});
    const sample::ShadowMap parallel = sample::renderShadowMap(scene, sample::DirectionalLight{toLight}, 512);
    EXPECT_NEAR(length(parallel.forward + toLight), 0, tolerance::sampleMatrix);
    checkMapOfSphere(parallel, {}, true);
    const Vec3 position{150, -100, 120};
    const sample::ShadowMap map =
        sample::renderShadowMap(scene, sample::SpotLight{position, sample::normalize(-position), 25}, 512);
    checkMapOfSphere(map, position, false);
    // The cone's edge meets the middle of the map's sides.
    const double tangent = std::tan(25 * std::numbers::pi / 180);
    EXPECT_NEAR(map.worldToUvz.project(position + map.forward + map.right * tangent).x, 1,
                tolerance::sampleMatrix);
    EXPECT_NEAR(map.worldToUvz.project(position + map.forward - map.down * tangent).y, 0,
                tolerance::sampleMatrix);
}

TEST(SampleShadowMap, LitPointsAreTheFirstThatTheLightMeets) {
    const sample::Scene scene(sphere().view());
    const Vec3 toLight = sample::normalize({-0.3, -0.8, 0.5});
    const sample::ShadowMap map = sample::renderShadowMap(scene, sample::DirectionalLight{toLight}, 1024);
    const sample::GBuffer g = sample::renderGBuffer(scene, {.eye = {0, -400, 0}}, 100, 100);
    const double texel = map.lengthPerUv(0) / map.size;
    int lit = 0, dark = 0;
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 100; ++x) {
            if (g.coverage.at(0, x, y) == 0) continue;
            const Vec3 p{g.position.at(0, x, y), g.position.at(1, x, y), g.position.at(2, x, y)};
            const Vec3 uvz = map.worldToUvz.project(p);
            const int tx = int(uvz.x * map.size), ty = int(uvz.y * map.size);
            const double stored = map.distance(map.depth[size_t(ty) * map.size + tx]);
            const double cosine = dot(p, toLight) / radius, reached = map.distance(uvz.z);
            if (cosine > 0.3) {  // within a texel, depth changes by the surface's slope
                ++lit;
                EXPECT_NEAR(stored, reached, texel / cosine + facetSag);
            } else if (cosine < -0.1) {
                ++dark;
                EXPECT_LT(stored, reached - radius * 0.1);
            }
        }
    EXPECT_GT(lit, 500);
    EXPECT_GT(dark, 10);
}

TEST(SampleShadowMap, EmptyAndTiny) {
    const sample::Scene nothing((sample::MeshView()));
    const sample::Scene scene(sample::makeSphere(radius, 8, 16).view());
    EXPECT_EQ(sample::renderShadowMap(nothing, sample::DirectionalLight{}, 4).depth,
              std::vector<float>(16, 1.0f));
    EXPECT_EQ(sample::renderShadowMap(nothing, sample::SpotLight{}, 4).depth, std::vector<float>(16, 1.0f));
    EXPECT_TRUE(sample::renderShadowMap(scene, sample::DirectionalLight{}, 0).depth.empty());
    EXPECT_LT(sample::renderShadowMap(scene, sample::DirectionalLight{}, 1).depth[0], 0.1f);
    EXPECT_THROW(sample::renderShadowMap(scene, sample::DirectionalLight{}, -1), std::invalid_argument);
    const sample::GBuffer row = rowOnPlane(-1, 1, 3);
    const sample::ShadowMap none = sample::renderShadowMap(scene, sample::DirectionalLight{}, 0);
    EXPECT_EQ(sample::filterWideShadow(row, none).data, std::vector<float>(3, 1.0f));
    EXPECT_TRUE(sample::filterWideShadow(rowOnPlane(-1, 1, 0), none).data.empty());
}

TEST(SampleWideShadow, FilterIsTheOneTheTableInverts) {
    for (double p : {0.05, 0.3, 0.5, 0.77, 0.98}) {
        const double w = sample::wideFilterEdge(p);
        EXPECT_NEAR((std::sqrt(w) - std::sqrt(1 - w)) / 2 + 0.5, p, tolerance::sampleMatrix);
    }
}

TEST(SampleWideShadow, StraightEdgeGivesTheRamp) {
    const double width = 10;
    const auto expectRamp = [&](const sample::GBuffer& row, const sample::ShadowMap& map,
                                const auto& positionAt) {
        // Texels so small that the edge's place in the map does not matter.
        const sample::Image w = sample::filterWideShadow(row, map, {.filterWidth = width, .maxTexels = 500});
        int inRamp = 0;
        for (int i = 0; i < row.width; ++i) {
            const double p = 0.5 + positionAt(row.position.at(0, i, 0)) / width;
            EXPECT_NEAR(w.at(0, i, 0), sample::wideFilterEdge(p), tolerance::sampleWideShadow)
                << "at p = " << p;
            if (p < -0.02 || p > 1.02) {
                EXPECT_EQ(w.at(0, i, 0), p < 0 ? 0 : 1);
            }
            inRamp += p > 0 && p < 1;
        }
        EXPECT_GT(inRamp, 50);
    };
    const double height = 30;
    const sample::Scene scene(sample::makePlaneWithOccluder(40, height).view());
    for (double lean : {0.0, 0.5}) {  // of the light towards +x
        const sample::DirectionalLight light{sample::normalize({lean, 0.2, 1})};
        // The edge's image moves by the lean; across the light, lengths along x shrink by this much.
        const Vec3 edge = sample::normalize(cross({0, 1, 0}, light.toLight));
        expectRamp(rowOnPlane(-30, 30, 1000), sample::renderShadowMap(scene, light, 4096), [&](double x) {
            return dot({x + lean * height, 0, 0}, edge);
        });
    }
    const sample::Scene high(sample::makePlaneWithOccluder(100, 60).view());
    expectRamp(rowOnPlane(-40, 40, 600),
               sample::renderShadowMap(high, sample::SpotLight{{20, 0, 500}, {0, 0, -1}, 8}, 4096),
               [](double x) { return x + 20.0 * 60 / (500 - 60); });
}

TEST(SampleWideShadow, RoundBodiesDoNotShadeTheirLitSide) {
    for (double r : {8.0, 30.0, 100.0}) {
        const sample::Scene scene(sample::makeSphere(r, 64, 128).view());
        const Vec3 toLight = sample::normalize({0.8, -0.5, 0.3});
        const sample::ShadowMap map = sample::renderShadowMap(scene, sample::DirectionalLight{toLight}, 1024);
        const sample::Camera camera{.eye = {0, -6 * r, 0}};
        const sample::GBuffer g = sample::renderGBuffer(scene, camera, 120, 120);
        const sample::Image w = sample::filterWideShadow(g, map, {});
        int lit = 0, dark = 0;
        for (size_t i = 0; i < g.coverage.data.size(); ++i) {
            if (g.coverage.data[i] == 0) {
                EXPECT_EQ(w.data[i], 1);
                continue;
            }
            const auto& n = g.geometricNormal;
            const double cosine = dot({n.plane(0)[i], n.plane(1)[i], n.plane(2)[i]}, toLight);
            if (cosine > 0.1) {
                ++lit;
                EXPECT_GT(w.data[i], 0.98f) << "radius " << r << ", N.L " << cosine;
            }
            // 16 mm of body are not held against a point that faces away.
            if (r > 50 && cosine < -0.5) {
                ++dark;
                EXPECT_EQ(w.data[i], 0);
            }
        }
        EXPECT_GT(lit, 300);
        if (r > 50) {
            EXPECT_GT(dark, 100);
        }
    }
}

TEST(SampleSky, ProjectionOfLowOrdersIsExact) {
    using sample::Rgb;
    const sample::Harmonics even = sample::projectIrradiance([](Vec3) { return Rgb{1, 1, 1}; });
    const sample::Harmonics tilted = sample::projectIrradiance([](Vec3 d) {
        return Rgb{1 + d.x, 1 + 0.5 * d.y - d.z, 3 * d.z * d.z - 1 + d.x * d.y};
    });
    for (const Vec3 d : {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{1, 2, -3}, Vec3{-1, 1, 1}}) {
        const Vec3 n = normalize(d);
        for (double v : sample::evaluate(even, n)) EXPECT_NEAR(v, 1, tolerance::sampleQuadrature);
        const Rgb e = sample::evaluate(tilted, n);
        EXPECT_NEAR(e[0], 1 + 2 * n.x / 3, tolerance::sampleQuadrature);
        EXPECT_NEAR(e[1], 1 + 2 * (0.5 * n.y - n.z) / 3, tolerance::sampleQuadrature);
        EXPECT_NEAR(e[2], (3 * n.z * n.z - 1 + n.x * n.y) / 4, tolerance::sampleQuadrature);
    }
}

TEST(SampleSky, NineHarmonicsCarryTheSkysIrradiance) {
    const sample::Sky sky;
    const sample::Harmonics harmonics = sample::projectIrradiance(sky);
    for (const Vec3 d :
         {Vec3{1, 0, 0}, Vec3{0, -1, 0.2}, Vec3{0, 0.1, 1}, Vec3{0.3, 0.2, -1}, Vec3{-1, 1, 1}}) {
        const Vec3 n = normalize(d);
        sample::Rgb sum{};
        const int steps = 200;
        for (int i = 0; i < steps; ++i)
            for (int j = 0; j < 2 * steps; ++j) {
                const double z = 2 * (i + 0.5) / steps - 1, phi = std::numbers::pi * (j + 0.5) / steps;
                const Vec3 w{std::sqrt(1 - z * z) * std::cos(phi), std::sqrt(1 - z * z) * std::sin(phi), z};
                const sample::Rgb light = sky.radiance(w);
                // Area 2 pi / steps^2 per cell, over pi.
                for (int c = 0; c < 3; ++c)
                    sum[c] += light[c] * std::max(0.0, dot(w, n)) * 2 / (steps * steps);
            }
        const sample::Rgb e = sample::evaluate(harmonics, n);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(e[c], sum[c], tolerance::sampleSky);
    }
}
