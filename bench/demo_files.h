// What `./run demo` leaves, for benchmarks and figures: where it is, and the head as `pellucid demo` places it.
#pragma once
#include <pellucid/pellucid.hpp>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "io/mesh/mesh_parts.h"

namespace demo {

inline std::string named(const char* variable, const char* otherwise) {
    const char* value = std::getenv(variable);
    return value && *value ? value : otherwise;
}

inline std::string directory() {
    return named("PELLUCID_DEMO_DIR", PELLUCID_SOURCE_DIR "/out/demo");
}

inline std::string meshFile() {
    return named("PELLUCID_DEMO_MESH", PELLUCID_SOURCE_DIR "/data/heads/head_female.obj");
}

// All parts of one of the heads in data/heads, with normals.
inline pellucid::io::MeshData head(const std::string& file) {
    return pellucid::io::loadParts(file, 2).mesh;
}

inline std::vector<float> curvature(const pellucid::Device& device, const pellucid::io::MeshData& mesh,
                                    const PelCurvatureParams& params) {
    using namespace pellucid;
    const auto n = uint32_t(mesh.vertexCount());
    PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
    desc.numVertices = n;
    desc.indices = mesh.triangles.data();
    desc.numIndices = mesh.triangles.size();
    const MeshTopology topology(device, desc);
    const Buffer positions(device, mesh.positions), normals(device, mesh.normals),
        out(device, n * sizeof(float));
    topology.curvature(params, vertexView(positions, n), vertexView(normals, n), vertexView(out, n));
    return out.readAll<float>();
}

// The demo's skin takes transmission from its profile. Measurements of thickness taps need deep scatter by a colour.
inline PelMaterial withDeepScatter(PelMaterial material) {
    constexpr float color[3] = {0.6f, 0.08f, 0.02f};
    std::copy_n(color, 3, material.deepScatterColor);
    return material;
}

}  // namespace demo
