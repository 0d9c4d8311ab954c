#include <map>
#include <random>

#include "reference/surfaces.h"

namespace reference {
namespace {

void appendFacing(AnalyticMesh& out, int a, int b, int c) {
    const auto& p = out.mesh.positions;
    const Vec3 across = cross(p[b] - p[a], p[c] - p[a]);
    if (dot(across, out.mesh.normals[a]) < 0) std::swap(b, c);
    out.mesh.triangles.push_back({a, b, c});
}

void appendVertex(AnalyticMesh& out, const SurfacePoint& point) {
    out.mesh.positions.push_back(point.position);
    out.mesh.normals.push_back(point.normal);
    out.truth.push_back(point);
}

}  // namespace

AnalyticMesh tessellate(const Surface& surface, int columns, int rows, Tessellation kind, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> jitter(-0.4, 0.4);  // 80 % of half a cell either way
    const bool moved = kind == Tessellation::irregular;
    AnalyticMesh out;
    const int across = surface.wrapsU ? columns : columns + 1, down = surface.wrapsV ? rows : rows + 1;
    for (int y = 0; y < down; ++y)
        for (int x = 0; x < across; ++x) {
            const bool border =
                (!surface.wrapsU && (x == 0 || x == columns)) || (!surface.wrapsV && (y == 0 || y == rows));
            const double dx = jitter(random), dy = jitter(random);
            const Vec2 uv{(x + (moved && !border ? dx : 0)) / columns,
                          (y + (moved && !border ? dy : 0)) / rows};
            appendVertex(out, surface.at(surface.uBegin + uv.x * (surface.uEnd - surface.uBegin),
                                         surface.vBegin + uv.y * (surface.vEnd - surface.vBegin)));
            out.mesh.uvs.push_back(uv);
        }
    auto vertex = [&](int x, int y) { return (y % down) * across + x % across; };
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const int a = vertex(x, y), b = vertex(x + 1, y), c = vertex(x + 1, y + 1), d = vertex(x, y + 1);
            const bool rising = kind == Tessellation::regular     ? true
                                : kind == Tessellation::irregular ? (random() & 1)
                                                                  : (x + y) % 2 == 0;
            if (rising) {
                appendFacing(out, a, b, c);
                appendFacing(out, a, c, d);
            } else {
                appendFacing(out, b, c, d);
                appendFacing(out, b, d, a);
            }
        }
    return out;
}

AnalyticMesh icosphere(double a, double b, double c, int splits) {
    const double g = (1 + std::sqrt(5.0)) / 2;
    std::vector<Vec3> points{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                             {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    for (Vec3& p : points) p = normalized(p);
    // The faces of the solid: three points at the least distance from each other.
    std::vector<Triangle> triangles;
    const double edge = 1.1 * length(points[0] - points[1]);
    for (int i = 0; i < 12; ++i)
        for (int j = i + 1; j < 12; ++j)
            for (int k = j + 1; k < 12; ++k)
                if (length(points[i] - points[j]) < edge && length(points[j] - points[k]) < edge &&
                    length(points[k] - points[i]) < edge)
                    triangles.push_back({i, j, k});
    for (int split = 0; split < splits; ++split) {
        std::map<std::pair<int, int>, int> middles;
        auto middle = [&](int i, int j) {
            const auto [at, added] = middles.try_emplace(std::minmax(i, j), int(points.size()));
            if (added) points.push_back(normalized(points[i] + points[j]));
            return at->second;
        };
        std::vector<Triangle> finer;
        for (const auto& [i, j, k] : triangles) {
            const int ij = middle(i, j), jk = middle(j, k), ki = middle(k, i);
            for (const Triangle& t : {Triangle{i, ij, ki}, {j, jk, ij}, {k, ki, jk}, {ij, jk, ki}})
                finer.push_back(t);
        }
        triangles = std::move(finer);
    }
    AnalyticMesh out;
    for (Vec3 p : points) appendVertex(out, ellipsoidPoint(p, a, b, c));
    for (const auto& [i, j, k] : triangles) appendFacing(out, i, j, k);
    return out;
}

void addNoise(Mesh& mesh, double fraction, uint32_t seed) {
    std::vector<double> total(mesh.positions.size(), 0.0);
    std::vector<int> count(mesh.positions.size(), 0);
    for (const Triangle& triangle : mesh.triangles)
        for (int i = 0; i < 3; ++i) {
            const int a = triangle[i], b = triangle[(i + 1) % 3];
            for (int v : {a, b}) {
                total[v] += length(mesh.positions[b] - mesh.positions[a]);
                ++count[v];
            }
        }
    std::mt19937 random(seed);
    std::normal_distribution<double> gaussian;
    for (size_t v = 0; v < mesh.positions.size(); ++v)
        for (int i = 0; i < 3; ++i) {
            const double sample = gaussian(random);
            if (count[v] > 0) mesh.positions[v][i] += fraction * total[v] / count[v] * sample;
        }
    mesh.normals = estimatedNormals(mesh);
}

}  // namespace reference
