// Makes docs/figures/curvature_estimators.png: the demo's head by each estimator on one scale, with a colour bar, and what
// edge and tensor differ from quadric by on another. Prints the RMS values and differences.
//   sweep_head_estimators FIGURE.png [MESH]    MESH: default data/heads/head_female.obj
#include <pellucid/pellucid.hpp>

#include <cmath>
#include <cstdio>

#include "demo_files.h"
#include "io/image/image_file.h"
#include "io/image/picture.h"
#include "sample/gbuffer.h"

using namespace pellucid;

namespace {

constexpr int viewWidth = 240, viewHeight = 280, supersampling = 3;
constexpr float high = 0.25f;  // 1/mm: sharper than a radius of 4 mm are the rims of lids, lips and teeth only
constexpr io::Srgb8 background{20, 20, 20};

// Darkened where the surface turns away, so that its shape can be read.
io::Picture seen(const io::MeshData& mesh, const std::vector<float>& values, float low, float high) {
    const int width = viewWidth * supersampling, height = viewHeight * supersampling;
    const sample::Scene scene(
        sample::MeshView{mesh.positions, mesh.normals, mesh.uvs, values, mesh.triangles, {}});
    sample::Framing framing;
    framing.azimuth = 20;
    framing.fill = 1.15;  // the box is deeper than the head is wide
    const sample::Camera camera =
        frameHead(scene.bounds(), {{0, 1, 0}, {0, 0, 1}}, framing, double(width) / height);
    sample::GBufferOptions options;
    options.detail.enabled = false;
    const sample::GBuffer g = renderGBuffer(scene, camera, width, height, options);
    io::Picture picture = io::colored(width, height, g.curvature.data, low, high, g.coverage.data, background);
    const sample::Vec3 toEye = camera.forward() * -1.0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (g.coverage.at(0, x, y) == 0) continue;
            const sample::Vec3 n{g.geometricNormal.at(0, x, y), g.geometricNormal.at(1, x, y),
                                 g.geometricNormal.at(2, x, y)};
            const float facing = float(0.55 + 0.45 * std::abs(dot(n, toEye)));
            uint8_t* rgb = &picture.rgb[3 * (size_t(y) * size_t(width) + size_t(x))];
            for (int c = 0; c < 3; ++c)
                rgb[c] =
                    uint8_t(255.0f * io::encodeSrgb(facing * io::decodeSrgb(float(rgb[c]) / 255.0f)) + 0.5f);
        }
    return io::shrunk(picture, supersampling);
}

void run(const std::string& figure, const std::string& meshFile) {
    const io::MeshData mesh = demo::head(meshFile);
    const Device device("");
    const char* names[] = {"edge", "tensor", "quadric"};
    std::vector<float> values[3];
    for (int e = 0; e < 3; ++e) {
        PelCurvatureParams params = pelCurvatureParamsDefaults();
        params.estimator = PelCurvatureEstimator(e);
        values[e] = demo::curvature(device, mesh, params);
    }
    std::vector<io::Tile> above, below;
    for (int e = 0; e < 3; ++e) {
        std::vector<float> difference(values[e]);
        double square = 0, away = 0;
        for (size_t v = 0; v < difference.size(); ++v) {
            difference[v] -= values[2][v];
            square += double(values[e][v]) * values[e][v], away += double(difference[v]) * difference[v];
        }
        const double n = double(difference.size());
        std::printf("%-8s RMS %.4f 1/mm, from quadric %.4f\n", names[e], std::sqrt(square / n),
                    std::sqrt(away / n));
        above.push_back({names[e], seen(mesh, values[e], 0, high)});
        if (e < 2)
            below.push_back({std::string(names[e]) + " - quadric", seen(mesh, difference, -high, high)});
    }
    // In the last place of the second row: both scales.
    io::Picture bars(viewWidth, viewHeight, background);
    bars.write(10, 70, "upper row", {200, 200, 200});
    bars.paste(0, 84, io::colorBar(viewWidth - 6, 0, high, "1/mm", 1));
    bars.write(10, 170, "differences", {200, 200, 200});
    bars.paste(0, 184, io::colorBar(viewWidth - 6, -high, high, "1/mm", 1));
    above.insert(above.end(), below.begin(), below.end());
    above.push_back({"", bars});
    const io::Picture sheet = io::contactSheet(above, 3);
    io::writeImage8(figure, sheet.width, sheet.height, 3, sheet.rgb);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: %s FIGURE.png [MESH]\n", argv[0]);
        return 2;
    }
    try {
        run(argv[1], argc > 2 ? argv[2] : demo::meshFile());
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
