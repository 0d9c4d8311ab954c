// The meshes of the reference data, and one-line calls of the mesh operations, for tests.
#pragma once
#include <gtest/gtest.h>

#include <pellucid/pellucid.hpp>

#include <cmath>

#include "mesh_calls.h"
#include "npy.h"
#include "test_size.h"

namespace fixture {

inline const pellucid::Device& device() {
    static const pellucid::Device device("");
    return device;
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

struct Result {
    std::vector<float> values;
    PelMeshReport report;
};

// `floats`: what the quantity has per vertex.
inline Result curvature(const Mesh& mesh, const PelMeshTopologyDesc& desc, const PelCurvatureParams& params,
                        uint32_t floats = 1) {
    using namespace pellucid;
    const MeshTopology topology(device(), desc);
    const Buffer positions(device(), mesh.positions), normals(device(), mesh.normals);
    const Buffer out(device(), mesh.vertices() * floats * sizeof(float));
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
