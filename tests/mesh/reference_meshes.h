// The oracle's meshes as the library's.
#pragma once
#include "mesh_shapes.h"
#include "reference/surfaces.h"

namespace fixture {

// The float mesh, and the oracle's mesh with exactly the same numbers in it.
struct Pair {
    Mesh mesh;
    reference::Mesh exact;
};

inline Pair pairOf(reference::Mesh exact) {
    Pair pair;
    const auto round = [](std::vector<float>& to, reference::Vec3& v) {
        for (int k = 0; k < 3; ++k) {
            to.push_back(float(v[k]));
            v[k] = to.back();
        }
    };
    for (reference::Vec3& p : exact.positions) round(pair.mesh.positions, p);
    for (reference::Vec3& n : exact.normals) round(pair.mesh.normals, n);
    for (reference::Vec2& uv : exact.uvs) {
        pair.mesh.uvs.insert(pair.mesh.uvs.end(), {float(uv.x), float(uv.y)});
        uv = {pair.mesh.uvs.end()[-2], pair.mesh.uvs.end()[-1]};
    }
    for (const reference::Triangle& t : exact.triangles)
        pair.mesh.indices.insert(pair.mesh.indices.end(), t.begin(), t.end());
    pair.exact = std::move(exact);
    return pair;
}

inline Mesh sampled(const reference::Surface& surface, int columns, int rows,
                    reference::Tessellation kind = reference::Tessellation::irregular) {
    return pairOf(tessellate(surface, columns, rows, kind).mesh).mesh;
}

inline Mesh irregularTorus(int columns, int rows) {
    return sampled(reference::torusSurface(3, 1), columns, rows);
}

inline reference::Mesh exactOf(const Mesh& mesh) {
    reference::Mesh exact;
    for (uint32_t v = 0; v < mesh.vertices(); ++v) {
        const float *p = &mesh.positions[3 * v], *n = &mesh.normals[3 * v];
        exact.positions.push_back({p[0], p[1], p[2]});
        exact.normals.push_back({n[0], n[1], n[2]});
        if (!mesh.uvs.empty()) exact.uvs.push_back({mesh.uvs[2 * v], mesh.uvs[2 * v + 1]});
    }
    for (size_t t = 0; t < mesh.indices.size(); t += 3)
        exact.triangles.push_back({int(mesh.indices[t]), int(mesh.indices[t + 1]), int(mesh.indices[t + 2])});
    return exact;
}

}  // namespace fixture
