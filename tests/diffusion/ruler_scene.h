// The head of the rulers: what light does on it (mathematics, section 9) was made by brute force elsewhere.
#pragma once
#include <array>
#include <cmath>
#include <pellucid/pellucid.hpp>
#include <string>
#include <vector>

#include "diffusion/shown_images.h"
#include "io/image/image_file.h"
#include "io/image/npy_read.h"

namespace ruler {

constexpr size_t side = 1536, coarse = 512;
constexpr double albedo = 0.8;  // of the pictures whose errors are measured

// Positions are in cm, the camera stands at (0, -60, 0).
struct Head {
    size_t side = 0;  // pixels: 3 x 3 of the finer picture are one of the coarser, which has the middle one's values
    std::vector<float> positions, normals, curvature, irradiance, integral;
    std::vector<uint8_t> ids;
};

inline Head load(const std::string& rulers) {
    const pellucid::io::Image image = pellucid::io::readImage(rulers + "/head_side_1536.exr");
    const auto interleaved = [&](std::string name, const std::string& components) {
        std::vector<std::string> names;
        for (char c : components) names.push_back(name + "." + c);
        return image.interleaved(names);
    };
    Head head;
    head.side = side;
    head.positions = interleaved("Position", "XYZ");
    head.normals = interleaved("NS", "XYZ");
    head.curvature = interleaved("Curvature", "C");
    head.integral = interleaved("Surface", "RGB");
    for (float e : interleaved("Irradiance", "Y")) head.irradiance.insert(head.irradiance.end(), 3, e);
    for (float id : interleaved("IndexOB", "X")) head.ids.push_back(id > 0);
    return head;
}

// At the coarser pixels' middles, with the surface integral of four times the radius.
inline Head fourfold(const Head& fine, const std::string& rulers) {
    Head head;
    head.side = coarse;
    const auto pick = [&](const auto& from, size_t components) {
        std::decay_t<decltype(from)> to;
        for (size_t y = 0; y < coarse; ++y)
            for (size_t x = 0; x < coarse; ++x) {
                const auto first = from.begin() + long(components * ((3 * y + 1) * side + 3 * x + 1));
                to.insert(to.end(), first, first + long(components));
            }
        return to;
    };
    head.positions = pick(fine.positions, 3);
    head.normals = pick(fine.normals, 3);
    head.curvature = pick(fine.curvature, 1);
    head.irradiance = pick(fine.irradiance, 3);
    head.ids = pick(fine.ids, 1);
    head.integral = pellucid::io::readNpy(rulers + "/head_side_x4_surface_integral_f16.npy").values;
    return head;
}

// Root mean square per channel, in 1e-4 of radiance: over the coarse pixels that are wholly covered.
inline std::array<double, 3> error(const Head& head, const std::vector<float>& result) {
    std::array<double, 3> sum{};
    size_t count = 0;
    const size_t block = head.side / coarse;
    for (size_t y = 0; y < coarse; ++y)
        for (size_t x = 0; x < coarse; ++x) {
            double mean[3] = {};
            bool covered = true;
            for (size_t k = 0; k < block * block; ++k) {
                const size_t i = (block * y + k / block) * head.side + block * x + k % block;
                covered &= head.ids[i] != 0;
                for (int c = 0; c < 3; ++c)
                    mean[c] += (result[3 * i + c] - head.integral[3 * i + c]) / double(block * block);
            }
            if (!covered) continue;
            ++count;
            for (int c = 0; c < 3; ++c) sum[c] += mean[c] * mean[c];
        }
    for (double& s : sum) s = 1e4 * albedo * std::sqrt(s / double(count));
    return sum;
}

// Where the camera stands, for what asks no more of the matrix: of clip = (x, z, y + 60 - 1, y + 60).
inline void standAt(float (&m)[16]) {
    std::fill(m, m + 16, 0.0f);
    m[0] = m[9] = 1;
    m[6] = -60, m[14] = 1;
}

// The head's own images but its light, and where the camera stands.
inline void setHead(scatter_scene::ShownImages& shown, const Head& head) {
    PelShaderOptions options = pelShaderOptionsDefaults();
    options.millimetresPerUnit = 10;
    shown.shader.set(options);
    shown.set(PEL_SLOT_POSITION, head.positions);
    shown.set(PEL_SLOT_NORMAL_SHADING, head.normals);
    shown.set(PEL_SLOT_MATERIAL, head.ids);
    PelCamera camera = pelCameraDefaults();
    standAt(camera.inverseViewProjection);
    shown.shader.set(camera);
}

// The light and its shadow map, whose texels are 0.33 mm wide (head_side.json).
inline PelLight light() {
    PelLight l = pelLightDefaults();
    const double toLight[3] = {0.7990018725395203, -0.44943854212760925, 0.39950093626976013};
    const double clip[2][4] = {
        {0.028838887041601424, 0.051269152776190374, 0, -0.23071089998809846},
        {-0.020482068628992045, 0.011521154509716969, 0.05392546182974578, 0.08296809507872638}};
    const double view[4] = {0.7990020513534546, -0.4494384527206421, 0.3995007276535034, -30.978775024414062};
    constexpr double range = 102;  // cm
    for (int k = 0; k < 4; ++k) {
        l.worldToShadow[k] = float(0.5 * clip[0][k] + (k == 3 ? 0.5 : 0));
        l.worldToShadow[4 + k] = float(-0.5 * clip[1][k] + (k == 3 ? 0.5 : 0));
        l.worldToShadow[8 + k] = float(-view[k] / range);
        if (k < 3) l.toLight[k] = float(toLight[k]);
    }
    l.shadowDepthRange = range;
    return l;
}

inline std::vector<float> shadowMap(const std::string& gbuffers) {
    const std::string name[] = {"ViewLayer.Depth.Z"};
    std::vector<float> map = pellucid::io::readImage(gbuffers + "/head_side_shadowmap.exr").interleaved(name);
    for (float& z : map) z /= 102;
    return map;
}

// d of 0.29205, 0.10902 and 0.05411 mm, times `scale`.
inline pellucid::Profile profile(float scale = 1) {
    const float d[] = {0.29205f * scale, 0.10902f * scale, 0.05411f * scale};
    return pellucid::Profile::burleyDistance(d);
}

}  // namespace ruler
