// Submissions behind an event that their caller sets later, on topologies that nothing was measured on
// before.
#include "held_queue.h"
#include "mesh_fixture.h"

using namespace fixture;
using namespace pellucid;

namespace {

struct Pose : OnDevice {
    Mesh mesh;
    MeshTopology topology{device(), topologyDesc(mesh)};
    explicit Pose(const Mesh& m = torus(24, 12)) : OnDevice(m), mesh(m) {}
    std::vector<float> measured(const PelCurvatureParams& params) const {
        return OnDevice(mesh).curvature(MeshTopology(device(), topologyDesc(mesh)), params, true);
    }
    std::vector<float> written() const { return out.readAll<float>(); }
};

TEST(MeshSubmit, TheFirstCurvatureReturns) {
    for (PelCurvatureEstimator estimator : allEstimators) {
        const Pose pose;
        PelCurvatureParams params = paramsOf(estimator);
        params.smoothingRadius = 0.5f;
        params.smoothingStages = 4;  // without a number the call measures the mesh
        expectReturns(device(), "pelMeshCurvature", [&](const PelSubmit* submit) {
            pose.topology.curvature(params, pose.at(), pose.result(), nullptr, submit);
        });
        EXPECT_EQ(pose.written(), pose.measured(params)) << int(estimator);
    }
}

TEST(MeshSubmit, TheFirstNormalsReturn) {
    const Pose pose;
    const OnDevice normals(pose.mesh, 3);
    expectReturns(device(), "pelMeshNormals", [&](const PelSubmit* submit) {
        pose.topology.normals(pose.at(), normals.result(), submit);
    });
    EXPECT_NE(normals.out.readAll<float>()[0], -1);
}

TEST(MeshSubmit, TheFirstUpdatesOfALiveMeshReturn) {
    for (PelCurvatureEstimator estimator : allEstimators) {
        Pose pose;
        const PelCurvatureParams params = paramsOf(estimator);
        const LiveMesh live(pose.topology, params);
        expectReturns(device(), "the first pelLiveMeshUpdate", [&](const PelSubmit* submit) {
            live.update(pose.at(), nullptr, pose.result(), submit);
        });
        EXPECT_EQ(pose.written(), pose.measured(params)) << int(estimator);
        for (uint32_t first : {7u, 100u}) {
            pose.mesh.positions[3 * first] += 0.05f;
            pose.positions.write(&pose.mesh.positions[3 * first], 12, 12 * first);
            expectReturns(device(), "pelLiveMeshUpdate with `changed`", [&](const PelSubmit* submit) {
                live.update(pose.at(), nullptr, pose.result(), std::vector<PelVertexRange>{{first, 1}},
                            submit);
            });
            EXPECT_EQ(pose.written(), pose.measured(params)) << int(estimator);
        }
        EXPECT_LT(live.stats().rowsStored, pose.n);
    }
}

// What needs nothing of what is queued.
TEST(MeshSubmit, SavingReturns) {
    const Pose pose;
    std::vector<char> bytes;
    expectReturns(device(), "pelMeshTopologySave", [&](const PelSubmit*) { bytes = pose.topology.save(); });
    EXPECT_EQ(bytes, pose.topology.save());
}

}  // namespace
