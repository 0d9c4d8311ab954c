#include "api/entry.h"
#include "core/mesh_topology.h"
#include "core/submission.h"
#include "ops/curvature.h"
#include "ops/uv_scale.h"

using namespace pel;

PelError pelMeshTopologyCreate(PelDevice device, const PelMeshTopologyDesc* desc, PelMeshTopology* topology,
                               PelMeshReport* report) {
    return entry([&] {
        output(topology, "topology");
        PelMeshReport found = pelMeshReportDefaults();
        const auto full = readStruct(desc, pelMeshTopologyDescDefaults(), "PelMeshTopologyDesc");
        Ref<MeshTopology> made = MeshTopology::create(Ref(&fromHandle<Device>(device)), full, found);
        if (report) writeStruct(report, found, "PelMeshReport");
        *topology = toHandle<PelMeshTopology>(std::move(made));
    });
}

void pelMeshTopologyRetain(PelMeshTopology topology) {
    retainHandle(topology);
}
void pelMeshTopologyRelease(PelMeshTopology topology) {
    releaseHandle(topology);
}

PelError pelMeshCurvature(PelMeshTopology topology, const PelCurvatureParams* params,
                          const PelVertexView* positions, const PelVertexView* normals,
                          const PelVertexView* curvature, PelMeshReport* report, const PelSubmit* submit) {
    return entry([&] {
        MeshTopology& mesh = fromHandle<MeshTopology>(topology);
        const auto full = readStruct(params, pelCurvatureParamsDefaults(), "PelCurvatureParams");
        checkCurvatureParams(full);
        const auto view = [&](const PelVertexView* v, const char* name, uint32_t components) {
            return checkedView(v, name, mesh.device(), mesh.vertices(), components);
        };
        const VertexView p = view(positions, "positions", 3), n = view(normals, "normals", 3);
        const VertexView out = view(curvature, "curvature", quantityFloats(full.quantity));
        PelMeshReport found = mesh.report();
        if (report) writeStruct(report, found, "PelMeshReport");  // fails before any work does
        MeshCounts counts{};
        Submission submission(mesh.device(), submit);
        meshCurvature(mesh, full, p, n, out, report ? &counts : nullptr);
        submission.finish();
        if (!report) return;
        found.zeroLengthEdges = counts.zeroLengthEdges;
        found.nonFinitePositions = counts.nonFinitePositions;
        found.nonFiniteNormals = counts.nonFiniteNormals;
        writeStruct(report, found, "PelMeshReport");
    });
}

PelError pelMeshUvScale(PelMeshTopology topology, const PelVertexView* positions, const PelVertexView* uvs,
                        float* uvScale) {
    return entry([&] {
        MeshTopology& mesh = fromHandle<MeshTopology>(topology);
        const VertexView p = checkedView(positions, "positions", mesh.device(), mesh.vertices(), 3);
        const VertexView uv = checkedView(uvs, "uvs", mesh.device(), mesh.vertices(), 2);
        output(uvScale, "uvScale") = meshUvScale(mesh, p, uv);
    });
}
