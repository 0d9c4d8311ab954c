// Matrices of each convention, by the interfaces' own definitions: what a shadow map and a depth buffer
// hold is read back to the places that it came from.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <pellucid/pellucid_conventions.hpp>
#include <random>

using namespace pellucid;

namespace {

using Vec = std::array<double, 3>;
using Matrix = std::array<double, 16>;

const Vec eye{1, 2, 5}, target{0.2, -0.3, 0.1};

double dot(const Vec& a, const Vec& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec minus(const Vec& a, const Vec& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vec unit(const Vec& a) {
    const double l = std::sqrt(dot(a, a));
    return {a[0] / l, a[1] / l, a[2] / l};
}
Vec cross(const Vec& a, const Vec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
const Vec forward = unit(minus(target, eye)), right = unit(cross(forward, {0, 1, 0})),
          up = cross(right, forward);

struct Case {
    PelConvention convention;
    bool perspective, infinite;
};

std::vector<Case> cases() {
    std::vector<Case> all;
    for (int depth = 0; depth < 3; ++depth)
        for (int bits = 0; bits < 32; ++bits) {
            const Case c{{PelClipDepth(depth), bits & 1, bits >> 1 & 1, bits >> 2 & 1},
                         (bits & 8) != 0,
                         (bits & 16) != 0};
            if (!c.infinite || c.perspective) all.push_back(c);
        }
    return all;
}

// Clip space of a point: z / w is z0 at the near plane and z1 at the far one.
std::array<double, 4> clip(const Case& c, const Vec& p) {
    const double ends[3][2] = {{-1, 1}, {0, 1}, {1, 0}};
    const double z0 = ends[c.convention.depth][0], z1 = ends[c.convention.depth][1], near = 2, far = 9;
    const Vec q = minus(p, eye);
    const double x = 1.3 * dot(q, right), y = (c.convention.yDown ? -1.7 : 1.7) * dot(q, up),
                 d = dot(q, forward);
    if (!c.perspective) return {x, y, z0 + (z1 - z0) * (d - near) / (far - near), 1};
    const double a = c.infinite ? z1 : (z1 * far - z0 * near) / (far - near);
    return {x, y, a * d + (z0 - a) * near, d};
}

// The matrix of clip(), which is affine: from four points.
std::array<float, 16> matrixOf(const Case& c) {
    const auto o = clip(c, {0, 0, 0});
    std::array<float, 16> m{};
    for (size_t i = 0; i < 4; ++i)
        for (size_t k = 0; k < 4; ++k) {
            Vec e{0, 0, 0};
            if (k < 3) e[k] = 1;
            const double value = k < 3 ? clip(c, e)[i] - o[i] : o[i];
            m[c.convention.columnMajor ? 4 * k + i : 4 * i + k] = float(value);
        }
    return m;
}

std::array<double, 4> times(const float* m, const std::array<double, 4>& v) {
    std::array<double, 4> out{};
    for (size_t i = 0; i < 4; ++i)
        for (size_t k = 0; k < 4; ++k) out[i] += double(m[4 * i + k]) * v[k];
    return out;
}

std::vector<Vec> points() {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> at(-0.8, 0.8);
    std::vector<Vec> all(50);
    for (Vec& p : all)
        for (size_t k = 0; k < 3; ++k) p[k] = target[k] + at(random);
    return all;
}

void pass(const std::array<float, 16>& m, float (&to)[16]) {
    std::copy(m.begin(), m.end(), to);
}

class Conventions : public testing::TestWithParam<Case> {};

TEST_P(Conventions, ALightMeasuresTheDistancesOfItsMap) {
    const Case& c = GetParam();
    float m[16];
    pass(matrixOf(c), m);
    PelLight given = pelLightDefaults();
    given.color[1] = 7;
    const PelLight light = lightFromViewProjection(m, c.convention, given);
    EXPECT_EQ(light.color[1], 7);
    double first = NAN;
    for (const Vec& p : points()) {
        const auto q = times(light.worldToShadow, {p[0], p[1], p[2], 1}), k = clip(c, p);
        const double x = k[0] / k[3], y = k[1] / k[3], z = k[2] / k[3];
        const double fromTop = c.convention.yDown ? 0.5 + 0.5 * y : 0.5 - 0.5 * y;
        EXPECT_NEAR(q[0] / q[3], 0.5 + 0.5 * x, 1e-5);
        EXPECT_NEAR(q[1] / q[3], c.convention.bottomFirst ? 1 - fromTop : fromTop, 1e-5);
        const double stored = c.convention.depth == PEL_CLIP_DEPTH_MINUS_ONE_TO_ONE ? 0.5 + 0.5 * z : z;
        EXPECT_NEAR(q[2] / q[3], stored, 1e-5);
        const double along = dot(minus(p, eye), forward);
        if (c.perspective) {
            EXPECT_NEAR(1 / (light.shadowDepthA * stored + light.shadowDepthB) / along, 1, 2e-4);
        } else {
            const double rest = light.shadowDepthRange * stored - along;
            if (std::isnan(first)) first = rest;
            EXPECT_NEAR(rest, first, 1e-4);
        }
    }
    for (size_t k = 0; k < 3; ++k) {
        if (c.perspective) {
            EXPECT_NEAR(light.position[k], eye[k], 1e-4);
            EXPECT_NEAR(light.spotDirection[k], forward[k], 1e-5);
        } else {
            EXPECT_NEAR(light.toLight[k], -forward[k], 1e-5);
        }
    }
    EXPECT_EQ(light.type, c.perspective ? PEL_LIGHT_SPOT : PEL_LIGHT_DIRECTIONAL);
}

TEST_P(Conventions, ACameraFindsPlacesFromDepth) {
    const Case& c = GetParam();
    float m[16];
    pass(matrixOf(c), m);
    const PelCamera camera = cameraFromViewProjection(m, c.convention);
    for (const Vec& p : points()) {
        const auto k = clip(c, p);
        const double z = k[2] / k[3],
                     stored = c.convention.depth == PEL_CLIP_DEPTH_MINUS_ONE_TO_ONE ? 0.5 + 0.5 * z : z;
        const double y = c.convention.yDown ? -k[1] / k[3] : k[1] / k[3];
        const auto world = times(camera.inverseViewProjection, {k[0] / k[3], y, stored, 1});
        for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(world[i] / world[3], p[i], 4e-4);
    }
    for (size_t k = 0; k < 3 && c.perspective; ++k) EXPECT_NEAR(camera.position[k], eye[k], 1e-4);
    if (!c.perspective) {  // far away, against the view
        const Vec q = unit({camera.position[0], camera.position[1], camera.position[2]});
        EXPECT_NEAR(std::abs(dot(q, forward)), 1, 1e-5);
    }
}

INSTANTIATE_TEST_SUITE_P(All, Conventions, testing::ValuesIn(cases()));

// What renderers have: arrays, pointers (glm::value_ptr), structures (glm::mat4, XMFLOAT4X4).
TEST(ConventionsTake, MatricesOfAnyType) {
    struct Column {
        float x, y, z, w;
    };
    struct Mat4 {
        Column columns[4];
    };
    float matrix[16] = {1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0.25f, 0, 0.5f, 0, 0.5f, 1};
    Mat4 mat4;
    std::memcpy(&mat4, matrix, sizeof mat4);
    std::array<float, 16> array;
    std::memcpy(&array, matrix, sizeof array);
    const float* const pointer = matrix;
    const PelConvention convention = {PEL_CLIP_DEPTH_ZERO_TO_ONE, 0, 0, 1};
    const PelCamera expected = cameraFromViewProjection(matrix, convention);
    EXPECT_EQ(expected.inverseViewProjection[5], 0.5f);
    const PelLight light = lightFromViewProjection(matrix, convention);
    const auto same = [&](const auto& other) {
        const PelCamera camera = cameraFromViewProjection(other, convention);
        const PelLight lamp = lightFromViewProjection(other, convention);
        return std::memcmp(&camera, &expected, sizeof camera) == 0 &&
               std::memcmp(lamp.worldToShadow, light.worldToShadow, sizeof lamp.worldToShadow) == 0;
    };
    EXPECT_TRUE(same(mat4));
    EXPECT_TRUE(same(array));
    EXPECT_TRUE(same(pointer));
    EXPECT_TRUE(same(&matrix[0]));
}

TEST(ConventionsRefuse, WhatIsNoProjection) {
    float zero[16] = {}, bad[16] = {}, flat[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    bad[3] = NAN;
    EXPECT_THROW(cameraFromViewProjection(zero, {}), Error);
    EXPECT_THROW(cameraFromViewProjection(bad, {}), Error);
    EXPECT_THROW(lightFromViewProjection(bad, {}), Error);
    EXPECT_THROW(lightFromViewProjection(flat, {PEL_CLIP_DEPTH_ZERO_TO_ONE, 0, 0, 0}), Error);
    PelCamera camera = pelCameraDefaults();
    EXPECT_EQ(pelCameraFromViewProjection(nullptr, PelConvention{}, &camera), PEL_ERROR_INVALID_ARGUMENT);
}

}  // namespace
