// Smooth frames for the passes before the shading kernel, and ways to show their results.
#pragma once
#include "reference/shade_passes.h"
#include "shade_scene.h"

namespace shade_test {

// A relief seen from above: waves, a cliff that rises 30 at x = 60 % of the width, two materials (1 and 2,
// split along a slanted line) and a hole; normals turned at random. `pixel` is the distance between pixels.
inline Frame reliefFrame(uint32_t seed, uint32_t width, uint32_t height, float pixel) {
    Random random(seed);
    Frame f;
    f.width = width;
    f.height = height = sizedRows(width, height);
    for (int slot : {PEL_SLOT_POSITION, PEL_SLOT_NORMAL_SHADING, PEL_SLOT_NORMAL_GEOMETRIC}) {
        f.slots[slot].components = 3;
        f.slots[slot].values.resize(f.pixels() * 3);
    }
    f.slots[PEL_SLOT_MATERIAL].components = 1;
    f.slots[PEL_SLOT_MATERIAL].values.resize(f.pixels());
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const size_t i = size_t(y) * width + x;
            const float px = pixel * float(x), py = pixel * float(y);
            const float fx = 0.11f + 0.03f * float(seed % 3), fy = 0.07f;
            const float z =
                3 * std::sin(fx * px) * std::cos(fy * py) + (x > 0.6f * float(width) ? 30.0f : 0.0f);
            const float dx = 3 * fx * std::cos(fx * px) * std::cos(fy * py),
                        dy = -3 * fy * std::sin(fx * px) * std::sin(fy * py);
            const Vec3 geometric = normalized(Vec3{-dx, -dy, 1});
            f.slots[PEL_SLOT_POSITION].set(i, {px, py, z});
            f.slots[PEL_SLOT_NORMAL_GEOMETRIC].set(i, geometric);
            f.slots[PEL_SLOT_NORMAL_SHADING].set(i, normalized(geometric + 0.4 * random.unit()));
            const bool hole = std::hypot(float(x) - 0.3f * float(width), float(y) - 0.5f * float(height)) <
                              0.1f * float(height);
            f.slots[PEL_SLOT_MATERIAL].values[i] = hole ? 0 : 3 * x + y < width ? 2 : 1;
        }
    for (uint32_t id : {1u, 2u}) {
        PelMaterial m = fixture::faceworksMaterial();
        m.diffusionRadius = id == 1 ? 2.7f : 1.4f;
        for (float& c : m.albedo) c = 1;
        f.materials[id] = m;
    }
    f.curvatureLut = f.shadowLut = false;
    return f;
}

// Makes the frame show its blurred normal: ambient light of 1 + n / 2 per channel.
inline void showBlurredNormal(Frame& f) {
    f.lights.clear();
    const double band = std::sqrt(3 / (4 * 3.14159265358979323846));
    f.ambient = pelAmbientDefaults();
    const int basis[3] = {3, 1, 2};  // x, y, z
    for (int c = 0; c < 3; ++c) {
        f.ambient.constant[c] = 1;
        f.ambient.sh[basis[c]][c] = float(0.5 / band);
    }
    for (auto& [id, m] : f.materials)
        for (int c = 0; c < 3; ++c) m.normalBlend[c] = m.albedo[c] = 1;
}
inline reference::Vec3 shownNormal(const std::vector<float>& radiance, size_t i) {
    return 2.0 * (vectorOf(&radiance[3 * i]) - Vec3{1, 1, 1});
}

// Whether all pixels are finite, and those farther than `reach` from bad ones, along x or y, are what they
// were before.
inline bool farOnesAreSame(const Frame& f, const std::vector<float>& before, const std::vector<float>& after,
                           std::initializer_list<size_t> bad, int reach) {
    for (size_t i = 0; i < f.pixels(); ++i) {
        const bool far = std::ranges::all_of(bad, [&](size_t b) {
            return std::abs(int(i % f.width) - int(b % f.width)) > reach ||
                   std::abs(int(i / f.width) - int(b / f.width)) > reach;
        });
        for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
            if (!std::isfinite(after[c]) || (far && after[c] != before[c])) return false;
        }
    }
    return true;
}

// With wide shadows and taps between pixels.
inline Frame interpolated(Frame f) {
    f.options.everyPixel = 0;
    return f;
}

inline reference::SurfacePixels surfaceOf(const Frame& f) {
    reference::SurfacePixels s;
    s.width = int(f.width);
    s.height = int(f.height);
    for (size_t i = 0; i < f.pixels(); ++i) {
        s.normals.push_back(f.slots[PEL_SLOT_NORMAL_SHADING].vec(i));
        s.positions.push_back(f.slots[PEL_SLOT_POSITION].vec(i));
        const int id = f.slots[PEL_SLOT_MATERIAL].values.empty() ? 1 : int(f.slots[PEL_SLOT_MATERIAL].at(i));
        s.ids.push_back(f.materials.count(uint32_t(id)) ? id : 0);
    }
    s.radii.assign(256, 0);
    for (const auto& [id, m] : f.materials) s.radii[id] = m.diffusionRadius;
    return s;
}

// A light with a shadow map of random bumps, looking at the relief along `forward`.
struct MapLight {
    Light light;
    reference::ShadowView view;
    reference::ShadowMap map;
};
inline MapLight mapLight(uint32_t seed, bool perspective = false, bool reversed = false,
                         Vec3 toLight = {0.5, 0.2, 0.9}, Vec3 target = {24, 10, 5}, double extent = 70,
                         uint32_t size = 61) {
    Random random(seed);
    MapLight out;
    auto& v = out.view;
    v.forward = -1.0 * normalized(toLight);
    v.right = normalized(cross(v.forward, Vec3{0.3, 1, 0.2}));
    v.down = cross(v.forward, v.right);
    const double away = 150, near = 50, far = 400;
    v.origin = target - away * v.forward;
    v.extent = perspective ? extent / away : extent;
    double depthScale, depthOffset;  // z of row 2 over w
    if (perspective) {
        const double n = reversed ? far : near, fa = reversed ? near : far;
        depthScale = fa / (fa - n), depthOffset = -n * fa / (fa - n);
        v.decoding = {true, 1, 1 / depthOffset, -depthScale / depthOffset};
    } else {
        v.decoding = {false, reversed ? -300.0 : 300.0, 0, 1};
        depthScale = 1 / v.decoding.range, depthOffset = 0;
    }
    PelLight& l = out.light.params;
    l.shadowProjection = perspective ? PEL_SHADOW_PERSPECTIVE : PEL_SHADOW_PARALLEL;
    const auto row = [&](int r, Vec3 axis, double constant) {
        copyTo(l.worldToShadow + 4 * r, axis);
        l.worldToShadow[4 * r + 3] = float(constant - dot(axis, v.origin));
    };
    const Vec3 none{0, 0, 0};
    const double k = 1 / v.extent;
    if (perspective) {
        row(0, k * v.right + 0.5 * v.forward, 0);
        row(1, k * v.down + 0.5 * v.forward, 0);
        row(2, depthScale * v.forward, depthOffset);
        row(3, v.forward, 0);
        l.shadowDepthA = float(v.decoding.a);
        l.shadowDepthB = float(v.decoding.b);
    } else {
        row(0, k * v.right, 0.5);
        row(1, k * v.down, 0.5);
        row(2, depthScale * v.forward, 0);
        row(3, none, 1);
        l.shadowDepthRange = float(v.decoding.range);
    }
    copyTo(l.toLight, -1 * v.forward);
    l.shadowFilterTexels = 24;
    out.map.width = out.map.height = int(size);
    out.light.mapSize = size;
    out.light.map.components = 1;
    for (uint32_t i = 0; i < size * size; ++i) {
        // Discs at random distances before the surface, on open ground.
        const uint32_t x = i % size, y = i / size, cell = (x / 13) * 31 + (y / 13) * 17 + seed;
        const bool disc = std::hypot(double(x % 13) - 6, double(y % 13) - 6) < 3 + cell % 4;
        const double distance = away + 20 - (disc ? 5 + double(cell * 7 % 23) : -10) + random.uniform();
        const double z =
            perspective ? (1 / distance - v.decoding.b) / v.decoding.a : distance / v.decoding.range;
        out.light.map.values.push_back(float(z));
        out.map.depth.push_back(float(z));
    }
    return out;
}

// Makes the frame show the wide shadow: shading normals that face the light, white.
inline void showWideShadow(Frame& f) {
    for (size_t i = 0; i < f.pixels(); ++i)
        f.slots[PEL_SLOT_NORMAL_SHADING].set(i, vectorOf(f.lights[0].params.toLight));
    f.ambient = pelAmbientDefaults();
}

}  // namespace shade_test
