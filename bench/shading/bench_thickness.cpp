// What taps cost and what they miss: thickness of 8, 16 and 32 taps against 4,096 on a view that `pellucid demo` wrote.
//
//     bench_thickness [out/demo/backlit]    reads backlit.toml, backlit_gbuffer.exr, backlit_shadowmap.exr
//
// Prints one line per number of taps, fixed and rotated from pixel to pixel, and one for cells of taps: time of the whole pass (median of 39, interleaved), and the
// error of thickness (mm) and of the transmittance exp(-t^2 / 2 radius^2), RMS and largest, in every 23rd block of 4 x 4 pixels of
// skin that the light reaches from behind; and RMS of the blocks' means, which is what a filter over pixels or frames leaves.
#include <pellucid/pellucid.hpp>

#include <algorithm>
#include <cmath>
#include <compare>
#include <cstdio>
#include <filesystem>
#include <map>

#include "demo_files.h"
#include "io/image/image_file.h"
#include "io/scene/scene_file.h"
#include "thickness_truth.h"

using namespace pellucid;
using reference::Vec3;

namespace {

struct Case {
    uint32_t taps;
    bool turned, cells;
    auto operator<=>(const Case&) const = default;
};

}  // namespace

int main(int argc, char** argv) try {
    const std::string base = argc > 1 && argv[1][0] != '-' ? argv[1] : "out/demo/backlit";
    if (!std::filesystem::exists(base + ".toml")) {
        std::printf("%s.toml is not there: ./run demo writes it\n", base.c_str());
        return 0;
    }
    const io::SceneFile scene = io::readScene(base + ".toml");
    const io::Image image = io::readImage(base + "_gbuffer.exr"),
                    map = io::readImage(scene.lights.at(0).shadowMapFile);
    const Device device("");
    const uint32_t width = uint32_t(image.width), height = uint32_t(image.height);
    std::vector<Buffer> buffers;
    const auto upload = [&](const io::Image& from, const std::vector<std::string>& channels, uint32_t w,
                            uint32_t h) {
        buffers.emplace_back(device, from.interleaved(channels));
        return imageDesc(buffers.back(), channels.size() == 1 ? PEL_FORMAT_R32F : PEL_FORMAT_RGB32F, w, h);
    };
    Shader shader(device);
    for (size_t slot = 0; slot < scene.channels.size(); ++slot)
        if (!scene.channels[slot].empty())
            shader.set(PelImageSlot(slot), upload(image, scene.channels[slot], width, height));
    const PelLight& light = scene.lights[0].light;
    shader.set(std::vector<PelLight>{light});
    shader.set(0, PEL_LIGHT_SHADOW_MAP,
               upload(map, {map.channels[0].name}, uint32_t(map.width), uint32_t(map.height)));
    const Buffer radiance(device, image.pixelCount() * 12), lengths(device, image.pixelCount() * 4);
    shader.set(PEL_SLOT_RADIANCE, imageDesc(radiance, PEL_FORMAT_RGB32F, width, height));
    shader.set(scene.camera);

    PelMaterial material = demo::withDeepScatter(scene.materials.at(0).material);
    const auto run = [&](Case c, bool output) {
        material.thicknessTaps = c.taps;
        PelShaderOptions options = pelShaderOptionsDefaults();
        options.rotateTaps = c.turned;
        options.everyPixel = !c.cells;
        shader.set(options);
        shader.setMaterial(scene.materials[0].id, material);
        if (output)
            shader.set(PEL_SLOT_OUT_THICKNESS, imageDesc(lengths, PEL_FORMAT_R32F, width, height));
        else
            shader.clear(PEL_SLOT_OUT_THICKNESS);
        shader.commit().execute();
        shader.execute();  // the first one after another case waits for fresh memory
        return shader.stats().deviceMilliseconds;
    };

    const ThicknessTruth manyTaps(map, light, material);
    const auto position = image.interleaved(scene.channels[PEL_SLOT_POSITION]),
               normal = image.interleaved(scene.channels[PEL_SLOT_NORMAL_GEOMETRIC]);
    const auto id = image.interleaved(scene.channels[PEL_SLOT_MATERIAL]);
    const auto at = [](const std::vector<float>& v, size_t i) {
        return Vec3{v[3 * i], v[3 * i + 1], v[3 * i + 2]};
    };
    const Vec3 l{light.toLight[0], light.toLight[1], light.toLight[2]};
    // Skin alone: it has the material that is set; eyes and teeth have others.
    const auto skin = float(scene.materials[0].id);
    const auto behind = [&](size_t i) { return id[i] == skin && dot(at(normal, i), l) < 0.3; };
    std::vector<std::pair<size_t, double>> truth;  // pixels, 16 of each block
    size_t seen = 0;
    for (uint32_t y = 0; y + 4 <= height; y += 4)
        for (uint32_t x = 0; x + 4 <= width; x += 4) {
            std::vector<size_t> block;
            for (uint32_t k = 0; k < 16; ++k)
                if (const size_t i = size_t(y + k / 4) * width + x + k % 4; behind(i)) block.push_back(i);
            if (block.size() < 16 || seen++ % 23) continue;
            for (size_t i : block) truth.emplace_back(i, manyTaps.at(at(position, i), at(normal, i)));
        }

    const Case cases[] = {{0, false, false}, {8, false, false},  {8, true, false},  {16, false, false},
                          {16, true, false}, {32, false, false}, {32, true, false}, {32, false, true}};
    std::map<Case, std::vector<double>> times;
    for (int round = 0; round < 40; ++round)
        for (const Case& c : cases)
            if (const double time = run(c, false); round > 0) times[c].push_back(time);
    std::printf("%s, %u x %u, %zu pixels compared\n", device.info().name, width, height, truth.size());
    const double radius = material.deepScatterRadius, count = double(truth.size());
    const auto through = [&](double t) { return std::exp(-t * t / (2 * radius * radius)); };
    for (const Case& c : cases) {
        auto& t = times[c];
        std::nth_element(t.begin(), t.begin() + 19, t.end());
        std::printf("%2u taps%s: %6.2f ms", c.taps,
                    c.cells    ? ", cells  "
                    : c.turned ? ", rotated"
                               : "         ",
                    t[19]);
        if (c.taps) {
            run(c, true);
            const auto ours = lengths.readAll<float>();
            double error = 0, worst = 0, light2 = 0, worstLight = 0, blocks = 0, sum = 0;
            for (size_t k = 0; k < truth.size(); ++k) {
                const auto& [i, exact] = truth[k];
                const double d = ours[i] - exact, e = through(ours[i]) - through(exact);
                error += d * d, light2 += e * e;
                worst = std::max(worst, std::abs(d)), worstLight = std::max(worstLight, std::abs(e));
                sum += e;
                if (k % 16 == 15) blocks += 16 * (sum / 16) * (sum / 16), sum = 0;
            }
            std::printf(
                "   thickness RMS %.3f mm, largest %.2f; transmittance RMS %.4f, largest %.3f; means of 4 x "
                "4 RMS %.4f",
                std::sqrt(error / count), worst, std::sqrt(light2 / count), worstLight,
                std::sqrt(blocks / count));
        }
        std::printf("\n");
    }
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
}
