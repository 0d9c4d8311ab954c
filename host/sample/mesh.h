// Triangle meshes as the sample renderer takes them, and analytic ones for tests. Lengths are in mm by
// convention; any unit works if it is used throughout.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "sample/vector.h"

namespace pellucid::sample {

// Arrays that the caller keeps.
struct MeshView {
    std::span<const float> positions;     // xyz per vertex, mm
    std::span<const float> normals;       // unit xyz per vertex; empty: the normal of each triangle
    std::span<const float> uvs;           // u, v per vertex, or empty
    std::span<const float> curvature;     // 1/mm per vertex, or empty: 0
    std::span<const uint32_t> triangles;  // three vertex indices each
    std::span<const uint32_t> materials;  // id per triangle, 1 to 255; empty: all 1
};

struct Mesh {
    std::vector<float> positions, normals, uvs, curvature;
    std::vector<uint32_t> triangles, materials;

    MeshView view() const { return {positions, normals, uvs, curvature, triangles, materials}; }
    void append(const Mesh& other);  // both have the same optional arrays
    std::array<Vec3, 3> corners(uint32_t triangle) const { return atCorners(positions, triangle); }
    // Normals or positions.
    std::array<Vec3, 3> atCorners(const std::vector<float>& values, uint32_t triangle) const {
        const auto at = [&](int k) {
            const float* v = &values[3 * size_t(triangles[3 * size_t(triangle) + k])];
            return Vec3{v[0], v[1], v[2]};
        };
        return {at(0), at(1), at(2)};
    }
};

struct Bounds {
    Vec3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};

    bool empty() const { return !(low.x <= high.x); }
    Vec3 centre() const { return empty() ? Vec3{} : (low + high) * 0.5; }
    Vec3 corner(int i) const {
        return {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z};
    }
    void add(Vec3 p);
};
Bounds boundsOf(const MeshView& mesh);  // of the vertices that triangles use

// Throws std::invalid_argument unless array lengths fit together, indices exist and positions are finite.
void checkMesh(const MeshView& mesh);

// Normals, UVs and curvature are those of the smooth surface, exact at the vertices.
Mesh makeSphere(double radius, int rings, int segments, Vec3 centre = {});
// A rectangle in the plane z, facing +z.
Mesh makeRectangle(double x0, double x1, double y0, double y1, double z);

}  // namespace pellucid::sample
