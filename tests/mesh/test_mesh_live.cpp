// Meshes that move: a topology kept, saved and loaded; normals made on the device; one submit and nothing
// more.
#include <algorithm>
#include <numeric>
#include <random>

#include "cl/cl_spy.h"
#include "mesh_fixture.h"
#include "reference_meshes.h"
#include "tolerances.h"

using namespace fixture;
using namespace pellucid;
using reference::Tessellation;

namespace {

PelCurvatureParams tensorParams() {
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.estimator = PEL_CURVATURE_TENSOR;
    return params;
}

std::vector<float> curvatureOf(const MeshTopology& topology, const Mesh& mesh) {
    const uint32_t n = mesh.vertices();
    const Buffer positions(device(), mesh.positions), normals(device(), mesh.normals), out(device(), n * 4);
    topology.curvature(tensorParams(), vertexView(positions, n), vertexView(normals, n), vertexView(out, n));
    return out.readAll<float>();
}

std::vector<float> normalsOf(const Mesh& mesh, const PelMeshTopologyDesc& desc, uint32_t stride = 3) {
    const MeshTopology topology(device(), desc);
    const uint32_t n = mesh.vertices();
    std::vector<float> strided(size_t(n) * stride);
    for (uint32_t v = 0; v < n; ++v) std::copy_n(&mesh.positions[3 * v], 3, &strided[size_t(v) * stride]);
    const Buffer positions(device(), strided), out(device(), n * 12);
    topology.normals(vertexView(positions, n, 0, stride * 4), vertexView(out, n));
    return out.readAll<float>();
}

}  // namespace

TEST(MeshNormals, EqualTheOracle) {
    for (auto kind : {Tessellation::regular, Tessellation::irregular, Tessellation::valenceVarying})
        for (const auto& surface : {reference::torusSurface(3, 1), reference::monkeySaddle(2)}) {
            const Pair pair = pairOf(tessellate(surface, 30, 20, kind).mesh);
            std::vector<double> expected;
            for (const auto& n : reference::estimatedNormals(pair.exact))
                for (int k = 0; k < 3; ++k) expected.push_back(n[k]);
            const std::vector<float> packed = normalsOf(pair.mesh, topologyDesc(pair.mesh));
            EXPECT_LE(relativeError(packed, expected), tolerance::normalComponent) << int(kind);
            EXPECT_EQ(normalsOf(pair.mesh, topologyDesc(pair.mesh), 5), packed)
                << "any stride, the same bits";
        }
}

TEST(MeshNormals, FollowTheWindingOfEachTriangle) {
    // A fan whose second triangle has the wrong order: it counts with the opposite sign, as its order says.
    Mesh mesh;
    mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 0, 0};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    mesh.normals.resize(12);
    std::vector<float> n = normalsOf(mesh, topologyDesc(mesh));
    for (int v = 0; v < 4; ++v) EXPECT_NEAR(n[3 * v + 2], 1, tolerance::normalComponent);
    mesh.indices = {0, 1, 2, 0, 3, 2};
    n = normalsOf(mesh, topologyDesc(mesh));
    EXPECT_NEAR(n[3 * 1 + 2], 1, tolerance::normalComponent);
    EXPECT_NEAR(n[3 * 3 + 2], -1, tolerance::normalComponent);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(n[k], 0) << "both right angles cancel at vertex 0";
    mesh.indices = {0, 0, 1};
    for (float x : normalsOf(mesh, topologyDesc(mesh))) EXPECT_EQ(x, 0);
    mesh.indices = {0, 1, 2, 0, 2, 3};
    mesh.positions[3] = NAN;
    expectFinite(normalsOf(mesh, topologyDesc(mesh)));
}

TEST(MeshNormals, CurvatureMakesThemItself) {
    const Mesh mesh =
        pairOf(tessellate(reference::torusSurface(3, 1), 30, 20, Tessellation::irregular).mesh).mesh;
    Mesh withMade = mesh;
    withMade.normals = normalsOf(mesh, topologyDesc(mesh));
    for (const PelMeshTopologyDesc& desc : {topologyDesc(mesh), weldedDesc(mesh, 0.05f)}) {
        const MeshTopology topology(device(), desc);
        const uint32_t n = mesh.vertices();
        const Buffer positions(device(), mesh.positions), out(device(), n * 4);
        PelMeshReport report = pelMeshReportDefaults();
        topology.curvature(tensorParams(), vertexView(positions, n), vertexView(out, n), &report);
        EXPECT_EQ(report.nonFiniteNormals, 0u);
        if (desc.weld == PEL_WELD_NONE)
            EXPECT_EQ(out.readAll<float>(), curvatureOf(topology, withMade));
        else
            expectFinite(out.readAll<float>());
    }
}

TEST(MeshTopologyFile, LoadedIsAsGoodAsAnalysed) {
    const Mesh mesh = torus(24, 16);
    Mesh split = mesh;  // one vertex twice
    split.positions.insert(split.positions.end(), mesh.positions.begin(), mesh.positions.begin() + 3);
    split.normals.insert(split.normals.end(), mesh.normals.begin(), mesh.normals.begin() + 3);
    split.indices[0] = mesh.vertices();
    for (const auto& [m, desc] : {std::pair(mesh, topologyDesc(mesh)), std::pair(split, weldedDesc(split))}) {
        PelMeshReport analysed = pelMeshReportDefaults(), loaded = pelMeshReportDefaults();
        const MeshTopology first(device(), desc, &analysed);
        const std::vector<char> bytes = first.save();
        const MeshTopology second = MeshTopology::load(device(), bytes.data(), bytes.size(), &loaded);
        EXPECT_EQ(std::memcmp(&analysed, &loaded, sizeof loaded), 0);
        EXPECT_EQ(curvatureOf(second, m), curvatureOf(first, m));
        EXPECT_EQ(second.save(), bytes);
    }
}

TEST(MeshOrder, AShuffledMeshGivesTheSameValues) {
    // Large enough that the library numbers the vertices anew for itself.
    const Mesh mesh = torus(200, 100);
    const Shuffled shuffle = shuffleVertices(mesh, 9);
    const Mesh& shuffled = shuffle.mesh;
    // Triangles in any order, too, do not tell which vertices are near to one another.
    Mesh scattered = shuffled;
    std::vector<uint32_t> order(mesh.indices.size() / 3);
    std::iota(order.begin(), order.end(), 0u);
    std::shuffle(order.begin(), order.end(), std::mt19937(10));
    for (size_t t = 0; t < order.size(); ++t)
        std::copy_n(&shuffled.indices[3 * order[t]], 3, &scattered.indices[3 * t]);
    for (auto estimator : {PEL_CURVATURE_EDGE, PEL_CURVATURE_TENSOR, PEL_CURVATURE_QUADRIC}) {
        PelCurvatureParams params = tensorParams();
        params.estimator = estimator;
        const std::vector<float> base = curvature(mesh, topologyDesc(mesh), params).values;
        for (const Mesh& other : {shuffled, scattered})
            for (const PelMeshTopologyDesc& desc : {topologyDesc(other), weldedDesc(other)}) {
                const Result result = curvature(other, desc, params);
                EXPECT_EQ(result.report.edges, 3 * mesh.vertices());
                EXPECT_LE(relativeError(shuffle.inOldOrder(result.values), base), tolerance::shuffled)
                    << estimator;
            }
    }
    const MeshTopology first(device(), topologyDesc(shuffled));
    const std::vector<char> bytes = first.save();
    EXPECT_EQ(curvatureOf(MeshTopology::load(device(), bytes.data(), bytes.size()), shuffled),
              curvatureOf(first, shuffled));
}

TEST(MeshTopologyFile, DamageIsRefused) {
    const Mesh mesh = torus(8, 6);
    const std::vector<char> sound = MeshTopology(device(), topologyDesc(mesh)).save();
    const auto refused = [](const std::vector<char>& bytes) {
        PelMeshTopology topology = nullptr;
        const PelError code =
            pelMeshTopologyLoad(device().get(), bytes.data(), bytes.size(), &topology, nullptr);
        EXPECT_EQ(topology, nullptr);
        return code == PEL_ERROR_INVALID_ARGUMENT;
    };
    for (size_t size : {size_t(0), size_t(7), size_t(40), sound.size() - 1})
        EXPECT_TRUE(refused(std::vector<char>(sound.begin(), sound.begin() + std::ptrdiff_t(size))));
    std::mt19937 random(5);
    for (int i = 0; i < 300; ++i) {
        std::vector<char> bytes = sound;
        const size_t at = random() % bytes.size();
        bytes[at] = char(bytes[at] ^ (1 << random() % 8));
        // The other counts of the report are shown only; no size is derived from them.
        PelMeshTopology topology = nullptr;
        if (pelMeshTopologyLoad(device().get(), bytes.data(), bytes.size(), &topology, nullptr) ==
            PEL_SUCCESS) {
            EXPECT_LT(at, 200u) << "damage behind the header";
            pelMeshTopologyRelease(topology);
        }
    }
    size_t room = 10;
    char small[10];
    const MeshTopology topology(device(), topologyDesc(mesh));
    EXPECT_EQ(pelMeshTopologySave(topology.get(), small, &room), PEL_ERROR_INVALID_ARGUMENT);
}

TEST(MeshLive, ANewPoseIsOneSubmitWithoutCopiesOrBuilds) {
    const Mesh mesh = torus(sized(64, 32), sized(48, 24));
    const uint32_t n = mesh.vertices();
    const MeshTopology topology(device(), topologyDesc(mesh));
    const Buffer positions(device(), mesh.positions), out(device(), n * 4);
    topology.curvature(tensorParams(), vertexView(positions, n), vertexView(out, n));
    const PelDeviceStats before = device().stats();
    const spy::Counts asked = spy::counts();
    PelEvent event = nullptr;
    const PelSubmit submit{nullptr, 0, &event};
    topology.curvature(tensorParams(), vertexView(positions, n), vertexView(out, n), nullptr, &submit);
    Event(event).wait();
    EXPECT_EQ(spy::counts().transfers, asked.transfers);
    EXPECT_EQ(spy::counts().buffersMade, asked.buffersMade);
    const PelDeviceStats after = device().stats();
    EXPECT_EQ(after.launches - before.launches, 5u) << "normals, tensor, two smoothing passes, store";
    EXPECT_EQ(after.bytesToDevice, before.bytesToDevice);
    EXPECT_EQ(after.bytesToHost, before.bytesToHost);
    EXPECT_EQ(after.bytesAllocated, before.bytesAllocated);
    EXPECT_EQ(after.programsBuilt, before.programsBuilt);
}
