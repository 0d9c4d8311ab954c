// The oracle's meshes as the library's.
#pragma once
#include "mesh_shapes.h"
#include "reference/curvature.h"
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

}  // namespace fixture
