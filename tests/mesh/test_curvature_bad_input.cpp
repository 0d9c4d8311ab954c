// Meshes that are broken: a clear error, or finite values and a count. Never a crash, never a NaN that
// spreads.

#include "mesh_fixture.h"
#include "tolerances.h"

using namespace fixture;

namespace {

std::string topologyError(const PelMeshTopologyDesc& desc) {
    PelMeshTopology topology = nullptr;
    EXPECT_EQ(pelMeshTopologyCreate(device().get(), &desc, &topology, nullptr), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(topology, nullptr);
    return pelGetErrorMessage();
}

bool contains(const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
}

// Vertices whose value differs from that of the sound mesh, beyond those within `rings` edges of the faulty
// one: a fault has spread to them.
std::vector<bool> within(const Mesh& mesh, uint32_t vertex, uint32_t rings) {
    std::vector<bool> inside(mesh.vertices());
    inside[vertex] = true;
    for (uint32_t r = 0; r < rings; ++r) {
        std::vector<bool> next = inside;
        for (size_t t = 0; t < mesh.indices.size(); t += 3)
            for (int c = 0; c < 3; ++c)
                if (inside[mesh.indices[t + c]])
                    for (int o = 0; o < 3; ++o) next[mesh.indices[t + o]] = true;
        inside = next;
    }
    return inside;
}

void expectLocalFault(const Mesh& sound, const Mesh& broken, uint32_t vertex, const char* what) {
    const uint32_t passes = 3;
    const std::vector<float> before = edgeCurvature(sound, passes).values;
    const Result after = edgeCurvature(broken, passes);
    expectFinite(after.values);
    const std::vector<bool> near = within(sound, vertex, passes + 1);
    for (size_t v = 0; v < before.size(); ++v) {
        if (near[v]) continue;
        EXPECT_EQ(after.values[v], before[v]) << what << ", vertex " << v;
    }
}

}  // namespace

TEST(CurvatureBadInput, NonFinitePositionsAndNormalsAreCountedAndStayLocal) {
    const Mesh mesh = torus(24, 16);
    for (float bad : {NAN, INFINITY, -INFINITY}) {
        Mesh position = mesh, normal = mesh;
        position.positions[3 * 100 + 1] = bad;
        normal.normals[3 * 100 + 2] = bad;
        expectLocalFault(mesh, position, 100, "position");
        expectLocalFault(mesh, normal, 100, "normal");
        const Result p = edgeCurvature(position, 2), n = edgeCurvature(normal, 2);
        EXPECT_EQ(p.report.nonFinitePositions, 1u);
        EXPECT_EQ(p.report.nonFiniteNormals, 0u);
        EXPECT_EQ(n.report.nonFinitePositions, 0u);
        EXPECT_EQ(n.report.nonFiniteNormals, 1u);
        EXPECT_EQ(p.values[100], 0);
        EXPECT_EQ(n.values[100], 0);
    }
    Mesh all = mesh;
    std::fill(all.positions.begin(), all.positions.end(), NAN);
    const Result result = edgeCurvature(all, 2);
    EXPECT_EQ(result.report.nonFinitePositions, mesh.vertices());
    for (float c : result.values) EXPECT_EQ(c, 0);
}

TEST(CurvatureBadInput, ZeroAndUnnormalisedNormals) {
    const Mesh mesh = torus(24, 16);
    Mesh zero = mesh;
    std::fill_n(zero.normals.begin() + 300, 3, 0.0f);
    expectLocalFault(mesh, zero, 100, "zero normal");
    EXPECT_EQ(edgeCurvature(zero, 0).report.nonFiniteNormals, 1u);
    const std::vector<float> base = edgeCurvature(mesh, 2).values;
    for (float length : {1e-30f, 0.5f, 40.0f, 1e30f}) {
        Mesh longer = mesh;
        for (float& x : longer.normals) x *= length;
        const Result result = edgeCurvature(longer, 2);
        EXPECT_LE(relativeError(result.values, base), tolerance::edgeCurvature) << length;
        EXPECT_EQ(result.report.nonFiniteNormals, 0u);
    }
}

TEST(CurvatureBadInput, ZeroLengthEdgesAreSkippedAndCounted) {
    Mesh mesh = torus(24, 16);
    std::copy_n(mesh.positions.begin() + 3 * 101, 3, mesh.positions.begin() + 3 * 100);
    const Result result = edgeCurvature(mesh, 2);
    expectFinite(result.values);
    EXPECT_EQ(result.report.zeroLengthEdges, 1u);
    EXPECT_GT(result.values[100], 0);
    for (float& x : mesh.positions) x = 4;
    const Result point = edgeCurvature(mesh, 2);
    EXPECT_EQ(point.report.zeroLengthEdges, point.report.edges);
    for (float c : point.values) EXPECT_EQ(c, 0);
}

TEST(CurvatureBadInput, DegenerateTrianglesAndUnreferencedVertices) {
    const Mesh mesh = torus(24, 16);
    Mesh more = mesh;
    const uint32_t v = mesh.vertices();
    more.positions.insert(more.positions.end(), {0, 0, 9, NAN, 0, 0});
    more.normals.insert(more.normals.end(), {0, 0, 1, 0, 0, 1});
    more.indices.insert(more.indices.end(), {5, 5, 6, 7, 8, 7, 9, 9, 9});
    const Result result = edgeCurvature(more, 2);
    EXPECT_EQ(result.report.unreferencedVertices, 2u);
    EXPECT_EQ(result.report.degenerateTriangles, 3u);
    EXPECT_EQ(result.report.triangles, more.indices.size() / 3);
    std::vector<float> expected = edgeCurvature(mesh, 2).values;
    expected.resize(v + 2);  // zeros
    EXPECT_EQ(result.values, expected);
}

TEST(CurvatureBadInput, NonManifoldEdgesAndBowTies) {
    // Three triangles on one edge, and two that meet in a vertex only.
    Mesh mesh;
    mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, -1, 0, 0, -1, 1, 0};
    mesh.normals = {0, 0, 1, 0.6f, 0, 0.8f, 0, 0.6f, 0.8f, 0, -0.6f, 0.8f, 0, 1, 0, -0.6f, 0, 0.8f, -1, 0, 0};
    mesh.indices = {0, 1, 2, 1, 0, 3, 0, 1, 4, 0, 5, 6};
    const Result result = edgeCurvature(mesh, 2);
    expectFinite(result.values);
    EXPECT_EQ(result.report.nonManifoldEdges, 1u);
    EXPECT_EQ(result.report.edges, 10u);
    EXPECT_EQ(result.report.borderEdges, 9u);
    // Vertex 4: once each of 0 and 1. Vertex 1: three times 0, once each of 2, 3 and 4.
    const std::vector<float> c = edgeCurvature(mesh, 0).values, s = edgeCurvature(mesh, 1).values;
    EXPECT_NEAR(s[4], (c[0] + c[1]) / 2, tolerance::edgeCurvature);
    EXPECT_NEAR(s[1], (3 * c[0] + c[2] + c[3] + c[4]) / 6, tolerance::edgeCurvature);
    // Two, four and five triangles on one edge, by repeating one.
    for (uint32_t copies : {2u, 4u, 5u}) {
        Mesh fan = mesh;
        fan.indices = {0, 1, 2};
        for (uint32_t i = 1; i < copies; ++i) fan.indices.insert(fan.indices.end(), {0, 1, 2});
        const std::vector<float> f = edgeCurvature(fan, 1).values, f0 = edgeCurvature(fan, 0).values;
        EXPECT_NEAR(f[0], (f0[1] + f0[2]) / 2, tolerance::edgeCurvature) << copies;
    }
}

TEST(CurvatureBadInput, EmptyMeshes) {
    using namespace pellucid;
    const PelMeshTopologyDesc none = pelMeshTopologyDescDefaults();
    PelMeshReport report = pelMeshReportDefaults();
    const MeshTopology topology(device(), none, &report);
    EXPECT_EQ(report.vertices, 0u);
    const PelVertexView view{};
    EXPECT_EQ(pelMeshCurvature(topology.get(), nullptr, &view, &view, &view, &report, nullptr),
              PEL_ERROR_INVALID_ARGUMENT);
    topology.curvature(edgeParams(2), view, view, view, &report);
    float scale = 5;
    EXPECT_EQ(pelMeshUvScale(topology.get(), &view, &view, &scale), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(scale, 5);

    Mesh points = torus(4, 4);
    points.indices.clear();
    const Result result = edgeCurvature(points, 2);
    EXPECT_EQ(result.report.unreferencedVertices, 16u);
    for (float c : result.values) EXPECT_EQ(c, 0);
}

TEST(CurvatureBadInput, WrongIndicesAreNamed) {
    Mesh mesh = torus(4, 4);
    mesh.indices[3 * 5 + 2] = 16;
    const std::string outOfRange = topologyError(topologyDesc(mesh));
    EXPECT_TRUE(contains(outOfRange, "triangle 5") && contains(outOfRange, "16 vertices")) << outOfRange;
    mesh = torus(4, 4);
    mesh.indices.pop_back();
    const std::string odd = topologyError(topologyDesc(mesh));
    EXPECT_TRUE(contains(odd, "95") && contains(odd, "2 are left over")) << odd;
    PelMeshTopologyDesc desc = topologyDesc(mesh);
    desc.indices = nullptr;
    desc.numIndices = 3;
    EXPECT_TRUE(contains(topologyError(desc), "indices is NULL"));
    // More than 2^31 bytes of indices, counted right: the first wrong index is found beyond what 32 bits
    // count.
    desc.numIndices = (1ull << 32) + 2;
    EXPECT_TRUE(contains(topologyError(desc), "4294967298")) << pelGetErrorMessage();
}

TEST(CurvatureBadInput, WrongViewsAndParametersAreNamed) {
    using namespace pellucid;
    const Mesh mesh = torus(4, 4);
    const MeshTopology topology(device(), topologyDesc(mesh));
    const Buffer data(device(), mesh.positions), out(device(), 16 * 4);
    const auto error = [&](PelVertexView p, PelVertexView n, PelVertexView c, PelCurvatureParams params) {
        EXPECT_EQ(pelMeshCurvature(topology.get(), &params, &p, &n, &c, nullptr, nullptr),
                  PEL_ERROR_INVALID_ARGUMENT);
        return std::string(pelGetErrorMessage());
    };
    const PelVertexView good = vertexView(data, 16), result = vertexView(out, 16);
    EXPECT_TRUE(contains(error(vertexView(data, 15), good, result, edgeParams(0)), "15 vertices"));
    EXPECT_TRUE(contains(error(good, vertexView(data, 16, 12), result, edgeParams(0)), "normals"));
    EXPECT_TRUE(contains(error(vertexView(data, 16, 0, 8), good, result, edgeParams(0)), "stride 8"));
    EXPECT_TRUE(contains(error(vertexView(data, 16, 2), good, result, edgeParams(0)), "multiples of 4"));
    EXPECT_TRUE(contains(error(good, good, PelVertexView{nullptr, 0, 0, 16}, edgeParams(0)), "PelBuffer"));
    PelCurvatureParams params = edgeParams(0);
    params.scale = NAN;
    EXPECT_TRUE(contains(error(good, good, result, params), "scale"));
    params = edgeParams(2000000000);
    EXPECT_TRUE(contains(error(good, good, result, params), "smoothingPasses"));
    params = edgeParams(0);
    params.estimator = PelCurvatureEstimator(77);
    EXPECT_TRUE(contains(error(good, good, result, params), "77"));
    const Device other("");
    const Buffer elsewhere(other, mesh.positions);
    EXPECT_TRUE(contains(error(vertexView(elsewhere, 16), good, result, edgeParams(0)), "another device"));
}
