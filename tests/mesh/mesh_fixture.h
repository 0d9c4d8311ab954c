// The meshes of the reference data, and one-line calls of the mesh operations, for tests.
#pragma once
#include "mesh_calls.h"
#include "npy.h"

namespace fixture {

inline Mesh oracleMesh(const std::filesystem::path& directory, const std::string& name) {
    const auto file = [&](const char* what) { return directory / ("mesh_" + name + "_" + what + ".npy"); };
    Mesh mesh;
    mesh.positions = npy::read<float>(file("pos_f32")).data;
    mesh.normals = npy::read<float>(file("nrm_f32")).data;
    mesh.uvs = npy::read<float>(file("uv_f32")).data;
    const std::vector<int32_t> indices = npy::read<int32_t>(file("idx_i32")).data;
    mesh.indices.assign(indices.begin(), indices.end());
    return mesh;
}

// A mesh's data on the device, and room for results of `floats` per vertex.
struct OnDevice {
    explicit OnDevice(const Mesh& mesh, uint32_t floatsPerVertex = 1)
        : n(mesh.vertices()),
          floats(floatsPerVertex),
          positions(device(), mesh.positions),
          normals(device(), mesh.normals),
          out(device(), std::vector<float>(size_t(n) * floats, -1)) {}
    PelVertexView at() const { return vertexView(positions, n); }
    PelVertexView normalsAt() const { return vertexView(normals, n); }
    PelVertexView result() const { return vertexView(out, n); }
    // By these normals, or by made ones.
    std::vector<float> curvature(const pellucid::MeshTopology& topology, const PelCurvatureParams& params,
                                 bool made = false, PelMeshReport* report = nullptr) const {
        made ? topology.curvature(params, at(), result(), report)
             : topology.curvature(params, at(), normalsAt(), result(), report);
        return out.readAll<float>();
    }
    uint32_t n, floats;
    pellucid::Buffer positions, normals, out;
};

struct Result {
    std::vector<float> values;
    PelMeshReport report;
};

// `floats`: what the quantity has per vertex.
inline Result curvature(const Mesh& mesh, const PelMeshTopologyDesc& desc, const PelCurvatureParams& params,
                        uint32_t floats = 1) {
    Result result{{}, pelMeshReportDefaults()};
    const pellucid::MeshTopology topology(device(), desc);
    result.values = OnDevice(mesh, floats).curvature(topology, params, false, &result.report);
    return result;
}

inline std::vector<float> valuesOf(const Mesh& mesh, const PelCurvatureParams& params, uint32_t floats = 1) {
    return curvature(mesh, topologyDesc(mesh), params, floats).values;
}

inline Result edgeCurvature(const Mesh& mesh, uint32_t passes) {
    return curvature(mesh, topologyDesc(mesh), edgeParams(passes));
}

// Made by the device; `stride`: floats from one position to the next.
inline std::vector<float> normalsOf(const Mesh& mesh, uint32_t stride = 3) {
    using namespace pellucid;
    const uint32_t n = mesh.vertices();
    std::vector<float> strided(size_t(n) * stride);
    for (uint32_t v = 0; v < n; ++v) std::copy_n(&mesh.positions[3 * v], 3, &strided[size_t(v) * stride]);
    const Buffer positions(device(), strided), out(device(), n * 12);
    MeshTopology(device(), topologyDesc(mesh))
        .normals(vertexView(positions, n, 0, stride * 4), vertexView(out, n));
    return out.readAll<float>();
}

inline float uvScale(const Mesh& mesh) {
    using namespace pellucid;
    const MeshTopology topology(device(), topologyDesc(mesh));
    const Buffer positions(device(), mesh.positions), uvs(device(), mesh.uvs);
    return topology.uvScale(vertexView(positions, mesh.vertices()), vertexView(uvs, mesh.vertices()));
}

// The largest difference, relative to the largest expected value.
template <class Expected>
double relativeError(const std::vector<float>& actual, const Expected& expected) {
    double largest = 0, difference = 0;
    for (size_t i = 0; i < actual.size(); ++i) {
        largest = std::max(largest, std::abs(double(expected[i])));
        const double d = std::abs(double(actual[i]) - double(expected[i]));
        difference = d <= difference ? difference : d;  // a NaN stays
    }
    return difference / largest;
}

inline void expectFinite(const std::vector<float>& values) {
    for (size_t i = 0; i < values.size(); ++i)
        ASSERT_TRUE(std::isfinite(values[i])) << "vertex " << i << ": " << values[i];
}

}  // namespace fixture
