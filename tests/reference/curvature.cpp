#include "reference/curvature.h"

#include <map>

namespace reference {
namespace {

// A symmetric bilinear form on space that vanishes along one normal: uu u u' + uv (u v' + v u') + vv v v'.
struct TangentForm {
    Vec3 u, v;  // orthonormal, in the tangent plane
    double uu = 0, uv = 0, vv = 0;
    double operator()(Vec3 a, Vec3 b) const {
        const double au = dot(a, u), av = dot(a, v), bu = dot(b, u), bv = dot(b, v);
        return uu * au * bu + uv * (au * bv + av * bu) + vv * av * bv;
    }
};

TangentForm faceForm(const Vec3 (&p)[3], const Vec3 (&n)[3]) {
    TangentForm form;
    form.u = normalized(p[1] - p[0]);
    form.v = normalized(cross(cross(p[1] - p[0], p[2] - p[0]), form.u));
    // Normal equations of: II (edge) = normal difference, six equations for (uu, uv, vv).
    double a = 0, b = 0, c = 0;
    Vec3 right;
    for (int i = 0; i < 3; ++i) {
        const Vec3 edge = p[(i + 1) % 3] - p[i], turn = n[(i + 1) % 3] - n[i];
        const double eu = dot(edge, form.u), ev = dot(edge, form.v);
        const double tu = dot(turn, form.u), tv = dot(turn, form.v);
        a += eu * eu;
        b += eu * ev;
        c += ev * ev;
        right = right + Vec3{eu * tu, ev * tu + eu * tv, ev * tv};
    }
    const Vec3 solution = solved({a, b, 0}, {b, a + c, b}, {0, b, c}, right);
    form.uu = solution.x;
    form.uv = solution.y;
    form.vv = solution.z;
    return form;
}

// The shortest rotation that takes unit vector from to unit vector to, applied to x (Rodrigues).
Vec3 rotated(Vec3 x, Vec3 from, Vec3 to) {
    const Vec3 axis = cross(from, to);
    const double cosine = dot(from, to);
    if (cosine <= -1) return -1.0 * x;  // no shortest rotation: the form does not see the sign
    return cosine * x + cross(axis, x) + dot(axis, x) / (1 + cosine) * axis;
}

}  // namespace

std::vector<double> edgeCurvature(const Mesh& mesh) {
    std::vector<double> least(mesh.positions.size(), INFINITY), most(mesh.positions.size(), -INFINITY);
    forCorners(mesh, [&](int a, int b, int) {
        const double distance = length(mesh.positions[b] - mesh.positions[a]);
        if (!(distance > 0)) return;
        const double curvature = length(mesh.normals[b] - mesh.normals[a]) / distance;
        for (int v : {a, b}) {
            least[v] = std::min(least[v], curvature);
            most[v] = std::max(most[v], curvature);
        }
    });
    std::vector<double> values(mesh.positions.size(), 0.0);
    for (size_t v = 0; v < values.size(); ++v)
        if (most[v] >= 0) values[v] = 0.5 * (least[v] + most[v]);
    return values;
}

std::vector<double> smoothed(const Mesh& mesh, std::vector<double> values, int passes) {
    for (int pass = 0; pass < passes; ++pass) {
        std::vector<double> sum(values.size(), 0.0);
        std::vector<int> count(values.size(), 0);
        forCorners(mesh, [&](int a, int b, int c) { sum[a] += values[b] + values[c], count[a] += 2; });
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
    forCorners(mesh, [&](int a, int b, int c) {
        const Vec3 one = mesh.positions[b] - mesh.positions[a], two = mesh.positions[c] - mesh.positions[a],
                   across = cross(one, two);
        if (!(length(across) > 0)) return;
        normals[a] = normals[a] + std::atan2(length(across), dot(one, two)) * normalized(across);
    });
    for (Vec3& normal : normals)
        if (length(normal) > 0) normal = normalized(normal);
    return normals;
}

std::array<double, 3> voronoiAreas(Vec3 a, Vec3 b, Vec3 c) {
    const Vec3 corner[3] = {a, b, c};
    const double doubled = length(cross(b - a, c - a));
    double cosine[3], side2[3];  // unnormalised cosine at each corner; squared length opposite to it
    for (int i = 0; i < 3; ++i) {
        const Vec3 one = corner[(i + 1) % 3] - corner[i], two = corner[(i + 2) % 3] - corner[i];
        cosine[i] = dot(one, two);
        side2[i] = dot(two - one, two - one);
    }
    std::array<double, 3> areas{};
    if (!(doubled > 0)) return areas;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        if (cosine[i] > 0) continue;
        // Obtuse at i: the other two corners keep right triangles with half a leg and the angle there.
        areas[j] = side2[k] / 8 * doubled / cosine[j];
        areas[k] = side2[j] / 8 * doubled / cosine[k];
        areas[i] = 0.5 * doubled - areas[j] - areas[k];
        return areas;
    }
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        areas[i] = (side2[k] * cosine[k] + side2[j] * cosine[j]) / (8 * doubled);
    }
    return areas;
}

std::vector<PrincipalCurvatures> tensorCurvature(const Mesh& mesh) {
    const size_t count = mesh.positions.size();
    std::vector<TangentForm> forms(count);
    std::vector<double> weights(count, 0.0);
    for (size_t i = 0; i < count; ++i) {
        const Vec3 n = mesh.normals[i];
        const Vec3 other = std::abs(n.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
        if (!(length(n) > 0)) continue;
        forms[i].u = normalized(cross(n, other));
        forms[i].v = normalized(cross(n, forms[i].u));
    }
    for (const Triangle& triangle : mesh.triangles) {
        const Vec3 p[3] = {mesh.positions[triangle[0]], mesh.positions[triangle[1]],
                           mesh.positions[triangle[2]]};
        const Vec3 n[3] = {mesh.normals[triangle[0]], mesh.normals[triangle[1]], mesh.normals[triangle[2]]};
        const Vec3 across = cross(p[1] - p[0], p[2] - p[0]);
        if (!(length(across) > 0)) continue;
        const TangentForm face = faceForm(p, n);
        const auto areas = voronoiAreas(p[0], p[1], p[2]);
        for (int i = 0; i < 3; ++i) {
            TangentForm& form = forms[triangle[i]];
            const Vec3 facing = normalized(dot(across, n[i]) < 0 ? -1.0 * across : across);
            const Vec3 u = rotated(form.u, n[i], facing), v = rotated(form.v, n[i], facing);
            form.uu += areas[i] * face(u, u);
            form.uv += areas[i] * face(u, v);
            form.vv += areas[i] * face(v, v);
            weights[triangle[i]] += areas[i];
        }
    }
    std::vector<PrincipalCurvatures> curvatures(count);
    for (size_t i = 0; i < count; ++i) {
        if (!(weights[i] > 0)) continue;
        const double uu = forms[i].uu / weights[i], uv = forms[i].uv / weights[i],
                     vv = forms[i].vv / weights[i];
        const double mean = 0.5 * (uu + vv), radius = std::hypot(0.5 * (uu - vv), uv);
        curvatures[i] = {mean + radius, mean - radius};
    }
    return curvatures;
}

std::vector<double> smoothedToRadius(const Mesh& mesh, std::vector<double> values,
                                     const RadiusSmoothing& how) {
    const size_t count = values.size();
    std::vector<std::map<int, double>> edges(count);  // weights
    std::vector<double> areas(count), voronoi(count);
    for (const Triangle& t : mesh.triangles) {
        const Vec3 p[3] = {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
        const double doubled = length(cross(p[1] - p[0], p[2] - p[0]));
        const auto nearest = voronoiAreas(p[0], p[1], p[2]);
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            const Vec3 toJ = p[j] - p[i], toK = p[k] - p[i], between = p[k] - p[j];
            if (doubled * doubled <= flatTriangle * dot(toJ, toJ) * dot(toK, toK)) continue;
            voronoi[t[i]] += nearest[i];
            areas[t[i]] += how.byArea ? doubled / 6 : nearest[i];
            // The edge to j has the cotangent at k, and the other way round.
            edges[t[i]][t[j]] += dot(toK, between) / doubled;
            edges[t[i]][t[k]] -= dot(toJ, between) / doubled;
        }
    }
    if (how.byArea) {
        // Removes negative weights; then restores the second moment of all cotangents together.
        std::vector<double> factors(count);
        for (size_t i = 0; i < count; ++i) {
            double moment = 0;
            for (auto& [to, weight] : edges[i]) {
                const Vec3 along = mesh.positions[to] - mesh.positions[i];
                weight = max0(weight);
                moment += weight * dot(along, along);
            }
            factors[i] = moment > 0 ? 8 * voronoi[i] / moment : 0;
        }
        for (size_t i = 0; i < count; ++i)
            for (auto& [to, weight] : edges[i]) weight *= (factors[i] + factors[to]) / 2;
    }
    // The limit of this number of stages: vertices that even out faster are slowed down to it.
    const double time = how.radius * how.radius / 2, wide = (how.stages > 1 ? how.stages - 1 : 0.5) / 2.63,
                 span = wide * wide / 2, limit = span / time, turn = 2 * std::sin(how.crease / 2);
    std::vector<double> rates(count);
    for (size_t i = 0; i < count; ++i)
        for (auto& [to, weight] : edges[i]) {
            weight = areas[i] > 0 ? weight * 0.5 / areas[i] : 0;
            if (how.crease > 0) {
                const Vec3 change = normalized(mesh.normals[to]) - normalized(mesh.normals[i]);
                weight = max0(weight) * std::exp(-dot(change, change) / (turn * turn));
            }
            rates[i] += std::abs(weight);
        }
    for (size_t i = 0; i < count; ++i)
        for (auto& [to, weight] : edges[i])
            weight /= std::max({1.0, rates[i] / limit, how.byArea ? rates[to] / limit : 0.0});
    // The equation itself by the classical Runge-Kutta method, in steps of a quarter of what is stable.
    const int steps = std::max(4, int(std::ceil(3 * span)));
    const auto slope = [&](const std::vector<double>& v) {
        std::vector<double> change(count);
        for (size_t i = 0; i < count; ++i)
            for (const auto& [to, weight] : edges[i]) change[i] += weight * (v[to] - v[i]);
        return change;
    };
    const auto moved = [&](const std::vector<double>& by, double part) {
        std::vector<double> result = values;
        for (size_t i = 0; i < count; ++i) result[i] += part * by[i];
        return result;
    };
    for (int step = 0; step < steps; ++step) {
        const double dt = time / steps;
        const auto a = slope(values), b = slope(moved(a, dt / 2)), c = slope(moved(b, dt / 2)),
                   d = slope(moved(c, dt));
        for (size_t i = 0; i < count; ++i) values[i] += dt / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
    }
    return values;
}

namespace {

bool usable(const ScreenImage& image, int pixel) {
    if (!image.ids.empty() && image.ids[pixel] == 0) return false;
    return finite(image.normals[pixel]) && finite(image.positions[pixel]) &&
           length(image.normals[pixel]) > 1e-6;
}

bool connected(const ScreenImage& image, int here, int there, double edge) {
    if (!usable(image, there) || (!image.ids.empty() && image.ids[here] != image.ids[there])) return false;
    const Vec3 step = image.positions[there] - image.positions[here];
    for (int end : {here, there})
        if (std::abs(dot(step, normalized(image.normals[end]))) > edge * length(step)) return false;
    return true;
}

}  // namespace

std::vector<double> screenCurvature(const ScreenImage& image, double edge) {
    std::vector<double> result(image.normals.size(), 0.0);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const int here = y * image.width + x;
            if (!usable(image, here)) continue;
            Vec3 turn, step;
            for (int axis = 0; axis < 2; ++axis) {
                // From the neighbour before to the one after, or from or to the pixel itself where one is
                // missing.
                int ends[2] = {here, here}, steps = 0;
                for (int side = 0; side < 2; ++side) {
                    const int nx = x + (axis == 0 ? 2 * side - 1 : 0),
                              ny = y + (axis == 1 ? 2 * side - 1 : 0);
                    if (nx < 0 || ny < 0 || nx >= image.width || ny >= image.height) continue;
                    const int there = ny * image.width + nx;
                    if (connected(image, here, there, edge)) ends[side] = there, ++steps;
                }
                if (steps == 0) continue;
                const Vec3 dn = normalized(image.normals[ends[1]]) - normalized(image.normals[ends[0]]);
                const Vec3 dp = image.positions[ends[1]] - image.positions[ends[0]];
                for (int k = 0; k < 3; ++k) {
                    turn[k] += std::abs(dn[k]) / steps;
                    step[k] += std::abs(dp[k]) / steps;
                }
            }
            if (length(step) > 0) result[here] = length(turn) / length(step);
        }
    return result;
}

}  // namespace reference
