// Invariants of any mesh: units, positions, views, relations between quantities, welding. Broken meshes give
// a clear error, or finite values and a count: never a crash, never a NaN that spreads.
#include "kept_sums.h"
#include "mesh_fixture.h"
#include "reference_meshes.h"

using namespace fixture;
using namespace pellucid;

namespace {

PelError topologyError(const PelMeshTopologyDesc& desc) {
    PelMeshTopology topology = nullptr;
    const PelError code = pelMeshTopologyCreate(device().get(), &desc, &topology, nullptr);
    EXPECT_EQ(topology, nullptr);
    return code;
}

// Those within `rings` edges of `vertex`.
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

// Connectivity of every kind of brokenness.
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

TEST(CurvatureProperties, UnitsOfLengthAndPlacesChangeNoBit) {
    // Powers of two, and positions that float holds exactly both near and far.
    Mesh base = irregularTorus(sized(48, 9), sized(32, 7));
    for (float& x : base.positions) x = std::round(x * 4096) / 4096;
    Mesh far = base;
    for (size_t i = 0; i < far.positions.size(); i += 3)
        far.positions[i] += 1024, far.positions[i + 1] -= 2048;
    for (auto estimator : allEstimators) {
        const PelCurvatureParams params = paramsOf(estimator);
        const std::vector<float> expected = valuesOf(base, params);
        EXPECT_EQ(valuesOf(far, params), expected) << estimator;
        for (float unit : {0x1p-20f, 0x1p-7f, 0x1p7f, 0x1p20f}) {
            Mesh mesh = base;
            for (float& x : mesh.positions) x *= unit;
            std::vector<float> values = valuesOf(mesh, params);
            for (float& c : values) c *= unit;
            EXPECT_EQ(values, expected) << "unit " << unit << ", estimator " << estimator;
        }
    }
}

TEST(CurvatureProperties, EdgeIsOneOverTheRadiusOfASphereWhateverTheLengthOfNormals) {
    // Every edge of a sphere is a chord of its normals too.
    for (float length : {1.0f, 1e-30f, 0.5f, 40.0f, 1e30f}) {
        Mesh mesh = latLongSphere(12, 16, 5);
        for (float& x : mesh.normals) x *= length;
        for (uint32_t passes : {0u, 3u}) {
            const Result result = edgeCurvature(mesh, passes);
            for (float value : result.values) EXPECT_NEAR(value, 0.2f, 0.2f * tolerance::edgeCurvature);
            EXPECT_EQ(result.report.nonFiniteNormals, 0u);
        }
    }
}

TEST(CurvatureProperties, ComesOutTheSameBitForBit) {
    const Mesh mesh = irregularTorus(sized(60, 9), sized(40, 7));
    Mesh reordered = mesh;  // the triangles, last one first
    for (size_t t = 0; t < mesh.indices.size(); t += 3)
        std::copy_n(mesh.indices.begin() + long(t), 3, reordered.indices.end() - long(t) - 3);
    for (auto estimator : allEstimators) {
        const std::vector<float> base = valuesOf(mesh, paramsOf(estimator));
        for (int run = 0; run < 3; ++run) EXPECT_EQ(valuesOf(mesh, paramsOf(estimator)), base);
        if (estimator != PEL_CURVATURE_EDGE) continue;
        EXPECT_EQ(valuesOf(reordered, paramsOf(estimator)), base)
            << "the order of the triangles must not show";
    }
}

TEST(CurvatureProperties, ReadsAndWritesStridedViews) {
    const Mesh mesh = torus(16, 12);
    const uint32_t n = mesh.vertices();
    const std::vector<float> base = edgeCurvature(mesh, 2).values;
    // One interleaved buffer: position, result, normal, two floats that nobody may touch.
    std::vector<float> interleaved(9 * n, 7);
    for (uint32_t v = 0; v < n; ++v) {
        std::copy_n(&mesh.positions[3 * v], 3, &interleaved[9 * v]);
        std::copy_n(&mesh.normals[3 * v], 3, &interleaved[9 * v + 4]);
    }
    const Buffer buffer(device(), interleaved);
    const MeshTopology topology(device(), topologyDesc(mesh));
    PelEvent event = nullptr;
    const PelSubmit submit{nullptr, 0, &event};
    topology.curvature(edgeParams(2), vertexView(buffer, n, 0, 36), vertexView(buffer, n, 16, 36),
                       vertexView(buffer, n, 12, 36), nullptr, &submit);
    Event(event).wait();
    for (uint32_t v = 0; v < n; ++v) interleaved[9 * v + 3] = base[v];
    EXPECT_EQ(buffer.readAll<float>(), interleaved);
}

TEST(CurvatureProperties, QuantitiesAreWhatTheyAreOfThePrincipalOnes) {
    const Mesh mesh = irregularTorus(sized(40, 9), sized(30, 7));
    const std::pair<PelCurvatureQuantity, double (*)(double, double)> quantities[] = {
        {PEL_QUANTITY_ABSOLUTE, [](double a, double b) { return std::abs(a + b) / 2; }},
        {PEL_QUANTITY_ABSOLUTE_MAX, [](double a, double b) { return std::max(std::abs(a), std::abs(b)); }},
        {PEL_QUANTITY_CURVEDNESS, [](double a, double b) { return std::sqrt((a * a + b * b) / 2); }},
        {PEL_QUANTITY_MEAN, [](double a, double b) { return (a + b) / 2; }},
        {PEL_QUANTITY_GAUSSIAN, [](double a, double b) { return a * b; }},
        {PEL_QUANTITY_FIRST, [](double a, double) { return a; }},
        {PEL_QUANTITY_SECOND, [](double, double b) { return b; }}};
    for (auto estimator : {PEL_CURVATURE_TENSOR, PEL_CURVATURE_QUADRIC})
        for (uint32_t passes : {0u, 2u}) {
            const auto k = valuesOf(mesh, paramsOf(estimator, passes, PEL_QUANTITY_PRINCIPAL), 2);
            for (size_t v = 0; v < k.size(); v += 2) EXPECT_GE(k[v], k[v + 1]);
            for (const auto& [quantity, of] : quantities) {
                const auto values = valuesOf(mesh, paramsOf(estimator, passes, quantity));
                std::vector<double> expected;
                for (size_t v = 0; v < values.size(); ++v) expected.push_back(of(k[2 * v], k[2 * v + 1]));
                EXPECT_LE(relativeError(values, expected), tolerance::quantity)
                    << quantity << " of " << estimator;
            }
        }
    for (auto quantity : {PelCurvatureQuantity(9), PEL_QUANTITY_GAUSSIAN})
        expectRefused(quantity == PEL_QUANTITY_GAUSSIAN ? "only, not PEL_QUANTITY_GAUSSIAN:" : "quantity",
                      [&] { valuesOf(mesh, paramsOf(PEL_CURVATURE_EDGE, 0, quantity)); });
}

TEST(CurvatureProperties, ScaleMultipliesCurvatureAndGaussianTwice) {
    const Mesh mesh = torus(24, 16);
    for (auto [estimator, quantity, factor] : {std::tuple(PEL_CURVATURE_TENSOR, PEL_QUANTITY_MEAN, 4.0f),
                                               {PEL_CURVATURE_TENSOR, PEL_QUANTITY_GAUSSIAN, 16.0f},
                                               {PEL_CURVATURE_EDGE, PEL_QUANTITY_ABSOLUTE, 4.0f}}) {
        PelCurvatureParams params = paramsOf(estimator, 2, quantity);
        std::vector<float> expected = valuesOf(mesh, params);
        for (float& value : expected) value *= factor;
        params.scale = 4;
        EXPECT_EQ(valuesOf(mesh, params), expected);
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
    const uint32_t v = mesh.vertices();
    for (const auto& p : {std::array{0.f, 0.f, 0.f}, {9, 0, 0}, {0, 9, 0}, {NAN, 0, 0}})
        more.vertex({p[0], p[1], p[2]});
    more.uvs.insert(more.uvs.end(), {0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0, 0});
    more.triangles({v, v + 1, v + 2, v, v, v, v + 1, v + 2, v + 3, 0, v, v + 3});
    EXPECT_EQ(uvScale(more), base);
    std::fill(mesh.uvs.begin(), mesh.uvs.end(), 0.25f);
    expectRefused("both an extent and a UV extent", [&] { uvScale(mesh); });
}

TEST(CurvatureBadInput, FaultsAreCountedAndStayLocal) {
    const Mesh mesh = torus(sized(32, 16), sized(24, 16));
    const uint32_t faulty = sized(300u, 136u);
    struct Fault {
        const char* what;
        void (*put)(float* position, float* normal);
        uint32_t positions, normals, edges;
    };
    const Fault faults[] = {
        {"NaN", [](float* p, float*) { p[1] = NAN; }, 1, 0, 0},
        {"infinity", [](float* p, float*) { p[0] = INFINITY; }, 1, 0, 0},
        {"-infinity", [](float* p, float*) { p[0] = -INFINITY; }, 1, 0, 0},
        {"normal NaN", [](float*, float* n) { n[2] = NAN; }, 0, 1, 0},
        {"normal infinity", [](float*, float* n) { n[1] = INFINITY; }, 0, 1, 0},
        {"normal 0", [](float*, float* n) { std::fill_n(n, 3, 0.0f); }, 0, 1, 0},
        {"an edge of no length", [](float* p, float*) { std::copy_n(p + 3, 3, p); }, 0, 0, 1},
        {"far away", [](float* p, float*) { p[2] = 3e38f; }, 0, 0, 0}};
    for (auto estimator : allEstimators) {
        const PelCurvatureParams params = paramsOf(estimator, 1);
        const std::vector<float> sound = valuesOf(mesh, params);
        // The ring of a pass, and those of an estimate: of the quadric two, and a third where these are few.
        const std::vector<bool> near = within(mesh, faulty, estimator == PEL_CURVATURE_QUADRIC ? 4 : 2);
        for (const Fault& fault : faults) {
            SCOPED_TRACE(std::string(fault.what) + ", estimator " + std::to_string(estimator));
            Mesh broken = mesh;
            fault.put(&broken.positions[3 * faulty], &broken.normals[3 * faulty]);
            const Result result = curvature(broken, topologyDesc(broken), params);
            expectFinite(result.values);
            EXPECT_NE(result.values, sound);
            for (size_t v = 0; v < sound.size(); ++v)
                ASSERT_TRUE(near[v] || result.values[v] == sound[v]) << v;
            EXPECT_EQ(result.report.nonFinitePositions, fault.positions);
            EXPECT_EQ(result.report.nonFiniteNormals, fault.normals);
            EXPECT_EQ(result.report.zeroLengthEdges, fault.edges);
            if (fault.positions + fault.normals) {
                EXPECT_EQ(result.values[faulty], 0);
            }
        }
        for (const float bad : {0.0f, NAN}) {
            Mesh none = mesh;
            std::fill(none.normals.begin(), none.normals.end(), bad);
            EXPECT_EQ(valuesOf(none, params), std::vector<float>(mesh.vertices()));
            none = mesh;
            std::fill(none.positions.begin(), none.positions.end(), bad);
            const Result result = curvature(none, topologyDesc(none), params);
            EXPECT_EQ(result.values, std::vector<float>(mesh.vertices()));
            EXPECT_EQ(result.report.nonFinitePositions, bad == 0 ? 0 : mesh.vertices());
            EXPECT_EQ(result.report.zeroLengthEdges, bad == 0 ? result.report.edges : 0);
        }
    }
}

TEST(CurvatureBadInput, DegenerateTrianglesAndUnreferencedVertices) {
    const Mesh mesh = torus(24, 16);
    Mesh more = mesh;
    more.vertex({0, 0, 9}), more.vertex({NAN, 0, 0});
    more.triangles({5, 5, 6, 7, 8, 7, 9, 9, 9});
    const Result result = edgeCurvature(more, 2);
    EXPECT_EQ(result.report.unreferencedVertices, 2u);
    EXPECT_EQ(result.report.degenerateTriangles, 3u);
    EXPECT_EQ(result.report.triangles, more.indices.size() / 3);
    std::vector<float> expected = edgeCurvature(mesh, 2).values;
    expected.resize(more.vertices());  // zeros
    EXPECT_EQ(result.values, expected);
}

TEST(CurvatureBadInput, NonManifoldEdgesAndBowTies) {
    // Three triangles on one edge, and two that meet in a vertex only.
    Mesh mesh;
    mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, -1, 0, 0, -1, 1, 0};
    mesh.normals = {0, 0, 1, 0.6f, 0, 0.8f, 0, 0.6f, 0.8f, 0, -0.6f, 0.8f, 0, 1, 0, -0.6f, 0, 0.8f, -1, 0, 0};
    mesh.indices = {0, 1, 2, 1, 0, 3, 0, 1, 4, 0, 5, 6};
    const PelMeshReport report = edgeCurvature(mesh, 2).report;  // MeshFuzz compares the values
    EXPECT_EQ(report.nonManifoldEdges, 1u);
    EXPECT_EQ(report.edges, 10u);
    EXPECT_EQ(report.borderEdges, 9u);
}

TEST(CurvatureBadInput, EmptyMeshes) {
    PelMeshReport report = pelMeshReportDefaults();
    const MeshTopology topology(device(), pelMeshTopologyDescDefaults(), &report);
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
    EXPECT_EQ(result.values, std::vector<float>(16));
}

TEST(CurvatureBadInput, WrongTopologiesAreNamed) {
    Mesh mesh = torus(4, 4);
    const auto refused = [&](std::initializer_list<const char*> words, auto change) {
        PelMeshTopologyDesc desc = weldedDesc(mesh);
        change(desc);
        expectRefused(words, [&] { return topologyError(desc); });
    };
    refused({"positions"}, [](auto& d) { d.positions = nullptr; });
    refused({"positionStride is 8"}, [](auto& d) { d.positionStride = 8; });
    for (float tolerance : {0.0f, -1.0f, NAN, INFINITY})
        refused({"weldTolerance"},
                [&](auto& d) { d.weld = PEL_WELD_TOLERANCE, d.weldTolerance = tolerance; });
    refused({"weld is 9"}, [](auto& d) { d.weld = PelWeld(9); });
    refused({"indices is NULL"}, [](auto& d) { d.indices = nullptr, d.numIndices = 3; });
    // More than 2^31 bytes of indices, counted right.
    refused({"4294967298"}, [](auto& d) { d.indices = nullptr, d.numIndices = (1ull << 32) + 2; });
    refused({"95", "2 are left over"}, [](auto& d) { d.numIndices = 95; });
    mesh.indices[3 * 5 + 2] = 16;
    refused({"triangle 5", "16 vertices"}, [](auto&) {});
}

TEST(CurvatureBadInput, WrongViewsAndParametersAreNamed) {
    const Mesh mesh = torus(4, 4);
    const MeshTopology topology(device(), topologyDesc(mesh));
    const Buffer data(device(), mesh.positions), out(device(), 16 * 4);
    const PelVertexView good = vertexView(data, 16), result = vertexView(out, 16);
    const auto refused = [&](const char* word, PelVertexView p, PelVertexView n, PelVertexView c,
                             PelCurvatureParams params = edgeParams(0)) {
        expectRefused(
            word, [&] { return pelMeshCurvature(topology.get(), &params, &p, &n, &c, nullptr, nullptr); });
    };
    refused("15 vertices", vertexView(data, 15), good, result);
    refused("normals", good, vertexView(data, 16, 12), result);
    refused("stride 8", vertexView(data, 16, 0, 8), good, result);
    refused("multiples of 4", vertexView(data, 16, 2), good, result);
    refused("PelBuffer", good, good, PelVertexView{nullptr, 0, 0, 16});
    PelCurvatureParams params = edgeParams(0);
    params.scale = NAN;
    refused("scale", good, good, result, params);
    refused("smoothingPasses", good, good, result, edgeParams(2000000000));
    refused("77", good, good, result, paramsOf(PelCurvatureEstimator(77)));
    const Buffer elsewhere(Device(""), mesh.positions);
    refused("another device", vertexView(elsewhere, 16), good, result);
}

TEST(Weld, MakesOneMeshOfATriangleSoup) {
    const Mesh mesh = torus(24, 16), split = soupOf(mesh);
    const std::vector<float> base = edgeCurvature(mesh, 2).values;
    EXPECT_EQ(curvature(mesh, weldedDesc(mesh), edgeParams(2)).values, base) << "nothing to weld";
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

TEST(Weld, ToleranceJoinsNearVerticesOnly) {
    const Mesh mesh = torus(24, 16);
    Mesh split = soupOf(mesh);
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
    EXPECT_EQ(all.values, std::vector<float>(split.vertices()));
}

TEST(Weld, MinusZeroIsZeroAndNonFiniteJoinsNothing) {
    Mesh mesh;
    mesh.positions = {0, 1, 0, -0.0f, 1, 0, NAN, 0, 0, NAN, 0, 0, INFINITY, 0, 0, INFINITY, 0, 0};
    mesh.normals.assign(18, 0.577350269f);
    for (float tolerance : {0.0f, 0.5f})
        EXPECT_EQ(curvature(mesh, weldedDesc(mesh, tolerance), edgeParams(0)).report.uniquePositions, 5u);
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

// Smooth meshes that were shaken, with parameters at random.
TEST(MeshKept, CurvatureIsTheKeptOne) {
    KeptSums kept("curvature.dat");
    constexpr PelCurvatureQuantity quantities[] = {
        PEL_QUANTITY_ABSOLUTE, PEL_QUANTITY_ABSOLUTE_MAX, PEL_QUANTITY_CURVEDNESS, PEL_QUANTITY_MEAN,
        PEL_QUANTITY_GAUSSIAN, PEL_QUANTITY_FIRST,        PEL_QUANTITY_SECOND};
    for (uint32_t index = 0; index < 24; ++index) {
        Draw draw(index);
        Mesh mesh = index % 2 ? torus(20, 12) : latLongSphere(14, 24, 2);
        if (draw.oneOf(3)) mesh.append(grid(9, 7), 5);
        if (draw.oneOf(4)) mesh = soupOf(mesh);
        const float shake = draw.in(0, 0.05f);
        for (float& p : mesh.positions) p += draw.in(-shake, shake);
        const PelCurvatureEstimator estimator = allEstimators[index % 3];
        PelCurvatureParams params =
            paramsOf(estimator, draw.below(4),
                     estimator == PEL_CURVATURE_EDGE ? PEL_QUANTITY_ABSOLUTE : quantities[draw.below(7)]);
        params.scale = draw.in(0.5f, 2);
        if (draw.oneOf(2)) {
            params.smoothingRadius = draw.in(0.1f, 1);
            params.smoothingCrease = draw.oneOf(2) ? draw.in(0.3f, 2) : 0;
            params.smoothingStages = draw.oneOf(2) ? 6 + draw.below(9) : 0;
            params.smoothingWeights = PelSmoothingWeights(draw.below(2));
        }
        const pellucid::MeshTopology topology(
            device(), draw.oneOf(3) ? weldedDesc(mesh, draw.in(0.001f, 0.2f)) : topologyDesc(mesh));
        kept.expect(OnDevice(mesh).curvature(topology, params, draw.oneOf(3)), tolerance::keptCurvature,
                    "mesh " + std::to_string(index));
    }
}
