#include "lut/lut_terms.h"

#include <numbers>

namespace pel {
namespace {

// Gauss-Legendre on [-1, 1], 4 points.
constexpr double inner = 0.3399810435848563, outer = 0.8611363115940526;
constexpr double fourAt[4] = {-outer, -inner, inner, outer};
constexpr double innerWeight = 0.6521451548625461, outerWeight = 0.3478548451374538;
constexpr double fourWeight[4] = {outerWeight, innerWeight, innerWeight, outerWeight};
// Below these angles chords are too near to the diameter for differences of moments, and of total, in float.
constexpr double nearAntipode = 0.8, antipodalAngle = 0.02;
constexpr size_t maxKnots = 128;  // a table with more distances is finer than the meshes here

cl_float4 float4Of(const Rgb& v, double w) {
    return {{float(v[0]), float(v[1]), float(v[2]), float(w)}};
}

// Ascending borders of cells, together with the knots between them.
std::vector<double> withKnots(std::vector<double> borders, const std::vector<cl_float4>& knots) {
    if (knots.size() > maxKnots) return borders;
    const double end = borders.back();
    for (const cl_float4& knot : knots)
        if (knot.s[3] < end) borders.push_back(knot.s[3]);
    std::sort(borders.begin(), borders.end());
    borders.erase(std::unique(borders.begin(), borders.end()), borders.end());
    return borders;
}

std::vector<double> meshOfCells(double end, int cells) {
    std::vector<double> mesh;
    for (int i = 0; i <= cells; ++i) mesh.push_back(end * i / cells * i / cells);
    return mesh;
}

Rgb lineSpread(const Profile& profile, double distance) {
    return profile.radius() * profile.shape().lineSpread(distance * profile.radius());
}

// visit(distance from a, total) for the points that stand for P from a to b. P behaves like the root of the
// distance before each distance where the slope of R changes or R ends, so a and b are such distances or have
// none between them, and points are evenly spaced in that root.
void eachPoint(const Profile& profile, double a, double b, auto&& visit) {
    const double h = b - a;
    for (int q = 0; q < 4; ++q) {
        const double x = 0.5 + 0.5 * fourAt[q], t = h * (1 - x * x), weight = fourWeight[q] * h * x;
        visit(t, weight * lineSpread(profile, a + t));
    }
}

}  // namespace

std::vector<cl_float4> tableKnots(const Profile& profile) {
    const double unit = profile.radius();
    std::vector<double> distances{0};
    for (double knot : profile.shape().knots()) distances.push_back(knot);
    std::vector<cl_float4> knots;
    for (double d : distances) knots.push_back(float4Of(unit * unit * profile.shape().radial(d), d / unit));
    return knots;
}

double tableEnd(const Profile& profile) {
    return std::min(tableReach(profile), profileCut);
}

double tableReach(const Profile& profile) {
    return profile.shape().knots().back() / profile.radius();
}

// From the end inwards, cell by cell: each tail is the tail of the next cell plus what P adds within the
// cell.
std::vector<cl_float4> tableTails(const Profile& profile, double end) {
    const std::vector<double> mesh = meshOfCells(end, PEL_TAIL_CELLS),
                              borders = withKnots(mesh, tableKnots(profile));
    std::vector<cl_float4> tails(size_t(PEL_TAIL_CELLS + 1) * PEL_TAIL_VALUES);
    Rgb total{}, first{}, second{}, third{};
    size_t border = borders.size() - 1;
    for (int i = PEL_TAIL_CELLS; i >= 0; --i) {
        while (borders[border] > mesh[i]) {
            const double b = borders[border], a = borders[--border], h = b - a;
            third += h * (second + h * (first / 2 + h * total / 6));
            second += h * (first + h * total / 2);
            first += h * total;
            eachPoint(profile, a, b, [&](double t, const Rgb& m) {
                total += m;
                first += t * m;
                second += t * (t * m) / 2;
                third += t * (t * (t * m)) / 6;
            });
        }
        cl_float4* out = tails.data() + size_t(i) * PEL_TAIL_VALUES;
        out[PEL_TAIL_SPREAD] = float4Of(lineSpread(profile, mesh[i]), 0);
        out[PEL_TAIL_TOTAL] = float4Of(total, 0);
        out[PEL_TAIL_FIRST] = float4Of(first, 0);
        out[PEL_TAIL_SECOND] = float4Of(second, 0);
        out[PEL_TAIL_THIRD] = float4Of(third, 0);
    }
    return tails;
}

std::vector<cl_float4> lineSums(const Profile& profile, double end, int cells) {
    const std::vector<double> mesh = meshOfCells(end, cells), borders = withKnots(mesh, tableKnots(profile));
    std::vector<cl_float4> sums;
    Rgb total{}, moment{};
    size_t border = 0;
    for (double distance : mesh) {
        while (borders[border] < distance) {
            const double a = borders[border], b = borders[++border];
            moment += (b - a) * total;
            eachPoint(profile, a, b, [&](double t, const Rgb& m) {
                total += m;
                moment += (b - a - t) * m;
            });
        }
        sums.insert(sums.end(),
                    {float4Of(lineSpread(profile, distance), 0), float4Of(total, 0), float4Of(moment, 0)});
    }
    return sums;
}

std::vector<cl_float4> radialSums(const Profile& profile, double end, int cells) {
    const std::vector<cl_float4> knots = tableKnots(profile);
    std::vector<cl_float4> sums;
    Rgb total{}, moment{};
    size_t piece = 0;
    double at = 0;
    const auto radial = [&](double distance) {
        const float *low = knots[piece].s, *high = knots[piece + 1].s;
        const double f = (distance - low[3]) / (double(high[3]) - low[3]);
        return threeAt(low) + f * (threeAt(high) - threeAt(low));
    };
    for (double distance : meshOfCells(end, cells)) {
        while (at < distance) {
            const bool last = piece + 2 == knots.size();
            const double next = last ? distance : std::min<double>(distance, knots[piece + 1].s[3]),
                         h = next - at;
            const Rgb low = radial(at), high = radial(next);
            moment += h * total + h * h * (2 * low + high) / 6;
            total += h * (low + high) / 2;
            at = next;
            if (next < distance) ++piece;
        }
        const Rgb R = threeOf([&](int c) { return std::max(radial(distance)[c], 0.0); });
        sums.insert(sums.end(), {float4Of(R, 0), float4Of(total, 0), float4Of(moment, 0)});
    }
    return sums;
}

std::vector<cl_float4> antipodes(const Profile& profile, bool radial, const std::vector<double>& radii) {
    std::vector<cl_float4> densities;
    for (double radius : radii) {
        const double chord = 2 * radius * std::cos(antipodalAngle / 4), unit = profile.radius();
        densities.push_back(float4Of(
            radial ? unit * unit * profile.shape().radial(chord * unit) : lineSpread(profile, chord), 0));
    }
    return densities;
}

std::vector<TableInterval> tableMesh(int nodes, bool chord) {
    std::vector<TableInterval> mesh;
    for (int j = 0; j < nodes; ++j) {
        const double low = nodeAngle(j, nodes), high = nodeAngle(j + 1, nodes),
                     sine = std::sin((high - low) / 2);
        // t: the angle of the mesh; points behind are at pi - t.
        const auto side = [&](bool back) {
            const auto distance = [&](double t) {
                if (chord) return 2 * (back ? std::cos(t / 2) : std::sin(t / 2));
                return back ? std::numbers::pi - t : t;
            };
            const double nearest = back ? distance(high) : distance(low),
                         length = std::abs(distance(high) - distance(low));
            // Least squares over the distances of the interval.
            const auto fit = [&](auto&& weight) {
                double sum = 0, moment = 0;
                for (int q = 0; q < 4; ++q) {
                    const double x = nearest + length * (1 + fourAt[q]) / 2;
                    double t = x, perDistance = 1;
                    if (chord) t = 2 * std::asin(std::min(x / 2, 1.0)), perDistance = 1 / std::cos(t / 2);
                    if (back) t = std::numbers::pi - t;
                    const double w = weight(t) * perDistance * fourWeight[q] / 2;
                    sum += w, moment += w * fourAt[q];
                }
                const double slope = 6 * moment / length;
                return TableWeight{float(sum - slope * length / 2), float(slope)};
            };
            if (back && chord && high < antipodalAngle) {
                const double h = high - low;
                return TableSide{2,
                                 2,
                                 {float(2 * sine * sine), 0},
                                 {float(std::sin(h)), 0},
                                 {float(std::sin(high) - std::sin(low)), 0},
                                 {float(h), 0}};
            }
            return TableSide{float(distance(low)),
                             float(back && chord && high < nearAntipode),
                             fit([&](double t) { return std::sin(t - low); }),
                             fit([&](double t) { return std::cos(t - low); }),
                             fit([](double t) { return std::cos(t); }),
                             fit([](double) { return 1.0; })};
        };
        mesh.push_back({float(std::sin(high - low)), float(2 * sine * sine), side(false), side(true)});
    }
    return mesh;
}

std::vector<RampWeight> rampWeights() {
    constexpr int parts = PEL_RAMP_PARTS;
    std::vector<std::array<double, 4>> sums(2 * parts + 1);
    for (int k = 0; k < 2 * parts; ++k)
        for (int q = 0; q < 4; ++q) {
            const double t = (1 + fourAt[q]) / 2, u = 1 - t, y = (k + t) / parts - 1;
            const double w = 0.75 * (1 - y * y) * fourWeight[q] / (2 * parts);
            const double value[2] = {u * u * (1 + 2 * t), t * t * (3 - 2 * t)},
                         slope[2] = {u * u * t, -t * t * u};
            const double valueToSlope[2] = {-6 * t * u, 6 * t * u},
                         slopeToSlope[2] = {u * (1 - 3 * t), t * (3 * t - 2)};
            for (int side = 0; side < 2; ++side) {
                std::array<double, 4>& sum = sums[size_t(k + side)];
                sum[0] += w * value[side], sum[1] += w * slope[side];
                sum[2] += w * parts * valueToSlope[side], sum[3] += w * parts * slopeToSlope[side];
            }
        }
    std::vector<RampWeight> weights;
    for (const auto& sum : sums)
        weights.push_back({float(sum[0]), float(sum[1]), float(sum[2]), float(sum[3])});
    return weights;
}

// Two points in each cell, weighted so that linear f are exact for any R within the cell. Cells are narrow
// near the shaded point, and at the end, where the circle round a sphere closes.
std::vector<cl_float4> tablePoints(const std::vector<cl_float4>& knots, double diameter) {
    constexpr int cells = 96;
    const double end = std::min<double>(knots.back().s[3], diameter);
    std::vector<double> borders;
    for (int i = 0; i <= cells; ++i)
        borders.push_back(end * std::sin(std::numbers::pi / 2 * i / cells * i / cells));
    // Opposite to the light the mean over a circle has a corner where the circle is a great circle.
    const double quarter = diameter / std::numbers::sqrt2;
    if (quarter < end) borders.insert(std::upper_bound(borders.begin(), borders.end(), quarter), quarter);

    std::vector<std::pair<Rgb, double>> points;
    Rgb all{};
    size_t piece = 0;
    for (size_t i = 0; i + 1 < borders.size(); ++i) {
        const double middle = (borders[i] + borders[i + 1]) / 2, half = (borders[i + 1] - borders[i]) / 2;
        Rgb sum{}, moment{};  // of R d; and about the middle, in halves
        for (double a = borders[i]; a < borders[i + 1];) {
            while (piece + 1 < knots.size() && knots[piece + 1].s[3] <= a) ++piece;
            if (piece + 1 == knots.size()) break;
            const cl_float4 &low = knots[piece], &high = knots[piece + 1];
            const double b = std::min<double>(borders[i + 1], high.s[3]), h = (b - a) / 2;
            for (int q = 0; q < 4; ++q) {
                const double d = (a + b) / 2 + h * fourAt[q],
                             f = (d - low.s[3]) / (double(high.s[3]) - low.s[3]);
                const Rgb m =
                    fourWeight[q] * h * d * (threeAt(low.s) + f * (threeAt(high.s) - threeAt(low.s)));
                sum += m;
                moment += (d - middle) * m / half;
            }
            a = b;
        }
        for (double sign : {-1.0, 1.0}) {
            const double at = sign / std::numbers::sqrt3;
            const Rgb weight = (sum + moment / at) / 2;
            all += weight;
            points.push_back({weight, middle + half * at});
        }
    }
    // A table may have no energy so near in some channel: then nothing scatters.
    std::vector<cl_float4> result{float4Of(threeOf([&](int c) { return all[c] > 0 ? 0.0 : 1.0; }), 0)};
    for (const auto& point : points) {
        const Rgb share = threeOf([&](int c) { return all[c] > 0 ? point.first[c] / all[c] : 0; });
        result.push_back(float4Of(share, point.second));
    }
    return result;
}

}  // namespace pel
