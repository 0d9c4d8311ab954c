#include "reference/scattered.h"

#include <boost/polygon/voronoi.hpp>
#include <map>
#include <random>

namespace reference {

std::vector<Vec2> uniformPoints(int count, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<Vec2> points(static_cast<size_t>(count));
    for (Vec2& p : points) p.x = unit(random), p.y = unit(random);
    return points;
}

FlatMesh delaunay(const std::vector<Vec2>& points) {
    std::vector<boost::polygon::point_data<int>> sites;
    for (Vec2 p : points) sites.emplace_back(int(std::lround(p.x * 0x1p30)), int(std::lround(p.y * 0x1p30)));
    boost::polygon::voronoi_diagram<double> diagram;
    boost::polygon::construct_voronoi(sites.begin(), sites.end(), &diagram);
    FlatMesh mesh{points, {}};
    for (const auto& vertex : diagram.vertices()) {
        // The cells round it, counter-clockwise; more than three where points lie on one circle.
        const auto* const first = vertex.incident_edge();
        const auto corner = [](const auto* edge) { return int(edge->cell()->source_index()); };
        for (const auto* edge = first->rot_next(); edge->rot_next() != first; edge = edge->rot_next())
            mesh.triangles.push_back({corner(first), corner(edge), corner(edge->rot_next())});
    }
    return mesh;
}

FlatMesh flatGrid(int columns, int rows) {
    FlatMesh mesh;
    for (int y = 0; y <= rows; ++y)
        for (int x = 0; x <= columns; ++x) mesh.points.push_back({double(x) / columns, double(y) / rows});
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const int a = y * (columns + 1) + x, b = a + 1, d = a + columns + 1, c = d + 1;
            mesh.triangles.insert(mesh.triangles.end(), {Triangle{a, b, c}, Triangle{a, c, d}});
        }
    return mesh;
}

FlatMesh poked(const FlatMesh& mesh, double part, int rounds, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    FlatMesh out{mesh.points, {}};
    std::vector<Triangle> open = mesh.triangles;
    for (int round = 0; round < rounds; ++round) {
        std::vector<Triangle> next;
        for (const Triangle& t : open) {
            if (unit(random) >= part) {
                out.triangles.push_back(t);
                continue;
            }
            const Vec2 a = out.points[size_t(t[0])], b = out.points[size_t(t[1])],
                       c = out.points[size_t(t[2])];
            const int centre = int(out.points.size());
            out.points.push_back({(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3});
            for (int i = 0; i < 3; ++i) next.push_back({t[i], t[(i + 1) % 3], centre});
        }
        open = std::move(next);
    }
    out.triangles.insert(out.triangles.end(), open.begin(), open.end());
    return out;
}

AnalyticMesh lifted(const FlatMesh& mesh, const Surface& surface) {
    AnalyticMesh out;
    for (Vec2 p : mesh.points) {
        out.truth.push_back(surface.at(surface.uBegin + p.x * (surface.uEnd - surface.uBegin),
                                       surface.vBegin + p.y * (surface.vEnd - surface.vBegin)));
        out.mesh.positions.push_back(out.truth.back().position);
        out.mesh.normals.push_back(out.truth.back().normal);
    }
    out.mesh.triangles = mesh.triangles;
    // Parameters may turn the other way round than the surface's outside; slivers at the hull may as well.
    double outwards = 0;
    const auto& p = out.mesh.positions;
    for (const auto& [a, b, c] : mesh.triangles)
        outwards +=
            dot(cross(p[size_t(b)] - p[size_t(a)], p[size_t(c)] - p[size_t(a)]), out.mesh.normals[size_t(a)]);
    if (outwards < 0)
        for (Triangle& turned : out.mesh.triangles) std::swap(turned[1], turned[2]);
    return out;
}

std::vector<bool> nearBorder(const Mesh& mesh, int rows) {
    std::map<std::pair<int, int>, int> triangles;
    forCorners(mesh, [&](int a, int b, int) { ++triangles[std::minmax(a, b)]; });
    std::vector<bool> near(mesh.positions.size());
    for (const auto& [edge, count] : triangles)
        if (count == 1) near[size_t(edge.first)] = near[size_t(edge.second)] = true;
    for (int row = 1; row < rows; ++row) {
        std::vector<bool> next = near;
        for (const auto& [edge, count] : triangles)
            if (near[size_t(edge.first)] || near[size_t(edge.second)])
                next[size_t(edge.first)] = next[size_t(edge.second)] = true;
        near.swap(next);
    }
    return near;
}

}  // namespace reference
