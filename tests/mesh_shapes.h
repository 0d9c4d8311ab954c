// Meshes for tests and benchmarks.
#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

namespace fixture {

struct Mesh {
    std::vector<float> positions, normals, uvs;  // 3, 3 and 2 per vertex
    std::vector<uint32_t> indices;
    uint32_t vertices() const { return uint32_t(positions.size() / 3); }
};

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

}  // namespace fixture
