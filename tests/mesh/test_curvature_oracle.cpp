// Edge and tensor estimator, smoothing, normals and UV scale against the double-precision oracle, over
// surfaces and kinds of meshes, and against FaceWorks' values of real ones.
#include "mesh_fixture.h"
#include "reference_meshes.h"

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
            for (bool noisy : {false, true}) {
                const std::string name = std::string(surfaceName) + ", " + kindName;
                reference::Mesh mesh = tessellate(surface, sized(24, 9), sized(17, 7), kind).mesh;
                if (noisy) addNoise(mesh, 0.02, 3);
                all.emplace_back(noisy ? "noisy " + name : name, pairOf(mesh));
            }
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

// Around its vertices, a walk from triangle to triangle returns, but not to its starting edge.
TEST(CurvatureOracle, OneTriangleBesideTwoThatLieOnEachOther) {
    Mesh mesh;
    mesh.positions = {0, 0, 0, 1, 0, 0.1f, 1, 1, 0.3f, 0, 1, 0.2f};
    mesh.normals = {0, 0, 1, 0.6f, 0, 0.8f, 0, 0.6f, 0.8f, -0.6f, 0, 0.8f};
    mesh.indices = {0, 1, 2, 0, 2, 3, 0, 3, 2};
    for (int first = 0; first < 3; ++first) {
        EXPECT_LE(relativeError(edgeCurvature(mesh, 0).values, reference::edgeCurvature(exactOf(mesh))),
                  tolerance::edgeCurvature);
        std::rotate(mesh.indices.begin(), mesh.indices.begin() + 3, mesh.indices.end());
    }
}

TEST(CurvatureOracle, Tensor) {
    for (const auto& [name, pair] : someMeshes()) {
        if (name.find("plane") != std::string::npos) continue;
        std::vector<double> expected;
        for (const auto& c : reference::tensorCurvature(pair.exact))
            expected.insert(expected.end(), {c.first, c.second});
        EXPECT_LE(
            relativeError(valuesOf(pair.mesh, paramsOf(PEL_CURVATURE_TENSOR, 0, PEL_QUANTITY_PRINCIPAL), 2),
                          expected),
            tolerance::tensorCurvature)
            << name;
    }
}

TEST(CurvatureOracle, NormalsAndUvScale) {
    for (const auto& [name, pair] : someMeshes()) {
        std::vector<double> expected;
        for (const auto& n : reference::estimatedNormals(pair.exact))
            expected.insert(expected.end(), {n.x, n.y, n.z});
        EXPECT_LE(relativeError(normalsOf(pair.mesh), expected), tolerance::normalComponent) << name;
        if (pair.mesh.uvs.empty()) continue;
        EXPECT_NEAR(uvScale(pair.mesh) / reference::uvScale(pair.exact), 1, tolerance::uvScale) << name;
    }
}

// FaceWorks' values are infinite where an edge has no length; ours are finite there, also after smoothing, so
// only finite values are compared.
TEST(CurvatureOracle, RealMeshes) {
    REQUIRE_ORACLE_DIRECTORY(directory);
    for (const std::string name : {"head", "sphere1cm"}) {
        const Mesh mesh = oracleMesh(directory, name);
        const reference::Mesh exact = exactOf(mesh);
        const auto file = [&](const std::string& what) {
            return directory / ("mesh_" + name + what + "_f32.npy");
        };
        for (uint32_t passes : {0u, 1u, 2u, 8u}) {
            SCOPED_TRACE(name + ", " + std::to_string(passes) + " passes");
            const std::vector<float> ours = edgeCurvature(mesh, passes).values;
            EXPECT_LE(
                relativeError(ours, reference::smoothed(exact, reference::edgeCurvature(exact), int(passes))),
                tolerance::edgeCurvature);
            if (passes % 2 || passes > 2) continue;
            const auto theirs = npy::read<float>(file("_fwcurv" + std::to_string(passes))).data;
            ASSERT_EQ(ours.size(), theirs.size());
            std::vector<float> a, b;
            for (size_t i = 0; i < ours.size(); ++i)
                if (std::isfinite(theirs[i]) && theirs[i] < 1e30f)
                    a.push_back(ours[i]), b.push_back(theirs[i]);
            EXPECT_GT(a.size() * 100, ours.size() * 99);
            EXPECT_LE(relativeError(a, b), tolerance::edgeCurvature);
        }
        const float theirs = npy::read<float>(file("_fwuvscale")).data[0];
        EXPECT_NEAR(uvScale(mesh) / theirs, 1, tolerance::edgeCurvature);
        EXPECT_NEAR(reference::uvScale(exact) / theirs, 1, tolerance::faceWorksUvScale);
    }
}
