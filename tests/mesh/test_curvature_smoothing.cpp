// Smoothing to a radius against the oracle's flow, and against what the heat equation says: the heat kernel
// of the plane.
#include "mesh_fixture.h"
#include "reference_meshes.h"

using namespace fixture;

namespace {

constexpr PelSmoothingWeights bothWeights[] = {PEL_SMOOTHING_COTANGENT, PEL_SMOOTHING_AREA};

PelCurvatureParams smoothed(double radius, PelSmoothingWeights weights = PEL_SMOOTHING_COTANGENT) {
    return meanParams(PEL_CURVATURE_EDGE, float(radius), weights);
}

// Smooths a grid, tilted only at its middle, whose vertices have an area of 1 each, and compares with the
// heat kernel applied to its values: the largest difference as a share of the peak.
double spread(uint32_t half, double radius, PelSmoothingWeights weights) {
    Mesh mesh = grid(2 * half, 2 * half);
    mesh.normals[3 * size_t(half * (2 * half + 1) + half)] = 0.01f;
    const auto before = valuesOf(mesh, smoothed(0)), after = valuesOf(mesh, smoothed(radius, weights));
    double worst = 0, peak = 0;
    for (uint32_t v = 0; v < mesh.vertices(); ++v) {
        double expected = 0;
        for (uint32_t s = 0; s < mesh.vertices(); ++s) {
            if (before[s] == 0) continue;
            const double dx = mesh.positions[3 * v] - mesh.positions[3 * s],
                         dy = mesh.positions[3 * v + 1] - mesh.positions[3 * s + 1], square = radius * radius;
            expected +=
                before[s] * std::exp(-(dx * dx + dy * dy) / (2 * square)) / (2 * std::numbers::pi * square);
        }
        worst = std::max(worst, std::abs(after[v] - expected)), peak = std::max(peak, expected);
    }
    return worst / peak;
}

}  // namespace

TEST(CurvatureSmoothing, EqualsTheOraclesFlow) {
    const std::pair<reference::Surface, double> surfaces[] = {// and about the length of an edge
                                                              {reference::torusSurface(3, 1), 0.4},
                                                              {reference::monkeySaddle(2), 0.1},
                                                              {reference::cylinderSurface(1, 0.3), 0.02}};
    for (const auto& [surface, edge] : surfaces)
        for (auto [noise, doubled] : {std::pair(0.0, false), {0.05, false}, {0.05, true}}) {
            reference::Mesh mesh =
                tessellate(surface, sized(40, 14), sized(30, 12), reference::Tessellation::irregular).mesh;
            if (noise > 0) addNoise(mesh, noise, 2);
            for (size_t t = mesh.triangles.size(); doubled && t-- > 0;)  // edges of three and four triangles
                if (t % 7 == 0) mesh.triangles.push_back(mesh.triangles[t]);
            const Pair pair = pairOf(mesh);
            for (auto weights : bothWeights)
                for (auto [edges, stages, crease] :
                     {std::tuple(0.5, 4, 0.0), {2.0, 16, 0.0}, {2.0, 16, 0.3}, {6.0, 64, 0.0}}) {
                    PelCurvatureParams params = smoothed(edges * edge, weights);
                    params.smoothingStages = uint32_t(stages);
                    params.smoothingCrease = float(crease);
                    std::vector<double> expected =
                        reference::smoothedToRadius(pair.exact, reference::edgeCurvature(pair.exact),
                                                    {params.smoothingRadius, params.smoothingCrease, stages,
                                                     weights == PEL_SMOOTHING_AREA});
                    for (double& v : expected) v = std::abs(v);  // slivers carry values below 0
                    EXPECT_LE(relativeError(valuesOf(pair.mesh, params), expected),
                              tolerance::radiusSmoothing)
                        << "edge " << edge << ", noise " << noise << ", doubled " << doubled << ", weights "
                        << weights << ", " << edges << " edges, crease " << crease;
                }
        }
}

// Rates grow as sizes shrink, so what a larger pose measured would hardly smooth a smaller one.
TEST(CurvatureSmoothing, PosesOfOtherSizesOnOneTopologyAreMeasuredAnew) {
    const Mesh mesh = irregularTorus(sized(60, 30), sized(30, 16));
    for (const auto weights : bothWeights) {
        const pellucid::MeshTopology kept(device(), topologyDesc(mesh));
        for (const float scale : {1.0f, 0.1f, 0.5f, 20.0f}) {
            Mesh pose = mesh;
            for (float& x : pose.positions) x *= scale;
            const PelCurvatureParams params = smoothed(0.3 * scale, weights);
            const std::vector<float> anew = valuesOf(pose, params);
            EXPECT_EQ(OnDevice(pose).curvature(kept, params), anew) << "scale " << scale;
            // An update of all vertices measures too, one of a part does not.
            const pellucid::MeshTopology topology(device(), topologyDesc(mesh));
            const pellucid::LiveMesh live(topology, params);
            const OnDevice before(mesh), after(pose);
            const PelVertexView normals = before.normalsAt();  // both have these
            live.update(before.at(), &normals, before.result());
            live.update(after.at(), &normals, after.result());
            EXPECT_EQ(after.out.readAll<float>(), anew) << "live, scale " << scale;
            live.update(after.at(), &normals, after.result(), {{7, 3}});
            EXPECT_EQ(after.out.readAll<float>(), anew) << "live, a part, scale " << scale;
        }
    }
}

TEST(CurvatureSmoothing, StaysWithinTheRangeOfItsValues) {
    reference::Mesh noisy = tessellate(reference::torusSurface(3, 1), sized(60, 9), sized(30, 7),
                                       reference::Tessellation::irregular)
                                .mesh;
    addNoise(noisy, 0.1, 2);
    const Mesh mesh = pairOf(noisy).mesh;
    const std::vector<float> before = valuesOf(mesh, smoothed(0));
    const auto [low, high] = std::minmax_element(before.begin(), before.end());
    for (uint32_t stages : {0u, 1u, 3u, 10u, 100u})
        for (float radius : {0.01f, 0.3f, 5.0f}) {
            PelCurvatureParams params = smoothed(radius, PEL_SMOOTHING_AREA);
            params.smoothingStages = stages;
            for (float value : valuesOf(mesh, params)) {
                EXPECT_GE(value, *low * (1 - tolerance::diffusionRange));
                EXPECT_LE(value, *high * (1 + tolerance::diffusionRange));
            }
        }
}

TEST(CurvatureSmoothing, MeshesTooSmallForTheirAreasStayFinite) {
    for (auto weights : bothWeights)
        for (double size : {1e-9, 1e-11, 1e-13, 1e-16, 1e9, 1e13})
            expectFinite(
                valuesOf(sampled(reference::torusSurface(3 * size, size), 24, 12), smoothed(size, weights)));
}

// As of a part of a larger vertex buffer.
TEST(CurvatureSmoothing, VerticesInNoTriangleChangeNothing) {
    const Mesh mesh = irregularTorus(sized(40, 20), sized(20, 16));
    for (auto weights : bothWeights)
        for (const size_t times : {3, 200}) {
            Mesh more = mesh;
            more.positions.resize(times * mesh.positions.size());
            more.normals.resize(times * mesh.normals.size());
            std::vector<float> values = valuesOf(more, smoothed(0.5, weights));
            values.resize(mesh.vertices());
            EXPECT_EQ(values, valuesOf(mesh, smoothed(0.5, weights))) << times;
        }
}

TEST(CurvatureSmoothing, SpreadsNoNaNAndNamesWrongParameters) {
    Mesh mesh = irregularTorus(sized(40, 20), sized(20, 16));
    mesh.positions[300] = NAN;
    mesh.normals[900] = INFINITY;
    const std::vector<float> values = valuesOf(mesh, smoothed(0.5));
    expectFinite(values);
    EXPECT_EQ(values[100], 0);
    PelCurvatureParams crease = smoothed(0.1);
    crease.smoothingCrease = 4;
    for (const PelCurvatureParams& wrong : {smoothed(-1), smoothed(NAN), smoothed(INFINITY), crease,
                                            smoothed(1e6),  // more stages than anybody waits for
                                            smoothed(0.1, PelSmoothingWeights(2))})
        expectRefused("smoothing", [&] { valuesOf(mesh, wrong); });
    mesh.indices.clear();
    for (float value : valuesOf(mesh, smoothed(0.5))) EXPECT_EQ(value, 0);
}

TEST(CurvatureHeat, APointSpreadsAsTheHeatKernelOfThePlane) {
    for (uint32_t radius : {2u, 4u, 8u})
        for (auto weights : bothWeights) {
            EXPECT_LE(spread(std::max(24u, 4 * radius), radius, weights), tolerance::heatKernel)
                << "radius " << radius << ", weights " << int(weights);
        }
}
