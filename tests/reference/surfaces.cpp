#include "reference/surfaces.h"

#include <map>
#include <random>

namespace reference {
namespace {

PrincipalCurvatures fromMeanAndGaussian(double mean, double gaussian) {
    const double root = std::sqrt(max0(mean * mean - gaussian));
    return {mean + root, mean - root};
}

Vec3 direction(double longitude, double latitude) {
    return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
            std::sin(latitude)};
}

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

using At = std::function<SurfacePoint(double, double)>;
// u goes round an axis.
Surface around(At at, double vBegin, double vEnd, bool wrapsV = false) {
    return {std::move(at), 0, 2 * pi, vBegin, vEnd, true, wrapsV};
}

}  // namespace

Surface planeSurface(double side) {
    return {[](double u, double v) { return SurfacePoint{{u, v, 0}, {0, 0, 1}, {0, 0}}; }, 0, side, 0, side};
}

Surface sphereSurface(double radius) {
    return ellipsoidSurface(radius, radius, radius);
}

Surface cylinderSurface(double radius, double height) {
    const auto at = [=](double u, double v) {
        const Vec3 n = direction(u, 0);
        return SurfacePoint{radius * n + Vec3{0, 0, v}, n, {1 / radius, 0}};
    };
    return around(at, 0, height);
}

Surface coneSurface(double halfAngle, double slantBegin, double slantEnd) {
    const double s = std::sin(halfAngle), c = std::cos(halfAngle);
    const auto at = [=](double u, double slant) {  // apex at the origin, opening downwards
        const Vec3 out = direction(u, 0), n = c * out + Vec3{0, 0, s};
        return SurfacePoint{slant * (s * out + Vec3{0, 0, -c}), n, {1 / (slant * std::tan(halfAngle)), 0}};
    };
    return around(at, slantBegin, slantEnd);
}

Surface torusSurface(double majorRadius, double minorRadius) {
    const auto at = [=](double u, double v) {
        const Vec3 out = direction(u, 0), n = std::cos(v) * out + Vec3{0, 0, std::sin(v)};
        const double k = 1 / minorRadius, other = std::cos(v) / (majorRadius + minorRadius * std::cos(v));
        return SurfacePoint{majorRadius * out + minorRadius * n, n, {std::max(k, other), std::min(k, other)}};
    };
    return around(at, 0, 2 * pi, true);
}

SurfacePoint ellipsoidPoint(Vec3 s, double a, double b, double c) {
    const Vec3 p{a * s.x, b * s.y, c * s.z}, gradient{s.x / a, s.y / b, s.z / c};
    const double g2 = dot(gradient, gradient), volume2 = a * a * b * b * c * c;
    // Everywhere umbilic: the root of mean² - gaussian would leave half the digits.
    if (a == b && b == c) return {p, s, {1 / a, 1 / a}};
    const double gaussian = 1 / (volume2 * g2 * g2);
    const double mean = (a * a + b * b + c * c - dot(p, p)) / (2 * volume2 * g2 * std::sqrt(g2));
    return {p, normalized(gradient), fromMeanAndGaussian(mean, gaussian)};
}

Surface ellipsoidSurface(double a, double b, double c) {
    const auto at = [=](double u, double v) { return ellipsoidPoint(direction(u, v), a, b, c); };
    return around(at, -pi / 3, pi / 3);
}

Surface monkeySaddle(double side) {
    const auto at = [](double x, double y) {
        const double gx = 3 * (x * x - y * y), gy = -6 * x * y, hxx = 6 * x, hxy = -6 * y, hyy = -6 * x;
        const double w2 = 1 + gx * gx + gy * gy, w = std::sqrt(w2);
        const double gaussian = (hxx * hyy - hxy * hxy) / (w2 * w2);
        // Minus: a graph that curves up curves towards its upward normal.
        const double mean = -((1 + gy * gy) * hxx - 2 * gx * gy * hxy + (1 + gx * gx) * hyy) / (2 * w2 * w);
        return SurfacePoint{
            {x, y, x * x * x - 3 * x * y * y}, Vec3{-gx, -gy, 1} / w, fromMeanAndGaussian(mean, gaussian)};
    };
    return {at, -side / 2, side / 2, -side / 2, side / 2};
}

Surface ellipsoidCap(double a, double b, double c) {
    return {[=](double u, double v) {
                const double r2 = u * u + v * v;
                return ellipsoidPoint(Vec3{2 * u, 2 * v, 1 - r2} / (1 + r2), a, b, c);
            },
            -1, 1, -1, 1};
}

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
    forCorners(mesh, [&](int a, int b, int) {
        for (int v : {a, b}) total[v] += length(mesh.positions[b] - mesh.positions[a]), ++count[v];
    });
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
