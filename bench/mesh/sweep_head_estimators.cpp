// Makes docs/figures/curvature_estimators.png: the demo's head by each estimator on one scale, with a colour bar, and what
// edge and tensor differ from quadric by on another. Prints the RMS values and differences.
//   sweep_head_estimators FIGURE.png [MESH]    MESH: default data/heads/head_female.obj
#include <pellucid/pellucid.hpp>

#include <cmath>
#include <cstdio>

#include "demo_files.h"
#include "head/curvature_view.h"
#include "io/image/image_file.h"

using namespace pellucid;

namespace {

constexpr int viewWidth = 240, viewHeight = 280;
constexpr float high = 0.25f;  // 1/mm: sharper than a radius of 4 mm are the rims of lids, lips and teeth only

io::Picture seen(const io::MeshData& mesh, const std::vector<float>& values, float low, float high) {
    const sample::Scene scene(
        sample::MeshView{mesh.positions, mesh.normals, mesh.uvs, values, mesh.triangles, {}});
    sample::Framing framing;
    framing.azimuth = 20;
    framing.fill = 1.15;  // the box is deeper than the head is wide
    return head::curvatureView(scene, {{0, 1, 0}, {0, 0, 1}}, framing, viewWidth, viewHeight, 3, low, high);
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
    io::Picture bars(viewWidth, viewHeight, head::viewBackground);
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
