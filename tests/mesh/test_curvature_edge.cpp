// The edge estimator and its smoothing: against other people's values and against what must hold for any
// mesh.
#include "mesh_fixture.h"
#include "tolerances.h"

using namespace fixture;

namespace {

// Other people's values are infinite where an edge has no length; ours are finite there and in what smoothing
// made of them, so that only the finite ones compare.
void expectTheirs(const Mesh& mesh, const std::filesystem::path& file, uint32_t passes) {
    const std::vector<float> theirs = npy::read<float>(file).data;
    const std::vector<float> ours = edgeCurvature(mesh, passes).values;
    ASSERT_EQ(ours.size(), theirs.size());
    std::vector<float> a, b;
    for (size_t i = 0; i < ours.size(); ++i)
        if (std::isfinite(theirs[i]) && theirs[i] < 1e30f) a.push_back(ours[i]), b.push_back(theirs[i]);
    EXPECT_GT(a.size() * 100, ours.size() * 99);
    EXPECT_LE(relativeError(a, b), tolerance::edgeCurvature) << file;
}

}  // namespace

TEST(CurvatureEdge, EqualsTheFaceWorksValuesOfRealMeshes) {
    REQUIRE_ORACLE_DIRECTORY(directory);
    for (const char* name : {"head", "sphere1cm"}) {
        const Mesh mesh = oracleMesh(directory, name);
        for (uint32_t passes : {0u, 2u}) {
            const std::string file =
                std::string("mesh_") + name + "_fwcurv" + std::to_string(passes) + "_f32.npy";
            expectTheirs(mesh, directory / file, passes);
        }
    }
}

TEST(CurvatureEdge, IsOneOverTheRadiusOfASphere) {
    // Every edge of a sphere is a chord of its normals too.
    Mesh mesh = torus(24, 16);
    for (size_t v = 0; v < mesh.normals.size(); ++v) mesh.positions[v] = 5 * mesh.normals[v];
    for (uint32_t passes : {0u, 3u})
        for (float value : edgeCurvature(mesh, passes).values)
            EXPECT_NEAR(value, 0.2f, 0.2f * tolerance::edgeCurvature);
}

TEST(CurvatureEdge, ScalesInverselyAndIgnoresRotation) {
    const Mesh mesh = torus(40, 24);
    const std::vector<float> base = edgeCurvature(mesh, 2).values;
    Mesh scaled = mesh, turned = mesh;
    for (float& x : scaled.positions) x *= 1024;
    std::vector<float> expected = base;
    for (float& c : expected) c /= 1024;
    EXPECT_EQ(edgeCurvature(scaled, 2).values, expected) << "a power of two changes no bit but the exponent";
    const float c = 0.6f, s = 0.8f;  // a Pythagorean rotation about z
    for (auto* data : {&turned.positions, &turned.normals})
        for (size_t v = 0; v < data->size(); v += 3) {
            const float x = (*data)[v], y = (*data)[v + 1];
            (*data)[v] = c * x - s * y;
            (*data)[v + 1] = s * x + c * y;
        }
    EXPECT_LE(relativeError(edgeCurvature(turned, 2).values, base), tolerance::edgeCurvature);
    const auto twice = curvature(mesh, topologyDesc(mesh), edgeParams(2, 2.0f)).values;
    for (size_t i = 0; i < base.size(); ++i) EXPECT_EQ(twice[i], 2 * base[i]);
}

TEST(CurvatureEdge, FollowsAPermutationOfTheVertices) {
    const Mesh mesh = torus(40, 24);
    const std::vector<float> base = edgeCurvature(mesh, 2).values;
    const Shuffled shuffled = shuffleVertices(mesh, 7);
    const std::vector<float> back = shuffled.inOldOrder(edgeCurvature(shuffled.mesh, 2).values);
    EXPECT_LE(relativeError(back, base), tolerance::edgeCurvature);
}

TEST(CurvatureEdge, ComesOutTheSameBitForBit) {
    const Mesh mesh = torus(sized(64, 12), sized(48, 10));
    const std::vector<float> base = edgeCurvature(mesh, 3).values;
    Mesh reordered = mesh;  // the triangles, last one first
    for (size_t t = 0; t < mesh.indices.size(); t += 3)
        std::copy_n(mesh.indices.begin() + long(t), 3, reordered.indices.end() - long(t) - 3);
    for (int run = 0; run < 3; ++run) EXPECT_EQ(edgeCurvature(mesh, 3).values, base);
    EXPECT_EQ(edgeCurvature(reordered, 3).values, base) << "the order of the triangles must not show";
}

TEST(CurvatureEdge, SmoothingCountsInteriorEdgesTwiceAndBorderEdgesOnce) {
    // A square of two triangles, the curvatures of whose vertices are known by hand. Normals are not of unit
    // length on purpose to within the tolerance, positions are.
    Mesh mesh;
    mesh.positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    mesh.normals = {0, 0, 1, 0.6f, 0, 0.8f, 0, 0.6f, 0.8f, 0, 0, 1};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    const std::vector<float> c = edgeCurvature(mesh, 0).values, s = edgeCurvature(mesh, 1).values;
    const double k01 = std::sqrt(0.36 + 0.04), k12 = std::sqrt(0.72), k02 = std::sqrt(0.4 / 2);
    EXPECT_NEAR(c[0], (0 + k01) / 2, tolerance::edgeCurvature);
    EXPECT_NEAR(c[1], (k01 + k12) / 2, tolerance::edgeCurvature);
    EXPECT_NEAR(c[2], (k02 + k12) / 2, tolerance::edgeCurvature);
    EXPECT_NEAR(c[3], (0 + k01) / 2, tolerance::edgeCurvature);
    EXPECT_NEAR(s[0], (c[1] + 2 * c[2] + c[3]) / 4, tolerance::edgeCurvature);
    EXPECT_NEAR(s[1], (c[0] + c[2]) / 2, tolerance::edgeCurvature);
    EXPECT_NEAR(s[2], (c[1] + 2 * c[0] + c[3]) / 4, tolerance::edgeCurvature);
    EXPECT_NEAR(s[3], (c[0] + c[2]) / 2, tolerance::edgeCurvature);
}

TEST(CurvatureEdge, ReadsAndWritesStridedViews) {
    using namespace pellucid;
    const Mesh mesh = torus(16, 12);
    const uint32_t n = mesh.vertices();
    const std::vector<float> base = edgeCurvature(mesh, 2).values;
    // One interleaved buffer: position, result, normal, two floats that nobody may touch.
    std::vector<float> interleaved;
    for (uint32_t v = 0; v < n; ++v) {
        interleaved.insert(interleaved.end(), &mesh.positions[3 * v], &mesh.positions[3 * v] + 3);
        interleaved.push_back(-1);
        interleaved.insert(interleaved.end(), &mesh.normals[3 * v], &mesh.normals[3 * v] + 3);
        interleaved.insert(interleaved.end(), {7, 8});
    }
    const Buffer buffer(device(), interleaved);
    const MeshTopology topology(device(), topologyDesc(mesh));
    Event done;
    PelEvent event = nullptr;
    const PelSubmit submit{nullptr, 0, &event};
    topology.curvature(edgeParams(2), vertexView(buffer, n, 0, 36), vertexView(buffer, n, 16, 36),
                       vertexView(buffer, n, 12, 36), nullptr, &submit);
    Event(event).wait();
    const std::vector<float> after = buffer.readAll<float>();
    for (uint32_t v = 0; v < n; ++v) {
        EXPECT_EQ(after[9 * v + 3], base[v]);
        for (int k : {0, 1, 2, 4, 5, 6, 7, 8}) EXPECT_EQ(after[9 * v + k], interleaved[9 * v + k]);
    }
}

TEST(UvScale, EqualsTheFaceWorksValuesOfRealMeshes) {
    REQUIRE_ORACLE_DIRECTORY(directory);
    for (const char* name : {"head", "sphere1cm"}) {
        const float theirs =
            npy::read<float>(directory / (std::string("mesh_") + name + "_fwuvscale_f32.npy")).data[0];
        EXPECT_NEAR(uvScale(oracleMesh(directory, name)) / theirs, 1, tolerance::edgeCurvature) << name;
    }
}

TEST(UvScale, MultipliesWithTheMeshAndSkipsWhatHasNoExtent) {
    Mesh mesh = torus(24, 16);
    const float base = uvScale(mesh);
    EXPECT_EQ(uvScale(mesh), base);
    for (float factor : {0x1p-20f, 0x1p20f}) {
        Mesh scaled = mesh;
        for (float& x : scaled.positions) x *= factor;
        EXPECT_EQ(uvScale(scaled), base * factor) << "not degenerate, only in another unit";
    }
    // A triangle without UV extent, one without extent, one with a NaN: none of them counts.
    Mesh more = mesh;
    more.positions.insert(more.positions.end(), {0, 0, 0, 9, 0, 0, 0, 9, 0, NAN, 0, 0});
    more.uvs.insert(more.uvs.end(), {0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0, 0});
    more.normals.resize(more.positions.size(), 1.0f);
    const uint32_t v = mesh.vertices();
    more.indices.insert(more.indices.end(), {v, v + 1, v + 2, v, v, v, v + 1, v + 2, v + 3, 0, v, v + 3});
    EXPECT_EQ(uvScale(more), base);
    Mesh flat = mesh;
    std::fill(flat.uvs.begin(), flat.uvs.end(), 0.25f);
    EXPECT_THROW(uvScale(flat), pellucid::Error);
}
