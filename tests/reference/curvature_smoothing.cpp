#include <cmath>
#include <utility>

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
    std::vector<double> areas(count);
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
            areas[size_t(t[i])] += how.byArea ? doubled : nearest[size_t(i)];
            // The edge to j has the cotangent at k, and the other way round.
            add(t[i], t[j], how.byArea ? 4 * doubled / dot(toJ, toJ) : dot(toK, between) / doubled);
            add(t[i], t[k], how.byArea ? 4 * doubled / dot(toK, toK) : -dot(toJ, between) / doubled);
        }
    }
    // Runge-Kutta-Legendre of first order, four super steps of `each` stages; slots that would be unstable
    // are slowed down.
    const int each = std::max(1, (how.stages + 3) / 4);
    const double span = double(each) * each + each, time = how.radius * how.radius / 2 / 4,
                 turn = 2 * std::sin(how.crease / 2);
    for (size_t i = 0; i < count; ++i) {
        double rate = 0;
        for (Edge& e : edges[i]) {
            e.weight *= 0.5 / areas[i];
            if (!(areas[i] > 0)) e.weight = 0;
            if (how.crease > 0) {
                const Vec3 change = normalized(mesh.normals[size_t(e.to)]) - normalized(mesh.normals[i]);
                e.weight = max0(e.weight) * std::exp(-dot(change, change) / (turn * turn));
            }
            rate += std::abs(e.weight);
        }
        for (Edge& e : edges[i]) e.weight *= rate > 0 ? std::min(time, span / 2 / rate) : time;
    }
    const auto laplacian = [&](const std::vector<double>& v, size_t i) {
        double sum = 0;
        for (const Edge& e : edges[i]) sum += e.weight * (v[size_t(e.to)] - v[i]);
        return sum;
    };
    for (int step = 0; step < 4; ++step) {
        std::vector<double> before, current = values;
        for (int j = 1; j <= each; ++j) {
            const double mu = j == 1 ? 1 : (2.0 * j - 1) / j, nu = j == 1 ? 0 : (1.0 - j) / j;
            std::vector<double> next(count);
            for (size_t i = 0; i < count; ++i)
                next[i] =
                    mu * current[i] + (j == 1 ? 0 : nu * before[i]) + mu * 2 / span * laplacian(current, i);
            before = std::exchange(current, std::move(next));
        }
        values = std::move(current);
    }
    return values;
}

}  // namespace reference
