#include "mesh_curvature.h"
#include "io/concat.h"

namespace pellucid::cli {

MeshCurvature meshCurvature(Run& run, const io::MeshData& mesh, const PelCurvatureParams& params,
                            const MeshWeldChoice& weld) {
    const auto count = uint32_t(mesh.vertexCount());
    MeshCurvature result{std::vector<float>(count), pelMeshReportDefaults()};
    withInput(mesh.source, [&] {
        PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
        desc.numVertices = count;
        desc.indices = mesh.triangles.data();
        desc.numIndices = mesh.triangles.size();
        desc.positions = mesh.positions.data();
        desc.weld = weld.weld;
        desc.weldTolerance = weld.tolerance;
        const MeshTopology topology(run.device(), desc, &result.report);
        const Buffer positions(run.device(), mesh.positions), normals(run.device(), mesh.normals);
        const Buffer curvature(run.device(), count * sizeof(float));
        topology.curvature(params, vertexView(positions, count), vertexView(normals, count),
                           vertexView(curvature, count), &result.report);
        curvature.read(result.values.data(), count * sizeof(float));
    });
    return result;
}

void reportMesh(Run& run, const PelMeshReport& r) {
    run.report["vertices"] = r.vertices;
    run.report["triangles"] = r.triangles;
    run.report["unique_positions"] = r.uniquePositions;
    run.report["edges"] = r.edges;
    run.report["border_edges"] = r.borderEdges;
    run.report["inconsistent_edges"] = r.inconsistentEdges;  // the reader has warned of them
    run.report["low_degree_fits"] = r.lowDegreeFits;
    const struct {
        const char* key;
        uint32_t count;
        const char* what;
    } oddities[] = {
        {"nonmanifold_edges", r.nonManifoldEdges,
         "edges belong to three or more triangles; all of them count"},
        {"unreferenced_vertices", r.unreferencedVertices,
         "vertices are in no triangle; their curvature is 0"},
        {"degenerate_triangles", r.degenerateTriangles, "triangles repeat an index and were skipped"},
        {"zero_length_edges", r.zeroLengthEdges, "edges have no length and were skipped"},
        {"nonfinite_positions", r.nonFinitePositions, "positions are not finite; edges to them were skipped"},
        {"nonfinite_normals", r.nonFiniteNormals,
         "normals are zero or not finite; edges to them were skipped"}};
    for (const auto& [key, count, what] : oddities) {
        run.report[key] = count;
        if (count > 0) run.warn(io::concat(count, " ", what));
    }
}

float percentile(std::vector<float> values, double share) {
    if (values.empty()) return 0;
    const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace pellucid::cli
