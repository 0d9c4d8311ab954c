// Light that comes through a small ball, from the shadow map of its light: against the surface integral, by quadrature over the ball, for every
// form of map. And what must hold for any input.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "diffusion/scatter_scene.h"
#include "diffusion/shown_images.h"
#include "tolerances.h"

using namespace scatter_scene;

namespace {

constexpr double radius = 2;  // of the ball, mm
constexpr float notANumber = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

enum class Form { parallel, reversed, perspective, cube, radial, cascades, moments, exponential };
constexpr Form forms[] = {Form::parallel, Form::reversed, Form::perspective, Form::cube,
                          Form::radial,   Form::cascades, Form::moments,     Form::exponential};

// The distance along a ray to the ball in the origin; infinite beside it.
double hitBall(Vec3 from, Vec3 direction) {
    const double along = -dot(from, direction), rest = along * along - dot(from, from) + radius * radius;
    return rest < 0 ? std::numeric_limits<double>::infinity() : along - std::sqrt(rest);
}

struct LitBall {
    PelLight light = pelLightDefaults();
    Vec3 toLight, position;
    bool point = false;
    std::vector<std::vector<float>> maps;  // of one image or of cascades
    uint32_t width = 0, height = 0, components = 1;

    double irradiance(Vec3 at) const {
        const Vec3 n = at / length(at), d = position - at;
        if (!point) return reference::max0(dot(n, toLight));
        return light.color[0] * reference::max0(dot(n, normalized(d))) / dot(d, d);
    }
};

void setRow(float* matrix, int row, Vec3 v, double constant) {
    for (int k = 0; k < 3; ++k) matrix[4 * row + k] = float(v[k]);
    matrix[4 * row + 3] = float(constant);
}

// A parallel map `extent` mm wide, 20 deep, from 10 before the ball.
std::vector<float> parallelMap(float* matrix, Vec3 toLight, double extent, uint32_t side, bool reversed) {
    const Vec3 right = normalized(cross(Vec3{0, 1, 0}, toLight)), up = cross(toLight, right);
    setRow(matrix, 0, right / extent, 0.5);
    setRow(matrix, 1, -1 / extent * up, 0.5);
    setRow(matrix, 2, (reversed ? 1 : -1) / 20.0 * toLight, 0.5);
    setRow(matrix, 3, {}, 1);
    std::vector<float> map(side * side, reversed ? 0.0f : 1.0f);
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const Vec3 from = 10 * toLight + (((x + 0.5) / side - 0.5) * extent) * right -
                              (((y + 0.5) / side - 0.5) * extent) * up;
            const double t = hitBall(from, -1 * toLight) / 20;
            if (t < 1) map[y * side + x] = float(reversed ? 1 - t : t);
        }
    return map;
}

LitBall makeBall(Form form, Vec3 toLight, uint32_t side) {
    LitBall ball;
    PelLight& l = ball.light;
    ball.toLight = toLight;
    ball.width = ball.height = side;
    for (int k = 0; k < 3; ++k) l.toLight[k] = float(toLight[k]);
    l.shadowDepthRange = form == Form::reversed ? -20.0f : 20.0f;
    ball.position = 8 * toLight;
    for (int k = 0; k < 3; ++k) l.position[k] = float(ball.position[k]);
    const Vec3 right = normalized(cross(Vec3{0, 1, 0}, toLight)), up = cross(toLight, right);
    const double near = 1, far = 40, a = far / (far - near), b = -near * far / (far - near);  // z = a + b / distance
    if (form == Form::perspective || form == Form::cube || form == Form::radial) {
        ball.point = true;
        l.type = PEL_LIGHT_POINT;
        std::fill_n(l.color, 3, 64.0f);
        l.shadowDepthA = float(1 / b);
        l.shadowDepthB = float(-a / b);
    }
    if (form == Form::perspective) {
        l.shadowProjection = PEL_SHADOW_PERSPECTIVE;
        const Vec3 forward = -1 * toLight;
        const double half = 0.4;  // tangent of half of its view
        const auto through = [&](Vec3 v, double k) { return (1 / half / 2) * v + k * forward; };
        const auto row = [&](int r, Vec3 v, double constant) {
            setRow(l.worldToShadow, r, v, constant - dot(v, ball.position));
        };
        row(0, through(right, 0.5), 0);
        row(1, through(-1 * up, 0.5), 0);
        row(2, a * forward, b);
        row(3, forward, 0);
        ball.maps.emplace_back(side * side, 1.0f);
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x) {
                const Vec3 d = forward + ((2 * (x + 0.5) / side - 1) * half) * right -
                               ((2 * (y + 0.5) / side - 1) * half) * up;
                const double t = hitBall(ball.position, normalized(d)) / length(d);
                if (t < far) ball.maps[0][y * side + x] = float(a + b / t);
            }
    } else if (form == Form::cube || form == Form::radial) {
        l.shadowProjection = form == Form::cube ? PEL_SHADOW_CUBE : PEL_SHADOW_CUBE_RADIAL;
        ball.height = 6 * side;
        for (int r = 0; r < 4; ++r)
            setRow(l.worldToShadow, r, {double(r == 0), double(r == 1), double(r == 2)},
                   r == 3 ? 1 : -ball.position[r]);
        ball.maps.emplace_back(6 * side * side, 1.0f);
        for (uint32_t face = 0; face < 6; ++face)
            for (uint32_t y = 0; y < side; ++y)
                for (uint32_t x = 0; x < side; ++x) {
                    const double u = 2 * (x + 0.5) / side - 1, v = 2 * (y + 0.5) / side - 1;
                    const Vec3 faces[] = {{1, -v, -u}, {-1, -v, u}, {u, 1, v},
                                          {u, -1, -v}, {u, -v, 1},  {-u, -v, -1}};
                    const Vec3 d = faces[face];
                    const double distance = hitBall(ball.position, normalized(d)), along = distance / length(d);
                    if (distance < 20)
                        ball.maps[0][(face * side + y) * side + x] =
                            float(form == Form::cube ? a + b / along : distance / 20);
                }
    } else {
        ball.maps.push_back(parallelMap(l.worldToShadow, toLight, form == Form::cascades ? 2.5 : 5, side,
                                        form == Form::reversed));
        if (form == Form::cascades) {
            l.shadowCascades = 2;
            ball.maps.push_back(parallelMap(l.cascadeToShadow[0], toLight, 6, side, false));
            l.cascadeDepthRange[0] = 20;
        }
        if (form == Form::exponential) {
            l.shadowContent = PEL_SHADOW_CONTENT_EXPONENTIAL;
            l.shadowExponent = 40;
            for (float& z : ball.maps[0]) z = std::exp(40 * z);
        }
        if (form == Form::moments) {
            l.shadowContent = PEL_SHADOW_CONTENT_MOMENTS;
            ball.components = 2;
            std::vector<float> both;
            for (float z : ball.maps[0]) both.push_back(z), both.push_back(z * z);
            ball.maps[0] = both;
        }
    }
    return ball;
}

// The ball from +z, each pixel with its light.
Picture pictureOf(const LitBall& ball, uint32_t side) {
    Picture p = scatter_scene::ball(side, radius, 2.2 * radius / side, {0, 0, 1});
    for (size_t i = 0; i < p.pixels(); ++i) {
        const Vec3 at{p.positions[3 * i], p.positions[3 * i + 1], p.positions[3 * i + 2]};
        if (p.ids[i]) std::fill_n(&p.irradiance[3 * i], 3, float(ball.irradiance(at)));
    }
    return p;
}

struct Lit {
    std::vector<float> light;
    PelShaderStats stats;
    std::string warnings;
};

Lit shaded(const Picture& p, const LitBall& ball, PelScattering scattering, const Profile& profile,
           float profileRadius = 0) {
    ShownImages shown(device(), p.width, p.height);
    std::vector<float> normals = p.positions;
    for (float& n : normals) n /= float(radius);
    shown.set(PEL_SLOT_POSITION, p.positions);
    shown.set(PEL_SLOT_NORMAL_SHADING, normals);
    shown.set(PEL_SLOT_IRRADIANCE, p.irradiance);
    shown.set(PEL_SLOT_MATERIAL, p.ids);
    PelMaterial material = whiteMaterial(profile, scattering);
    material.diffusionRadius = profileRadius;
    material.specular = 0;
    shown.shader.setMaterial(1, material);
    shown.shader.set(std::vector<PelLight>{ball.light});
    for (size_t k = 0; k < ball.maps.size(); ++k)
        shown.setMap(PelLightSlot(k ? PEL_LIGHT_CASCADE_1 + int(k) - 1 : int(PEL_LIGHT_SHADOW_MAP)),
                     ball.maps[k], ball.width, ball.height);
    std::vector<float> light = shown.execute();
    return {std::move(light), shown.shader.stats(), shown.shader.warnings()};
}

// Over the lit part, by midpoints in the angles round the light.
reference::Rgb surfaceIntegral(const LitBall& ball, const reference::Profile& profile, Vec3 at, int steps) {
    const Vec3 right = normalized(cross(Vec3{0, 1, 0}, ball.toLight)), up = cross(ball.toLight, right);
    reference::Rgb sum;
    for (int j = 0; j < steps; ++j)
        for (int i = 0; i < 2 * steps; ++i) {
            const double z = (j + 0.5) / steps, turn = std::numbers::pi * (i + 0.5) / steps,
                         s = std::sqrt(1 - z * z);
            const Vec3 y =
                radius * (z * ball.toLight + (s * std::cos(turn)) * right + (s * std::sin(turn)) * up);
            const double e = ball.irradiance(y), area = radius * radius / steps * std::numbers::pi / steps;
            if (e > 0) sum = sum + (e * area) * profile.radial(length(at - y));
        }
    return sum;
}

}  // namespace

// Where the ball is dark all light has come through it: every texel counts, and no pixel does.
TEST(LightSpace, ThroughABallIsTheSurfaceIntegralForEveryFormOfMap) {
    const uint32_t side = sized(24u, 16u), mapSide = sized(256u, 96u);
    const auto exact = reference::skinProfile();
    const Vec3 toLight = normalized(Vec3{0.3, 0.2, -1});
    std::vector<reference::Rgb> truths[2];  // of parallel light, of a point's
    for (Form form : forms) {
        // A cube's face is 90 degrees wide.
        const LitBall ball =
            makeBall(form, toLight, form == Form::cube || form == Form::radial ? 2 * mapSide : mapSide);
        const Picture p = pictureOf(ball, side);
        const auto at = [&](size_t i) {
            return Vec3{p.positions[3 * i], p.positions[3 * i + 1], p.positions[3 * i + 2]};
        };
        std::vector<size_t> dark;  // away from the lit rim
        for (size_t i = 0; i < p.pixels(); ++i)
            if (p.ids[i] && dot(at(i), toLight) < -0.25 * radius) dark.push_back(i);
        ASSERT_GT(dark.size(), 50u);
        std::vector<reference::Rgb>& truth = truths[ball.point];
        if (truth.empty())
            for (size_t i : dark) truth.push_back(surfaceIntegral(ball, *exact, at(i), 48));
        for (PelScattering method : {PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO}) {
            const Lit lit = shaded(p, ball, method, Profile::skin());
            double square = 0, whole = 0;
            for (size_t k = 0; k < dark.size(); ++k) {
                square += std::pow(lit.light[3 * dark[k]] - truth[k].x, 2), whole += truth[k].x * truth[k].x;
            }
            EXPECT_GT(std::sqrt(whole / double(dark.size())), 0.03);
            EXPECT_LT(std::sqrt(square / whole), method == PEL_SCATTERING_LIGHT ? tolerance::lightThroughBall
                                                                                : tolerance::hiddenThroughBall)
                << "form " << int(form) << ", method " << int(method);
        }
    }
}

// A camera that sees all that is lit needs no map.
TEST(LightSpace, TexelsThatTheCameraSeesCountOnce) {
    const LitBall ball = makeBall(Form::parallel, {0, 0, 1}, sized(256u, 64u));
    const Picture p = pictureOf(ball, sized(96u, 24u));
    LitBall without = ball;
    without.maps.clear();
    const float width = 0.4f;
    const Lit with = shaded(p, ball, PEL_SCATTERING_AUTO, Profile::skin(), width),
              alone = shaded(p, without, PEL_SCATTERING_AUTO, Profile::skin(), width);
    for (size_t i = 0; i < p.pixels(); ++i)
        if (p.ids[i] && p.positions[3 * i + 2] > 0.3 * radius) {
            ASSERT_NEAR(with.light[3 * i], alone.light[3 * i], tolerance::lightSeenTwice) << i;
        }
}

TEST(LightSpace, LightOfMapsFallsOnNobodyElse) {
    LitBall ball = makeBall(Form::parallel, normalized(Vec3{0.3, 0.2, -1}), 128);
    ball.light.worldToShadow[3] += 40;  // the ball lies outside of its map
    const Picture p = pictureOf(ball, 24);
    for (PelScattering method : {PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO}) {
        const Lit lit = shaded(p, ball, method, Profile::skin());
        for (size_t i = 0; i < p.pixels(); ++i) {
            const Vec3 at{p.positions[3 * i], p.positions[3 * i + 1], p.positions[3 * i + 2]};
            if (p.ids[i] && dot(at, ball.toLight) < -0.5 * radius) {
                ASSERT_NEAR(lit.light[3 * i], 0, 0.02) << i;
            }
        }
    }
}

TEST(LightSpace, InvalidTexelsThrowNoLight) {
    const LitBall sound = makeBall(Form::parallel, normalized(Vec3{0.3, 0.2, -1}), 128);
    LitBall ball = sound;
    for (size_t k = 0; k < ball.maps[0].size(); k += 3)
        ball.maps[0][k] = k % 2 ? notANumber : k % 4 ? infinity : -infinity;
    Picture p = pictureOf(ball, 32);
    const Lit before = shaded(p, sound, PEL_SCATTERING_LIGHT, Profile::skin()),
              after = shaded(p, ball, PEL_SCATTERING_LIGHT, Profile::skin());
    double sum[2] = {};
    for (size_t i = 0; i < 3 * p.pixels(); i += 3) {
        ASSERT_TRUE(std::isfinite(after.light[i]) && after.light[i] >= 0);
        sum[0] += before.light[i], sum[1] += after.light[i];
    }
    EXPECT_NEAR(sum[1] / sum[0], 2 / 3.0, 0.1);
}

TEST(LightSpace, AnInvalidPixelStaysAlone) {
    const LitBall ball = makeBall(Form::parallel, normalized(Vec3{1, 0.2, -0.2}), 128);
    Picture p = pictureOf(ball, 40);
    for (PelScattering method : {PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO}) {
        Picture bad = p;
        bad.irradiance[3 * p.at(25, 20) + 1] = notANumber;
        bad.positions[3 * p.at(12, 18)] = infinity;
        const Lit lit = shaded(bad, ball, method, Profile::skin(), 0.4f);
        EXPECT_EQ(lit.stats.pixelsInvalid, 2u);
        for (float v : lit.light) ASSERT_TRUE(std::isfinite(v));
    }
}

TEST(LightSpace, SizesAndRadiiAtTheirEnds) {
    const LitBall ball = makeBall(Form::parallel, normalized(Vec3{0.5, 0.2, -1}), 64);
    LitBall least = ball;
    least.width = least.height = 1;
    least.maps = {{0.4f}};
    for (PelScattering method : {PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO})
        for (uint32_t side : {1u, 17u})
            for (float width : {1e-6f, 1.0f, 1e6f})
                for (const LitBall* b : {&ball, static_cast<const LitBall*>(&least)}) {
                    const Picture p = pictureOf(*b, side);
                    for (float v : shaded(p, *b, method, Profile::skin(), width).light)
                        ASSERT_TRUE(v >= 0 && v < 2)
                            << side << " pixels, radius " << width << ", map of " << b->width;
                }
}

TEST(LightSpace, SameInputSameBits) {
    const LitBall ball = makeBall(Form::parallel, normalized(Vec3{0.6, 0.2, -0.5}), 128);
    const Picture p = pictureOf(ball, 48);
    for (PelScattering method : {PEL_SCATTERING_LIGHT, PEL_SCATTERING_AUTO})
        EXPECT_EQ(shaded(p, ball, method, Profile::skin()).light, shaded(p, ball, method, Profile::skin()).light);
}

// A light without a map beside it: as on the screen, and said.
TEST(LightSpace, WithoutAllMapsTheScreenDoes) {
    LitBall ball = makeBall(Form::parallel, normalized(Vec3{1, 0.2, 0.4}), 64);
    ball.maps.clear();
    const Picture p = pictureOf(ball, 40);
    const Lit light = shaded(p, ball, PEL_SCATTERING_LIGHT, Profile::skin(), 0.4f),
              screen = shaded(p, ball, PEL_SCATTERING_SCREEN, Profile::skin(), 0.4f);
    EXPECT_EQ(light.light, screen.light);
    EXPECT_NE(light.warnings.find("shadow maps do not hold all light"), std::string::npos) << light.warnings;
    EXPECT_EQ(screen.warnings.find("shadow maps do not hold"), std::string::npos);
}

TEST(LightSpace, ASingularMatrixIsAnError) {
    LitBall ball = makeBall(Form::parallel, {0, 0, 1}, 16);
    std::fill_n(ball.light.worldToShadow + 4, 4, 0.0f);
    EXPECT_THROW(shaded(pictureOf(ball, 16), ball, PEL_SCATTERING_LIGHT, Profile::skin()), std::exception);
}
