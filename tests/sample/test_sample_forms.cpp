// The sample renderer's cube maps and cascades, against a sphere.
#include <gtest/gtest.h>

#include <numbers>

#include "reference/shadow_forms.h"
#include "sample/shadow_forms.h"
#include "tolerances.h"

namespace sample = pellucid::sample;
using sample::Vec3;

namespace {

constexpr double radius = 50;
constexpr int rings = 256;
const double facetSag = radius * (1 - std::pow(std::cos(std::numbers::pi / (2 * rings)), 2));

TEST(SampleForms, ACubeRoundALampBesideASphere) {
    const sample::Mesh sphere = sample::makeSphere(radius, rings, 2 * rings);
    const sample::Scene scene(sphere.view());
    // Two faces see it: the light lies in the direction of an edge of the cube.
    const Vec3 lamp{-90, 10, -80};
    const sample::CubeShadowMap map = sample::renderCubeShadowMap(scene, lamp, 128);
    int hit[6] = {};
    for (int face = 0; face < 6; ++face)
        for (int i = 0; i < 128 * 128; ++i) {
            const double z = map.depth[size_t(face) * 128 * 128 + size_t(i)];
            if (z == 1) continue;
            ++hit[face];
            const auto d = reference::shadowCubeDirection(face, i % 128, i / 128, 128);
            const Vec3 p = lamp + Vec3{d.x, d.y, d.z} * (1 / (map.depthA * z + map.depthB));
            EXPECT_NEAR(length(p), radius, facetSag + 10 * tolerance::samplePosition);
            EXPECT_GT(dot(p, lamp - p), -tolerance::samplePosition * radius);
        }
    EXPECT_GT(hit[0], 500);
    EXPECT_GT(hit[4], 500);
    EXPECT_EQ(hit[1] + hit[5], 0);
    EXPECT_THROW(sample::renderCubeShadowMap(scene, lamp, -1), std::invalid_argument);
}

TEST(SampleForms, CascadesAreMapsOfTheirExtent) {
    const sample::Mesh sphere = sample::makeSphere(radius, rings, 2 * rings);
    const sample::Scene scene(sphere.view());
    const Vec3 focus{20, 10, 30};
    const auto maps = sample::renderCascades(scene, {normalize(Vec3{1, 2, 3})}, focus, {40, 160}, 96);
    ASSERT_EQ(maps.size(), 2u);
    for (const sample::ShadowMap& map : maps) {
        const Vec3 middle = map.worldToUvz.project(focus);
        EXPECT_NEAR(middle.x, 0.5, tolerance::sampleMatrix);
        EXPECT_NEAR(middle.y, 0.5, tolerance::sampleMatrix);
        const sample::Matrix4 back = map.worldToUvz.inverse();
        int hit = 0;
        for (int i = 0; i < 96 * 96; ++i) {
            const double z = map.depth[size_t(i)];
            if (z == 1) continue;
            ++hit;
            const Vec3 p = back.project({(i % 96 + 0.5) / 96, (i / 96 + 0.5) / 96, z});
            EXPECT_NEAR(length(p), radius, facetSag + tolerance::samplePosition);
        }
        EXPECT_GT(hit, 2000);
    }
}

}  // namespace
