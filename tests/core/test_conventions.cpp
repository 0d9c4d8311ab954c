// Matrices of each convention, by the definitions of the graphics APIs: the content of a shadow map and of a
// depth buffer is mapped back to the original positions.
#include "test.h"

#include <pellucid/pellucid_conventions.hpp>

#include "reference/vec.h"

using namespace pellucid;

namespace {

using reference::Vec3;
using Vec4 = std::array<double, 4>;

const Vec3 eye{1, 2, 5}, target{0.2, -0.3, 0.1}, forward = normalized(target - eye),
                                                 right = normalized(cross(forward, Vec3{0, 1, 0})),
                                                 up = cross(right, forward);

struct Case {
    PelConvention convention;
    bool perspective, infinite;
    double z0, z1;  // z / w at the near plane, and at the far one
};

std::vector<Case> cases() {
    std::vector<Case> all;
    for (const auto& [depth, z0, z1] : {std::tuple{PEL_CLIP_DEPTH_MINUS_ONE_TO_ONE, -1.0, 1.0},
                                        {PEL_CLIP_DEPTH_ZERO_TO_ONE, 0.0, 1.0},
                                        {PEL_CLIP_DEPTH_ONE_TO_ZERO, 1.0, 0.0}})
        for (int bits = 0; bits < 32; ++bits) {
            const Case c{
                {depth, bits & 1, bits >> 1 & 1, bits >> 2 & 1}, (bits & 8) != 0, (bits & 16) != 0, z0, z1};
            if (!c.infinite || c.perspective) all.push_back(c);
        }
    return all;
}

// Clip space of a point.
Vec4 clip(const Case& c, Vec3 p) {
    const double z0 = c.z0, z1 = c.z1, near = 2, far = 9;
    const Vec3 q = p - eye;
    const double x = 1.3 * dot(q, right), y = (c.convention.yDown ? -1.7 : 1.7) * dot(q, up),
                 d = dot(q, forward);
    if (!c.perspective) return {x, y, z0 + (z1 - z0) * (d - near) / (far - near), 1};
    const double a = c.infinite ? z1 : (z1 * far - z0 * near) / (far - near);
    return {x, y, a * d + (z0 - a) * near, d};
}

// Depth as it is stored.
double stored(const Case& c, double z) {
    return c.convention.depth == PEL_CLIP_DEPTH_MINUS_ONE_TO_ONE ? 0.5 + 0.5 * z : z;
}

struct Matrix {
    float m[16];
};

// The matrix of clip(), which is affine: from four points.
Matrix matrixOf(const Case& c) {
    const Vec4 o = clip(c, {});
    Matrix matrix{};
    for (size_t k = 0; k < 4; ++k) {
        Vec3 e;
        if (k < 3) e[int(k)] = 1;
        const Vec4 column = clip(c, e);
        for (size_t i = 0; i < 4; ++i)
            matrix.m[c.convention.columnMajor ? 4 * k + i : 4 * i + k] =
                float(k < 3 ? column[i] - o[i] : o[i]);
    }
    return matrix;
}

Vec4 times(const float* m, const Vec4& v) {
    Vec4 out{};
    for (size_t i = 0; i < 16; ++i) out[i / 4] += double(m[i]) * v[i % 4];
    return out;
}

std::vector<Vec3> points() {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> at(-0.8, 0.8);
    std::vector<Vec3> all;
    for (int i = 0; i < 50; ++i) all.push_back(target + Vec3{at(random), at(random), at(random)});
    return all;
}

class Conventions : public testing::TestWithParam<Case> {};

TEST_P(Conventions, ALightMeasuresTheDistancesOfItsMap) {
    const Case& c = GetParam();
    PelLight given = pelLightDefaults();
    std::memset(&given.type, 0x5A, sizeof given - offsetof(PelLight, type));
    const PelLight light = lightFromViewProjection(matrixOf(c), c.convention, given);
    PelLight rest = light;
    const auto undo = [&](auto PelLight::*field) {
        std::memcpy(&(rest.*field), &(given.*field), sizeof(rest.*field));
    };
    undo(&PelLight::type), undo(&PelLight::worldToShadow), undo(&PelLight::shadowProjection);
    if (c.perspective) {
        undo(&PelLight::position), undo(&PelLight::spotDirection);
        undo(&PelLight::shadowDepthA), undo(&PelLight::shadowDepthB);
    } else {
        undo(&PelLight::toLight), undo(&PelLight::shadowDepthRange);
    }
    EXPECT_EQ(std::memcmp(&rest, &given, sizeof rest), 0) << "the other fields are left alone";
    double first = NAN;
    for (const Vec3& p : points()) {
        const auto q = times(light.worldToShadow, {p.x, p.y, p.z, 1}), k = clip(c, p);
        const double x = k[0] / k[3], y = k[1] / k[3], z = k[2] / k[3];
        const double fromTop = c.convention.yDown ? 0.5 + 0.5 * y : 0.5 - 0.5 * y;
        EXPECT_NEAR(q[0] / q[3], 0.5 + 0.5 * x, 1e-5);
        EXPECT_NEAR(q[1] / q[3], c.convention.bottomFirst ? 1 - fromTop : fromTop, 1e-5);
        EXPECT_NEAR(q[2] / q[3], stored(c, z), 1e-5);
        const double along = dot(p - eye, forward);
        if (c.perspective) {
            EXPECT_NEAR(1 / (light.shadowDepthA * stored(c, z) + light.shadowDepthB) / along, 1, 2e-4);
        } else {
            const double beyond = light.shadowDepthRange * stored(c, z) - along;
            if (std::isnan(first)) first = beyond;
            EXPECT_NEAR(beyond, first, 1e-4);
        }
    }
    for (int k = 0; k < 3; ++k) {
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
    const PelCamera camera = cameraFromViewProjection(matrixOf(c), c.convention);
    for (const Vec3& p : points()) {
        const auto k = clip(c, p);
        const double y = c.convention.yDown ? -k[1] / k[3] : k[1] / k[3];
        const auto world = times(camera.inverseViewProjection, {k[0] / k[3], y, stored(c, k[2] / k[3]), 1});
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(world[size_t(i)] / world[3], p[i], 4e-4);
    }
    for (int k = 0; k < 3 && c.perspective; ++k) EXPECT_NEAR(camera.position[k], eye[k], 1e-4);
    if (!c.perspective) {  // far away, against the view
        const Vec3 q{camera.position[0], camera.position[1], camera.position[2]};
        EXPECT_NEAR(dot(normalized(q), forward), -1, 1e-5);
        const auto m = times(camera.inverseViewProjection, {0, 0, 0.5, 1});
        const Vec3 away = q - Vec3{m[0] / m[3], m[1] / m[3], m[2] / m[3]};
        EXPECT_NEAR(1.3 * length(away), 1e6, 1e3) << "of half of the width";
        EXPECT_LT(length(away - dot(away, forward) * forward), 0.3) << "beside the middle of the picture";
    }
}

INSTANTIATE_TEST_SUITE_P(All, Conventions, testing::ValuesIn(cases()));

// What renderers have: arrays, pointers (glm::value_ptr), structures (glm::mat4, XMFLOAT4X4).
TEST(ConventionsTake, MatricesOfAnyType) {
    struct Mat4 {
        struct {
            float x, y, z, w;
        } columns[4];
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
    EXPECT_TRUE(same(mat4) && same(array) && same(pointer) && same(&matrix[0]));
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
