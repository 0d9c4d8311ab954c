#include "api/entry.h"
#include "core/submission.h"
#include "mesh/live_mesh.h"

using namespace pel;

PelError pelMeshTopologyCreate(PelDevice device, const PelMeshTopologyDesc* desc, PelMeshTopology* topology,
                               PelMeshReport* report) {
    return entry([&] {
        output(topology, "topology");
        PelMeshReport found = pelMeshReportDefaults();
        const auto full = readStruct(desc, pelMeshTopologyDescDefaults());
        const Ref<Device> d = fromHandle<Device>(device);
        Ref<MeshTopology> made = MeshTopology::create(
            d, full, found, [&](double fraction) { d->progress(fraction, "analysing the mesh"); });
        if (report) writeStruct(report, found);
        *topology = toHandle<PelMeshTopology>(std::move(made));
    });
}

PelError pelMeshTopologySave(PelMeshTopology topology, void* destination, size_t* size) {
    return entry([&] {
        const std::vector<char> bytes = fromHandle<MeshTopology>(topology)->save();
        const size_t room = output(size, "size");
        if (destination && room < bytes.size())
            invalidArgument("the analysis takes ", bytes.size(), " bytes, and there is room for ", room);
        if (destination) std::copy(bytes.begin(), bytes.end(), static_cast<char*>(destination));
        *size = bytes.size();
    });
}

PelError pelMeshTopologyLoad(PelDevice device, const void* bytes, size_t size, PelMeshTopology* topology,
                             PelMeshReport* report) {
    return entry([&] {
        output(topology, "topology");
        Ref<MeshTopology> made = MeshTopology::load(fromHandle<Device>(device), bytes, size);
        if (report) writeStruct(report, made->report());
        *topology = toHandle<PelMeshTopology>(std::move(made));
    });
}

PelError pelMeshNormals(PelMeshTopology topology, const PelVertexView* positions,
                        const PelVertexView* normals, const PelSubmit* submit) {
    return entry([&] {
        const Ref<MeshTopology> mesh = fromHandle<MeshTopology>(topology);
        const VertexView p = checkedView(positions, "positions", mesh->device(), mesh->vertices(), 3);
        const VertexView n = checkedView(normals, "normals", mesh->device(), mesh->vertices(), 3);
        submitted(mesh->device(), submit, [&](bool) { meshNormals(*mesh, p, n); });
    });
}

PelError pelMeshOrient(const PelMeshTopologyDesc* desc, const float* normals, uint32_t normalStride,
                       uint32_t* indices, PelMeshOrientation* found) {
    return entry([&] {
        const auto full = readStruct(desc, pelMeshTopologyDescDefaults());
        PelMeshOrientation counts = pelMeshOrientationDefaults();
        if (found) checkStructSize<PelMeshOrientation>(found->structSize);
        const std::vector<uint32_t> turned = orientTriangles(full, normals, normalStride, counts);
        if (!turned.empty()) std::copy(turned.begin(), turned.end(), &output(indices, "indices"));
        if (found) writeStruct(found, counts);
    });
}

PEL_COUNTED(MeshTopology)

PelError pelMeshCurvature(PelMeshTopology topology, const PelCurvatureParams* params,
                          const PelVertexView* positions, const PelVertexView* normals,
                          const PelVertexView* curvature, PelMeshReport* report, const PelSubmit* submit) {
    return entry([&] {
        const Ref<MeshTopology> mesh = fromHandle<MeshTopology>(topology);
        const auto full = readStruct(params, pelCurvatureParamsDefaults());
        checkCurvatureParams(full);
        const auto view = [&](const PelVertexView* v, const char* name, uint32_t components) {
            return checkedView(v, name, mesh->device(), mesh->vertices(), components);
        };
        const VertexView p = view(positions, "positions", 3);
        const VertexView n = normals ? view(normals, "normals", 3) : VertexView{};
        const VertexView out = view(curvature, "curvature", quantityFloats(full.quantity));
        PelMeshReport found = mesh->report();
        if (report) checkStructSize<PelMeshReport>(report->structSize);
        MeshCounts counts{};
        submitted(mesh->device(), submit, [&](bool blocks) {
            meshCurvature(*mesh, full, p, n, out, report ? &counts : nullptr, blocks || report);
        });
        if (!report) return;
        found.zeroLengthEdges = counts.zeroLengthEdges;
        found.nonFinitePositions = counts.nonFinitePositions;
        found.nonFiniteNormals = counts.nonFiniteNormals;
        found.lowDegreeFits = counts.lowDegreeFits;
        writeStruct(report, found);
    });
}

PelError pelMeshUvScale(PelMeshTopology topology, const PelVertexView* positions, const PelVertexView* uvs,
                        float* uvScale) {
    return entry([&] {
        const Ref<MeshTopology> mesh = fromHandle<MeshTopology>(topology);
        const VertexView p = checkedView(positions, "positions", mesh->device(), mesh->vertices(), 3);
        const VertexView uv = checkedView(uvs, "uvs", mesh->device(), mesh->vertices(), 2);
        output(uvScale, "uvScale") = meshUvScale(*mesh, p, uv);
    });
}

PelError pelLiveMeshCreate(PelMeshTopology topology, const PelCurvatureParams* params, PelLiveMesh* live) {
    return entry([&] {
        output(live, "live");
        const auto full = readStruct(params, pelCurvatureParamsDefaults());
        checkCurvatureParams(full);
        *live = toHandle<PelLiveMesh>(make<LiveMesh>(fromHandle<MeshTopology>(topology), full));
    });
}

PEL_COUNTED(LiveMesh)

PelError pelLiveMeshUpdate(PelLiveMesh live, const PelVertexView* positions, const PelVertexView* normals,
                           const PelVertexView* curvature, const PelVertexRange* changed, uint32_t numChanged,
                           const PelSubmit* submit) {
    return entry([&] {
        const Ref<LiveMesh> mesh = fromHandle<LiveMesh>(live);
        const MeshTopology& topology = *mesh->topology();
        const auto view = [&](const PelVertexView* v, const char* name, uint32_t components) {
            return checkedView(v, name, topology.device(), topology.vertices(), components);
        };
        const VertexView p = view(positions, "positions", 3);
        const VertexView n = normals ? view(normals, "normals", 3) : VertexView{};
        const VertexView out = view(curvature, "curvature", quantityFloats(mesh->params().quantity));
        checkRanges(changed, numChanged, topology.vertices());
        submitted(topology.device(), submit,
                  [&](bool blocks) { mesh->update(p, n, out, changed, numChanged, blocks); });
    });
}

PelError pelLiveMeshGetStats(PelLiveMesh live, PelLiveMeshStats* stats) {
    return entry([&] { writeStruct(stats, fromHandle<LiveMesh>(live)->stats()); });
}
