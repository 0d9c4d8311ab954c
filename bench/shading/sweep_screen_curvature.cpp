// Screen-space curvature of the demo's key view against per-vertex curvature, and what the difference does to the shaded
// picture: numbers on stdout, docs/figures/screen_curvature.png by bench/shading/screen_curvature_figure.
//   sweep_screen_curvature MESH DEMO_FOLDER SHADED_VERTEX.exr SHADED_SCREEN.exr FIGURE.png
// MESH: the demo's. The two shaded pictures are of the same G-buffer, DEMO_FOLDER/key_gbuffer.exr.
#include <pellucid/pellucid.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "demo_files.h"
#include "io/image/color_difference.h"
#include "io/image/image_file.h"
#include "io/image/picture.h"
#include "io/image/tone_map.h"
#include "sample/gbuffer.h"

using namespace pellucid;

namespace {

const Device& device() {
    static const Device device("");
    return device;
}

// A quantity at the vertices, seen through the demo's camera.
std::vector<float> vertexCurvature(const io::MeshData& mesh, PelCurvatureQuantity quantity, uint32_t passes,
                                   int width, int height) {
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.quantity = quantity;
    params.smoothingPasses = passes;
    const std::vector<float> values = demo::curvature(device(), mesh, params);
    const sample::Scene scene(
        sample::MeshView{mesh.positions, mesh.normals, mesh.uvs, values, mesh.triangles, {}});
    sample::Framing framing;
    framing.azimuth = 25;
    sample::GBufferOptions plain;
    plain.detail.enabled = false;
    return renderGBuffer(scene, frameHead(scene.bounds(), {}, framing, double(width) / height), width, height,
                         plain)
        .curvature.data;
}

std::vector<float> measuredOnScreen(const io::Image& g, const char* normalName) {
    const auto names = [](std::string name, const char* letters) {
        std::vector<std::string> all;
        for (; *letters; ++letters) all.push_back(name + "." + *letters);
        return all;
    };
    const auto w = uint32_t(g.width), h = uint32_t(g.height);
    const Buffer n(device(), g.interleaved(names(normalName, "XYZ"))),
        p(device(), g.interleaved(names("Position", "XYZ")));
    const Buffer out(device(), g.pixelCount() * sizeof(float));
    std::vector<uint8_t> bytes(g.pixelCount());
    std::ranges::transform(g.channel("Material.I").pixels, bytes.begin(), [](float id) { return uint8_t(id); });
    const Buffer idBytes(device(), bytes);
    const PelImageDesc position = imageDesc(p, PEL_FORMAT_RGB32F, w, h),
                       id = imageDesc(idBytes, PEL_FORMAT_R8_UINT, w, h);
    screenCurvature(device(), pelScreenCurvatureParamsDefaults(), imageDesc(n, PEL_FORMAT_RGB32F, w, h),
                    &position, nullptr, &id, imageDesc(out, PEL_FORMAT_R32F, w, h));
    return out.readAll<float>();
}

float percentile(std::vector<float> values, double share) {
    const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

void report(const char* what, const std::vector<float>& screen, const std::vector<float>& vertex,
            const std::vector<float>& mask) {
    double error = 0, total = 0, bias = 0, count = 0;
    std::vector<float> ratios, differences;
    for (size_t i = 0; i < mask.size(); ++i) {
        if (mask[i] == 0) continue;
        const double d = screen[i] - vertex[i];
        error += d * d, total += double(vertex[i]) * vertex[i], bias += d, ++count;
        differences.push_back(float(d));
        if (vertex[i] > 1e-4f) ratios.push_back(screen[i] / vertex[i]);
    }
    std::printf("| %s | %.4f | %.0f %% | %+.4f |", what, std::sqrt(total / count),
                100 * std::sqrt(error / total), bias / count);
    for (double share : {0.05, 0.25, 0.5, 0.75, 0.95})
        std::printf(" %+.4f |", percentile(differences, share));
    std::printf(" %.2f |\n", percentile(ratios, 0.5));
}

// What is not background, with a margin.
struct Crop {
    int left, top, width, height;
};

Crop headOf(const std::vector<float>& mask, int width, int height) {
    int left = width, top = height, right = 0, bottom = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (mask[size_t(y) * size_t(width) + size_t(x)] > 0)
                left = std::min(left, x), top = std::min(top, y), right = std::max(right, x + 1),
                bottom = std::max(bottom, y + 1);
    left = std::max(left - 8, 0), top = std::max(top - 8, 0);
    return {left, top, std::min(right + 8, width) - left, (bottom - top) * 9 / 10};  // less of the neck: a smaller file
}

io::Picture tile(const io::Picture& whole, const Crop& c) {
    io::Picture part(c.width, c.height);
    for (int y = 0; y < c.height; ++y)
        std::copy_n(&whole.rgb[3 * (size_t(c.top + y) * size_t(whole.width) + size_t(c.left))], 3 * c.width,
                    &part.rgb[3 * size_t(y) * size_t(c.width)]);
    return io::shrunk(part, 2);
}

void run(const std::string& meshFile, const std::string& folder, const std::string& vertexFile,
         const std::string& screenFile, const std::string& figure) {
    const io::Image g = io::readImage(folder + "/key_gbuffer.exr");
    const std::vector<float>&vertex = g.channel("Curvature.V").pixels, &mask = g.channel("Material.I").pixels;
    const std::vector<float> screen = measuredOnScreen(g, "NormalGeometric");
    const io::MeshData mesh = demo::head(meshFile);
    size_t head = 0, unmeasured = 0;
    for (size_t i = 0; i < mask.size(); ++i)
        if (mask[i] > 0) ++head, unmeasured += screen[i] == 0;
    std::printf("%zu pixels of the head, %zu of them without a value\n\n", head, unmeasured);
    std::printf(
        "| per-vertex quantity | its RMS, 1/mm | RMS difference | mean | 5 %% | 25 %% | median | 75 %% | 95 "
        "%% | median ratio |\n"
        "|---|---|---|---|---|---|---|---|---|---|\n");
    report("`absolute`, 4 passes (the demo's)", screen, vertex, mask);
    const struct {
        const char* name;
        PelCurvatureQuantity quantity;
        uint32_t passes;
    } others[] = {{"`absolute-max`, 4 passes", PEL_QUANTITY_ABSOLUTE_MAX, 4},
                  {"`curvedness`, 4 passes", PEL_QUANTITY_CURVEDNESS, 4},
                  {"`curvedness`, not smoothed", PEL_QUANTITY_CURVEDNESS, 0}};
    for (const auto& [name, quantity, passes] : others)
        report(name, screen, vertexCurvature(mesh, quantity, passes, g.width, g.height), mask);
    report("`absolute`, 4 passes; on screen from the normal map's normals",
           measuredOnScreen(g, "NormalShading"), vertex, mask);
    report("`absolute`, not smoothed, against 4 passes",
           vertexCurvature(mesh, PEL_QUANTITY_ABSOLUTE, 0, g.width, g.height), vertex, mask);

    const std::vector<std::string> rgb = {"R", "G", "B"};
    const std::vector<float> one = io::readImage(vertexFile).interleaved(rgb),
                             two = io::readImage(screenFile).interleaved(rgb);
    double error = 0, total = 0;
    std::vector<float> deltaE(mask.size()), seen;
    for (size_t i = 0; i < mask.size(); ++i) {
        if (mask[i] == 0) continue;
        for (size_t c = 3 * i; c < 3 * i + 3; ++c)
            error += std::pow(one[c] - two[c], 2), total += double(one[c]) * one[c];
        deltaE[i] = float(pellucid::io::deltaE2000(
            pellucid::io::labFromLinear({one[3 * i], one[3 * i + 1], one[3 * i + 2]}),
            pellucid::io::labFromLinear({two[3 * i], two[3 * i + 1], two[3 * i + 2]})));
        seen.push_back(deltaE[i]);
    }
    std::printf(
        "\nshaded: RMS difference %.2f %% of the RMS radiance; CIEDE2000 median %.2f, 95 %% %.2f, 99 %% "
        "%.2f, largest %.1f\n",
        100 * std::sqrt(error / total), percentile(seen, 0.5), percentile(seen, 0.95), percentile(seen, 0.99),
        percentile(seen, 1));

    std::vector<float> onHead, difference(mask.size());
    for (size_t i = 0; i < mask.size(); ++i) {
        difference[i] = screen[i] - vertex[i];
        if (mask[i] > 0) onHead.push_back(vertex[i]);
    }
    const float high = percentile(onHead, 0.98);
    const Crop crop = headOf(mask, g.width, g.height);
    const auto map = [&](const std::vector<float>& values, float from, float to, const char* unit) {
        return io::withColorBar(tile(io::colored(g.width, g.height, values, from, to, mask), crop), from, to,
                                unit, 1);
    };
    const auto shaded = [&](const std::vector<float>& radiance) {
        return tile(io::Picture(g.width, g.height, io::toSrgb8(radiance)), crop);
    };
    const std::vector<io::Tile> tiles = {{"per vertex", map(vertex, 0, high, "1/mm")},
                                         {"on screen", map(screen, 0, high, "1/mm")},
                                         {"on screen - per vertex", map(difference, -high, high, "1/mm")},
                                         {"shaded, per vertex", shaded(one)},
                                         {"shaded, on screen", shaded(two)},
                                         {"their difference", map(deltaE, 0, 5, "CIEDE2000")}};
    const io::Picture sheet = io::contactSheet(tiles, 3, 1);
    io::writeImage8(figure, sheet.width, sheet.height, 3, sheet.rgb);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 6) {
        std::fprintf(stderr, "usage: %s MESH DEMO_FOLDER SHADED_VERTEX.exr SHADED_SCREEN.exr FIGURE.png\n",
                     argv[0]);
        return 2;
    }
    try {
        run(argv[1], argv[2], argv[3], argv[4], argv[5]);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
