// Welding: vertices at one place are one vertex to the topology, results come back per vertex of the caller.
#include "mesh_fixture.h"
#include "tolerances.h"

using namespace fixture;

namespace {

// The same surface with three vertices of its own for every triangle; `first` receives where each came from.
Mesh soup(const Mesh& mesh) {
    Mesh split;
    for (uint32_t index : mesh.indices) {
        split.positions.insert(split.positions.end(), &mesh.positions[3 * index],
                               &mesh.positions[3 * index] + 3);
        split.normals.insert(split.normals.end(), &mesh.normals[3 * index], &mesh.normals[3 * index] + 3);
        split.indices.push_back(uint32_t(split.indices.size()));
    }
    return split;
}

}  // namespace

TEST(Weld, MakesOneMeshOfATriangleSoup) {
    const Mesh mesh = torus(24, 16);
    const Mesh split = soup(mesh);
    const std::vector<float> base = edgeCurvature(mesh, 2).values;
    const Result welded = curvature(split, weldedDesc(split), edgeParams(2));
    EXPECT_EQ(welded.report.uniquePositions, mesh.vertices());
    EXPECT_EQ(welded.report.borderEdges, 0u);
    EXPECT_EQ(welded.report.vertices, split.vertices());
    std::vector<float> expected;
    for (uint32_t index : mesh.indices) expected.push_back(base[index]);
    EXPECT_LE(relativeError(welded.values, expected), tolerance::edgeCurvature);

    const Result loose = edgeCurvature(split, 2);
    EXPECT_EQ(loose.report.uniquePositions, split.vertices());
    EXPECT_EQ(loose.report.borderEdges, loose.report.edges);
    EXPECT_GT(relativeError(loose.values, expected), 0.01) << "unwelded, every triangle is alone";
}

TEST(Weld, NoneAndExactAreTheSameWithoutDuplicates) {
    const Mesh mesh = torus(24, 16);
    EXPECT_EQ(curvature(mesh, weldedDesc(mesh), edgeParams(2)).values, edgeCurvature(mesh, 2).values);
}

TEST(Weld, ToleranceJoinsNearVerticesOnly) {
    const Mesh mesh = torus(24, 16);
    Mesh split = soup(mesh);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> jitter(-1e-4f, 1e-4f);
    for (float& x : split.positions) x += jitter(random);
    EXPECT_GT(curvature(split, weldedDesc(split), edgeParams(0)).report.uniquePositions, mesh.vertices());
    const Result result = curvature(split, weldedDesc(split, 1e-3f), edgeParams(2));
    EXPECT_EQ(result.report.uniquePositions, mesh.vertices());
    EXPECT_EQ(result.report.edges, 3 * mesh.vertices());
    expectFinite(result.values);
    const Result all = curvature(split, weldedDesc(split, 100.0f), edgeParams(2));
    EXPECT_EQ(all.report.uniquePositions, 1u);
    EXPECT_EQ(all.report.degenerateTriangles, split.indices.size() / 3);
    for (float c : all.values) EXPECT_EQ(c, 0);
}

TEST(Weld, MinusZeroIsZeroAndNonFiniteJoinsNothing) {
    Mesh mesh;
    mesh.positions = {0, 1, 0, -0.0f, 1, 0, NAN, 0, 0, NAN, 0, 0, INFINITY, 0, 0, INFINITY, 0, 0};
    mesh.normals.assign(18, 0.577350269f);
    EXPECT_EQ(curvature(mesh, weldedDesc(mesh), edgeParams(0)).report.uniquePositions, 5u);
    EXPECT_EQ(curvature(mesh, weldedDesc(mesh, 0.5f), edgeParams(0)).report.uniquePositions, 5u);
}

TEST(Weld, NormalsOfASplitVertexAreAveraged) {
    // A folded strip: along the fold each side brings its own normal. Welded, both sides see their mean.
    Mesh mesh;
    mesh.positions = {0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, -1};
    mesh.normals = {0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 0, 0};
    mesh.indices = {0, 2, 1, 3, 4, 5};
    const Result result = curvature(mesh, weldedDesc(mesh), edgeParams(0));
    const double dn = 2 * std::sin(3.14159265358979 / 8);  // 45 degrees between side and mean
    EXPECT_NEAR(result.values[2], (dn + dn / std::sqrt(2)) / 2, tolerance::edgeCurvature);
    EXPECT_EQ(result.values[0], result.values[3]);
    EXPECT_EQ(result.values[1], result.values[4]);
}

TEST(Weld, WrongUseIsNamed) {
    const Mesh mesh = torus(4, 4);
    const auto error = [](const PelMeshTopologyDesc& desc) {
        PelMeshTopology topology = nullptr;
        EXPECT_EQ(pelMeshTopologyCreate(device().get(), &desc, &topology, nullptr),
                  PEL_ERROR_INVALID_ARGUMENT);
        return std::string(pelGetErrorMessage());
    };
    PelMeshTopologyDesc desc = weldedDesc(mesh);
    desc.positions = nullptr;
    EXPECT_NE(error(desc).find("positions"), std::string::npos);
    desc = weldedDesc(mesh);
    desc.positionStride = 8;
    EXPECT_NE(error(desc).find("positionStride is 8"), std::string::npos);
    for (float tolerance : {0.0f, -1.0f, NAN, INFINITY}) {
        desc = weldedDesc(mesh);
        desc.weld = PEL_WELD_TOLERANCE;
        desc.weldTolerance = tolerance;
        EXPECT_NE(error(desc).find("weldTolerance"), std::string::npos);
    }
    desc.weld = PelWeld(9);
    EXPECT_NE(error(desc).find("weld is 9"), std::string::npos);
}
