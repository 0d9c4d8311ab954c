// A torus stretched, scaled and moved away from the origin: float positions lose what the distance takes.
#pragma once
#include "reference/curvature.h"
#include "reference/surfaces.h"

#include "stability.h"

namespace stability {

constexpr const char* meshRange =
    "size 1e-5 to 1e7 units, up to 500 sizes away from the origin, flattened down to 0.02";

class MovedMesh : public Case {
  public:
    explicit MovedMesh(const Point& p, reference::Tessellation kind = reference::Tessellation::irregular) {
        scale = logBetween(p[0], 1e-6, 1e6);
        const double away = p[1] < 0.1 ? 0 : logBetween(p[1], 1e-3, 1e3), flat = logBetween(p[2], 0.02, 1);
        mesh =
            reference::tessellate(reference::torusSurface(3, 1), 24, 14, kind, uint32_t(1 + p[3] * 8)).mesh;
        for (auto& v : mesh.positions) {
            v = {scale * (v.x + 4 * away), scale * v.y, scale * flat * v.z};
            for (int i = 0; i < 3; ++i) positions.push_back(float(v[i]));
        }
        accept();
        for (auto& n : reference::estimatedNormals(mesh))
            for (int i = 0; i < 3; ++i) normals.push_back(float(n[i]));
        accept();
        std::vector<uint32_t> indices;
        for (const auto& t : mesh.triangles)
            indices.insert(indices.end(), {uint32_t(t[0]), uint32_t(t[1]), uint32_t(t[2])});
        PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
        desc.numVertices = count();
        desc.indices = indices.data();
        desc.numIndices = indices.size();
        topology = MeshTopology(device(), desc);
        place = text("size %.2g, distance from the origin %.2g sizes, flattened to %.2g", 8 * scale, away / 2,
                     flat);
    }
    void move(Jitter& j) override {
        j(positions), j(normals);
        accept();
    }
    std::string where() override { return place; }

  protected:
    uint32_t count() const { return uint32_t(mesh.positions.size()); }
    // The oracle gets the floats.
    void accept() {
        mesh.normals.resize(normals.size() / 3);
        for (size_t i = 0; i < positions.size(); ++i) mesh.positions[i / 3][int(i % 3)] = positions[i];
        for (size_t i = 0; i < normals.size(); ++i) mesh.normals[i / 3][int(i % 3)] = normals[i];
    }
    std::vector<float> curvature(const PelCurvatureParams& params, uint32_t floats = 1) const {
        const Buffer at(device(), positions), n(device(), normals), out(device(), count() * floats * 4);
        topology.curvature(params, vertexView(at, count()), vertexView(n, count()), vertexView(out, count()));
        return out.readAll<float>();
    }

    reference::Mesh mesh;
    std::vector<float> positions, normals;
    MeshTopology topology;
    double scale;
    std::string place;
};

}  // namespace stability
