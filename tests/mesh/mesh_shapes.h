// Meshes for tests and benchmarks.
#pragma once
#include "test.h"

namespace fixture {

struct Mesh {
    std::vector<float> positions, normals, uvs;  // 3, 3 and 2 per vertex
    std::vector<uint32_t> indices;
    uint32_t vertices() const { return uint32_t(positions.size() / 3); }
    void vertex(std::initializer_list<float> position, std::initializer_list<float> normal = {0, 0, 1}) {
        positions.insert(positions.end(), position);
        normals.insert(normals.end(), normal);
    }
    void triangles(std::initializer_list<uint32_t> corners) { indices.insert(indices.end(), corners); }
    // Behind the others, moved along x.
    void append(const Mesh& other, float dx = 0) {
        for (uint32_t index : other.indices) indices.push_back(vertices() + index);
        for (size_t i = 0; i < other.positions.size(); ++i)
            positions.push_back(other.positions[i] + (i % 3 ? 0 : dx));
        normals.insert(normals.end(), other.normals.begin(), other.normals.end());
    }
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
            mesh.triangles({p, q, r, p, r, s});
        }
    return mesh;
}

// (columns + 1) x (rows + 1) vertices on the integers of the plane, all triangles facing up.
inline Mesh grid(uint32_t columns, uint32_t rows) {
    Mesh mesh;
    for (uint32_t y = 0; y <= rows; ++y)
        for (uint32_t x = 0; x <= columns; ++x) {
            const uint32_t p = y * (columns + 1) + x, q = p + columns + 1;
            mesh.vertex({float(x), float(y), 0});
            if (x < columns && y < rows) mesh.triangles({p, p + 1, q + 1, p, q + 1, q});
        }
    return mesh;
}

// The same surface with three vertices of its own for every triangle, as STL files have them.
inline Mesh soupOf(const Mesh& mesh) {
    Mesh soup;
    for (uint32_t index : mesh.indices) {
        soup.indices.push_back(soup.vertices());
        soup.positions.insert(soup.positions.end(), &mesh.positions[3 * index],
                              &mesh.positions[3 * index] + 3);
        soup.normals.insert(soup.normals.end(), &mesh.normals[3 * index], &mesh.normals[3 * index] + 3);
    }
    return soup;
}

// Rings of latitude round the z axis, closed by a vertex at each pole, which comes first and last: near the
// poles triangles are slivers.
inline Mesh latLongSphere(uint32_t rings, uint32_t columns, double radius) {
    Mesh mesh;
    const double pi = 3.14159265358979323846;
    const auto add = [&](double colatitude, double longitude) {
        const double x = std::sin(colatitude) * std::cos(longitude),
                     y = std::sin(colatitude) * std::sin(longitude), z = std::cos(colatitude);
        mesh.vertex({float(radius * x), float(radius * y), float(radius * z)},
                    {float(x), float(y), float(z)});
    };
    add(0, 0);
    for (uint32_t i = 1; i < rings; ++i)
        for (uint32_t j = 0; j < columns; ++j) add(pi * i / rings, 2 * pi * j / columns);
    add(pi, 0);
    const uint32_t last = mesh.vertices() - 1;
    const auto at = [&](uint32_t i, uint32_t j) { return 1 + (i - 1) * columns + j % columns; };
    for (uint32_t j = 0; j < columns; ++j) {
        mesh.triangles({0u, at(1, j), at(1, j + 1)});
        for (uint32_t i = 1; i + 1 < rings; ++i)
            mesh.triangles(
                {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        mesh.triangles({last, at(rings - 1, j + 1), at(rings - 1, j)});
    }
    return mesh;
}

// The same surface with its vertices in random order: vertex v becomes newOf[v].
struct Shuffled {
    Mesh mesh;
    std::vector<uint32_t> newOf;
    std::vector<float> inOldOrder(const std::vector<float>& values) const {
        std::vector<float> back(newOf.size());
        for (uint32_t v = 0; v < newOf.size(); ++v) back[v] = values[newOf[v]];
        return back;
    }
};

inline Shuffled shuffleVertices(const Mesh& mesh, uint32_t seed) {
    Shuffled s{mesh, std::vector<uint32_t>(mesh.vertices())};
    for (uint32_t i = 0; i < s.newOf.size(); ++i) s.newOf[i] = i;
    std::shuffle(s.newOf.begin(), s.newOf.end(), std::mt19937(seed));
    for (uint32_t v = 0; v < s.newOf.size(); ++v) {
        std::copy_n(&mesh.positions[3 * v], 3, &s.mesh.positions[3 * s.newOf[v]]);
        std::copy_n(&mesh.normals[3 * v], 3, &s.mesh.normals[3 * s.newOf[v]]);
    }
    for (uint32_t& index : s.mesh.indices) index = s.newOf[index];
    return s;
}

}  // namespace fixture
