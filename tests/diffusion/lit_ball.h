// A small ball under lights with shadow maps of every form, and what the shader makes of it.
#pragma once
#include <cmath>
#include <limits>
#include <vector>

#include "diffusion/scatter_scene.h"
#include "diffusion/shown_images.h"

namespace lit_ball {

using namespace scatter_scene;

inline constexpr double radius = 2;  // of the ball, mm
enum class Form { parallel, reversed, perspective, spot, cube, radial, cascades, moments, exponential };
inline constexpr Form forms[] = {Form::parallel, Form::reversed, Form::perspective,
                                 Form::spot,     Form::cube,     Form::radial,
                                 Form::cascades, Form::moments,  Form::exponential};

// The distance along a ray to the ball in the origin; infinite beside it.
inline double hitBall(Vec3 from, Vec3 direction) {
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
        return light.color[0] * falloff(normalized(d)) * reference::max0(dot(n, normalized(d))) / dot(d, d);
    }
    // Of a spot's cone, from its inner to its outer angle.
    double falloff(Vec3 toPoint) const {
        if (light.type != PEL_LIGHT_SPOT) return 1;
        const double cosine = dot(toPoint, toLight), outer = light.spotCosOuter, inner = light.spotCosInner;
        return reference::smoothstep01(reference::saturate((cosine - outer) / (inner - outer)));
    }
};

inline void setRow(float* matrix, int row, Vec3 v, double constant) {
    for (int k = 0; k < 3; ++k) matrix[4 * row + k] = float(v[k]);
    matrix[4 * row + 3] = float(constant);
}

// A parallel map `extent` mm wide, 20 deep, from 10 before the ball.
inline std::vector<float> parallelMap(float* matrix, Vec3 toLight, double extent, uint32_t side,
                                      bool reversed) {
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

inline LitBall makeBall(Form form, Vec3 toLight, uint32_t side) {
    LitBall ball;
    PelLight& l = ball.light;
    ball.toLight = toLight;
    ball.width = ball.height = side;
    for (int k = 0; k < 3; ++k) l.toLight[k] = float(toLight[k]);
    l.shadowDepthRange = form == Form::reversed ? -20.0f : 20.0f;
    ball.position = 8 * toLight;
    for (int k = 0; k < 3; ++k) l.position[k] = float(ball.position[k]);
    const Vec3 right = normalized(cross(Vec3{0, 1, 0}, toLight)), up = cross(toLight, right);
    // z = a + b / distance
    const double near = 1, far = 40, a = far / (far - near), b = -near * far / (far - near);
    if (form == Form::perspective || form == Form::spot || form == Form::cube || form == Form::radial) {
        ball.point = true;
        l.type = form == Form::spot ? PEL_LIGHT_SPOT : PEL_LIGHT_POINT;
        std::fill_n(l.color, 3, 64.0f);
        l.shadowDepthA = float(1 / b);
        l.shadowDepthB = float(-a / b);
    }
    if (form == Form::spot) {  // the ball is 14.5 degrees to each side
        for (int k = 0; k < 3; ++k) l.spotDirection[k] = float(-toLight[k]);
        l.spotCosInner = 0.998f, l.spotCosOuter = 0.97f;
    }
    if (form == Form::perspective || form == Form::spot) {
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
                    const double distance = hitBall(ball.position, normalized(d)),
                                 along = distance / length(d);
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

// The ball from +z, each pixel with the light of all.
inline Picture pictureOf(const std::vector<LitBall>& lights, uint32_t side) {
    Picture p = scatter_scene::ball(side, radius, 2.2 * radius / side, {0, 0, 1});
    for (size_t i = 0; i < p.pixels(); ++i) {
        const Vec3 at{p.positions[3 * i], p.positions[3 * i + 1], p.positions[3 * i + 2]};
        double e = 0;
        for (const LitBall& light : lights) e += light.irradiance(at);
        if (p.ids[i]) std::fill_n(&p.irradiance[3 * i], 3, float(e));
    }
    return p;
}
inline Picture pictureOf(const LitBall& ball, uint32_t side) {
    return pictureOf(std::vector<LitBall>{ball}, side);
}

struct Lit {
    std::vector<float> light;
    PelShaderStats stats;
    std::string warnings;
};

struct Request {
    PelScattering scattering = PEL_SCATTERING_LIGHT;
    float radius = 0;  // of the profile, mm; 0: its own
    float targetError = pelShaderOptionsDefaults().targetError;
};

// The next picture of the same shader.
inline Lit show(ShownImages& shown, const Picture& p, const std::vector<LitBall>& lights,
                const Profile& profile, const Request& request) {
    std::vector<float> normals = p.positions;
    for (float& n : normals) n /= float(radius);
    PelShaderOptions options = pelShaderOptionsDefaults();
    options.targetError = request.targetError;
    shown.shader.set(options);
    shown.set(PEL_SLOT_POSITION, p.positions);
    shown.set(PEL_SLOT_NORMAL_SHADING, normals);
    shown.set(PEL_SLOT_IRRADIANCE, p.irradiance);
    shown.set(PEL_SLOT_MATERIAL, p.ids);
    PelMaterial material = whiteMaterial(profile, request.scattering);
    material.diffusionRadius = request.radius;
    material.specular = 0;
    shown.shader.setMaterial(1, material);
    std::vector<PelLight> all;
    for (const LitBall& ball : lights) all.push_back(ball.light);
    shown.shader.set(all);
    for (size_t i = 0; i < lights.size(); ++i)
        for (size_t k = 0; k < lights[i].maps.size(); ++k)
            shown.setMap(PelLightSlot(k ? PEL_LIGHT_CASCADE_1 + int(k) - 1 : int(PEL_LIGHT_SHADOW_MAP)),
                         lights[i].maps[k], lights[i].width, lights[i].height, uint32_t(i));
    std::vector<float> light = shown.execute();
    return {std::move(light), shown.shader.stats(), shown.shader.warnings()};
}

inline Lit shaded(const Picture& p, const std::vector<LitBall>& lights, const Profile& profile,
                  const Request& request) {
    ShownImages shown(device(), p.width, p.height);
    return show(shown, p, lights, profile, request);
}

inline Lit shaded(const Picture& p, const LitBall& ball, PelScattering scattering, const Profile& profile,
                  float profileRadius = 0) {
    return shaded(p, std::vector<LitBall>{ball}, profile, {scattering, profileRadius});
}

}  // namespace lit_ball
