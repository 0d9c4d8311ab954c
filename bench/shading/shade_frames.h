// The frames that bench_shade measures, as the library and the baselines take them.
#pragma once
#include <pellucid/pellucid.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "baseline_shade.h"
#include "demo_files.h"
#include "faceworks_material.h"
#include "io/image/image_file.h"
#include "io/scene/scene_file.h"

namespace frames {

using namespace pellucid;
using baseline::ShadeFrame;
using baseline::ShadeSettings;
using baseline::ShadeTable;

inline void append3(std::vector<float>& to, float x, float y, float z) {
    to.insert(to.end(), {x, y, z});
}

inline void appendUnit(std::vector<float>& to, float x, float y, float z) {
    const float length = std::sqrt(x * x + y * y + z * z);
    append3(to, x / length, y / length, z / length);
}

// Coverage: share of the rows, from the top, that are skin.
inline ShadeFrame foldedSkin(int width, int height, double coverage) {
    ShadeFrame f;
    f.width = width;
    f.height = height;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float a = 1.6f * std::sin(float(x) / 110), b = 1.2f * std::cos(float(y) / 85);
            f.id.push_back(y < int(std::lround(coverage * height)));
            append3(f.position, 0.1f * float(x - width / 2), 0.1f * float(height / 2 - y),
                    12 * std::sin(float(x + y) / 150));
            appendUnit(f.geometric, a, b, 1);
            appendUnit(f.shading, a + 0.1f * std::sin(float(x) / 3), b + 0.1f * std::sin(float(y) / 4), 1);
            appendUnit(f.blurred, 0.9f * a, 0.9f * b, 1);
            f.curvature.push_back(0.05f + 0.2f * float((x / 7 + y / 5) % 10) / 10);
            append3(f.albedo, 0.8f, 0.5f, 0.4f);
            f.wide.push_back(std::clamp(0.5f + 3 * std::sin(float(x - y) / 140), 0.0f, 1.0f));
        }
    return f;
}

inline ShadeFrame ball(int width, int height) {
    ShadeFrame f;
    f.width = width;
    f.height = height;
    const float radius = 0.45f * float(height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float px = (float(x) - 0.5f * float(width)) / radius,
                        py = (0.5f * float(height) - float(y)) / radius;
            const float r2 = px * px + py * py;
            const bool inside = r2 < 1;
            const float pz = inside ? std::sqrt(1 - r2) : 0;
            f.id.push_back(inside);
            append3(f.position, 110 * px, 110 * py, 110 * pz);
            appendUnit(f.geometric, px, py, pz + 1e-3f);
            appendUnit(f.shading, px + 0.05f * std::sin(float(x) / 3), py + 0.05f * std::sin(float(y) / 4),
                       pz + 1e-3f);
            appendUnit(f.blurred, px, py, pz + 1e-3f);
            f.curvature.push_back(1.0f / 110 + 0.1f * std::fabs(std::sin(float(x + y) / 40)));
            append3(f.albedo, 0.8f, 0.5f, 0.4f);
            f.wide.push_back(std::clamp(0.5f + 4 * (0.7f * px + 0.3f * py + 0.6f * pz), 0.0f, 1.0f));
        }
    return f;
}

inline void addShadowMap(ShadeFrame& f) {
    f.mapSize = 1024;
    for (int y = 0; y < 1024; ++y)
        for (int x = 0; x < 1024; ++x)
            f.map.push_back(0.42f + 0.05f * std::sin(float(x) / 60) * std::cos(float(y) / 50));
}

struct Scene {
    ShadeFrame frame;
    ShadeSettings settings{};
    ShadeTable curvature, shadow;
    Lut curvatureLut, shadowLut;
    PelLight light = pelLightDefaults();
    PelMaterial material = fixture::faceworksMaterial();
    PelAmbient ambient = pelAmbientDefaults();
    PelCamera camera = pelCameraDefaults();
    std::vector<float> out;
};

inline std::vector<float> readDisk(int taps) {
    std::ifstream file(PELLUCID_SOURCE_DIR "/kernels/lib/shading/poisson_disk.clh");
    const std::string start = "pelDisk" + std::to_string(taps) + "[";
    std::vector<float> disk;
    for (std::string line; std::getline(file, line);)
        if (line.find(start) != std::string::npos)
            while (std::getline(file, line) && line[0] != '}') {
                for (size_t at = 0; (at = line.find("(float2)(", at)) != std::string::npos; ++at) {
                    float x = 0, y = 0;
                    std::sscanf(line.c_str() + at, "(float2)(%ff, %ff)", &x, &y);
                    disk.insert(disk.end(), {x, y});
                }
            }
    if (disk.size() != 2 * size_t(taps))
        throw std::runtime_error("no disk of this many taps in poisson_disk.clh");
    return disk;
}

inline void describeScene(Scene& s, int taps) {
    const float toLight[3] = {0.8f, 0.36f, 0.48f}, camera[3] = {0, 0, 600};
    std::copy_n(toLight, 3, s.light.toLight);
    std::copy_n(camera, 3, s.camera.position);
    const float rows[16] = {0.004f, 0, 0, 0.5f, 0, 0.004f, 0, 0.5f, 0, 0, -0.004f, 0.5f, 0, 0, 0, 1};
    std::copy_n(rows, 16, s.light.worldToShadow);
    s.light.shadowDepthRange = 250;
    const float color[3] = {0.9f, 0.4f, 0.3f};
    if (taps) std::copy_n(color, 3, s.material.deepScatterColor);
    s.material.thicknessTaps = uint32_t(taps);
    s.material.specular = 0.8f;
    for (int i = 0; i < 9; ++i)
        for (int c = 0; c < 3; ++c) s.ambient.sh[i][c] = 0.3f / float(1 + i + c);
}

// A parallel camera along -z that sees `scale` of length a pixel, to the depth of `reach` on either side of the origin.
inline void describeCamera(Scene& s, float scale, float reach) {
    const float w = float(s.frame.width), h = float(s.frame.height);
    const float rows[16] = {
        0.5f * scale * w, 0, 0, -0.5f * scale, 0, 0.5f * scale * h, 0, 0.5f * scale, 0, 0, 2 * reach, -reach, 0, 0, 0, 1};
    std::copy_n(rows, 16, s.camera.inverseViewProjection);
}

// The baselines take their numbers from what the library is given.
inline void fillSettings(Scene& s) {
    ShadeSettings& b = s.settings;
    const int taps = int(s.material.thicknessTaps);
    std::copy_n(s.light.toLight, 3, b.toLight);
    std::copy_n(s.camera.position, 3, b.camera);
    std::copy_n(s.light.color, 3, b.light);
    std::copy_n(s.material.deepScatterColor, 3, b.deepScatter);
    std::copy_n(s.light.worldToShadow, 16, b.worldToShadow);
    const float one = 0.48860251f, two = 1.09254843f;
    const float factors[9] = {0.28209479f, one, one, one, two, two, 0.31539157f, two, 0.5f * two};
    for (int i = 0; i < 9; ++i)
        for (int c = 0; c < 3; ++c)
            b.ambient[i][c] = factors[i] * s.ambient.sh[i][c] + (i ? 0 : s.ambient.constant[c]);
    b.depthRange = s.light.shadowDepthRange;
    b.rowsCurvature[0] = 1 / (1 - 0.01f);
    b.rowsCurvature[1] = -0.01f / (1 - 0.01f);
    b.rowsShadow[0] = 1 / (1 / 8.0f - 0.01f);
    b.rowsShadow[1] = -0.01f / (1 / 8.0f - 0.01f);
    b.penumbraPerCosine = 1 / s.material.shadowFilterWidth;
    b.sharpening = 9;
    b.deepScatterRadius = s.material.deepScatterRadius;
    b.normalOffset = s.material.deepScatterNormalOffset;
    b.filterRadius = s.material.thicknessFilterRadius;
    b.taps = taps;
    b.specular = s.material.specular;
    b.roughness = s.material.roughness;
    b.f0 = s.material.f0;
    if (taps) b.disk = readDisk(taps);
}

inline void makeTables(Scene& s, const Device& device) {
    s.curvatureLut = Lut(device, pelCurvatureLutDescFaceWorks());
    s.shadowLut = Lut(device, pelShadowLutDescFaceWorks());
    s.curvature = {s.curvatureLut.read<float>(PEL_LUT_FLOAT), 512, 512};
    s.shadow = {s.shadowLut.read<float>(PEL_LUT_FLOAT), 512, 512};
    s.out.resize(s.frame.position.size());
}

inline std::unique_ptr<Scene> makeScene(const Device& device, ShadeFrame frame, int taps) {
    auto s = std::make_unique<Scene>();
    s->frame = std::move(frame);
    addShadowMap(s->frame);
    describeScene(*s, taps);
    fillSettings(*s);
    makeTables(*s, device);
    return s;
}

// A view as `pellucid demo` wrote it.
inline std::unique_ptr<Scene> readDemoView(const Device& device, const std::string& directory,
                                           const std::string& view) {
    const io::SceneFile file = io::readScene(directory + "/" + view + ".toml");
    const io::Image g = io::readImage(directory + "/" + view + "_gbuffer.exr");
    auto s = std::make_unique<Scene>();
    ShadeFrame& f = s->frame;
    f.width = g.width;
    f.height = g.height;
    const auto take = [&](PelImageSlot slot) { return g.interleaved(file.channels[slot]); };
    f.position = take(PEL_SLOT_POSITION);
    f.geometric = take(PEL_SLOT_NORMAL_GEOMETRIC);
    f.shading = take(PEL_SLOT_NORMAL_SHADING);
    f.blurred = take(PEL_SLOT_NORMAL_BLURRED);
    f.curvature = take(PEL_SLOT_CURVATURE);
    f.albedo = take(PEL_SLOT_ALBEDO);
    for (const float id : take(PEL_SLOT_MATERIAL)) f.id.push_back(id == 1.0f);
    f.wide = g.interleaved(std::vector{file.lights.at(0).wideShadow});
    const io::Image map = io::readImage(file.lights[0].shadowMapFile);
    f.map = map.interleaved(std::vector{file.lights[0].shadowMapChannel});
    f.mapSize = map.width;
    s->light = file.lights[0].light;
    s->material = demo::withDeepScatter(file.materials.at(0).material);
    s->ambient = file.ambient;
    s->camera = file.camera;
    fillSettings(*s);
    makeTables(*s, device);
    return s;
}

}  // namespace frames
