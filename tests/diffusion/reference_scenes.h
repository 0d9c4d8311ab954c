// Pictures with the shadow map of their light and the surface integral over them: computed by brute force
// elsewhere (a head), or in closed form (a ball).
#pragma once
#include <nlohmann/json.hpp>

#include "diffusion/scatter_scene.h"
#include "io/image/image_file.h"

namespace reference_scenes {

using pellucid::Buffer;
using pellucid::Device;
using pellucid::Profile;
using scatter_scene::Shown;

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

// Depths are lengths along the light.
inline void addMap(ReferenceScene& r, const std::string& base) {
    std::ifstream file(base + ".json");
    const nlohmann::json json = nlohmann::json::parse(file);
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
    for (float v : pellucid::io::readNpy(references + "/head_side_irradiance_f16.npy").values)
        r.irradiance.insert(r.irradiance.end(), 3, v);
    r.truth = pellucid::io::readNpy(references + "/head_side_x4_surface_integral_f16.npy").values;
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
    const auto light = scatter_scene::lightOnBall(
        *reference::burleyProfile({meanFreePath[0], meanFreePath[1], meanFreePath[2]}, {0.8, 0.8, 0.8}));
    for (size_t i = 0; i < r.ids.size(); ++i) {
        double cosine = 0;
        for (int c = 0; c < 3; ++c) cosine += double(r.positions[3 * i + c]) * r.light.toLight[c];
        for (int c = 0; c < 3; ++c) {
            r.irradiance.push_back(r.ids[i] ? float(std::max(0.0, cosine)) : 0.0f);
            r.truth.push_back(r.ids[i] ? float(light(cosine)[c]) : 0.0f);
        }
    }
    return r;
}

// By the shader, at an albedo of 1. `given`: with the irradiance of the scene, else with shadows from the
// map. `taps`: PelMaterial.scatterTaps.
inline Shown shade(const Device& device, const ReferenceScene& r, PelScattering scattering, bool given,
                   bool withMap = true, uint32_t taps = 0) {
    scatter_scene::ShownImages shown(device, 1, 1);
    scatter_scene::Picture p(r.side, r.side);
    p.positions = r.positions, p.irradiance = r.irradiance, p.ids = r.ids;
    scatter_scene::Frame f(p, scattering);
    f.options.millimetresPerUnit = 10;
    f.images[PEL_SLOT_NORMAL_SHADING] = r.normals;
    if (r.curvature > 0) f.images[PEL_SLOT_CURVATURE].assign(r.ids.size(), r.curvature);
    f.giveIrradiance = given;
    f.profile = profile();
    f.material.curvatureGain = r.gain;
    f.material.scatterTaps = taps;
    if (r.profileScale != 1)
        f.material.diffusionRadius = float(f.profile.info().radius) * r.profileScale / 10;
    PelCamera camera = scatter_scene::standingAt({0, -r.camera, 0});
    camera.position[1] = -r.camera;
    shown.shader.set(camera);
    f.lamps = {{r.light, {}, r.mapSide, r.mapSide}};
    std::fill_n(f.lamps[0].light.color, 3, 1.0f);
    if (withMap) f.lamps[0].maps = {r.map};
    return f.shade(shown);
}

// Root mean square per channel over pixels of the reference that are wholly covered, in 1e-4 of radiance.
inline std::array<double, 3> error(const ReferenceScene& r, const std::vector<float>& result) {
    std::array<double, 3> sum{};
    size_t count = 0;
    const size_t k = r.samples, coarse = r.side / k;
    for (size_t y = 0; y < coarse; ++y)
        for (size_t x = 0; x < coarse; ++x) {
            double mean[3] = {};
            bool covered = true;
            for (size_t j = 0; j < k * k; ++j) {
                const size_t i = (k * y + j / k) * r.side + k * x + j % k;
                covered &= r.ids[i] != 0;
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
