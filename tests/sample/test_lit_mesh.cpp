// Irradiance on a mesh that is split where light asks for it: sums, bounds and limits.
#include <gtest/gtest.h>

#include <numbers>

#include "sample/lit_mesh.h"
#include "tolerances.h"

namespace sample = pellucid::sample;
using sample::Vec3;

namespace {

constexpr double radius = 50;

sample::Lighting fromAbove() {
    sample::SurfaceLight light;
    light.color = {1, 0.5, 0.25};
    return {{light}, {}};
}

Vec3 cornerOf(const sample::LitMesh& lit, size_t corner) {
    return {lit.positions[3 * corner], lit.positions[3 * corner + 1], lit.positions[3 * corner + 2]};
}

struct Sums {
    double area = 0, flux = 0, longest = 0;
};
Sums sumsOf(const sample::LitMesh& lit) {
    Sums sums;
    for (size_t t = 0; t < lit.triangles.size(); t += 3) {
        const Vec3 a = cornerOf(lit, t), b = cornerOf(lit, t + 1), c = cornerOf(lit, t + 2);
        const double area = length(cross(b - a, c - a)) / 2;
        sums.area += area;
        for (int k = 0; k < 3; ++k) sums.flux += area * lit.irradiance[3 * (t + size_t(k))] / 3;
        sums.longest = std::max({sums.longest, length(b - a), length(c - b), length(a - c)});
    }
    return sums;
}

}  // namespace

// More triangles than are split at a time.
TEST(LitMesh, ALargeSphereTakesTheFluxOfItsDisk) {
    const sample::Scene scene(sample::makeSphere(radius, 100, 200).view());
    std::vector<double> told;
    const sample::LitMesh lit =
        sample::lightMesh(scene, fromAbove(), {INFINITY, 0, 1}, [&](double part) { told.push_back(part); });
    const double pi = std::numbers::pi;
    const Sums sums = sumsOf(lit);
    EXPECT_EQ(lit.triangles.size(), scene.mesh().triangles.size()) << "nothing to split";
    EXPECT_NEAR(sums.area / (4 * pi * radius * radius), 1, tolerance::litSphere);
    EXPECT_NEAR(sums.flux / (pi * radius * radius), 1, tolerance::litSphere);
    ASSERT_GE(told.size(), 2u);
    EXPECT_EQ(told[0], 0);
    for (size_t i = 1; i < told.size(); ++i) EXPECT_GT(told[i], told[i - 1]);
    EXPECT_LT(told.back(), 1);
    for (size_t corner = 0; corner < lit.triangles.size(); ++corner) {
        EXPECT_EQ(lit.triangles[corner], corner);
        const double expected = std::max(0.0, cornerOf(lit, corner).z / radius);
        const float* E = &lit.irradiance[3 * corner];
        ASSERT_NEAR(E[0], expected, tolerance::sampleFacetNormal) << corner;
        ASSERT_NEAR(E[1], expected / 2, tolerance::sampleFacetNormal);
        ASSERT_NEAR(E[2], expected / 4, tolerance::sampleFacetNormal);
    }
}

// Along the terminator a coarse sphere is split until light is linear, and no further than `finest`.
TEST(LitMesh, SplitsWhereLightIsNotLinear) {
    const sample::Scene scene(sample::makeSphere(radius, 16, 32).view());
    const auto lit = [&](double deviation, double finest, double coarsest = INFINITY) {
        return sample::lightMesh(scene, fromAbove(), {coarsest, finest, deviation});
    };
    size_t before = scene.mesh().triangles.size();
    for (double deviation : {0.004, 0.002, 0.001}) {
        const sample::LitMesh mesh = lit(deviation, 0.01);
        EXPECT_GT(mesh.triangles.size(), before) << deviation;
        before = mesh.triangles.size();
        EXPECT_NEAR(sumsOf(mesh).area, sumsOf(lit(1, 0)).area, tolerance::litSphere * radius * radius);
    }
    EXPECT_EQ(lit(0, 1000).triangles.size(), scene.mesh().triangles.size()) << "all edges are short enough";
    const double coarsest = 2;
    const Sums split = sumsOf(lit(1, 0, coarsest));
    EXPECT_LE(split.longest, coarsest);
    EXPECT_GT(split.longest, coarsest / 4) << "not much further than asked for";
}

TEST(LitMesh, LightsAndLimits) {
    sample::Mesh two = sample::makeSphere(radius, 8, 16);
    two.materials.assign(two.triangles.size() / 3, 1);
    // A little aside: Embree may miss a triangle whose corner a ray meets exactly.
    sample::Mesh other = sample::makeSphere(radius, 8, 16, {0.3, 0.7, -300});
    other.materials.assign(other.triangles.size() / 3, 2);
    two.append(other);
    const sample::Scene scene(two.view());
    sample::LitMeshOptions options{INFINITY, INFINITY, 1};
    options.material = 2;
    const sample::LitMesh behind = sample::lightMesh(scene, fromAbove(), options);
    EXPECT_EQ(behind.triangles.size(), other.triangles.size()) << "of its own material only";
    for (size_t corner = 0; corner < behind.triangles.size(); ++corner)
        if (std::hypot(behind.positions[3 * corner], behind.positions[3 * corner + 1]) < 0.9 * radius) {
            ASSERT_EQ(behind.irradiance[3 * corner], 0) << "in the first one's shadow";
        }
    options.mostTriangles = 3;
    EXPECT_THROW(sample::lightMesh(scene, fromAbove(), options), std::runtime_error);

    // A point light at distance 100 from the first sphere's pole, without and with a range; a spot's cone.
    sample::SurfaceLight light;
    light.type = sample::SurfaceLight::Type::Point;
    light.position = {0, 0, radius + 100};
    light.color = {1e4, 1e4, 1e4};
    uint32_t pole = 0, triangle = 0;
    for (uint32_t t = 0; t < scene.mesh().triangles.size() / 3; ++t)
        for (uint32_t k = 0; k < 3; ++k)
            if (scene.mesh().positions[3 * scene.mesh().triangles[3 * t + k] + 2] > radius - 1e-3)
                triangle = t, pole = k;
    std::array<double, 3> weights{};
    weights[pole] = 1;
    const sample::SurfacePoint point{triangle, weights};
    const auto atPole = [&](const sample::SurfaceLight& l) {
        return irradianceAt(scene, {{l}, {}}, {&point, 1})[0];
    };
    EXPECT_NEAR(atPole(light), 1, tolerance::sampleFacetNormal);
    light.range = 99;
    EXPECT_EQ(atPole(light), 0);
    light.range = 101;
    EXPECT_NEAR(atPole(light), 1, tolerance::sampleFacetNormal);
    light.type = sample::SurfaceLight::Type::SpotLight;
    const double inner = light.spotCosInner, outer = light.spotCosOuter;
    for (double cosine : {inner, 0.75 * inner + 0.25 * outer, (inner + outer) / 2, outer}) {
        light.spotDirection = {std::sqrt(1 - cosine * cosine), 0, -cosine};
        const double t = (cosine - outer) / (inner - outer);
        EXPECT_NEAR(atPole(light), t * t * (3 - 2 * t), tolerance::sampleFacetNormal) << cosine;
    }
}
