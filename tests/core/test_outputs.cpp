// What a call writes into memory of its caller: nothing that was not asked for, and nothing at all if the call is
// refused.
#include <gtest/gtest.h>

#include <cstring>
#include <pellucid/pellucid.hpp>

#include "mesh/mesh_calls.h"

using namespace pellucid;

TEST(Outputs, AnyPointerOfGetClMayBeNull) {
    const Device device("");
    void *context = nullptr, *id = nullptr, *queue = nullptr;
    check(pelDeviceGetCl(device.get(), &context, &id, &queue));
    for (int asked = 0; asked < 8; ++asked) {
        void* got[3] = {};
        check(pelDeviceGetCl(device.get(), asked & 1 ? &got[0] : nullptr, asked & 2 ? &got[1] : nullptr,
                             asked & 4 ? &got[2] : nullptr));
        EXPECT_EQ(got[0], asked & 1 ? context : nullptr);
        EXPECT_EQ(got[1], asked & 2 ? id : nullptr);
        EXPECT_EQ(got[2], asked & 4 ? queue : nullptr);
    }
}

// A report that cannot be filled is refused before any work: what is in the result stays there.
TEST(Outputs, AReportOfNoSizeIsRefusedBeforeAnyWork) {
    const Device device("");
    const fixture::Mesh mesh = fixture::torus(24, 12);
    const MeshTopology topology(device, fixture::topologyDesc(mesh));
    const uint32_t count = mesh.vertices();
    const Buffer positions(device, mesh.positions), normals(device, mesh.normals),
        out(device, std::vector<float>(count, -7.0f));
    const PelVertexView p = vertexView(positions, count), n = vertexView(normals, count),
                        c = vertexView(out, count);
    const PelCurvatureParams params = fixture::edgeParams(1);
    PelMeshReport report = pelMeshReportDefaults();
    for (const uint32_t size : {0u, 1u << 20}) {
        report.structSize = size;
        EXPECT_EQ(pelMeshCurvature(topology.get(), &params, &p, &n, &c, &report, nullptr),
                  PEL_ERROR_INVALID_ARGUMENT);
        for (const float value : out.readAll<float>()) ASSERT_EQ(value, -7.0f);
    }
    report = pelMeshReportDefaults();
    check(pelMeshCurvature(topology.get(), &params, &p, &n, &c, &report, nullptr));
    for (const float value : out.readAll<float>()) ASSERT_NE(value, -7.0f);
}
