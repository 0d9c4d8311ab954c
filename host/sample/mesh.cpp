#include "sample/mesh.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace pellucid::sample {
namespace {

void addVertex(Mesh& mesh, Vec3 position, Vec3 normal, double u, double v, double curvature) {
    for (double x : {position.x, position.y, position.z}) mesh.positions.push_back(float(x));
    for (double x : {normal.x, normal.y, normal.z}) mesh.normals.push_back(float(x));
    mesh.uvs.push_back(float(u));
    mesh.uvs.push_back(float(v));
    mesh.curvature.push_back(float(curvature));
}

// Two triangles per cell of a (rows + 1) x (columns + 1) grid of vertices, without empty ones at poles.
void addGrid(Mesh& mesh, int rows, int columns, bool poles) {
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) {
            const uint32_t a = uint32_t(i * (columns + 1) + j), b = a + 1, c = a + uint32_t(columns) + 1,
                           d = c + 1;
            if (!poles || i > 0) mesh.triangles.insert(mesh.triangles.end(), {a, c, b});
            if (!poles || i + 1 < rows) mesh.triangles.insert(mesh.triangles.end(), {b, c, d});
        }
}

void checkLength(const char* what, size_t length, size_t expected, bool optional) {
    if (length == expected || (optional && length == 0)) return;
    throw std::invalid_argument(std::string("mesh: ") + what + " holds " + std::to_string(length) +
                                " values, but " + std::to_string(expected) + " would fit the mesh");
}

}  // namespace

void Mesh::append(const Mesh& other) {
    const auto first = uint32_t(positions.size() / 3);
    for (auto member : {&Mesh::positions, &Mesh::normals, &Mesh::uvs, &Mesh::curvature})
        (this->*member).insert((this->*member).end(), (other.*member).begin(), (other.*member).end());
    for (uint32_t index : other.triangles) triangles.push_back(first + index);
    materials.insert(materials.end(), other.materials.begin(), other.materials.end());
}

void Bounds::add(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
}

Bounds boundsOf(const MeshView& mesh) {
    Bounds bounds;
    for (uint32_t index : mesh.triangles) {
        const float* p = &mesh.positions[3 * size_t(index)];
        bounds.add({p[0], p[1], p[2]});
    }
    return bounds;
}

void checkMesh(const MeshView& mesh) {
    const size_t vertices = mesh.positions.size() / 3, triangles = mesh.triangles.size() / 3;
    checkLength("positions", mesh.positions.size(), 3 * vertices, false);
    checkLength("triangles", mesh.triangles.size(), 3 * triangles, false);
    checkLength("normals", mesh.normals.size(), 3 * vertices, true);
    checkLength("uvs", mesh.uvs.size(), 2 * vertices, true);
    checkLength("curvature", mesh.curvature.size(), vertices, true);
    checkLength("materials", mesh.materials.size(), triangles, true);
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
        const size_t vertex = mesh.triangles[i];
        const std::string where =
            "mesh: triangle " + std::to_string(i / 3) + " has vertex " + std::to_string(vertex);
        if (vertex >= vertices)
            throw std::invalid_argument(where + ", but there are only " + std::to_string(vertices) +
                                        " vertices");
        for (int k = 0; k < 3; ++k)
            if (!std::isfinite(mesh.positions[3 * vertex + k]))
                throw std::invalid_argument(where + ", whose position is not finite");
    }
}

Mesh makeSphere(double radius, int rings, int segments, Vec3 centre) {
    Mesh mesh;
    for (int i = 0; i <= rings; ++i)
        for (int j = 0; j <= segments; ++j) {
            const double theta = pi * i / rings, phi = 2 * pi * j / segments;
            const Vec3 n{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
            addVertex(mesh, centre + n * radius, n, double(j) / segments, double(i) / rings, 1 / radius);
        }
    addGrid(mesh, rings, segments, true);
    return mesh;
}

Mesh makeRectangle(double x0, double x1, double y0, double y1, double z) {
    Mesh mesh;
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) addVertex(mesh, {j ? x1 : x0, i ? y0 : y1, z}, {0, 0, 1}, j, i, 0);
    addGrid(mesh, 1, 1, false);
    return mesh;
}

}  // namespace pellucid::sample
