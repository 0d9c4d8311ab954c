#include <cmath>

#include "reference/curvature.h"

namespace reference {

std::vector<double> smoothedToRadius(const Mesh& mesh, std::vector<double> values,
                                     const RadiusSmoothing& how) {
    const size_t count = values.size();
    struct Edge {
        int to;
        double weight;
    };
    std::vector<std::vector<Edge>> edges(count);
    std::vector<double> areas(count), voronoi(count);
    const auto add = [&](int from, int to, double weight) {
        for (Edge& e : edges[size_t(from)])
            if (e.to == to) return void(e.weight += weight);
        edges[size_t(from)].push_back({to, weight});
    };
    for (const Triangle& t : mesh.triangles) {
        const Vec3 p[3] = {mesh.positions[size_t(t[0])], mesh.positions[size_t(t[1])],
                           mesh.positions[size_t(t[2])]};
        const double doubled = length(cross(p[1] - p[0], p[2] - p[0]));
        const auto nearest = voronoiAreas(p[0], p[1], p[2]);
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            const Vec3 toJ = p[j] - p[i], toK = p[k] - p[i], between = p[k] - p[j];
            if (doubled * doubled <= flatTriangle * dot(toJ, toJ) * dot(toK, toK)) continue;
            voronoi[size_t(t[i])] += nearest[size_t(i)];
            areas[size_t(t[i])] += how.byArea ? doubled / 6 : nearest[size_t(i)];
            // The edge to j has the cotangent at k, and the other way round.
            add(t[i], t[j], dot(toK, between) / doubled);
            add(t[i], t[k], -dot(toJ, between) / doubled);
        }
    }
    if (how.byArea) {
        // Nothing negative; then the second moment that all cotangents together have.
        std::vector<double> factors(count);
        for (size_t i = 0; i < count; ++i) {
            double moment = 0;
            for (Edge& e : edges[i]) {
                const Vec3 along = mesh.positions[size_t(e.to)] - mesh.positions[i];
                e.weight = max0(e.weight);
                moment += e.weight * dot(along, along);
            }
            factors[i] = moment > 0 ? 8 * voronoi[i] / moment : 0;
        }
        for (size_t i = 0; i < count; ++i)
            for (Edge& e : edges[i]) e.weight *= (factors[i] + factors[size_t(e.to)]) / 2;
    }
    // What so many stages can do: slots that even out faster are slowed down to it.
    const double time = how.radius * how.radius / 2, wide = (how.stages > 1 ? how.stages - 1 : 0.5) / 2.63,
                 span = wide * wide / 2, limit = span / time, turn = 2 * std::sin(how.crease / 2);
    std::vector<double> rates(count);
    for (size_t i = 0; i < count; ++i)
        for (Edge& e : edges[i]) {
            e.weight *= 0.5 / areas[i];
            if (!(areas[i] > 0)) e.weight = 0;
            if (how.crease > 0) {
                const Vec3 change = normalized(mesh.normals[size_t(e.to)]) - normalized(mesh.normals[i]);
                e.weight = max0(e.weight) * std::exp(-dot(change, change) / (turn * turn));
            }
            rates[i] += std::abs(e.weight);
        }
    for (size_t i = 0; i < count; ++i)
        for (Edge& e : edges[i])
            e.weight /= std::max({1.0, rates[i] / limit, how.byArea ? rates[size_t(e.to)] / limit : 0.0});
    // The equation itself by the classical Runge-Kutta method, in steps of a quarter of what is stable.
    const int steps = std::max(4, int(std::ceil(3 * span)));
    const auto slope = [&](const std::vector<double>& v) {
        std::vector<double> change(count);
        for (size_t i = 0; i < count; ++i)
            for (const Edge& e : edges[i]) change[i] += e.weight * (v[size_t(e.to)] - v[i]);
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

}  // namespace reference
