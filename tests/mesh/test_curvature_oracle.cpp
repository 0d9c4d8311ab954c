// Curvature, smoothing and UV scale against the double-precision oracle, over surfaces and kinds of meshes.
#include "mesh_fixture.h"
#include "reference_meshes.h"
#include "tolerances.h"

using namespace fixture;

namespace {

std::vector<std::pair<std::string, Pair>> someMeshes() {
    using namespace reference;
    const std::pair<const char*, Surface> surfaces[] = {
        {"sphere", sphereSurface(5)},  {"cylinder", cylinderSurface(2, 6)},
        {"torus", torusSurface(3, 1)}, {"cone", coneSurface(0.5, 1, 4)},
        {"saddle", monkeySaddle(2)},   {"ellipsoid", ellipsoidSurface(1, 2, 3)},
        {"plane", planeSurface(4)},
    };
    const std::pair<const char*, Tessellation> kinds[] = {{"regular", Tessellation::regular},
                                                          {"irregular", Tessellation::irregular},
                                                          {"valence", Tessellation::valenceVarying}};
    std::vector<std::pair<std::string, Pair>> all;
    for (const auto& [surfaceName, surface] : surfaces)
        for (const auto& [kindName, kind] : kinds)
            all.emplace_back(std::string(surfaceName) + ", " + kindName,
                             pairOf(tessellate(surface, sized(24, 9), sized(17, 7), kind).mesh));
    AnalyticMesh noisy = tessellate(torusSurface(3, 1), sized(40, 11), sized(20, 8), Tessellation::irregular);
    addNoise(noisy.mesh, 0.02, 5);
    all.emplace_back("noisy torus", pairOf(noisy.mesh));
    all.emplace_back("icosphere", pairOf(icosphere(1, 1, 1, sized(3, 1)).mesh));
    return all;
}

}  // namespace

TEST(CurvatureOracle, EdgeAndSmoothingFromNoneToEightPasses) {
    for (const auto& [name, pair] : someMeshes())
        for (uint32_t passes : {0u, 1u, 2u, 5u, 8u}) {
            const auto expected =
                reference::smoothed(pair.exact, reference::edgeCurvature(pair.exact), int(passes));
            const std::vector<float> actual = edgeCurvature(pair.mesh, passes).values;
            if (name.starts_with("plane"))
                EXPECT_EQ(actual, std::vector<float>(expected.size())) << name;
            else
                EXPECT_LE(relativeError(actual, expected), tolerance::edgeCurvature)
                    << name << ", " << passes;
        }
}

TEST(CurvatureOracle, RealMeshes) {
    REQUIRE_ORACLE_DIRECTORY(directory);
    const Mesh head = oracleMesh(directory, "head");
    reference::Mesh exact;
    for (uint32_t v = 0; v < head.vertices(); ++v) {
        const float *p = &head.positions[3 * v], *n = &head.normals[3 * v];
        exact.positions.push_back({p[0], p[1], p[2]});
        exact.normals.push_back({n[0], n[1], n[2]});
    }
    for (size_t t = 0; t < head.indices.size(); t += 3)
        exact.triangles.push_back({int(head.indices[t]), int(head.indices[t + 1]), int(head.indices[t + 2])});
    for (uint32_t passes : {0u, 1u, 2u, 8u}) {
        const auto expected = reference::smoothed(exact, reference::edgeCurvature(exact), int(passes));
        EXPECT_LE(relativeError(edgeCurvature(head, passes).values, expected), tolerance::edgeCurvature)
            << passes;
    }
}

TEST(CurvatureOracle, UvScale) {
    for (const auto& [name, pair] : someMeshes()) {
        if (pair.mesh.uvs.empty()) continue;
        EXPECT_NEAR(uvScale(pair.mesh) / reference::uvScale(pair.exact), 1, tolerance::uvScale) << name;
    }
}
