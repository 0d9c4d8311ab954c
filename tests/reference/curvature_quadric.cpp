#include "reference/curvature_quadric.h"

#include <map>
#include <set>

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
    for (const Triangle& t : mesh.triangles)
        for (int i = 0; i < 3; ++i) {
            const int b = t[(i + 1) % 3], c = t[(i + 2) % 3];
            Neighbourhood& n = all[t[i]];
            n.ring.insert({b, c});
            n.across[b] = c;
            n.before[c] = b;
        }
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

// The weight of each vertex in the fit at `vertex`.
std::map<int, int> twoRing(const std::vector<Neighbourhood>& all, int vertex) {
    std::map<int, int> counts;
    for (int b : all[vertex].ring) {
        ++counts[b];
        std::set<int> further = nearOf(all[b], vertex);
        further.erase(vertex);
        if (all[b].closed) {
            const int next = all[vertex].across.at(b), before = all[vertex].before.at(b);
            further.erase(next);
            further.erase(before);
            // The corner on the other side of the edge (b, next) is left to the neighbour `next`; not where
            // there is no other.
            if (further.size() > 1)
                further.erase(all[b].before.at(next) == vertex ? all[b].across.at(next) : all[b].before.at(next));
        }
        for (int f : further) ++counts[f];
    }
    return counts;
}

// The points of the two-ring and, as often as they come up, the rings of these, if those have at most 36
// neighbours.
std::map<int, int> threeRing(const std::vector<Neighbourhood>& all, int vertex, const std::map<int, int>& two) {
    std::map<int, int> counts = two;
    for (const auto& [point, count] : two)
        for (int f : all[point].ring)
            if (f != vertex && all[point].ring.size() <= 36) counts[f] += count;
    return counts;
}

struct Frame {
    Vec3 u, v, n;
};

// [Duff et al., Building an Orthonormal Basis, Revisited, JCGT 2017]
Frame frameOf(Vec3 n) {
    const double s = std::copysign(1.0, n.z), a = -1 / (s + n.z);
    return {{1 + s * n.x * n.x * a, s * n.x * n.y * a, -s * n.x}, {n.x * n.y * a, s + n.y * n.y * a, -n.y}, n};
}

// The coordinates of the fit, from the one-ring.
struct Chart {
    Frame frame;
    double reach = 0;
    double slopeU = 0, slopeV = 0;  // taken off the heights
    double flatness = 0;
    double xu = 0, yu = 0, yv = 0;  // coordinates x = xu u, y = yu u + yv v; u, v in units of twice the reach
    double steepness = 0, slope2 = 0;
    double unit = 0, round = 1, farthest2 = 4;
    bool thin = false;  // than high
};

// (x, y) = size L^-1 (u, v) with L L' = moments.
void shape(Chart& chart, double uu, double uv, double vv, double thick, double size) {
    const double least = std::max(1e-6 * (uu + vv), thick);
    const double l11 = std::sqrt(std::max(uu, least)), l21 = uv / l11;
    const double l22 = std::sqrt(std::max(vv - l21 * l21, least));
    chart.xu = size / l11;
    chart.yv = size / l22;
    chart.yu = -chart.yv * l21 / l11;
    chart.round = std::min(1.0, std::pow(2 * l11 * l22 / (uu + vv), 2));
}

Chart chartOf(const Mesh& mesh, const std::set<int>& ring, int vertex, Vec3 normal, bool replaced) {
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
    shape(chart, uu, uv, vv, replaced ? nn : 0, std::sqrt(0.5));
    return chart;
}

// Gaussian elimination with pivots, in place.
template <size_t N>
std::array<double, N> solve(std::array<std::array<double, N>, N> a, std::array<double, N> b) {
    for (size_t i = 0; i < N; ++i) {
        size_t pivot = i;
        for (size_t k = i; k < N; ++k)
            if (std::abs(a[k][i]) > std::abs(a[pivot][i])) pivot = k;
        std::swap(a[i], a[pivot]);
        std::swap(b[i], b[pivot]);
        for (size_t k = i + 1; k < N; ++k) {
            const double factor = a[k][i] / a[i][i];
            for (size_t j = i; j < N; ++j) a[k][j] -= factor * a[i][j];
            b[k] -= factor * b[i];
        }
    }
    for (size_t i = N; i-- > 0;) {
        for (size_t j = i + 1; j < N; ++j) b[i] -= a[i][j] * b[j];
        b[i] /= a[i][i];
    }
    return b;
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

// All points as wide as long, near ones weighing more, or all alike.
void widen(Chart& chart, const Mesh& mesh, const std::map<int, int>& points, int vertex, bool replaced,
           bool alike) {
    double uu = 0, uv = 0, vv = 0, nn = 0, total = 0;
    for (const auto& [point, count] : points) {
        const Vec3 p = (mesh.positions[point] - mesh.positions[vertex]) / chart.unit;
        const double u = dot(p, chart.frame.u), v = dot(p, chart.frame.v);
        const double n = dot(p, chart.frame.n) - chart.slopeU * u - chart.slopeV * v;
        const double weight = alike ? count : count / (0.05 + dot(p, p));
        uu += weight * u * u, uv += weight * u * v, vv += weight * v * v, nn += weight * n * n, total += weight;
    }
    // Its unit makes the mean square of the distance 0.72.
    const double unit2 = (uu + vv) / total / 0.72, part = 1 / (total * unit2);
    chart.unit *= std::sqrt(unit2);
    chart.farthest2 = 16;
    shape(chart, part * uu, part * uv, part * vv, replaced ? part * nn : 0, 0.5);
}

void nearer(double& margin, double value, double threshold) {
    margin = std::min(margin, std::abs(value / threshold - 1));
}

double determinant(std::array<std::array<double, 9>, 9> a, size_t first, size_t last) {
    double product = 1;
    for (size_t i = first; i < last; ++i) {
        product *= a[i][i];
        for (size_t k = i + 1; k < last; ++k)
            for (size_t j = last; j-- > i;) a[k][j] -= a[k][i] / a[i][i] * a[i][j];
    }
    return product;
}

// How well the points separate quadratic terms from linear ones, and cubic terms from all lower ones: from 0,
// not at all, to 1, as if the lower terms were absent.
double distinct(const std::array<std::array<double, 9>, 9>& a) {
    const double five = determinant(a, 0, 5);
    return std::min(five / (determinant(a, 0, 2) * determinant(a, 2, 5)),
                    determinant(a, 0, 9) / (five * determinant(a, 5, 9)));
}

// The smallest contribution of a quadratic or cubic term to the sum of squares, given the terms before it, in
// units of the ridge that is used inside of a mesh. The ridge itself is subtracted.
double smallestTerm(std::array<std::array<double, 9>, 9> a, double total, bool border) {
    double least = 1e30;
    for (size_t i = 0; i < 9; ++i) {
        const double ridge = i < 5 ? 1e-7 : 1e-5, added = i >= 5 && border ? 1e-3 : ridge;
        const double share = i == 3 ? 2 : i == 6 || i == 7 ? 3 : 1;
        if (i >= 2) least = std::min(least, (a[i][i] / (total * share) - added) / ridge);
        for (size_t k = i + 1; k < 9; ++k)
            for (size_t j = 9; j-- > i;) a[k][j] -= a[k][i] / a[i][i] * a[i][j];
    }
    return least;
}

struct Fit {
    std::array<double, 9> solution{};
    double told = 0;
    double distinct = 0;
    // Error of H, times the square of the reach, for an error of 1 of each height and of the vertex.
    double noise = 0;
    int points = 0;
};

Fit fitTo(const Mesh& mesh, const std::map<int, int>& points, const Chart& chart, int vertex, bool border,
          double& margin) {
    Fit fit;
    std::array<std::array<double, 9>, 9> matrix{};
    std::array<double, 9> right{};
    double total = 0, weights2 = 0;
    std::array<double, 9> ones{};
    for (const auto& [point, count] : points) {
        const Vec3 p = (mesh.positions[point] - mesh.positions[vertex]) / chart.unit;
        const double u = dot(p, chart.frame.u), v = dot(p, chart.frame.v);
        const double x = chart.xu * u, y = chart.yu * u + chart.yv * v;
        nearer(margin, x * x + y * y, chart.farthest2);
        if (!(x * x + y * y <= chart.farthest2)) continue;
        const double q = dot(p, chart.frame.n) - chart.slopeU * u - chart.slopeV * v;
        const double r2 = u * u + v * v, bent = r2 + chart.flatness * q * q;
        const double z = bent > 0 ? q * r2 / bent : 0;
        const double weight = 1 / (0.05 * chart.round + dot(p, p));
        const double terms[9] = {
            x, y, x * x / 2, x * y, y * y / 2, x * x * x / 6, x * x * y / 2, x * y * y / 2, y * y * y / 6};
        total += count * std::min(weight, 20.0);
        weights2 += count * weight * weight;
        ++fit.points;
        for (int i = 0; i < 9; ++i) {
            right[i] += count * weight * z * terms[i];
            ones[i] += count * weight * terms[i];
            for (int j = 0; j < 9; ++j) matrix[i][j] += count * weight * terms[i] * terms[j];
        }
    }
    // The squares of all derivatives of an order: mixed ones stand there twice, or three times.
    const double often[9] = {1, 1, 1, 2, 1, 1, 3, 3, 1};
    for (int i = 0; i < 9; ++i) matrix[i][i] += total * often[i] * (i < 5 ? 1e-7 : border ? 1e-3 : 1e-5);
    if (!(total > 0)) return fit;
    fit.distinct = distinct(matrix);
    fit.told = smallestTerm(matrix, total, border);
    fit.solution = solve(matrix, right);
    // Of the error of heights, what the sum of squares leaves to H.
    std::array<double, 9> trace{};
    trace[2] = chart.xu * chart.xu / 2, trace[3] = chart.xu * chart.yu;
    trace[4] = (chart.yu * chart.yu + chart.yv * chart.yv) / 2;
    const std::array<double, 9> part = solve(matrix, trace);
    double square = 0;
    double own = 0;
    for (int i = 0; i < 9; ++i) square += part[i] * trace[i], own += part[i] * ones[i];
    fit.noise = std::sqrt(square * weights2 / total + own * own) * std::pow(chart.reach / chart.unit, 2);

    return fit;
}

// Whether float rounding of positions, which moves heights by 2^-25 (root mean square) of what the position
// has along the normal, moves H by too much. What is far from one of the thresholds decides however near
// another one is.
bool isNoisy(const Fit& fit, const Chart& chart, Vec3 at, double& margin) {
    const Vec3 n = chart.frame.n;
    const double noise =
        fit.noise * std::ldexp(1, -25) * length(Vec3{n.x * at.x, n.y * at.y, n.z * at.z}) / chart.reach;
    const auto& s = fit.solution;
    const double xu = chart.xu, yu = chart.yu, yv = chart.yv, part = chart.reach / chart.unit;
    const double uu = xu * xu * s[2] + 2 * xu * yu * s[3] + yu * yu * s[4], uv = yv * (xu * s[3] + yu * s[4]),
                 vv = yv * yv * s[4];
    const double bent = part * std::sqrt((uu * uu + 2 * uv * uv + vv * vv) / 2);
    const double over[] = {noise / 3e-5, noise / (0.01 * bent), fit.noise / 3};
    const double least = std::min({over[0], over[1], over[2]});
    nearer(margin, least, 1);
    return least > 1;
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
        Chart chart = chartOf(mesh, ring, vertex, given, false);
        if (!(chart.reach > 0)) continue;
        out.measured = true;

        const bool doubtful = chart.steepness > 0.05 || chart.slope2 > 0.01 || chart.thin;
        Vec3 sum;
        for (int b : ring) sum = sum + normalized(mesh.normals[b]);
        const double cosine = dot(normalized(sum), given);
        if (cosine < 0.99) {
            nearer(out.margin, chart.steepness, 0.05);
            nearer(out.margin, chart.slope2, 0.01);
        }
        if (doubtful) nearer(out.margin, cosine, 0.99);
        if (doubtful && cosine < 0.99) {
            out.replaced = true;
            chart = chartOf(mesh, ring, vertex, normalized(sum), true);
        }

        std::map<int, int> points = twoRing(all, vertex);
        double fine = 1;  // of the narrow fit, which does not count where it is not used
        Fit fit = fitTo(mesh, points, chart, vertex, out.border, fine);
        nearer(out.margin, fit.distinct, 1e-3);
        nearer(out.margin, chart.round, 0.1);
        bool noisy = isNoisy(fit, chart, mesh.positions[vertex], out.margin);
        if (noisy || fit.distinct < 1e-3 || chart.round < 0.1) {
            out.wide = true;
            widen(chart, mesh, points, vertex, out.replaced, false);
            fine = 1;
            fit = fitTo(mesh, points, chart, vertex, out.border, fine);
            if (noisy) nearer(out.margin, fit.distinct, 1e-3);
            noisy = isNoisy(fit, chart, mesh.positions[vertex], out.margin) || (noisy && fit.distinct < 1e-3);
            out.wider = noisy;
        }
        if (out.wider) {
            points = threeRing(all, vertex, points);
            widen(chart, mesh, points, vertex, out.replaced, true);
            fine = 1;
            fit = fitTo(mesh, points, chart, vertex, out.border, fine);
        }
        nearer(out.lowMargin, fit.told, 1);
        out.low = fit.told < 1;
        out.margin = std::min(out.margin, fine);
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
