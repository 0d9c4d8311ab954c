// Pictures that the tests of scattering run, on the device and in double precision.
#pragma once
#include <pellucid/pellucid.hpp>

#include <cmath>
#include <cstring>
#include <functional>
#include <random>

#include "reference/diffusion_screen.h"
#include "test_size.h"

namespace scatter_scene {

using pellucid::Buffer;
using pellucid::Device;
using pellucid::Profile;
using pellucid::Scatter;
using reference::Vec3;

inline const Device& device() {
    static const Device device("");
    return device;
}

struct Picture {
    uint32_t width, height;
    std::vector<float> positions, irradiance;
    std::vector<uint8_t> ids;
    PelScatterParams params = pelScatterParamsDefaults();
    Picture(uint32_t w, uint32_t h)
        : width(w), height(h), positions(3 * w * h), irradiance(3 * w * h), ids(w * h) {}
    size_t at(uint32_t x, uint32_t y) const { return size_t(y) * width + x; }
    size_t pixels() const { return ids.size(); }
    void set(size_t pixel, Vec3 p, Vec3 e, uint8_t id = 1) {
        for (int c = 0; c < 3; ++c)
            positions[3 * pixel + c] = float(p[c]), irradiance[3 * pixel + c] = float(e[c]);
        ids[pixel] = id;
    }
    reference::ScatterPicture exact() const {
        reference::ScatterPicture p{int(width), int(height), {}, {}, {}, {}};
        for (size_t i = 0; i < pixels(); ++i) {
            p.positions.push_back({positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]});
            p.irradiance.push_back({irradiance[3 * i], irradiance[3 * i + 1], irradiance[3 * i + 2]});
            p.ids.push_back(ids[i]);
        }
        return p;
    }
};

// A plane at right angles to the view, pixels `size` wide, lit as a function of the place.
inline Picture plane(uint32_t width, uint32_t height, double size,
                     const std::function<Vec3(double, double)>& light) {
    Picture p(width, height);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            p.set(p.at(x, y), {(x + 0.5) * size, (y + 0.5) * size, 0},
                  light((x + 0.5) * size, (y + 0.5) * size));
    return p;
}

// A ball seen in parallel from +z, lit from `toLight`; `size`: length of a pixel.
inline Picture ball(uint32_t side, double radius, double size, Vec3 toLight) {
    Picture p(side, side);
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const double u = (x + 0.5 - 0.5 * side) * size, v = (0.5 * side - y - 0.5) * size,
                         rest = radius * radius - u * u - v * v;
            if (rest <= 0) continue;
            const Vec3 n = Vec3{u, v, std::sqrt(rest)} / radius;
            const double e = reference::max0(dot(n, toLight));
            p.set(p.at(x, y), radius * n, {e, e, e});
        }
    return p;
}

struct Result {
    std::vector<float> scattered;
    PelScatterStats stats;
};

struct Material {
    uint32_t id;
    Profile profile;
    float scale;
};

inline Result run(const Picture& p, const std::vector<Material>& materials, bool inPlace = false) {
    Scatter scatter(device());
    for (const Material& m : materials) scatter.setMaterial(m.id, m.profile, m.scale);
    const Buffer e(device(), p.irradiance), x(device(), p.positions), i(device(), p.ids);
    const Buffer out(device(), std::vector<float>(p.irradiance.size(), -7.0f));
    const auto rgb = [&](const Buffer& b) {
        return pellucid::imageDesc(b, PEL_FORMAT_RGB32F, p.width, p.height);
    };
    const PelImageDesc positions = rgb(x),
                       ids = pellucid::imageDesc(i, PEL_FORMAT_R8_UINT, p.width, p.height);
    scatter.execute(p.params, rgb(e), &positions, nullptr, &ids, rgb(inPlace ? e : out));
    return {(inPlace ? e : out).readAll<float>(), scatter.stats()};
}

inline Result run(const Picture& p, const Profile& profile, float scale = 1) {
    return run(p, std::vector<Material>{{1, profile, scale}});
}

}  // namespace scatter_scene
