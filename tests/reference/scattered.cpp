#include "reference/scattered.h"

#include <map>
#include <random>

namespace reference {
namespace {

double across(Vec2 a, Vec2 b, Vec2 c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Whether d lies in the circle through a, b, c (counter-clockwise).
bool inCircle(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
    const auto row = [&](Vec2 p) {
        return Vec3{p.x - d.x, p.y - d.y, (p.x - d.x) * (p.x - d.x) + (p.y - d.y) * (p.y - d.y)};
    };
    return determinant(row(a), row(b), row(c)) > 0;
}

class Delaunay {
  public:
    explicit Delaunay(const std::vector<Vec2>& points) : points_(points) {
        const int count = int(points.size());
        // Far enough away to leave the hull alone but for slivers.
        points_.insert(points_.end(), {{-1000, -1000}, {2000, -1000}, {0.5, 2000}});
        nodes_.push_back({{count, count + 1, count + 2}, {-1, -1, -1}, false});
        // Along rows of cells, every other row backwards: the walk to the next point is short.
        std::vector<int> order(points.size());
        for (int i = 0; i < count; ++i) order[size_t(i)] = i;
        const int cells = std::max(1, int(std::sqrt(count / 4.0)));
        const auto key = [&](int i) {
            const int x = int(points[size_t(i)].x * cells), y = int(points[size_t(i)].y * cells);
            return std::pair(y, y % 2 ? -x : x);
        };
        std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
        for (int i : order) insert(i);
    }
    std::vector<Triangle> triangles() const {
        std::vector<Triangle> result;
        const int count = int(points_.size()) - 3;
        for (const Node& n : nodes_)
            if (!n.dead && n.corners[0] < count && n.corners[1] < count && n.corners[2] < count)
                result.push_back(n.corners);
        return result;
    }

  private:
    struct Node {
        Triangle corners;
        std::array<int, 3> beside;  // the triangle on the other side of the edge that faces corner i
        bool dead;
    };
    Vec2 at(int i) const { return points_[size_t(i)]; }
    int find(int point) const {
        for (int t = last_;;) {
            const Node& n = nodes_[size_t(t)];
            int i = 0;
            while (i < 3 && across(at(n.corners[(i + 1) % 3]), at(n.corners[(i + 2) % 3]), at(point)) >= 0)
                ++i;
            if (i == 3) return t;
            t = n.beside[size_t(i)];
        }
    }
    void insert(int point) {
        std::vector<int> open{find(point)};
        nodes_[size_t(open[0])].dead = true;
        std::map<int, int> from;  // of the cavity's outline, by its first corner: the new triangle there
        std::vector<std::array<int, 3>> outline;  // edge, triangle outside
        while (!open.empty()) {
            const Node n = nodes_[size_t(open.back())];
            open.pop_back();
            for (int i = 0; i < 3; ++i) {
                const int outside = n.beside[size_t(i)], a = n.corners[(i + 1) % 3],
                          b = n.corners[(i + 2) % 3];
                if (outside >= 0) {
                    Node& o = nodes_[size_t(outside)];
                    if (o.dead) continue;
                    if (inCircle(at(o.corners[0]), at(o.corners[1]), at(o.corners[2]), at(point))) {
                        o.dead = true;
                        open.push_back(outside);
                        continue;
                    }
                }
                outline.push_back({a, b, outside});
            }
        }
        // Edges towards triangles that died later are inside.
        std::erase_if(outline, [&](const auto& e) { return e[2] >= 0 && nodes_[size_t(e[2])].dead; });
        for (const auto& [a, b, outside] : outline) {
            from[a] = int(nodes_.size());
            if (outside >= 0)
                for (int i = 0; i < 3; ++i) {
                    Node& o = nodes_[size_t(outside)];
                    if (o.corners[(i + 1) % 3] == b && o.corners[(i + 2) % 3] == a)
                        o.beside[size_t(i)] = int(nodes_.size());
                }
            nodes_.push_back({{a, b, point}, {-1, -1, outside}, false});
        }
        for (const auto& [a, b, outside] : outline) {
            const int t = from.at(a), next = from.at(b);
            nodes_[size_t(t)].beside[0] = next;  // across (b, point)
            nodes_[size_t(next)].beside[1] = t;
        }
        last_ = int(nodes_.size()) - 1;
    }

    std::vector<Vec2> points_;
    std::vector<Node> nodes_;
    int last_ = 0;
};

Vec2 middle(Vec2 a, Vec2 b) {
    return {(a.x + b.x) / 2, (a.y + b.y) / 2};
}

}  // namespace

std::vector<Vec2> uniformPoints(int count, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<Vec2> points(static_cast<size_t>(count));
    for (Vec2& p : points) p.x = unit(random), p.y = unit(random);
    return points;
}

FlatMesh delaunay(const std::vector<Vec2>& points) {
    return {points, Delaunay(points).triangles()};
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

FlatMesh redGreen(const FlatMesh& mesh, double part, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    FlatMesh out{mesh.points, {}};
    std::map<std::pair<int, int>, int> middles;
    const auto middleOf = [&](int a, int b) {
        const auto found = middles.find(std::minmax(a, b));
        return found == middles.end() ? -1 : found->second;
    };
    const auto cut = [&](int a, int b) {
        const auto [found, added] = middles.try_emplace(std::minmax(a, b), int(out.points.size()));
        if (added) out.points.push_back(middle(out.points[size_t(a)], out.points[size_t(b)]));
    };
    for (const Triangle& t : mesh.triangles)
        if (unit(random) < part)
            for (int i = 0; i < 3; ++i) cut(t[i], t[(i + 1) % 3]);
    // Two cut edges make it three.
    for (bool more = true; more;) {
        more = false;
        for (const Triangle& t : mesh.triangles) {
            int edges = 0;
            for (int i = 0; i < 3; ++i) edges += middleOf(t[i], t[(i + 1) % 3]) >= 0;
            if (edges != 2) continue;
            more = true;
            for (int i = 0; i < 3; ++i) cut(t[i], t[(i + 1) % 3]);
        }
    }
    for (const Triangle& t : mesh.triangles) {
        const int m[3] = {middleOf(t[0], t[1]), middleOf(t[1], t[2]), middleOf(t[2], t[0])};
        if (m[0] >= 0 && m[1] >= 0) {
            for (const Triangle& s :
                 {Triangle{t[0], m[0], m[2]}, {t[1], m[1], m[0]}, {t[2], m[2], m[1]}, {m[0], m[1], m[2]}})
                out.triangles.push_back(s);
            continue;
        }
        int i = 0;
        while (i < 3 && m[i] < 0) ++i;
        if (i == 3) {
            out.triangles.push_back(t);
            continue;
        }
        out.triangles.push_back({t[i], m[i], t[(i + 2) % 3]});
        out.triangles.push_back({m[i], t[(i + 1) % 3], t[(i + 2) % 3]});
    }
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
    // Parameters may turn the other way round than the surface's outside.
    const Triangle& t = mesh.triangles.front();
    const auto& p = out.mesh.positions;
    if (dot(cross(p[size_t(t[1])] - p[size_t(t[0])], p[size_t(t[2])] - p[size_t(t[0])]),
            out.mesh.normals[size_t(t[0])]) < 0)
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
