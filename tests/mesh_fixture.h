// Small meshes, and one-line calls of the mesh operations, for tests.
#pragma once
#include <gtest/gtest.h>

#include <pellucid/pellucid.hpp>

#include <cmath>
#include <random>

#include "npy.h"

namespace fixture {

struct Mesh {
    std::vector<float> positions, normals, uvs;  // 3, 3 and 2 per vertex
    std::vector<uint32_t> indices;
    uint32_t vertices() const { return uint32_t(positions.size() / 3); }
};

inline const pellucid::Device& device() {
    static const pellucid::Device device("");
    return device;
}

// An (a, b) torus of rings x sides vertices, closed both ways.
inline Mesh torus(uint32_t rings, uint32_t sides, double a = 3, double b = 1) {
    Mesh mesh;
    const double pi = 3.14159265358979323846;
    for (uint32_t i = 0; i < rings; ++i)
        for (uint32_t j = 0; j < sides; ++j) {
            const double u = 2 * pi * i / rings, v = 2 * pi * j / sides;
            const double n[3] = {std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v)};
            const double c[3] = {a * std::cos(u), a * std::sin(u), 0};
            for (int k = 0; k < 3; ++k) {
                mesh.positions.push_back(float(c[k] + b * n[k]));
                mesh.normals.push_back(float(n[k]));
            }
            mesh.uvs.push_back(float(i) / float(rings));
            mesh.uvs.push_back(float(j) / float(sides));
            const uint32_t i1 = (i + 1) % rings, j1 = (j + 1) % sides;
            const uint32_t p = i * sides + j, q = i1 * sides + j, r = i1 * sides + j1, s = i * sides + j1;
            mesh.indices.insert(mesh.indices.end(), {p, q, r, p, r, s});
        }
    return mesh;
}

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

inline PelMeshTopologyDesc topologyDesc(const Mesh& mesh) {
    PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
    desc.numVertices = mesh.vertices();
    desc.indices = mesh.indices.data();
    desc.numIndices = mesh.indices.size();
    desc.positions = mesh.positions.data();
    return desc;
}

inline PelMeshTopologyDesc weldedDesc(const Mesh& mesh, float tolerance = 0) {
    PelMeshTopologyDesc desc = topologyDesc(mesh);
    desc.weld = tolerance > 0 ? PEL_WELD_TOLERANCE : PEL_WELD_EXACT;
    desc.weldTolerance = tolerance;
    return desc;
}

inline PelCurvatureParams edgeParams(uint32_t passes, float scale = 1) {
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.estimator = PEL_CURVATURE_EDGE;
    params.smoothingPasses = passes;
    params.scale = scale;
    return params;
}

struct Result {
    std::vector<float> values;
    PelMeshReport report;
};

inline Result curvature(const Mesh& mesh, const PelMeshTopologyDesc& desc, const PelCurvatureParams& params) {
    using namespace pellucid;
    const MeshTopology topology(device(), desc);
    const Buffer positions(device(), mesh.positions), normals(device(), mesh.normals);
    const Buffer out(device(), mesh.vertices() * sizeof(float));
    Result result{{}, pelMeshReportDefaults()};
    const uint32_t n = mesh.vertices();
    topology.curvature(params, vertexView(positions, n), vertexView(normals, n), vertexView(out, n),
                       &result.report);
    result.values = out.readAll<float>();
    return result;
}

inline Result edgeCurvature(const Mesh& mesh, uint32_t passes) {
    return curvature(mesh, topologyDesc(mesh), edgeParams(passes));
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
