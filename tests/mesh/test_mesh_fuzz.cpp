// Random connectivity of every kind of brokenness: nothing crashes, nothing is NaN, edge curvature and
// smoothing are still what the oracle says.
#include "mesh_fixture.h"
#include "reference_meshes.h"
#include "tolerances.h"

using namespace fixture;

namespace {

Mesh randomMesh(uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1);
    Mesh mesh;
    const uint32_t vertices = 1 + random() % 40, triangles = random() % 80;
    for (uint32_t v = 0; v < vertices; ++v) {
        const reference::Vec3 n = normalized(reference::Vec3{unit(random), unit(random), unit(random) + 0.1});
        mesh.vertex({unit(random), unit(random), unit(random)}, {float(n.x), float(n.y), float(n.z)});
    }
    // Some seeds make a hub, doubled triangles, or repeated corners.
    for (uint32_t t = 0; t < triangles; ++t) {
        uint32_t c[3] = {uint32_t(random() % vertices), uint32_t(random() % vertices),
                         uint32_t(random() % vertices)};
        if (seed % 3 == 0) c[0] = 0;
        if (seed % 7 == 0 && t % 2 == 1) std::copy(mesh.indices.end() - 3, mesh.indices.end(), c);
        mesh.indices.insert(mesh.indices.end(), c, c + 3);
    }
    return mesh;
}

}  // namespace

TEST(MeshFuzz, EdgeCurvatureEqualsTheOracleOnAnyConnectivity) {
    for (uint32_t seed = 0; seed < 1000; ++seed) {
        const Mesh mesh = randomMesh(seed);
        reference::Mesh exact = exactOf(mesh);
        // Repeated corners are skipped by the library and would be edges of no length to the oracle.
        std::erase_if(exact.triangles,
                      [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
        const uint32_t passes = seed % 4;
        const auto expected = reference::smoothed(exact, reference::edgeCurvature(exact), int(passes));
        const std::vector<float> actual = edgeCurvature(mesh, passes).values;
        ASSERT_EQ(actual.size(), expected.size());
        double largest = 1e-30;
        for (double e : expected) largest = std::max(largest, e);
        for (size_t v = 0; v < actual.size(); ++v)
            ASSERT_NEAR(actual[v], expected[v], tolerance::edgeCurvature * largest)
                << "seed " << seed << ", vertex " << v;
    }
}

TEST(MeshFuzz, EveryEstimatorStaysFiniteOnBrokenData) {
    const float poison[] = {NAN, INFINITY, -INFINITY, 3e38f, 1e-40f, 0.0f};
    for (uint32_t seed = 0; seed < 1000; ++seed) {
        Mesh mesh = randomMesh(seed);
        std::mt19937 random(seed + 12345);
        for (uint32_t faults = random() % 5; faults > 0; --faults) {
            auto& data = random() % 2 ? mesh.positions : mesh.normals;
            data[random() % data.size()] = poison[random() % 6];
        }
        if (seed % 5 == 0 && mesh.vertices() > 2)
            std::copy_n(mesh.positions.begin(), 3, mesh.positions.begin() + 3);
        PelCurvatureParams params = paramsOf(PelCurvatureEstimator(seed % 3), seed % 2,
                                             seed % 3 == 0 ? PEL_QUANTITY_ABSOLUTE : PEL_QUANTITY_FRAME);
        params.smoothingRadius = seed % 4 == 0 ? 0.3f : 0.0f;
        params.smoothingStages = 12;
        params.smoothingWeights = PelSmoothingWeights(seed % 8 == 0);
        PelMeshTopologyDesc desc =
            seed % 2 ? weldedDesc(mesh, seed % 4 == 1 ? 0.2f : 0.0f) : topologyDesc(mesh);
        const std::vector<float> values =
            curvature(mesh, desc, params, params.quantity == PEL_QUANTITY_FRAME ? 8 : 1).values;
        for (float value : values) ASSERT_TRUE(std::isfinite(value)) << "seed " << seed;
    }
}
