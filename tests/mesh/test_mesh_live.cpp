// Normals made on the device; a topology saved and loaded; meshes in any order.
#define XXH_INLINE_ALL
#define XXH_NO_INLINE_HINTS 1  // tests are compiled with -Og
#include <xxhash.h>

#include "mesh_fixture.h"
#include "reference_meshes.h"

using namespace fixture;
using namespace pellucid;

namespace {

const PelCurvatureParams tensor = paramsOf(PEL_CURVATURE_TENSOR);

std::vector<float> curvatureOf(const MeshTopology& topology, const Mesh& mesh) {
    return OnDevice(mesh).curvature(topology, tensor);
}

}  // namespace

TEST(MeshNormals, OfAnyStrideAreTheSameBits) {
    const Mesh mesh = irregularTorus(30, 20);
    EXPECT_EQ(normalsOf(mesh, 5), normalsOf(mesh));
}

TEST(MeshNormals, FollowTheWindingOfEachTriangle) {
    // A fan whose second triangle has the wrong order: it counts with the opposite sign, as its order says.
    Mesh mesh;
    mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 0, 0};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    mesh.normals.resize(12);
    std::vector<float> n = normalsOf(mesh);
    for (int v = 0; v < 4; ++v) EXPECT_NEAR(n[3 * v + 2], 1, tolerance::normalComponent);
    mesh.indices = {0, 1, 2, 0, 3, 2};
    n = normalsOf(mesh);
    EXPECT_NEAR(n[3 * 1 + 2], 1, tolerance::normalComponent);
    EXPECT_NEAR(n[3 * 3 + 2], -1, tolerance::normalComponent);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(n[k], 0) << "both right angles cancel at vertex 0";
    mesh.indices = {0, 0, 1};
    for (float x : normalsOf(mesh)) EXPECT_EQ(x, 0);
    mesh.indices = {0, 1, 2, 0, 2, 3};
    mesh.positions[3] = NAN;
    expectFinite(normalsOf(mesh));
}

TEST(MeshNormals, CurvatureMakesThemItself) {
    const Mesh mesh = irregularTorus(30, 20);
    Mesh withMade = mesh;
    withMade.normals = normalsOf(mesh);
    for (const PelMeshTopologyDesc& desc : {topologyDesc(mesh), weldedDesc(mesh, 0.05f)}) {
        const MeshTopology topology(device(), desc);
        PelMeshReport report = pelMeshReportDefaults();
        const std::vector<float> values = OnDevice(mesh).curvature(topology, tensor, true, &report);
        EXPECT_EQ(report.nonFiniteNormals, 0u);
        if (desc.weld == PEL_WELD_NONE)
            EXPECT_EQ(values, curvatureOf(topology, withMade));
        else
            expectFinite(values);
    }
}

TEST(MeshTopologyFile, LoadedIsAsGoodAsAnalysed) {
    const Mesh mesh = torus(24, 16);
    const Mesh split = soupOf(mesh);
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
    for (auto estimator : allEstimators) {
        const PelCurvatureParams params = paramsOf(estimator);
        const std::vector<float> base = valuesOf(mesh, params);
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
    for (size_t size : {size_t(0), size_t(7), size_t(40), sound.size() - 1}) {
        PelMeshTopology topology = nullptr;
        EXPECT_EQ(pelMeshTopologyLoad(device().get(), sound.data(), size, &topology, nullptr),
                  PEL_ERROR_INVALID_ARGUMENT);
        EXPECT_EQ(topology, nullptr);
    }
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

// Forged files: the checksum is right, and a number in one of the arrays is wrong.
TEST(MeshTopologyFile, NumbersThatKernelsCannotFollowAreRefused) {
    const std::vector<char> sound = MeshTopology(device(), weldedDesc(soupOf(torus(8, 6)))).save();
    constexpr size_t countsAt = 12, checksumAt = 36, begin = 40 + sizeof(PelMeshReport);
    uint32_t counts[6];
    std::memcpy(counts, &sound[countsAt], sizeof counts);
    size_t at = begin;
    for (const uint32_t count : counts) {
        ASSERT_GT(count, 0u);
        for (const uint32_t i : {0u, count / 2, count - 1}) {
            std::vector<char> bytes = sound;
            std::fill_n(&bytes[at + i * sizeof i], sizeof i, char(0x7f));
            const uint32_t checksum = XXH32(&bytes[begin], bytes.size() - begin, 0);
            std::memcpy(&bytes[checksumAt], &checksum, sizeof checksum);
            PelMeshTopology topology = nullptr;
            ASSERT_EQ(pelMeshTopologyLoad(device().get(), bytes.data(), bytes.size(), &topology, nullptr),
                      PEL_ERROR_INVALID_ARGUMENT)
                << "word " << i << " of " << count;
            const std::string said = pelGetErrorMessage();
            EXPECT_EQ(said.find("checksum"), std::string::npos) << said;
        }
        at += count * sizeof count;
    }
    EXPECT_EQ(at, sound.size());
}
