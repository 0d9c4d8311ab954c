// Pictures with the shadow map of their light and the surface integral over them: computed by brute force
// elsewhere (a head), or in closed form (a ball).
#pragma once
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <pellucid/pellucid.hpp>

#include "diffusion/shown_images.h"
#include "io/image/image_file.h"
#include "reference/lut.h"
#include "reference/profile.h"

namespace reference_scenes {

using pellucid::Buffer;
using pellucid::Device;
using pellucid::Profile;

constexpr double albedo = 0.8;  // of the pictures that errors are in

// Lengths are in cm.
struct ReferenceScene {
    uint32_t side = 0, samples = 1;  // pixels of the picture, of which samples^2 are one of the reference
    std::vector<float> positions, normals, irradiance, truth;  // RGB
    std::vector<uint8_t> ids;
    uint32_t mapSide = 0;
    std::vector<float> map;
    PelLight light = pelLightDefaults();
    float profileScale = 1;
    float curvature = 0;  // 1/cm, of the whole surface, for tables; 0: not known
    float gain = 0;       // PelMaterial.curvatureGain; 0: as the surface integral, which has no volume
    float camera = 60;    // it stands at (0, -camera, 0) and looks along y
};

// Christensen and Burley's profile with d of 0.29205, 0.10902, 0.05411 mm: the mean free path is d s(A), s
// = 1.1 for an albedo of 0.8.
inline const float meanFreePath[3] = {0.29205f * 1.1f, 0.10902f * 1.1f, 0.05411f * 1.1f};
inline const float white[3] = {0.8f, 0.8f, 0.8f};
inline Profile profile() {
    return Profile::burley(meanFreePath, white);
}

inline nlohmann::json readJson(const std::string& path) {
    std::ifstream file(path);
    return nlohmann::json::parse(file);
}

// Depths are lengths along the light.
inline void addMap(ReferenceScene& r, const std::string& base) {
    const nlohmann::json json = readJson(base + ".json");
    const pellucid::io::Image image = pellucid::io::readImage(base + "_shadowmap.exr");
    r.mapSide = uint32_t(image.width);
    r.map = image.channel("ViewLayer.Depth.Z").pixels;
    const auto& view = json["shadow_map"]["world_to_light_view"];
    const double extent = json["shadow_map"]["ortho_extent_cm"];
    for (int k = 0; k < 4; ++k) {
        r.light.worldToShadow[k] = float(double(view[0][k]) / extent + (k == 3 ? 0.5 : 0));
        r.light.worldToShadow[4 + k] = float(-double(view[1][k]) / extent + (k == 3 ? 0.5 : 0));
        r.light.worldToShadow[8 + k] = -float(view[2][k]);
        r.light.worldToShadow[12 + k] = k == 3;
    }
    r.light.shadowDepthRange = 1;
    for (int k = 0; k < 3; ++k) r.light.toLight[k] = float(json["light"]["direction_towards_light_world"][k]);
}

inline std::vector<float> readHalves(const std::string& path, size_t count) {
    std::ifstream file(path, std::ios::binary);
    std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
    std::vector<float> values(count);
    const char* from = bytes.data() + bytes.size() - 2 * count;
    for (size_t i = 0; i < count; ++i) {
        uint16_t h;
        std::memcpy(&h, from + 2 * i, 2);
        const int exponent = h >> 10 & 31, mantissa = h & 1023;
        const double v =
            exponent ? std::ldexp(1 + mantissa / 1024.0, exponent - 15) : std::ldexp(mantissa, -24);
        values[i] = float(h >> 15 ? -v : v);
    }
    return values;
}

inline ReferenceScene head1536(const std::string& references, const std::string& gbuffers) {
    const pellucid::io::Image image = pellucid::io::readImage(references + "/head_side_1536.exr");
    ReferenceScene r;
    r.side = 1536, r.samples = 3;
    const std::string position[] = {"Position.X", "Position.Y", "Position.Z"},
                      normal[] = {"NS.X", "NS.Y", "NS.Z"},
                      surface[] = {"Surface.R", "Surface.G", "Surface.B"},
                      light[] = {"Irradiance.Y", "Irradiance.Y", "Irradiance.Y"};
    r.positions = image.interleaved(position);
    r.normals = image.interleaved(normal);
    r.truth = image.interleaved(surface);
    r.irradiance = image.interleaved(light);
    for (float id : image.channel("IndexOB.X").pixels) r.ids.push_back(id > 0);
    addMap(r, gbuffers + "/head_side");
    return r;
}

inline void readGbuffer(ReferenceScene& r, const std::string& path) {
    const pellucid::io::Image image = pellucid::io::readImage(path);
    r.side = uint32_t(image.width);
    const std::string v = "ViewLayer.", position[] = {v + "Position.X", v + "Position.Y", v + "Position.Z"},
                      normal[] = {v + "NShading.R", v + "NShading.G", v + "NShading.B"};
    r.positions = image.interleaved(position);
    r.normals = image.interleaved(normal);
    for (float id : image.channel(v + "IndexOB.X").pixels) r.ids.push_back(id > 0);
}

inline ReferenceScene headTimesFour(const std::string& references, const std::string& gbuffers) {
    ReferenceScene r;
    readGbuffer(r, gbuffers + "/head_gbuf.exr");
    const std::vector<float> e = readHalves(references + "/head_side_irradiance_f16.npy", r.ids.size());
    for (float v : e) r.irradiance.insert(r.irradiance.end(), 3, v);
    r.truth = readHalves(references + "/head_side_x4_surface_integral_f16.npy", 3 * r.ids.size());
    r.profileScale = 4;
    addMap(r, gbuffers + "/head_side");
    return r;
}

// A ball of 10 mm, in the closed form of section 2.
inline ReferenceScene ball(const std::string& gbuffers) {
    ReferenceScene r;
    readGbuffer(r, gbuffers + "/sphere10_gbuf.exr");
    r.camera = 10;
    r.curvature = 1;
    addMap(r, gbuffers + "/sphere10_side");
    const auto exact =
        reference::burleyProfile({meanFreePath[0], meanFreePath[1], meanFreePath[2]}, {0.8, 0.8, 0.8});
    std::vector<reference::Rgb> curve;  // over N.L from -1 to 1
    const int steps = 200;
    for (int k = 0; k <= steps; ++k)
        curve.push_back(reference::curvatureD(reference::Form::sphere, *exact, -1 + 2.0 * k / steps, 10));
    for (size_t i = 0; i < r.ids.size(); ++i) {
        double cosine = 0;
        for (int c = 0; c < 3; ++c) cosine += double(r.positions[3 * i + c]) * r.light.toLight[c];
        const double u = std::clamp((cosine + 1) / 2 * steps, 0.0, steps - 1e-9);
        const reference::Rgb s = mix(curve[size_t(u)], curve[size_t(u) + 1], u - std::floor(u));
        for (int c = 0; c < 3; ++c) {
            r.irradiance.push_back(r.ids[i] ? float(std::max(0.0, cosine)) : 0.0f);
            r.truth.push_back(r.ids[i] ? float(s[c]) : 0.0f);
        }
    }
    return r;
}

struct Shown {
    std::vector<float> light;  // scattered irradiance
    PelShaderStats stats;
    double milliseconds;
};

// By the shader, at an albedo of 1. `given`: with the irradiance of the scene, else with shadows from the
// map. `taps`: PelMaterial.scatterTaps.
inline Shown shade(const Device& device, const ReferenceScene& r, PelScattering scattering, bool given,
                   bool withMap = true, uint32_t taps = 0) {
    scatter_scene::ShownImages shown(device, r.side, r.side);
    PelShaderOptions options = pelShaderOptionsDefaults();
    options.millimetresPerUnit = 10;
    options.countPixels = 1;
    shown.shader.set(options);
    shown.set(PEL_SLOT_POSITION, r.positions);
    shown.set(PEL_SLOT_NORMAL_SHADING, r.normals);
    if (r.curvature > 0) shown.set(PEL_SLOT_CURVATURE, std::vector<float>(r.ids.size(), r.curvature));
    if (given) shown.set(PEL_SLOT_IRRADIANCE, r.irradiance);
    shown.set(PEL_SLOT_MATERIAL, r.ids);
    const Profile skin = profile();
    PelMaterial material = scatter_scene::whiteMaterial(skin, scattering);
    material.specular = 0;
    material.curvatureGain = r.gain;
    material.scatterTaps = taps;
    if (r.profileScale != 1) material.diffusionRadius = float(skin.info().radius) * r.profileScale / 10;
    shown.shader.setMaterial(1, material);
    // Of clip = (x, z, y + camera - 1, y + camera): only where the camera stands matters.
    PelCamera camera = pelCameraDefaults();
    std::fill_n(camera.inverseViewProjection, 16, 0.0f);
    camera.position[1] = -r.camera;
    camera.inverseViewProjection[0] = camera.inverseViewProjection[9] = camera.inverseViewProjection[14] = 1;
    camera.inverseViewProjection[6] = -r.camera;
    shown.shader.set(camera);
    PelLight light = r.light;
    std::fill_n(light.color, 3, 1.0f);
    shown.shader.set(std::vector<PelLight>{light});
    if (withMap) shown.setMap(PEL_LIGHT_SHADOW_MAP, r.map, r.mapSide, r.mapSide);
    shown.execute();
    std::vector<float> result = shown.execute();
    const PelShaderStats stats = shown.shader.stats();
    return {std::move(result), stats, stats.deviceMilliseconds};
}

// Root mean square per channel over pixels of the reference that are wholly covered, in 1e-4 of radiance.
// `unlit`: of those without light.
inline std::array<double, 3> error(const ReferenceScene& r, const std::vector<float>& result,
                                   bool unlit = false) {
    std::array<double, 3> sum{};
    size_t count = 0;
    const size_t k = r.samples, coarse = r.side / k;
    for (size_t y = 0; y < coarse; ++y)
        for (size_t x = 0; x < coarse; ++x) {
            double mean[3] = {};
            bool covered = true;
            for (size_t j = 0; j < k * k; ++j) {
                const size_t i = (k * y + j / k) * r.side + k * x + j % k;
                covered &= r.ids[i] != 0 && !(unlit && r.irradiance[3 * i] > 0);
                for (int c = 0; c < 3; ++c)
                    mean[c] += (result[3 * i + c] - r.truth[3 * i + c]) / double(k * k);
            }
            if (!covered) continue;
            ++count;
            for (int c = 0; c < 3; ++c) sum[c] += mean[c] * mean[c];
        }
    for (double& s : sum) s = 1e4 * albedo * std::sqrt(s / double(std::max<size_t>(count, 1)));
    return sum;
}

}  // namespace reference_scenes
