// What matters to a mesh: the error of each estimator and smoothing against the time it takes, on tori of
// rising size (radii 3 and 1), regular and irregular, with exact normals, with normals from the mesh, and
// with noise of 2 % of the edges. One JSON line per case on stdout; bench/plot curvature draws them.
//   sweep_curvature [LARGEST]   vertices, default 200000
#include <pellucid/pellucid.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "mesh/mesh_calls.h"
#include "mesh/reference_meshes.h"
#include "reference/surfaces.h"

using namespace pellucid;
using reference::Tessellation;

namespace {

const Device& device() {
    static const Device device("");
    return device;
}

struct Smoothing {
    const char* name;
    uint32_t passes;
    double edges;  // radius in mean edge lengths
};

// RMS error of mean curvature over the RMS of the truth.
double errorOf(const std::vector<float>& values, const reference::AnalyticMesh& truth) {
    double error = 0, total = 0;
    for (size_t v = 0; v < values.size(); ++v) {
        const double mean = truth.truth[v].curvature.mean();
        error += std::pow(values[v] - mean, 2);
        total += mean * mean;
    }
    return std::sqrt(error / total);
}

void measure(const reference::AnalyticMesh& truth, const fixture::Mesh& mesh, const char* kind,
             const char* normals, PelCurvatureEstimator estimator, const Smoothing& smoothing, double edge) {
    const uint32_t n = mesh.vertices();
    const MeshTopology topology(device(), fixture::topologyDesc(mesh));
    const Buffer positions(device(), mesh.positions), given(device(), mesh.normals),
        out(device(), n * sizeof(float));
    PelCurvatureParams params = fixture::meanParams(estimator, float(smoothing.edges * edge));
    params.smoothingPasses = smoothing.passes;
    double best = 1e30;
    for (int run = 0; run < 6; ++run) {
        const auto start = std::chrono::steady_clock::now();
        topology.curvature(params, vertexView(positions, n), vertexView(given, n), vertexView(out, n));
        const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
        if (run > 0) best = std::min(best, took.count());  // the first one builds and measures
    }
    static constexpr const char* names[] = {"edge", "tensor", "quadric"};
    std::printf(
        "{\"mesh\": \"%s\", \"normals\": \"%s\", \"vertices\": %u, \"estimator\": \"%s\", \"smoothing\": "
        "\"%s\", "
        "\"error\": %.6g, \"ms\": %.4g}\n",
        kind, normals, n, names[estimator], smoothing.name, errorOf(out.readAll<float>(), truth), best);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    const double largest = argc > 1 ? std::atof(argv[1]) : 200000;
    const double pi = 3.14159265358979;
    for (double vertices = 2000; vertices <= largest * 1.01; vertices *= std::sqrt(10.0)) {
        const int side = int(std::lround(std::sqrt(vertices / 2)));
        const double edge = std::sqrt(4 * pi * pi * 3 / (2.0 * side * side));
        for (auto [kind, name] :
             {std::pair(Tessellation::regular, "regular"), {Tessellation::irregular, "irregular"}})
            for (const char* normals : {"exact", "made", "noisy"}) {
                reference::AnalyticMesh torus = tessellate(reference::torusSurface(3, 1), 2 * side, side, kind);
                if (*normals == 'm') torus.mesh.normals = reference::estimatedNormals(torus.mesh);
                if (*normals == 'n') addNoise(torus.mesh, 0.02, 11);
                const fixture::Mesh mesh = fixture::pairOf(torus.mesh).mesh;
                for (auto estimator : {PEL_CURVATURE_EDGE, PEL_CURVATURE_TENSOR, PEL_CURVATURE_QUADRIC})
                    for (const Smoothing& s :
                         {Smoothing{"none", 0, 0}, {"2 passes", 2, 0}, {"8 passes", 8, 0}, {"3 edges", 0, 3}})
                        measure(torus, mesh, name, normals, estimator, s, edge);
            }
    }
}
