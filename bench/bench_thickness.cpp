// What taps cost and what they miss: thickness of 8, 16 and 32 taps against 4,096 on a view that `pellucid demo` wrote.
//
//     bench_thickness [out/demo/backlit]    reads backlit.toml, backlit_gbuffer.exr, backlit_shadowmap.exr
//
// Prints one line per number of taps: time of the whole pass (median of 9, interleaved), and the error of thickness (mm) and of the
// transmittance exp(-t^2 / 2 radius^2) at every 23rd pixel of skin that the light reaches from behind, RMS and largest.
#include <pellucid/pellucid.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <numbers>

#include "io/image_file.h"
#include "io/scene_file.h"
#include "reference/shade.h"

using namespace pellucid;
using reference::Vec3;

int main(int argc, char** argv) try {
    const std::string base = argc > 1 && argv[1][0] != '-' ? argv[1] : "out/demo/backlit";
    if (!std::filesystem::exists(base + ".toml")) {
        std::printf("%s.toml is not there: ./run demo writes it\n", base.c_str());
        return 0;
    }
    const io::SceneFile scene = io::readScene(base + ".toml");
    const io::Image image = io::readImage(base + "_gbuffer.exr"), map = io::readImage(scene.lights.at(0).shadowMapFile);
    const Device device("");
    const uint32_t width = uint32_t(image.width), height = uint32_t(image.height);
    std::vector<Buffer> buffers;
    const auto upload = [&](const io::Image& from, const std::vector<std::string>& channels, uint32_t w, uint32_t h) {
        buffers.emplace_back(device, from.interleaved(channels));
        return imageDesc(buffers.back(), channels.size() == 1 ? PEL_FORMAT_R32F : PEL_FORMAT_RGB32F, w, h);
    };
    Shader shader(device);
    for (size_t slot = 0; slot < scene.channels.size(); ++slot)
        if (!scene.channels[slot].empty())
            shader.set(PelImageSlot(slot), upload(image, scene.channels[slot], width, height));
    const PelLight& light = scene.lights[0].light;
    shader.set(std::vector<PelLight>{light});
    shader.set(0, PEL_LIGHT_SHADOW_MAP, upload(map, {map.channels[0].name}, uint32_t(map.width), uint32_t(map.height)));
    const Buffer radiance(device, image.pixelCount() * 12), lengths(device, image.pixelCount() * 4);
    shader.set(PEL_SLOT_RADIANCE, imageDesc(radiance, PEL_FORMAT_RGB32F, width, height));
    shader.set(scene.camera);

    PelMaterial material = scene.materials.at(0).material;
    const auto run = [&](uint32_t taps, bool output) {
        material.thicknessTaps = taps;
        shader.setMaterial(scene.materials[0].id, material);
        if (output)
            shader.set(PEL_SLOT_OUT_THICKNESS, imageDesc(lengths, PEL_FORMAT_R32F, width, height));
        else
            shader.clear(PEL_SLOT_OUT_THICKNESS);
        shader.commit().execute();
        return shader.stats().deviceMilliseconds;
    };

    // The reference: 4,096 points of a sunflower's spiral, in double precision.
    std::vector<reference::Vec2> many;
    for (int i = 0; i < 4096; ++i) {
        const double r = std::sqrt((i + 0.5) / 4096), a = i * std::numbers::pi * (3 - std::sqrt(5.0));
        many.push_back({r * std::cos(a), r * std::sin(a)});
    }
    const auto& depths = map.channels[0].pixels;
    const reference::ShadowMap truthMap{map.width, map.height, {depths.begin(), depths.end()}};
    reference::Matrix4 m;
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c) m[r][c] = light.worldToShadow[4 * r + c];
    const auto position = image.interleaved(scene.channels[PEL_SLOT_POSITION]),
               normal = image.interleaved(scene.channels[PEL_SLOT_NORMAL_GEOMETRIC]);
    const auto id = image.interleaved(scene.channels[PEL_SLOT_MATERIAL]);
    const auto at = [](const std::vector<float>& v, size_t i) { return Vec3{v[3 * i], v[3 * i + 1], v[3 * i + 2]}; };
    const Vec3 l{light.toLight[0], light.toLight[1], light.toLight[2]};
    std::map<size_t, double> truth;
    for (size_t i = 0, seen = 0; i < image.pixelCount(); ++i)
        if (id[i] != 0 && dot(at(normal, i), l) < 0.3 && seen++ % 23 == 0)
            truth[i] = thickness(truthMap, shadowCoordinates(m, at(position, i), at(normal, i), material.deepScatterNormalOffset),
                                 many, material.thicknessFilterRadius, {false, light.shadowDepthRange, 0, 1},
                                 reference::MapFilter::bilinear);

    const uint32_t counts[] = {0, 8, 16, 32};
    std::map<uint32_t, std::vector<double>> times;
    for (int round = 0; round < 10; ++round)
        for (uint32_t taps : counts)
            if (const double time = run(taps, false); round > 0) times[taps].push_back(time);
    std::printf("%s, %u x %u, %zu pixels compared\n", device.info().name, width, height, truth.size());
    for (uint32_t taps : counts) {
        auto& t = times[taps];
        std::nth_element(t.begin(), t.begin() + 4, t.end());
        std::printf("%2u taps: %7.2f ms", taps, t[4]);
        if (taps) {
            run(taps, true);
            const auto ours = lengths.readAll<float>();
            double error = 0, worst = 0, through = 0, worstThrough = 0;
            const double radius = material.deepScatterRadius;
            for (const auto& [i, exact] : truth) {
                const double d = ours[i] - exact,
                             e = std::exp(-ours[i] * double(ours[i]) / (2 * radius * radius)) - std::exp(-exact * exact / (2 * radius * radius));
                error += d * d, through += e * e;
                worst = std::max(worst, std::abs(d)), worstThrough = std::max(worstThrough, std::abs(e));
            }
            std::printf("   thickness RMS %.3f mm, largest %.2f; transmittance RMS %.4f, largest %.3f",
                        std::sqrt(error / double(truth.size())), worst, std::sqrt(through / double(truth.size())), worstThrough);
        }
        std::printf("\n");
    }
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
}
