// Smoothing to a radius against what the heat equation says: the heat kernel of the plane, harmonics of the
// sphere, the conservation of the sum of values.
#include <algorithm>
#include <random>

#include "mesh_fixture.h"
#include "reference/scattered.h"
#include "reference_meshes.h"
#include "tolerances.h"

using namespace fixture;

namespace {

constexpr PelSmoothingWeights bothWeights[] = {PEL_SMOOTHING_COTANGENT, PEL_SMOOTHING_AREA};

std::vector<float> run(const Mesh& mesh, float radius, PelSmoothingWeights weights) {
    return curvature(mesh, topologyDesc(mesh), meanParams(PEL_CURVATURE_EDGE, radius, weights)).values;
}

// A lattice of the plane, one unit between vertices; `slant` 0: squares cut along one diagonal, 0.5:
// equilateral triangles.
Mesh lattice(int half, double slant) {
    Mesh mesh;
    const double height = slant > 0 ? std::sqrt(0.75) : 1;
    const int side = 2 * half + 1;
    for (int y = -half; y <= half; ++y)
        for (int x = -half; x <= half; ++x) {
            const double shift = slant > 0 && (y & 1) ? 0.5 : 0;
            mesh.positions.insert(mesh.positions.end(), {float(x + shift), float(y * height), 0.0f});
            mesh.normals.insert(mesh.normals.end(), {0, 0, 1});
        }
    for (int y = 0; y + 1 < side; ++y)
        for (int x = 0; x + 1 < side; ++x) {
            const uint32_t a = uint32_t(y * side + x), b = a + 1, c = a + uint32_t(side), d = c + 1;
            if (slant > 0 && ((y - half) & 1))
                mesh.indices.insert(mesh.indices.end(), {a, b, d, a, d, c});
            else if (slant > 0)
                mesh.indices.insert(mesh.indices.end(), {a, b, c, b, d, c});
            else
                mesh.indices.insert(mesh.indices.end(), {a, b, d, a, d, c});
        }
    return mesh;
}

// A third of the areas of its triangles for each vertex.
std::vector<double> areasOf(const Mesh& mesh) {
    std::vector<double> areas(mesh.vertices());
    const auto at = [&](uint32_t v) {
        return reference::Vec3{mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]};
    };
    for (size_t t = 0; t < mesh.indices.size(); t += 3) {
        const uint32_t* v = &mesh.indices[t];
        const double area = length(cross(at(v[1]) - at(v[0]), at(v[2]) - at(v[0]))) / 2;
        for (int c = 0; c < 3; ++c) areas[v[c]] += area / 3;
    }
    return areas;
}

// What `mesh`, tilted at vertex `source` alone, becomes, over what the heat kernel makes of the values
// before: the largest difference in parts of the peak, and the peak's ratio.
std::pair<double, double> spread(Mesh mesh, uint32_t source, double radius, PelSmoothingWeights weights) {
    mesh.normals[3 * source] = 0.01f;
    const std::vector<float> before = run(mesh, 0, weights), after = run(mesh, float(radius), weights);
    const std::vector<double> areas = areasOf(mesh);
    const double pi = 3.14159265358979;
    double worst = 0, peak = 0, found = 0;
    for (uint32_t v = 0; v < mesh.vertices(); ++v) {
        double expected = 0;
        for (uint32_t s = 0; s < mesh.vertices(); ++s) {
            if (before[s] == 0) continue;
            const double dx = mesh.positions[3 * v] - mesh.positions[3 * s],
                         dy = mesh.positions[3 * v + 1] - mesh.positions[3 * s + 1];
            expected += before[s] * areas[s] * std::exp(-(dx * dx + dy * dy) / (2 * radius * radius)) /
                        (2 * pi * radius * radius);
        }
        worst = std::max(worst, std::abs(after[v] - expected));
        peak = std::max(peak, expected), found = std::max(found, double(after[v]));
    }
    return {worst / peak, found / peak};
}

}  // namespace

TEST(CurvatureHeat, APointSpreadsAsTheHeatKernelOfThePlane) {
    for (double slant : {0.0, 0.5})
        for (int radius : {2, 4, 8, 16})
            for (auto weights : bothWeights) {
                const int half = std::max(24, 4 * radius);
                const auto [worst, peak] =
                    spread(lattice(half, slant), uint32_t(half * (2 * half + 1) + half), radius, weights);
                EXPECT_LE(worst, tolerance::heatKernel)
                    << slant << ", radius " << radius << ", weights " << int(weights) << ", peak " << peak;
            }
}

TEST(CurvatureHeat, IrregularLatticesSpreadAsFarAsRegularOnes) {
    // Vertices moved within the plane by up to `jitter` of an edge; the variance that a point has gained,
    // along both axes.
    for (float jitter : {0.2f, 0.3f, 0.4f})
        for (auto weights : bothWeights) {
            const int half = 32;
            const float radius = 7;
            Mesh mesh = lattice(half, 0.5);
            std::mt19937 random(5);
            std::uniform_real_distribution<float> move(-jitter, jitter);
            for (size_t i = 0; i < mesh.positions.size(); ++i)
                if (i % 3 < 2) mesh.positions[i] += move(random);
            mesh.normals[3 * size_t(half * (2 * half + 1) + half)] = 0.01f;
            const std::vector<double> areas = areasOf(mesh);
            const auto variance = [&](float r) {
                const std::vector<float> values = run(mesh, r, weights);
                std::array<double, 5> sums{};  // 1, x, x^2, y, y^2
                for (size_t v = 0; v < values.size(); ++v) {
                    const double m = areas[v] * values[v], x = mesh.positions[3 * v],
                                 y = mesh.positions[3 * v + 1];
                    sums[0] += m, sums[1] += m * x, sums[2] += m * x * x, sums[3] += m * y,
                        sums[4] += m * y * y;
                }
                const double x = sums[1] / sums[0], y = sums[3] / sums[0];
                return std::pair(sums[2] / sums[0] - x * x, sums[4] / sums[0] - y * y);
            };
            const auto before = variance(0), after = variance(radius);
            for (double gained : {after.first - before.first, after.second - before.second})
                EXPECT_NEAR(std::sqrt(gained) / radius, 1, tolerance::heatSpread)
                    << jitter << " " << int(weights);
        }
}

TEST(CurvatureHeat, AreaWeightsKeepMass) {
    // Of values that are anything, on triangles that are anything.
    const auto flat = reference::delaunay(reference::uniformPoints(4000, 7));
    reference::Mesh exact = lifted(flat, reference::ellipsoidCap(1, 1.5, 2)).mesh;
    addNoise(exact, 0.1, 3);
    const Mesh mesh = pairOf(exact).mesh;
    const std::vector<double> areas = areasOf(mesh);
    const auto total = [&](const std::vector<float>& values) {
        double sum = 0;
        for (size_t v = 0; v < values.size(); ++v) sum += areas[v] * values[v];
        return sum;
    };
    const double before = total(run(mesh, 0, PEL_SMOOTHING_AREA));
    for (float radius : {0.02f, 0.1f, 0.4f})
        EXPECT_NEAR(total(run(mesh, radius, PEL_SMOOTHING_AREA)) / before, 1, tolerance::heatMass) << radius;
}

TEST(CurvatureHeat, HarmonicsOfASphereDecay) {
    // Normals turned by amounts that are a harmonic about the axis would not be one of their sizes; so the
    // sphere's own radius waves: its mean curvature is 1 plus a multiple of P8, of which exp(-l (l + 1) r^2 /
    // 2) is left.
    const double wave = 1e-3, radius = 0.3, left = std::exp(-8 * 9 * radius * radius / 2);
    for (int splits : {4, 5})
        for (auto weights : bothWeights) {
            reference::AnalyticMesh sphere = reference::icosphere(1, 1, 1, splits);
            std::vector<double> harmonic;
            for (auto& p : sphere.mesh.positions) {
                harmonic.push_back(std::legendre(8, std::clamp(p.z, -1.0, 1.0)));
                p = (1 + wave * harmonic.back()) * p;
            }
            const Mesh mesh = pairOf(sphere.mesh).mesh;
            const auto amplitude = [&](float r) {
                const auto values =
                    curvature(mesh, topologyDesc(mesh), meanParams(PEL_CURVATURE_QUADRIC, r, weights)).values;
                double sum = 0, squares = 0;
                for (size_t v = 0; v < values.size(); ++v)
                    sum += (values[v] - 1) * harmonic[v], squares += harmonic[v] * harmonic[v];
                return sum / squares;
            };
            EXPECT_NEAR(amplitude(float(radius)) / amplitude(0) / left, 1, tolerance::heatHarmonic)
                << int(weights) << ", " << splits;
        }
}
