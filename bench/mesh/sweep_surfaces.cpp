// Error of every curvature estimator on every surface whose curvature is known, as rows of
// docs/guide/curvature.md: tessellations of about 20,000 vertices, exact normals; "noisy": the irregular one
// with noise of 2 % of an edge, normals from the mesh, smoothed over three edges, by cotangents and by areas.
// RMS error of mean curvature in percent of the RMS curvedness of the truth (which does not vanish on a
// saddle), away from borders; of a plane times its side. Behind the slash: the border itself and its ring.
// Then two tables of spheres: of any size, and away from the origin.
//   sweep_surfaces [CELLS]   of a grid's side, default 140
#include <pellucid/pellucid.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

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

double meanEdge(const fixture::Mesh& mesh) {
    double sum = 0;
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        double square = 0;
        for (size_t k = 0; k < 3; ++k)
            square += std::pow(
                mesh.positions[3 * mesh.indices[i] + k] - mesh.positions[3 * mesh.indices[i + 1] + k], 2);
        sum += std::sqrt(square);
    }
    return sum / double(mesh.indices.size() / 3);
}

// Vertices within a ring of an edge of one triangle.
std::vector<bool> nearBorder(const fixture::Mesh& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    for (size_t i = 0; i < mesh.indices.size(); ++i) {
        const uint32_t a = mesh.indices[i], b = mesh.indices[i % 3 == 2 ? i - 2 : i + 1];
        ++edges[{std::min(a, b), std::max(a, b)}];
    }
    std::vector<bool> near(mesh.vertices());
    for (const auto& [edge, triangles] : edges)
        if (triangles == 1) near[edge.first] = near[edge.second] = true;
    std::vector<bool> wider = near;
    for (const auto& [edge, triangles] : edges)
        if (near[edge.first] || near[edge.second]) wider[edge.first] = wider[edge.second] = true;
    return wider;
}

struct Sum {
    double error = 0, truth = 0;
    double percent(bool plane) const { return 100 * std::sqrt(error / (plane ? 1 : truth)); }
};

std::vector<float> meanCurvature(const fixture::Mesh& mesh, PelCurvatureEstimator estimator, float radius,
                                 PelSmoothingWeights weights) {
    const uint32_t n = mesh.vertices();
    const MeshTopology topology(device(), fixture::topologyDesc(mesh));
    const Buffer positions(device(), mesh.positions), normals(device(), mesh.normals),
        out(device(), n * sizeof(float));
    topology.curvature(fixture::meanParams(estimator, radius, weights), vertexView(positions, n),
                       vertexView(normals, n), vertexView(out, n));
    return out.readAll<float>();
}

// How a row of the table is smoothed.
enum class Noise { none, byCotangents, byAreas };

void measure(const reference::AnalyticMesh& truth, bool plane, Noise noise, PelCurvatureEstimator estimator) {
    const fixture::Mesh mesh = fixture::pairOf(truth.mesh).mesh;
    const uint32_t n = mesh.vertices();
    const std::vector<float> values =
        meanCurvature(mesh, estimator, noise == Noise::none ? 0.0f : float(3 * meanEdge(mesh)),
                      noise == Noise::byAreas ? PEL_SMOOTHING_AREA : PEL_SMOOTHING_COTANGENT);
    const std::vector<bool> border = nearBorder(mesh);
    Sum sums[2];
    size_t counts[2] = {0, 0};
    for (uint32_t v = 0; v < n; ++v) {
        const reference::PrincipalCurvatures& k = truth.truth[v].curvature;
        Sum& sum = sums[border[v]];
        const double wanted = estimator == PEL_CURVATURE_EDGE ? std::abs(k.mean()) : k.mean();
        sum.error += std::pow(values[v] - wanted, 2);
        sum.truth += (k.first * k.first + k.second * k.second) / 2;
        ++counts[border[v]];
    }
    if (plane)
        for (int i = 0; i < 2; ++i) sums[i].error /= double(std::max<size_t>(counts[i], 1));
    std::printf(" %.2g", sums[0].percent(plane));
    if (counts[1]) std::printf(" / %.2g", sums[1].percent(plane));
    std::printf(" |");
    std::fflush(stdout);
}

constexpr PelCurvatureEstimator estimators[] = {PEL_CURVATURE_EDGE, PEL_CURVATURE_TENSOR,
                                                PEL_CURVATURE_QUADRIC};

// Relative RMS errors of an irregular sphere of that radius, moved by `distance` along all three axes;
// normals are exact.
void measureSphere(double radius, double distance, int cells) {
    reference::AnalyticMesh sphere =
        tessellate(reference::sphereSurface(radius), cells, cells, Tessellation::irregular);
    for (reference::Vec3& p : sphere.mesh.positions) p = p + reference::Vec3{distance, distance, distance};
    const fixture::Mesh mesh = fixture::pairOf(sphere.mesh).mesh;
    const std::vector<bool> border = nearBorder(mesh);
    for (auto estimator : estimators) {
        const std::vector<float> values = meanCurvature(mesh, estimator, 0, PEL_SMOOTHING_COTANGENT);
        double error = 0, count = 0;
        for (size_t v = 0; v < values.size(); ++v)
            if (!border[v]) error += std::pow(values[v] * radius - 1, 2), ++count;
        std::printf(" %.2g |", 100 * std::sqrt(error / count));
    }
    std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
    const int cells = argc > 1 ? std::atoi(argv[1]) : 140;
    const double pi = 3.14159265358979;
    const std::pair<const char*, reference::Surface> surfaces[] = {
        {"plane", reference::planeSurface(1)},          {"sphere", reference::sphereSurface(1)},
        {"cylinder", reference::cylinderSurface(1, 6)}, {"cone", reference::coneSurface(pi / 6, 1, 4)},
        {"torus", reference::torusSurface(3, 1)},       {"ellipsoid", reference::ellipsoidSurface(3, 2, 1.5)},
        {"monkey saddle", reference::monkeySaddle(1)},
    };
    const std::pair<const char*, Tessellation> kinds[] = {{"regular", Tessellation::regular},
                                                          {"irregular", Tessellation::irregular},
                                                          {"valence-varying", Tessellation::valenceVarying},
                                                          {"noisy", Tessellation::irregular},
                                                          {"noisy, by areas", Tessellation::irregular}};
    std::printf("| | | `edge` | `tensor` | `quadric` |\n|---|---|---|---|---|\n");
    for (const auto& [name, surface] : surfaces)
        for (const auto& [kind, tessellation] : kinds) {
            const Noise noise = *kind != 'n' ? Noise::none : kind[5] ? Noise::byAreas : Noise::byCotangents;
            reference::AnalyticMesh mesh = tessellate(surface, cells, cells, tessellation);
            if (noise != Noise::none) addNoise(mesh.mesh, 0.02, 11);
            std::printf("| %s | %s |", name, kind);
            for (auto estimator : estimators) measure(mesh, *name == 'p', noise, estimator);
            std::printf("\n");
        }
    std::printf("\n| radius | `edge` | `tensor` | `quadric` |\n|---|---|---|---|\n");
    for (double radius : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
        std::printf("| %g |", radius);
        measureSphere(radius, 0, cells);
    }
    std::printf(
        "\n| distance of a sphere of radius 1, along each axis | `edge` | `tensor` | `quadric` "
        "|\n|---|---|---|---|\n");
    for (double distance : {0.0, 1.0, 10.0, 100.0, 1000.0}) {
        std::printf("| %g |", distance);
        measureSphere(1, distance, cells);
    }
}
