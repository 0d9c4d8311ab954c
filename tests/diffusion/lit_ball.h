// A small ball under lights with shadow maps of every form.
#pragma once
#include "diffusion/scatter_scene.h"
#include "reference/shade.h"

namespace lit_ball {

using namespace scatter_scene;

inline constexpr double radius = 2;  // of the ball, mm
enum class Form { parallel, reversed, perspective, spot, cube, radial, cascades, moments, exponential };
inline constexpr Form forms[] = {Form::parallel, Form::reversed, Form::perspective,
                                 Form::spot,     Form::cube,     Form::radial,
                                 Form::cascades, Form::moments,  Form::exponential};

// The distance along a ray to the ball at the origin; infinite if the ray misses it.
inline double hitBall(Vec3 from, Vec3 direction) {
    const double along = -dot(from, direction), rest = along * along - dot(from, from) + radius * radius;
    return rest < 0 ? double(infinity) : along - std::sqrt(rest);
}

struct LitBall : Lamp {
    Vec3 toLight, position;
    bool point = false;
    uint32_t components = 1;

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

// value(s, t, face) of every texel, s and t from -1 to 1; faces below each other.
template <class Value>
std::vector<float> texelsOf(uint32_t side, const Value& value, int faces = 1) {
    std::vector<float> map;
    for (int face = 0; face < faces; ++face)
        for (uint32_t i = 0; i < side * side; ++i)
            map.push_back(
                float(value(2 * (i % side + 0.5) / side - 1, 2 * (i / side + 0.5) / side - 1, face)));
    return map;
}

// A parallel map `extent` mm wide, 20 deep, from 10 before the ball.
inline std::vector<float> parallelMap(float* matrix, Vec3 toLight, double extent, uint32_t side,
                                      bool reversed) {
    const Vec3 right = normalized(cross(Vec3{0, 1, 0}, toLight)), up = cross(toLight, right);
    setRow(matrix, 0, right / extent, 0.5);
    setRow(matrix, 1, -1 / extent * up, 0.5);
    setRow(matrix, 2, (reversed ? 1 : -1) / 20.0 * toLight, 0.5);
    setRow(matrix, 3, {}, 1);
    return texelsOf(side, [&](double s, double t, int) {
        const Vec3 from = 10 * toLight + (s * extent / 2) * right - (t * extent / 2) * up;
        const double depth = std::min(hitBall(from, -1 * toLight) / 20, 1.0);
        return reversed ? 1 - depth : depth;
    });
}

// Lit from a direction of any length.
inline LitBall makeBall(Form form, Vec3 from, uint32_t side) {
    const Vec3 toLight = normalized(from);
    LitBall ball;
    PelLight& l = ball.light;
    ball.toLight = toLight;
    ball.position = 8 * toLight;
    ball.width = ball.height = side;
    const bool perspective = form == Form::perspective || form == Form::spot,
               cube = form == Form::cube || form == Form::radial;
    ball.point = perspective || cube;
    l.shadowDepthRange = form == Form::reversed ? -20.0f : 20.0f;
    for (int k = 0; k < 3; ++k) {
        l.toLight[k] = float(toLight[k]);
        l.position[k] = float(ball.position[k]);
        l.spotDirection[k] = float(-toLight[k]);
    }
    // z = a + b / distance
    const double near = 1, far = 40, a = far / (far - near), b = -near * far / (far - near);
    if (ball.point) {
        l.type = form == Form::spot ? PEL_LIGHT_SPOT : PEL_LIGHT_POINT;
        std::fill_n(l.color, 3, 64.0f);
        l.shadowDepthA = float(1 / b);
        l.shadowDepthB = float(-a / b);
    }
    if (form == Form::spot) l.spotCosInner = 0.998f, l.spotCosOuter = 0.97f;  // the ball: 14.5 degrees
    const auto row = [&](int r, Vec3 v, double constant) {
        setRow(l.worldToShadow, r, v, constant - dot(v, ball.position));
    };
    if (perspective) {
        l.shadowProjection = PEL_SHADOW_PERSPECTIVE;
        const Vec3 right = normalized(cross(Vec3{0, 1, 0}, toLight)), up = cross(toLight, right),
                   forward = -1 * toLight;
        const double half = 0.4;  // tangent of half of its view
        row(0, 0.5 / half * right + 0.5 * forward, 0);
        row(1, -0.5 / half * up + 0.5 * forward, 0);
        row(2, a * forward, b);
        row(3, forward, 0);
        ball.maps.push_back(texelsOf(side, [&](double s, double t, int) {
            const Vec3 d = forward + (s * half) * right - (t * half) * up;
            const double along = hitBall(ball.position, normalized(d)) / length(d);
            return along < far ? a + b / along : 1;
        }));
    } else if (cube) {
        l.shadowProjection = form == Form::cube ? PEL_SHADOW_CUBE : PEL_SHADOW_CUBE_RADIAL;
        ball.height = 6 * side;
        for (int r = 0; r < 3; ++r) row(r, {double(r == 0), double(r == 1), double(r == 2)}, 0);
        setRow(l.worldToShadow, 3, {}, 1);
        const auto depth = [&](double s, double t, int face) {
            const Vec3 d = reference::cubeDirection(face, s, t);
            const double distance = hitBall(ball.position, normalized(d));
            if (!(distance < 20)) return 1.0;
            return form == Form::cube ? a + b / (distance / length(d)) : distance / 20;
        };
        ball.maps.push_back(texelsOf(side, depth, 6));
    } else {
        const bool cascades = form == Form::cascades;
        ball.maps.push_back(
            parallelMap(l.worldToShadow, toLight, cascades ? 2.5 : 5, side, form == Form::reversed));
        if (cascades) {
            l.shadowCascades = 2;
            ball.maps.push_back(parallelMap(l.cascadeToShadow[0], toLight, 6, side, false));
            l.cascadeDepthRange[0] = 20;
        } else if (form == Form::exponential) {
            l.shadowContent = PEL_SHADOW_CONTENT_EXPONENTIAL;
            l.shadowExponent = 40;
            for (float& z : ball.maps[0]) z = std::exp(40 * z);
        } else if (form == Form::moments) {
            l.shadowContent = PEL_SHADOW_CONTENT_MOMENTS;
            ball.components = 2;
            std::vector<float> both;
            for (float z : ball.maps[0]) both.insert(both.end(), {z, z * z});
            ball.maps[0] = both;
        }
    }
    return ball;
}

// A ball of as much detail for every form: a cube's face is 90 degrees wide.
inline LitBall evenBall(Form form, Vec3 from, uint32_t side) {
    return makeBall(form, from, form == Form::cube || form == Form::radial ? 2 * side : side);
}

// The ball from +z, each pixel with the light of all.
inline Picture pictureOf(const std::vector<LitBall>& lights, uint32_t side) {
    Picture p = scatter_scene::ball(side, radius, 2.2 * radius / side, {0, 0, 1});
    for (size_t i = 0; i < p.pixels(); ++i) {
        double e = 0;
        for (const LitBall& light : lights) e += light.irradiance(p.place(i));
        if (p.ids[i]) std::fill_n(&p.irradiance[3 * i], 3, float(e));
    }
    return p;
}
inline Picture pictureOf(const LitBall& ball, uint32_t side) {
    return pictureOf(std::vector<LitBall>{ball}, side);
}

inline Frame frameOf(const std::vector<LitBall>& lights, uint32_t side, PelScattering scattering,
                     float profileRadius = 0, const Profile& profile = Profile::skin()) {
    Frame f(pictureOf(lights, side), scattering, radius);
    f.lamps.assign(lights.begin(), lights.end());
    f.profile = profile;
    f.material.diffusionRadius = profileRadius;
    return f;
}

}  // namespace lit_ball
