#include "reference/curvature.h"

#include <limits>

namespace reference {

std::vector<double> edgeCurvature(const Mesh& mesh) {
    const double none = std::numeric_limits<double>::infinity();
    std::vector<double> least(mesh.positions.size(), none), most(mesh.positions.size(), -none);
    for (const Triangle& triangle : mesh.triangles)
        for (int i = 0; i < 3; ++i) {
            const int a = triangle[i], b = triangle[(i + 1) % 3];
            const double distance = length(mesh.positions[b] - mesh.positions[a]);
            if (!(distance > 0)) continue;
            const double curvature = length(mesh.normals[b] - mesh.normals[a]) / distance;
            for (int v : {a, b}) {
                least[v] = std::min(least[v], curvature);
                most[v] = std::max(most[v], curvature);
            }
        }
    std::vector<double> values(mesh.positions.size(), 0.0);
    for (size_t v = 0; v < values.size(); ++v)
        if (most[v] >= 0) values[v] = 0.5 * (least[v] + most[v]);
    return values;
}

std::vector<double> smoothed(const Mesh& mesh, std::vector<double> values, int passes) {
    for (int pass = 0; pass < passes; ++pass) {
        std::vector<double> sum(values.size(), 0.0);
        std::vector<int> count(values.size(), 0);
        for (const Triangle& triangle : mesh.triangles)
            for (int i = 0; i < 3; ++i) {
                sum[triangle[i]] += values[triangle[(i + 1) % 3]] + values[triangle[(i + 2) % 3]];
                count[triangle[i]] += 2;
            }
        for (size_t v = 0; v < values.size(); ++v) values[v] = count[v] > 0 ? sum[v] / count[v] : 0.0;
    }
    return values;
}

double uvScale(const Mesh& mesh) {
    if (mesh.uvs.size() != mesh.positions.size()) return 0;
    auto longest = [&](const Triangle& triangle, const auto& distance) {
        double edge = 0;
        for (int i = 0; i < 3; ++i) edge = std::max(edge, distance(triangle[i], triangle[(i + 1) % 3]));
        return edge;
    };
    auto inSpace = [&](int a, int b) { return length(mesh.positions[b] - mesh.positions[a]); };
    auto inUv = [&](int a, int b) {
        return std::hypot(mesh.uvs[b].x - mesh.uvs[a].x, mesh.uvs[b].y - mesh.uvs[a].y);
    };
    double largest = 0, largestUv = 0;
    for (const Triangle& triangle : mesh.triangles) {
        largest = std::max(largest, longest(triangle, inSpace));
        largestUv = std::max(largestUv, longest(triangle, inUv));
    }
    double logarithms = 0;
    int count = 0;
    for (const Triangle& triangle : mesh.triangles) {
        const double edge = longest(triangle, inSpace), uvEdge = longest(triangle, inUv);
        if (!(edge > 0 && uvEdge > 0 && edge >= 1e-6 * largest && uvEdge >= 1e-6 * largestUv)) continue;
        logarithms += std::log(edge / uvEdge);
        ++count;
    }
    return count > 0 ? std::exp(logarithms / count) : 0.0;
}

std::vector<Vec3> estimatedNormals(const Mesh& mesh) {
    std::vector<Vec3> normals(mesh.positions.size());
    for (const Triangle& triangle : mesh.triangles)
        for (int i = 0; i < 3; ++i) {
            const Vec3 corner = mesh.positions[triangle[i]];
            const Vec3 one = mesh.positions[triangle[(i + 1) % 3]] - corner;
            const Vec3 two = mesh.positions[triangle[(i + 2) % 3]] - corner;
            const Vec3 across = cross(one, two);
            if (!(length(across) > 0)) continue;
            const double angle = std::atan2(length(across), dot(one, two));
            normals[triangle[i]] = normals[triangle[i]] + angle * normalized(across);
        }
    for (Vec3& normal : normals)
        if (length(normal) > 0) normal = normalized(normal);
    return normals;
}

}  // namespace reference
