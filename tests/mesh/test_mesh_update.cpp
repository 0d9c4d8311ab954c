// Live meshes: a partial update gives the same bits as measuring everything anew, and counters show that less
// was measured.
#include "held_queue.h"
#include "mesh_fixture.h"
#include "reference_meshes.h"

using namespace fixture;
using namespace pellucid;

namespace {

// On the device, and the mesh as it stands in this pose.
struct Pose : OnDevice {
    Mesh mesh;
    bool given;
    explicit Pose(const Mesh& m, bool givenNormals = false, uint32_t floatsPerVertex = 1)
        : OnDevice(m, floatsPerVertex), mesh(m), given(givenNormals) {}
    void move(PelVertexRange range, float by) {
        for (uint32_t v = range.first; v < range.first + range.count; ++v) {
            mesh.positions[3 * v] += by;
            mesh.normals[3 * v + 1] += 0.1f * by;
        }
        positions.write(&mesh.positions[3 * range.first], range.count * 12, range.first * 12);
        normals.write(&mesh.normals[3 * range.first], range.count * 12, range.first * 12);
    }
    void update(const LiveMesh& live, const std::vector<PelVertexRange>* changed = nullptr,
                const PelSubmit* submit = nullptr) const {
        const PelVertexView view = normalsAt(), *optional = given ? &view : nullptr;
        changed ? live.update(at(), optional, result(), *changed, submit)
                : live.update(at(), optional, result(), submit);
    }
    std::vector<float> values() const { return out.readAll<float>(); }
    // Submitted, so that a smoothing to a radius takes what the update measured.
    std::vector<float> anew(const MeshTopology& topology, const PelCurvatureParams& params) const {
        const OnDevice again(mesh, floats);
        PelEvent event = nullptr;
        const PelSubmit submit{nullptr, 0, &event};
        given ? topology.curvature(params, again.at(), again.normalsAt(), again.result(), nullptr, &submit)
              : topology.curvature(params, again.at(), again.result(), nullptr, &submit);
        Event(event).wait();
        return again.out.readAll<float>();
    }
};

// What the device has done since `before`, but for launches.
void expectNoTraffic(const PelDeviceStats& before) {
    const PelDeviceStats after = device().stats();
    EXPECT_EQ(after.bytesToDevice, before.bytesToDevice);
    EXPECT_EQ(after.bytesToHost, before.bytesToHost);
    EXPECT_EQ(after.bytesAllocated, before.bytesAllocated);
    EXPECT_EQ(after.programsBuilt, before.programsBuilt);
}

}  // namespace

TEST(LiveMesh, APartGivesTheBitsOfTheWhole) {
    const Mesh mesh = irregularTorus(80, 50);
    std::mt19937 random(3);
    struct Case {
        PelCurvatureEstimator estimator;
        PelCurvatureQuantity quantity;
        uint32_t floats;
        bool given;  // normals
        uint32_t passes;
        float radius;
        bool welded;          // and in an order without sense: slots are not the vertices
        uint32_t stages = 0;  // few reach as far as their weights
    };
    for (const Case& c : {Case{PEL_CURVATURE_EDGE, PEL_QUANTITY_ABSOLUTE, 1, true, 3, 0, false},
                          Case{PEL_CURVATURE_EDGE, PEL_QUANTITY_ABSOLUTE, 1, false, 0, 0, true},
                          Case{PEL_CURVATURE_TENSOR, PEL_QUANTITY_FRAME, 8, true, 1, 0, true},
                          Case{PEL_CURVATURE_QUADRIC, PEL_QUANTITY_ABSOLUTE, 1, true, 2, 0, false},
                          Case{PEL_CURVATURE_QUADRIC, PEL_QUANTITY_ABSOLUTE, 1, false, 1, 0.2f, false},
                          Case{PEL_CURVATURE_EDGE, PEL_QUANTITY_ABSOLUTE, 1, true, 0, 0.1f, false, 1},
                          Case{PEL_CURVATURE_EDGE, PEL_QUANTITY_ABSOLUTE, 1, true, 0, 0.1f, false, 2},
                          Case{PEL_CURVATURE_EDGE, PEL_QUANTITY_ABSOLUTE, 1, false, 0, 0.1f, false, 1},
                          Case{PEL_CURVATURE_EDGE, PEL_QUANTITY_ABSOLUTE, 1, false, 0, 0.1f, false, 2}}) {
        PelCurvatureParams params = paramsOf(c.estimator, c.passes, c.quantity);
        params.smoothingRadius = c.radius;
        params.smoothingStages = c.stages;
        params.smoothingCrease = c.radius > 0 ? 0.5f : 0;
        params.smoothingWeights = c.given ? PEL_SMOOTHING_COTANGENT : PEL_SMOOTHING_AREA;
        Pose pose(c.welded ? shuffleVertices(mesh, 4).mesh : mesh, c.given, c.floats);
        const MeshTopology topology(device(),
                                    c.welded ? weldedDesc(pose.mesh, 0.04f) : topologyDesc(pose.mesh));
        const LiveMesh live(topology, params);
        pose.update(live);
        EXPECT_EQ(pose.values(), pose.anew(topology, params));
        for (int step = 0; step < 4; ++step) {
            std::vector<PelVertexRange> changed;
            for (int r = 0; r <= step % 2; ++r) {
                const uint32_t count = 1 + random() % (c.welded ? 3 : 60);
                changed.push_back({uint32_t(random() % (pose.n - count)), count});
                pose.move(changed.back(), 0.02f);
            }
            pose.update(live, &changed);
            EXPECT_EQ(pose.values(), pose.anew(topology, params))
                << c.estimator << c.given << c.passes << c.welded << c.stages << " step " << step;
        }
    }
}

TEST(LiveMesh, WorksOnNoMoreRowsThanTheChangeReaches) {
    const Mesh mesh = torus(400, 200);
    Pose pose(mesh, true);
    const MeshTopology topology(device(), topologyDesc(mesh));
    const LiveMesh live(topology, paramsOf(PEL_CURVATURE_QUADRIC));
    pose.update(live);
    EXPECT_EQ(live.stats().rowsEstimated, mesh.vertices());
    EXPECT_EQ(live.stats().launches, 4u) << "quadric, two smoothing passes, store";
    const std::vector<PelVertexRange> one{{40100, 1}};
    pose.move(one[0], 0.001f);
    pose.update(live, &one);
    PelLiveMeshStats stats = live.stats();
    EXPECT_EQ(stats.rowsStored, 91u) << "five rings of a vertex of six neighbours: 1 + 6 + 12 + 18 + 24 + 30";
    EXPECT_LE(stats.rowsEstimated, 22u * 8) << "three rings in whole slices";
    EXPECT_LE(stats.rowsSmoothed, (26u + 30u) * 8);
    EXPECT_GT(stats.bytesUploaded, 0u);
    EXPECT_LE(stats.bytesUploaded, 2 * 4 * stats.rowsSmoothed) << "two numbers a row at most";
    EXPECT_EQ(stats.rowsTotal, mesh.vertices());
    // The same vertices again: not even the list.
    const PelDeviceStats before = device().stats();
    pose.update(live, &one);
    stats = live.stats();
    EXPECT_EQ(stats.bytesUploaded, 0u);
    EXPECT_EQ(stats.rowsStored, 91u);
    EXPECT_EQ(device().stats().launches - before.launches, stats.launches);
    expectNoTraffic(before);
}

TEST(LiveMesh, NothingChangedCostsNothing) {
    Pose pose(torus(sized(64, 32), sized(48, 24)));
    const MeshTopology topology(device(), topologyDesc(pose.mesh));
    const LiveMesh live(topology, pelCurvatureParamsDefaults());
    const std::vector<PelVertexRange> none, empty{{5, 0}}, some{{100, 9}};
    pose.update(live, &none);
    EXPECT_EQ(live.stats().rowsStored, pose.n)
        << "the first update measures everything, whatever its ranges are";
    const std::vector<float> values = pose.values();
    const PelDeviceStats before = device().stats();
    const spy::Counts asked = spy::counts();
    pose.update(live, &none);
    pose.update(live, &empty);
    EXPECT_EQ(spy::counts().transfers, asked.transfers);
    EXPECT_EQ(spy::counts().launches, asked.launches);
    EXPECT_EQ(spy::counts().buffersMade, asked.buffersMade);
    EXPECT_EQ(device().stats().launches, before.launches);
    expectNoTraffic(before);
    EXPECT_EQ(live.stats().launches, 0u);
    EXPECT_EQ(pose.values(), values);
    // An event comes all the same, and an update of a part reads nothing back. Where memory is not shared the
    // first one reads the neighbours of the vertices.
    if (!device().info().sharedMemory) pose.update(live, &some);
    const uint64_t read = device().stats().bytesToHost;
    for (const auto& changed : {none, some}) {
        PelEvent event = nullptr;
        const PelSubmit submit{nullptr, 0, &event};
        pose.update(live, &changed, &submit);
        ASSERT_NE(event, nullptr);
        Event(event).wait();
    }
    EXPECT_EQ(device().stats().bytesToHost, read);
}

TEST(LiveMesh, AnotherTargetIsWrittenWholeAndNormalsThatAppearCount) {
    Pose pose(torus(sized(64, 32), sized(48, 24)), true);
    const MeshTopology topology(device(), topologyDesc(pose.mesh));
    const PelCurvatureParams params = paramsOf(PEL_CURVATURE_TENSOR);
    const LiveMesh live(topology, params);
    pose.update(live);
    const std::vector<PelVertexRange> some{{100, 9}}, none;
    pose.move(some[0], 0.05f);
    pose.out = Buffer(device(), pose.n * 4);
    pose.update(live, &some);
    EXPECT_EQ(pose.values(), pose.anew(topology, params));
    EXPECT_LT(live.stats().rowsEstimated, pose.n / 4) << "estimates are kept";
    pose.given = false;
    pose.update(live, &none);
    EXPECT_EQ(pose.values(), pose.anew(topology, params));
}

TEST(LiveMesh, NamesWhatIsWrong) {
    Pose pose(torus(8, 6));
    const MeshTopology topology(device(), topologyDesc(pose.mesh));
    const LiveMesh live(topology, pelCurvatureParamsDefaults());
    const std::vector<PelVertexRange> whole{{0, 48}, {48, 0}, {47, 1}};
    pose.update(live, &whole);
    for (PelVertexRange range :
         {PelVertexRange{48, 1}, PelVertexRange{40, 9}, PelVertexRange{1, UINT32_MAX}}) {
        const std::vector<PelVertexRange> changed{{0, 1}, range};
        expectRefused("range 1", [&] { pose.update(live, &changed); });
    }
    PelLiveMesh handle = nullptr;
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.scale = NAN;
    EXPECT_EQ(pelLiveMeshCreate(topology.get(), &params, &handle), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(pelLiveMeshCreate(nullptr, &params, &handle), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(handle, nullptr);
    const MeshTopology empty(device(), topologyDesc(Mesh()));
    const Buffer any(device(), 16);
    LiveMesh(empty, pelCurvatureParamsDefaults()).update(vertexView(any, 0), nullptr, vertexView(any, 0));
}

TEST(MeshLive, ANewPoseIsOneSubmitWithoutCopiesOrBuilds) {
    const Pose pose(torus(sized(64, 32), sized(48, 24)));
    const MeshTopology topology(device(), topologyDesc(pose.mesh));
    const PelCurvatureParams params = paramsOf(PEL_CURVATURE_TENSOR);
    pose.curvature(topology, params, true);
    const PelDeviceStats before = device().stats();
    const spy::Counts asked = spy::counts();
    PelEvent event = nullptr;
    const PelSubmit submit{nullptr, 0, &event};
    topology.curvature(params, pose.at(), pose.result(), nullptr, &submit);
    Event(event).wait();
    EXPECT_EQ(spy::counts().transfers, asked.transfers);
    EXPECT_EQ(spy::counts().buffersMade, asked.buffersMade);
    EXPECT_EQ(device().stats().launches - before.launches, 5u)
        << "normals, tensor, two smoothing passes, store";
    expectNoTraffic(before);
}

// --- submitted behind an event that is set later, on topologies that nothing was measured on before ---

TEST(MeshSubmit, EachReturns) {
    const Mesh mesh = torus(24, 12);
    for (PelCurvatureEstimator estimator : allEstimators) {
        Pose pose(mesh);
        const MeshTopology measured(device(), topologyDesc(mesh)), updated(device(), topologyDesc(mesh));
        PelCurvatureParams params = paramsOf(estimator);
        const LiveMesh live(updated, params);
        params.smoothingRadius = 0.5f;
        params.smoothingStages = 4;  // without a number the call measures the mesh
        expectReturns(device(), "pelMeshCurvature", [&](const PelSubmit* submit) {
            measured.curvature(params, pose.at(), pose.result(), nullptr, submit);
        });
        EXPECT_EQ(pose.values(), pose.anew(measured, params)) << int(estimator);
        params = paramsOf(estimator);
        expectReturns(device(), "the first pelLiveMeshUpdate",
                      [&](const PelSubmit* submit) { pose.update(live, nullptr, submit); });
        EXPECT_EQ(pose.values(), pose.anew(measured, params)) << int(estimator);
        for (uint32_t first : {7u, 100u}) {
            const std::vector<PelVertexRange> one{{first, 1}};
            pose.move(one[0], 0.05f);
            expectReturns(device(), "pelLiveMeshUpdate with `changed`",
                          [&](const PelSubmit* submit) { pose.update(live, &one, submit); });
            EXPECT_EQ(pose.values(), pose.anew(measured, params)) << int(estimator);
        }
        EXPECT_LT(live.stats().rowsStored, pose.n);
    }
    const MeshTopology topology(device(), topologyDesc(mesh));
    const OnDevice normals(mesh, 3);
    expectReturns(device(), "pelMeshNormals",
                  [&](const PelSubmit* submit) { topology.normals(normals.at(), normals.result(), submit); });
    EXPECT_NE(normals.out.readAll<float>()[0], -1);
    // Calls that do not depend on queued work.
    std::vector<char> bytes;
    expectReturns(device(), "pelMeshTopologySave", [&](const PelSubmit*) { bytes = topology.save(); });
    EXPECT_EQ(bytes, topology.save());
}
