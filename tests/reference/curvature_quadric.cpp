#include <map>
#include <set>

#include "reference/curvature.h"

namespace reference {
namespace {

struct Neighbourhood {
    std::set<int> ring;
    std::map<int, int> across;  // by neighbour b: of triangle (vertex, b, c), in its order, the corner c
    std::map<int, int> before;  // the same, by c: b
    bool border = false, closed = false;
};

// Made only from the triangles that have the vertex as a corner.
std::vector<Neighbourhood> neighbourhoods(const Mesh& mesh) {
    std::vector<Neighbourhood> all(mesh.positions.size());
    forCorners(mesh, [&](int a, int b, int c) {
        all[a].ring.insert({b, c});
        all[a].across[b] = c;
        all[a].before[c] = b;
    });
    for (Neighbourhood& n : all) {
        for (int b : n.ring) n.border |= !n.across.contains(b) || !n.before.contains(b);
        if (n.border || n.ring.size() < 3) continue;
        size_t steps = 1;  // round the vertex and back
        for (int b = n.across.at(*n.ring.begin()); b != *n.ring.begin(); b = n.across.at(b)) ++steps;
        n.closed = steps == n.ring.size();
    }
    return all;
}

// The ring; of more than 36 the 17 neighbours to either side of `vertex`, on open ones 16.
std::set<int> nearOf(const Neighbourhood& n, int vertex) {
    if (n.ring.size() <= 36) return n.ring;
    std::set<int> near;
    for (const auto& steps : {n.across, n.before}) {
        int at = vertex;
        for (int i = 0; i < (n.closed ? 17 : 16) && steps.contains(at); ++i) near.insert(at = steps.at(at));
    }
    return near;
}

// The neighbours of `b` away from its neighbour `vertex`: all others or, where the ring of `b` is closed,
// without the two neighbours that both share and without the corner on the other side of the edge (b,
// next). That corner is left to the neighbour `next` of `vertex`, except where it is the only one.
std::set<int> beyond(const std::vector<Neighbourhood>& all, int b, int vertex) {
    std::set<int> further = nearOf(all[b], vertex);
    further.erase(vertex);
    if (!all[b].closed) return further;
    const int next = all[b].before.at(vertex);
    further.erase(next);
    further.erase(all[b].across.at(vertex));
    if (further.size() > 1) further.erase(all[b].before.at(next));
    return further;
}

// How many times each vertex counts in the fit at `vertex`. A closed ring of at most four neighbours with a
// two-ring of fewer than 15 points gets the three-ring as well.
std::map<int, int> pointsOf(const std::vector<Neighbourhood>& all, int vertex) {
    std::map<int, int> points, further;
    int count = 0;
    for (int b : all[vertex].ring) {
        ++points[b], ++count;
        for (int f : beyond(all, b, vertex)) {
            ++points[f], ++count;
            for (int g : beyond(all, f, b))
                if (g != vertex) ++further[g];
        }
    }
    if (all[vertex].closed && all[vertex].ring.size() <= 4 && count < 15)
        for (const auto& [point, times] : further) points[point] += times;
    return points;
}

struct Frame {
    Vec3 u, v, n;
};

// [Duff et al., Building an Orthonormal Basis, Revisited, JCGT 2017]
Frame frameOf(Vec3 n) {
    const double s = std::copysign(1.0, n.z), a = -1 / (s + n.z);
    return {
        {1 + s * n.x * n.x * a, s * n.x * n.y * a, -s * n.x}, {n.x * n.y * a, s + n.y * n.y * a, -n.y}, n};
}

// The coordinates of the fit, from the one-ring.
struct Chart {
    Frame frame;
    double reach = 0;
    double slopeU = 0, slopeV = 0;  // taken off the heights
    double flatness = 0;
    double xu = 0, yu = 0, yv = 0;  // coordinates x = xu u, y = yu u + yv v; u, v in units of twice the reach
    double steepness = 0, slope2 = 0;
    double unit = 0, round = 1;
    bool thin = false;  // than high
};

Chart chartOf(const Mesh& mesh, const std::set<int>& ring, int vertex, Vec3 normal) {
    Chart chart;
    chart.frame = frameOf(normal);
    for (int b : ring)
        chart.reach = std::max(chart.reach, length(mesh.positions[b] - mesh.positions[vertex]));
    if (!(chart.reach > 0)) return chart;
    double uu = 0, uv = 0, vv = 0, un = 0, vn = 0, nn = 0;  // means over the ring, in units of the reach
    for (int b : ring) {
        const Vec3 p = (mesh.positions[b] - mesh.positions[vertex]) / chart.reach;
        const double u = dot(p, chart.frame.u), v = dot(p, chart.frame.v), n = dot(p, normal);
        const double part = 1.0 / double(ring.size());
        uu += part * u * u, uv += part * u * v, vv += part * v * v;
        un += part * u * n, vn += part * v * n, nn += part * n * n;
    }
    // Slope by least squares, held down by a ridge of 0.03; small ones stay in the heights.
    const double a = uu + 0.03, c = vv + 0.03, determinant = a * c - uv * uv;
    const double su = (c * un - uv * vn) / determinant, sv = (a * vn - uv * un) / determinant;
    chart.slope2 = su * su + sv * sv;
    const double part = chart.slope2 / (chart.slope2 + 0.05 * 0.05);
    chart.slopeU = part * su;
    chart.slopeV = part * sv;
    chart.steepness = nn / (uu + vv);
    chart.flatness = 1 / (1 + std::pow(chart.steepness / 0.04, 2));
    chart.unit = 2 * chart.reach;
    chart.thin = uu < nn || vv - uv * uv / uu < nn;
    return chart;
}

// Principal curvatures and directions of the graph h(u, v) with these derivatives at 0: Gauss and Weingarten.
void principal(QuadricCurvature& out, const Frame& frame, double hu, double hv, double huu, double huv,
               double hvv) {
    const double E = 1 + hu * hu, F = hu * hv, G = 1 + hv * hv, area2 = E * G - F * F;
    const double part = -1 / std::sqrt(area2);  // bending away from the normal counts positive
    const double L = part * huu, M = part * huv, N = part * hvv;
    const double H = (E * N - 2 * F * M + G * L) / (2 * area2), K = (L * N - M * M) / area2;
    const double radius = std::sqrt(std::max(0.0, H * H - K));
    out.first = H + radius;
    out.second = H - radius;
    const Vec3 tangentU = frame.u + hu * frame.n, tangentV = frame.v + hv * frame.n;
    out.normal = normalized(cross(tangentU, tangentV));
    // (II - k I) d = 0: d is at right angles to the longer row.
    const double r0 = L - out.first * E, r1 = M - out.first * F, r2 = N - out.first * G;
    const bool upper = std::hypot(r0, r1) > std::hypot(r1, r2);
    Vec3 d = upper ? -r1 * tangentU + r0 * tangentV : -r2 * tangentU + r1 * tangentV;
    if (!(length(d) > 0)) d = tangentU;
    out.firstDirection = normalized(d);
    out.secondDirection = cross(out.normal, out.firstDirection);
}

// Coordinates in which the points are as wide as long: (x, y) = L^-1 (u, v) / 2 with L L' their second
// moments, in a unit in which their mean squared distance is 0.72.
void shape(Chart& chart, const Mesh& mesh, const std::map<int, int>& points, int vertex, bool replaced) {
    double uu = 0, uv = 0, vv = 0, nn = 0, total = 0;
    for (const auto& [point, count] : points) {
        const Vec3 p = (mesh.positions[point] - mesh.positions[vertex]) / chart.unit;
        const double u = dot(p, chart.frame.u), v = dot(p, chart.frame.v);
        const double n = dot(p, chart.frame.n) - chart.slopeU * u - chart.slopeV * v;
        const double weight = count / (0.05 + dot(p, p));
        uu += weight * u * u, uv += weight * u * v, vv += weight * v * v, nn += weight * n * n,
            total += weight;
    }
    const double unit2 = (uu + vv) / total / 0.72, part = 1 / (total * unit2);
    const double least = std::max(1e-6 * 0.72, replaced ? part * nn : 0);
    const double l11 = std::sqrt(std::max(part * uu, least)), l21 = part * uv / l11;
    const double l22 = std::sqrt(std::max(part * vv - l21 * l21, least));
    chart.unit *= std::sqrt(unit2);
    chart.xu = 0.5 / l11;
    chart.yv = 0.5 / l22;
    chart.yu = -chart.yv * l21 / l11;
    chart.round = std::min(1.0, std::pow(2 * l11 * l22 / 0.72, 2));
}

void nearer(double& margin, double value, double threshold) {
    margin = std::min(margin, std::abs(value / threshold - 1));
}

struct Fit {
    std::array<double, 9> solution{};
    // The smallest contribution of a quadratic or cubic term to the sum of squares, given the terms before
    // it, in units of the ridge that is used inside of a mesh. The ridge itself is subtracted.
    double told = 0;
    int points = 0;
};

Fit fitTo(const Mesh& mesh, const std::map<int, int>& points, const Chart& chart, int vertex, bool border) {
    Fit fit;
    std::array<std::array<double, 9>, 9> matrix{};
    std::array<double, 9>& right = fit.solution;
    double total = 0;
    for (const auto& [point, count] : points) {
        const Vec3 p = (mesh.positions[point] - mesh.positions[vertex]) / chart.unit;
        const double u = dot(p, chart.frame.u), v = dot(p, chart.frame.v);
        const double x = chart.xu * u, y = chart.yu * u + chart.yv * v;
        const double q = dot(p, chart.frame.n) - chart.slopeU * u - chart.slopeV * v;
        const double r2 = u * u + v * v, bent = r2 + chart.flatness * q * q;
        const double z = bent > 0 ? q * r2 / bent : 0;
        const double weight = 1 / (0.05 * chart.round + dot(p, p));
        const double terms[9] = {
            x, y, x * x / 2, x * y, y * y / 2, x * x * x / 6, x * x * y / 2, x * y * y / 2, y * y * y / 6};
        total += count * std::min(weight, 20.0);
        ++fit.points;
        for (int i = 0; i < 9; ++i) {
            right[i] += count * weight * z * terms[i];
            for (int j = 0; j < 9; ++j) matrix[i][j] += count * weight * terms[i] * terms[j];
        }
    }
    // The squares of all derivatives of an order: mixed ones stand there twice, or three times.
    const double often[9] = {1, 1, 1, 2, 1, 1, 3, 3, 1};
    const auto added = [&](int i) { return i < 5 ? 1e-7 : border ? 1e-3 : 1e-5; };
    for (int i = 0; i < 9; ++i) matrix[i][i] += total * often[i] * added(i);
    if (!(total > 0)) return fit;
    fit.told = 1e30;
    for (int i = 0; i < 9; ++i) {  // Gaussian elimination; the matrix is positive definite
        if (i >= 2)
            fit.told =
                std::min(fit.told, (matrix[i][i] / (total * often[i]) - added(i)) / (i < 5 ? 1e-7 : 1e-5));
        for (int k = i + 1; k < 9; ++k) {
            const double factor = matrix[k][i] / matrix[i][i];
            for (int j = i; j < 9; ++j) matrix[k][j] -= factor * matrix[i][j];
            right[k] -= factor * right[i];
        }
    }
    for (int i = 9; i-- > 0;) {
        for (int j = i + 1; j < 9; ++j) right[i] -= matrix[i][j] * right[j];
        right[i] /= matrix[i][i];
    }
    return fit;
}

}  // namespace

std::vector<QuadricCurvature> quadricCurvature(const Mesh& mesh) {
    const std::vector<Neighbourhood> all = neighbourhoods(mesh);
    std::vector<QuadricCurvature> curvatures(mesh.positions.size());
    for (int vertex = 0; vertex < int(curvatures.size()); ++vertex) {
        QuadricCurvature& out = curvatures[vertex];
        const std::set<int>& ring = all[vertex].ring;
        out.border = all[vertex].border;
        const Vec3 given = normalized(mesh.normals[vertex]);
        Chart chart = chartOf(mesh, ring, vertex, given);
        if (!(chart.reach > 0)) continue;
        out.measured = true;

        const bool doubtful = chart.steepness > 0.05 || chart.slope2 > 0.01 || chart.thin;
        Vec3 sum;
        for (int b : ring) sum = sum + normalized(mesh.normals[b]);
        const double cosine = length(sum) > 1e-3 ? dot(normalized(sum), given) : 1;  // 1: they cancel out
        if (cosine < 0.99) {
            nearer(out.margin, chart.steepness, 0.05);
            nearer(out.margin, chart.slope2, 0.01);
        }
        if (doubtful) nearer(out.margin, cosine, 0.99);
        if (doubtful && cosine < 0.99) {
            out.replaced = true;
            chart = chartOf(mesh, ring, vertex, normalized(sum));
        }

        const std::map<int, int> points = pointsOf(all, vertex);
        shape(chart, mesh, points, vertex, out.replaced);
        const Fit fit = fitTo(mesh, points, chart, vertex, out.border);
        nearer(out.lowMargin, fit.told, 1);
        out.low = fit.told < 1;
        out.points = fit.points;
        const std::array<double, 9>& s = fit.solution;

        // Back to u and v, and to lengths.
        const double unit = chart.unit, xu = chart.xu, yu = chart.yu, yv = chart.yv;
        principal(out, chart.frame, chart.slopeU + xu * s[0] + yu * s[1], chart.slopeV + yv * s[1],
                  (xu * xu * s[2] + 2 * xu * yu * s[3] + yu * yu * s[4]) / unit,
                  yv * (xu * s[3] + yu * s[4]) / unit, yv * yv * s[4] / unit);
    }
    return curvatures;
}

}  // namespace reference
