// Shared by the tests of scattering: pictures, and how a PelScatter, a shader and the oracle scatter them.
#pragma once
#include "tools.h"

#include "reference/diffusion_screen.h"
#include "reference/lut.h"

namespace scatter_scene {

using pellucid::Buffer;
using pellucid::Device;
using pellucid::Profile;
using pellucid::Scatter;
using reference::Vec3;

constexpr float notANumber = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

constexpr PelScattering screen = PEL_SCATTERING_SCREEN, separable = PEL_SCATTERING_SEPARABLE,
                        byLight = PEL_SCATTERING_LIGHT, byAuto = PEL_SCATTERING_AUTO;

// --- pictures ---

struct Picture {
    uint32_t width, height;
    std::vector<float> positions, irradiance;
    std::vector<uint8_t> ids;
    PelScatterParams params = pelScatterParamsDefaults();
    Picture(uint32_t w, uint32_t h)
        : width(w), height(h), positions(3 * w * h), irradiance(3 * w * h), ids(w * h) {}
    size_t at(uint32_t x, uint32_t y) const { return size_t(y) * width + x; }
    size_t pixels() const { return ids.size(); }
    Vec3 place(size_t i) const { return {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]}; }
    void set(size_t pixel, Vec3 p, Vec3 e, uint8_t id = 1) {
        for (int c = 0; c < 3; ++c)
            positions[3 * pixel + c] = float(p[c]), irradiance[3 * pixel + c] = float(e[c]);
        ids[pixel] = id;
    }
    reference::ScatterPicture exact() const {
        reference::ScatterPicture p{int(width), int(height), {}, {}, {}, {}};
        for (size_t i = 0; i < pixels(); ++i) {
            p.positions.push_back(place(i));
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
        for (uint32_t x = 0; x < width; ++x) {
            const double u = (x + 0.5) * size, v = (y + 0.5) * size;
            p.set(p.at(x, y), {u, v, 0}, light(u, v));
        }
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

// The scattered light of a ball of 10 mm by the cosine to the light: the closed form `sphere` of section 2.
inline std::function<Vec3(double)> lightOnBall(const reference::Profile& profile) {
    constexpr int steps = 200;
    std::vector<Vec3> curve;
    for (int k = 0; k <= steps; ++k)
        curve.push_back(reference::curvatureD(reference::Form::sphere, profile, -1 + 2.0 * k / steps, 10));
    return [=](double cosine) {
        const double u = std::clamp((cosine + 1) / 2 * steps, 0.0, steps - 1e-9);
        return mix(curve[size_t(u)], curve[size_t(u) + 1], u - std::floor(u));
    };
}

// Of pixels with an id from expected(pixel, channel); `relative`: RMS over that of what is expected.
struct Difference {
    double rms = 0, most = 0, relative = 0;
};
template <class Expected>
Difference difference(const Picture& p, const std::vector<float>& result, const Expected& expected) {
    Difference d;
    double squares = 0, whole = 0, count = 0;
    for (size_t i = 0; i < p.pixels(); ++i)
        for (int c = 0; p.ids[i] && c < 3; ++c) {
            const double truth = expected(i, c), e = result[3 * i + size_t(c)] - truth;
            squares += e * e, whole += truth * truth, ++count;
            d.most = std::max(d.most, std::abs(e));
        }
    d.rms = std::sqrt(squares / std::max(count, 1.0));
    d.relative = std::sqrt(squares / whole);
    return d;
}
inline Difference difference(const Picture& p, const std::vector<float>& result,
                             const std::vector<float>& other) {
    return difference(p, result, [&](size_t i, int c) { return double(other[3 * i + size_t(c)]); });
}
inline Difference difference(const Picture& p, const std::vector<float>& result,
                             const std::vector<Vec3>& exact) {
    return difference(p, result, [&](size_t i, int c) { return exact[i][c]; });
}

// --- by a PelScatter ---

// One to four values per pixel.
inline pellucid::OwnedImage imageOf(const Device& on, const std::vector<float>& values, uint32_t width,
                                    uint32_t height) {
    constexpr PelFormat formats[] = {PEL_FORMAT_R32F, PEL_FORMAT_RG32F, PEL_FORMAT_RGB32F,
                                     PEL_FORMAT_RGBA32F};
    return pellucid::imageDesc(Buffer(on, values), formats[values.size() / (size_t(width) * height) - 1],
                               width, height);
}
inline pellucid::OwnedImage imageOf(const Device& on, const std::vector<uint8_t>& ids, uint32_t width,
                                    uint32_t height) {
    return pellucid::imageDesc(Buffer(on, ids), PEL_FORMAT_R8_UINT, width, height);
}

inline PelScatterControls controlsOf(PelScattering method, uint32_t taps, float border = 0) {
    PelScatterControls c = pelScatterControlsDefaults();
    c.scattering = method;
    c.scatterTaps = taps;
    std::fill_n(c.borderColor, 3, border);
    return c;
}

struct Material {
    uint32_t id;
    Profile profile;
    float scale = 1;
    PelScatterControls controls = pelScatterControlsDefaults();
};

// The inputs of a call besides irradiance and positions.
struct Extra {
    std::vector<float> weights, albedo, back, normals, curvature;
    std::vector<float> depth;  // in place of positions
    std::vector<float> out;    // what the output holds before
    bool inPlace = false, ids = true;
};

struct Result {
    std::vector<float> scattered;
    PelScatterStats stats;
};

inline Result run(Scatter& scatter, const Picture& p, const std::vector<Material>& materials,
                  const Extra& extra = {}) {
    for (const Material& m : materials) {
        scatter.setMaterial(m.id, m.profile, m.scale);
        if (m.profile && m.scale > 0) scatter.setControls(m.id, m.controls);
    }
    const auto image = [&](const auto& values) { return imageOf(device(), values, p.width, p.height); };
    const std::pair<PelImageSlot, const std::vector<float>*> slots[] = {
        {PEL_SLOT_SCATTER_WEIGHT, &extra.weights},
        {PEL_SLOT_ALBEDO, &extra.albedo},
        {PEL_SLOT_IRRADIANCE_BACK, &extra.back},
        {PEL_SLOT_NORMAL_GEOMETRIC, &extra.normals},
        {PEL_SLOT_MEAN_CURVATURE, &extra.curvature}};
    for (const auto& [slot, values] : slots) {
        scatter.clear(slot);
        if (!values->empty()) scatter.set(slot, image(*values));
    }
    const Buffer e(device(), p.irradiance),
        other(device(), extra.out.empty() ? std::vector<float>(p.irradiance.size(), -7.0f) : extra.out);
    const Buffer& out = extra.inPlace ? e : other;
    const auto rgb = [&](const Buffer& b) {
        return pellucid::imageDesc(b, PEL_FORMAT_RGB32F, p.width, p.height);
    };
    const bool byDepth = !extra.depth.empty();
    const auto places = image(byDepth ? extra.depth : p.positions), ids = image(p.ids);
    scatter.execute(p.params, rgb(e), byDepth ? nullptr : &places, byDepth ? &places : nullptr,
                    extra.ids ? &ids : nullptr, rgb(out));
    return {out.readAll<float>(), scatter.stats()};
}

inline Result run(const Picture& p, const std::vector<Material>& materials, const Extra& extra = {}) {
    Scatter scatter(device());
    return run(scatter, p, materials, extra);
}

inline Result run(const Picture& p, const Profile& profile, float scale = 1) {
    return run(p, std::vector<Material>{{1, profile, scale}});
}

// --- by a shader ---

// A shader over images that a test has as vectors.
struct ShownImages {
    Device device;
    uint32_t width, height;
    pellucid::Shader shader;
    Buffer out;

    ShownImages(const Device& on, uint32_t w, uint32_t h) : device(on), shader(on) { resize(w, h); }
    void resize(uint32_t w, uint32_t h) {
        width = w, height = h;
        out = Buffer(device, std::vector<float>(3 * size_t(w) * h));
        shader.set(PEL_SLOT_RADIANCE, pellucid::imageDesc(out, PEL_FORMAT_RGB32F, w, h));
    }
    template <class T>
    void set(PelImageSlot slot, const std::vector<T>& values) {
        shader.set(slot, imageOf(device, values, width, height));
    }
    // A map of a light, by default the first one.
    void setMap(PelLightSlot slot, const std::vector<float>& values, uint32_t w, uint32_t h,
                uint32_t light = 0) {
        shader.set(light, slot, imageOf(device, values, w, h));
    }
    std::vector<float> execute() {
        shader.commit();
        shader.execute();
        return out.readAll<float>();
    }
};

// Of an albedo of 1 and without the gain of curved bodies: the result is the scattered irradiance.
inline PelMaterial whiteMaterial(const Profile& profile, PelScattering scattering) {
    PelMaterial material = pelMaterialDefaults();
    material.profile = profile.get();
    material.scattering = scattering;
    material.curvatureGain = 0;
    std::fill_n(material.albedo, 3, 1.0f);
    return material;
}

// Only its position matters.
inline PelCamera standingAt(Vec3 place) {
    PelCamera camera = pelCameraDefaults();
    std::fill_n(camera.inverseViewProjection, 16, 0.0f);
    camera.inverseViewProjection[14] = 1;
    for (int k = 0; k < 3; ++k) camera.inverseViewProjection[4 * k + 2] = float(place[k]);
    return camera;
}

struct Lamp {
    PelLight light = pelLightDefaults();
    std::vector<std::vector<float>> maps;  // of one image or of cascades
    uint32_t width = 0, height = 0;        // of each
    std::vector<float> shadow = {};        // by pixel
};

struct Shown {
    std::vector<float> light;
    PelShaderStats stats;
    std::string warnings;
};

// A picture through a shader, and what a test changes of it.
struct Frame {
    Picture picture;
    std::map<PelImageSlot, std::vector<float>> images;  // beside positions, irradiance and ids
    std::vector<Lamp> lamps;
    Profile profile = Profile::skin();
    PelMaterial material;  // its profile is the one above
    pellucid::Lut curvatureLut, shadowLut;
    uint32_t materials = 1;  // ids that have it, from 1
    PelShaderOptions options = pelShaderOptionsDefaults();
    bool giveIrradiance = true;
    std::vector<float> texture;  // a scattered one, square

    // `radius`: of a ball, for its normals; 0: they are along z. Pixels are counted, so that tests that need
    // the counts and those that do not compile the same programs.
    Frame(Picture p, PelScattering scattering, double radius = 0)
        : picture(std::move(p)), material(whiteMaterial(Profile(), scattering)) {
        options.countPixels = 1;
        std::vector<float>& normals = images[PEL_SLOT_NORMAL_SHADING];
        normals = picture.positions;
        for (size_t i = 0; i < normals.size(); ++i)
            normals[i] = radius > 0 ? normals[i] / float(radius) : float(i % 3 == 2);
    }
    Shown shade() const {
        ShownImages shown(device(), 1, 1);
        return shade(shown);
    }
    // The next frame of the same shader.
    Shown shade(ShownImages& shown) const {
        shown.resize(picture.width, picture.height);
        shown.shader.set(options);
        for (PelImageSlot slot : {PEL_SLOT_IRRADIANCE, PEL_SLOT_CURVATURE, PEL_SLOT_UV, PEL_SLOT_MATERIAL,
                                  PEL_SLOT_SCATTER_WEIGHT})
            shown.shader.clear(slot);
        shown.set(PEL_SLOT_POSITION, picture.positions);
        if (!picture.ids.empty()) shown.set(PEL_SLOT_MATERIAL, picture.ids);
        if (giveIrradiance) shown.set(PEL_SLOT_IRRADIANCE, picture.irradiance);
        for (const auto& [slot, values] : images) shown.set(slot, values);
        PelMaterial own = material;
        own.profile = profile.get();
        const auto side = uint32_t(std::sqrt(texture.size() / 3));
        for (uint32_t id = 1; id <= materials; ++id) {
            shown.shader.setMaterial(id, own, curvatureLut, shadowLut);
            if (side) shown.shader.setScatteredTexture(id, imageOf(shown.device, texture, side, side));
        }
        std::vector<PelLight> lights;
        for (const Lamp& lamp : lamps) lights.push_back(lamp.light);
        shown.shader.set(lights);
        for (size_t i = 0; i < lamps.size(); ++i) {
            for (size_t k = 0; k < lamps[i].maps.size(); ++k)
                shown.setMap(PelLightSlot(k ? PEL_LIGHT_CASCADE_1 + int(k) - 1 : int(PEL_LIGHT_SHADOW_MAP)),
                             lamps[i].maps[k], lamps[i].width, lamps[i].height, uint32_t(i));
            if (!lamps[i].shadow.empty())
                shown.setMap(PEL_LIGHT_WIDE_SHADOW, lamps[i].shadow, picture.width, picture.height,
                             uint32_t(i));
        }
        std::vector<float> light = shown.execute();
        return {std::move(light), shown.shader.stats(), shown.shader.warnings()};
    }
};

}  // namespace scatter_scene
