// Smoothing to a radius in length units.
#include "mesh_fixture.h"
#include "reference_meshes.h"
#include "tolerances.h"

using namespace fixture;
using reference::AnalyticMesh;
using reference::Tessellation;

namespace {

constexpr PelSmoothingWeights bothWeights[] = {PEL_SMOOTHING_COTANGENT, PEL_SMOOTHING_AREA};

PelCurvatureParams smoothed(float radius, PelCurvatureEstimator estimator = PEL_CURVATURE_QUADRIC,
                            PelSmoothingWeights weights = PEL_SMOOTHING_COTANGENT) {
    return meanParams(estimator, radius, weights);
}

std::vector<float> run(const Mesh& mesh, const PelCurvatureParams& params) {
    return curvature(mesh, topologyDesc(mesh), params).values;
}

// RMS difference over RMS of `expected`.
double rms(const std::vector<float>& a, const std::vector<double>& expected) {
    double difference = 0, total = 0;
    for (size_t i = 0; i < a.size(); ++i) {
        difference += (a[i] - expected[i]) * (a[i] - expected[i]);
        total += expected[i] * expected[i];
    }
    return std::sqrt(difference / total);
}

}  // namespace

TEST(CurvatureDiffusion, BlursACosineByWhatTheHeatEquationSays) {
    // A cylinder whose radius hardly waves along its axis: the mean curvature is 1/2 plus a cosine, and a
    // blur of standard deviation r leaves exp(-r^2 k^2 / 2) of a cosine of wave number k. Whatever the mesh.
    const double k = 2, height = 4 * 3.14159265358979, wave = 1e-3;
    reference::Surface tube = reference::cylinderSurface(1, height);
    for (auto kind : {Tessellation::regular, Tessellation::irregular})
        for (int columns : {60, 120}) {
            AnalyticMesh mesh = tessellate(tube, columns, 2 * columns, kind);
            std::vector<double> phase;
            double lowest = 1e30, highest = -1e30;
            int axis = 0;
            for (int c = 0; c < 3; ++c) {
                // The axis is the coordinate that spans the height.
                double low = 1e30, high = -1e30;
                for (const auto& p : mesh.mesh.positions)
                    low = std::min(low, p[c]), high = std::max(high, p[c]);
                if (high - low > 3) axis = c, lowest = low, highest = high;
            }
            for (auto& p : mesh.mesh.positions) {
                phase.push_back(k * (p[axis] - lowest));
                for (int c = 0; c < 3; ++c)
                    if (c != axis) p[c] *= 1 + wave * std::cos(phase.back());
            }
            ASSERT_GT(highest - lowest, 10);
            const Mesh sampled = pairOf(mesh.mesh).mesh;
            const std::vector<float> before = run(sampled, smoothed(0));
            for (auto [radius, weights] : {std::pair(0.25f, PEL_SMOOTHING_COTANGENT),
                                           {0.5f, PEL_SMOOTHING_COTANGENT},
                                           {0.5f, PEL_SMOOTHING_AREA}}) {
                const std::vector<float> after =
                    run(sampled, smoothed(radius, PEL_CURVATURE_QUADRIC, weights));
                // Amplitudes by least squares, away from the borders.
                const auto amplitude = [&](const std::vector<float>& values) {
                    double n = 0, c = 0, cc = 0, f = 0, fc = 0;
                    for (size_t v = 0; v < phase.size(); ++v) {
                        if (phase[v] < 5 || phase[v] > k * height - 5) continue;
                        const double wave = std::cos(phase[v]);
                        n += 1, c += wave, cc += wave * wave, f += values[v], fc += wave * values[v];
                    }
                    return (n * fc - f * c) / (n * cc - c * c);
                };
                const double expected = std::exp(-0.5 * radius * radius * k * k);
                EXPECT_NEAR(amplitude(after) / amplitude(before), expected,
                            weights == PEL_SMOOTHING_AREA ? tolerance::diffusionAmplitudeArea
                                                          : tolerance::diffusionAmplitude)
                    << columns << " " << int(kind) << " " << radius << " " << int(weights);
            }
        }
}

TEST(CurvatureDiffusion, TwiceTheTrianglesGiveTheSameAnswer) {
    // Vertex (2x, 2y) of the fine mesh is vertex (x, y) of the coarse one.
    const int n = 40;
    const AnalyticMesh coarse = tessellate(reference::torusSurface(3, 1), 2 * n, n, Tessellation::regular);
    const AnalyticMesh fine = tessellate(reference::torusSurface(3, 1), 4 * n, 2 * n, Tessellation::regular);
    // By the tensor estimator, which with exact normals is the same on both to 0.1 %.
    const auto at = [&](const AnalyticMesh& mesh, float radius,
                        PelSmoothingWeights weights = PEL_SMOOTHING_COTANGENT) {
        return run(pairOf(mesh.mesh).mesh, smoothed(radius, PEL_CURVATURE_TENSOR, weights));
    };
    for (auto [radius, weights] : {std::pair(0.2f, PEL_SMOOTHING_COTANGENT),
                                   {0.6f, PEL_SMOOTHING_COTANGENT},
                                   {1.0f, PEL_SMOOTHING_COTANGENT},
                                   {1.0f, PEL_SMOOTHING_AREA}}) {
        const std::vector<float> a = at(coarse, radius, weights), b = at(fine, radius, weights);
        std::vector<double> atCoarse;
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < 2 * n; ++x) atCoarse.push_back(b[size_t(2 * y) * 4 * n + 2 * x]);
        EXPECT_LE(rms(a, atCoarse), tolerance::densityIndependence) << radius << " " << int(weights);
        if (radius < 1) continue;
        EXPECT_GT(rms(at(coarse, 0), atCoarse), 5 * tolerance::densityIndependence)
            << "the radius must do something";
    }
}

TEST(CurvatureDiffusion, TakesNoiseOut) {
    AnalyticMesh torus = tessellate(reference::torusSurface(3, 1), 200, 100, Tessellation::irregular);
    addNoise(torus.mesh, 0.02, 11);
    const Mesh mesh = pairOf(torus.mesh).mesh;
    std::vector<double> truth;
    for (const auto& point : torus.truth) truth.push_back(point.curvature.mean());
    const double raw = rms(run(mesh, smoothed(0)), truth);
    EXPECT_GT(raw, 2 * tolerance::noisyTorus);
    for (auto weights : bothWeights)
        EXPECT_LE(rms(run(mesh, smoothed(0.15f, PEL_CURVATURE_QUADRIC, weights)), truth),
                  tolerance::noisyTorus)
            << int(weights);
}

TEST(CurvatureDiffusion, StaysWithinTheRangeOfItsValues) {
    AnalyticMesh torus =
        tessellate(reference::torusSurface(3, 1), sized(60, 9), sized(30, 7), Tessellation::irregular);
    addNoise(torus.mesh, 0.1, 2);
    const Mesh mesh = pairOf(torus.mesh).mesh;
    const std::vector<float> before = run(mesh, smoothed(0));
    const auto [low, high] = std::minmax_element(before.begin(), before.end());
    for (uint32_t stages : {0u, 1u, 3u, 10u, 100u})
        for (float radius : {0.01f, 0.3f, 5.0f}) {
            PelCurvatureParams params = smoothed(radius);
            params.smoothingStages = stages;
            for (float value : run(mesh, params)) {
                EXPECT_GE(value, *low - tolerance::diffusionRange * std::abs(*low));
                EXPECT_LE(value, *high + tolerance::diffusionRange * std::abs(*high));
            }
        }
}

TEST(CurvatureDiffusion, AreaWeightsKeepEveryValueBetweenItsNeighbours) {
    // Slivers have negative cotangents, which carry a spike beyond the range of all values; areas have none.
    const AnalyticMesh sliced =
        tessellate(reference::cylinderSurface(1, 0.3), sized(40, 14), sized(60, 20), Tessellation::irregular);
    Mesh mesh = pairOf(sliced.mesh).mesh;
    PelCurvatureParams params = smoothed(0.05f, PEL_CURVATURE_EDGE, PEL_SMOOTHING_AREA);
    const std::vector<float> before = run(mesh, smoothed(0, PEL_CURVATURE_EDGE));
    const auto [low, high] = std::minmax_element(before.begin(), before.end());
    const std::vector<float> area = run(mesh, params);
    for (float value : area) {
        EXPECT_GE(value, *low * (1 - tolerance::diffusionRange));
        EXPECT_LE(value, *high * (1 + tolerance::diffusionRange));
    }
    params.smoothingWeights = PEL_SMOOTHING_COTANGENT;
    EXPECT_NE(run(mesh, params), area) << "the choice must do something";
    params.smoothingWeights = PelSmoothingWeights(2);
    EXPECT_THROW(run(mesh, params), pellucid::Error);
}

TEST(CurvatureDiffusion, MeshesTooSmallForTheirAreasStayFinite) {
    for (auto weights : bothWeights)
        for (double size : {1e-9, 1e-11, 1e-13, 1e-16, 1e9, 1e13}) {
            const AnalyticMesh torus =
                tessellate(reference::torusSurface(3 * size, size), 24, 12, Tessellation::irregular);
            for (float value :
                 run(pairOf(torus.mesh).mesh, smoothed(float(size), PEL_CURVATURE_EDGE, weights)))
                ASSERT_TRUE(std::isfinite(value)) << size << ", " << int(weights);
        }
}

TEST(CurvatureDiffusion, KeepsWhatLiesBeyondACrease) {
    // Two planes at a right angle, welded along the fold, curvature of the fold itself: edge-preserving
    // smoothing leaves it where it is, plain smoothing carries it into the planes.
    Mesh mesh;
    const int n = sized(20, 8);
    const double degrees90[2][3] = {{1, 0, 0}, {0, 0, -1}};
    for (int y = 0; y <= n; ++y)
        for (int x = -n; x <= n; ++x) {
            const double* d = degrees90[x > 0];
            for (int c = 0; c < 3; ++c) mesh.positions.push_back(float(0.1 * (x * d[c] + (c == 1 ? y : 0))));
            const float side[3] = {x > 0   ? 1.0f
                                   : x < 0 ? 0.0f
                                           : 0.70710678f,
                                   0,
                                   x > 0   ? 0.0f
                                   : x < 0 ? 1.0f
                                           : 0.70710678f};
            mesh.normals.insert(mesh.normals.end(), side, side + 3);
        }
    const uint32_t row = 2 * n + 1;
    for (uint32_t y = 0; y < uint32_t(n); ++y)
        for (uint32_t x = 0; x + 1 < row; ++x) {
            const uint32_t p = y * row + x;
            mesh.indices.insert(mesh.indices.end(), {p, p + 1, p + row + 1, p, p + row + 1, p + row});
        }
    PelCurvatureParams params = smoothed(0.3f, PEL_CURVATURE_EDGE);
    const uint32_t planeVertex = (n / 2) * row + n + 4, foldVertex = (n / 2) * row + n;
    const std::vector<float> plain = run(mesh, params);
    params.smoothingCrease = 0.2f;
    const std::vector<float> kept = run(mesh, params);
    const std::vector<float> before = run(mesh, smoothed(0, PEL_CURVATURE_EDGE));
    // The edge estimator sees the fold from the vertices beside it too: these are on the planes and do spread
    // there.
    EXPECT_GT(kept[foldVertex], 0.99 * before[foldVertex]);
    EXPECT_LT(plain[foldVertex], 0.7 * before[foldVertex]);
    EXPECT_LT(kept[planeVertex], plain[planeVertex]);
}

TEST(CurvatureDiffusion, SpreadsNoNaNAndNamesWrongParameters) {
    Mesh mesh = pairOf(tessellate(reference::torusSurface(3, 1), sized(40, 20), sized(20, 16),
                                  Tessellation::irregular)
                           .mesh)
                    .mesh;
    mesh.positions[300] = NAN;
    mesh.normals[900] = INFINITY;
    const std::vector<float> values = run(mesh, smoothed(0.5f));
    expectFinite(values);
    EXPECT_EQ(values[100], 0);
    for (float bad : {-1.0f, NAN, INFINITY}) EXPECT_THROW(run(mesh, smoothed(bad)), pellucid::Error);
    EXPECT_THROW(run(mesh, smoothed(1e6f)), pellucid::Error) << "more stages than anybody waits for";
    PelCurvatureParams params = smoothed(0.1f);
    params.smoothingCrease = 4;
    EXPECT_THROW(run(mesh, params), pellucid::Error);
    Mesh points = mesh;
    points.indices.clear();
    for (float value : run(points, smoothed(0.5f))) EXPECT_EQ(value, 0);
}
