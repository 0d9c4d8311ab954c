#include "lut/tabulated_integrals.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pel {
namespace {

// Gauss-Legendre on [-1, 1], 4 points.
constexpr double gaussAt[4] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
constexpr double gaussWeight[4] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                   0.3478548451374538};
constexpr size_t knotsWorthCells = 128;  // a table with more is finer than the meshes here

cl_float4 float4Of(const Rgb& v, double w) {
    return {{float(v[0]), float(v[1]), float(v[2]), float(w)}};
}

// Ascending borders of cells, together with the knots between them.
std::vector<double> withKnots(std::vector<double> borders, const std::vector<cl_float4>& knots) {
    if (knots.size() > knotsWorthCells) return borders;
    const double end = borders.back();
    for (const cl_float4& knot : knots)
        if (knot.s[3] < end) borders.push_back(knot.s[3]);
    std::sort(borders.begin(), borders.end());
    borders.erase(std::unique(borders.begin(), borders.end()), borders.end());
    return borders;
}

}  // namespace

std::vector<cl_float4> tableKnots(const Profile& profile) {
    const double unit = profile.radius();
    std::vector<double> distances{0};
    for (double knot : profile.shape().knots()) distances.push_back(knot);
    std::vector<cl_float4> knots;
    for (double d : distances) {
        Rgb R = profile.shape().radial(d);
        for (double& value : R) value *= unit * unit;
        knots.push_back(float4Of(R, d / unit));
    }
    return knots;
}

double tableEnd(const Profile& profile) {
    return std::min(tableReach(profile), profileCut);
}

double tableReach(const Profile& profile) {
    return profile.shape().knots().back() / profile.radius();
}

// From the end inwards, cell by cell: each tail is the tail of the next cell plus what P adds within the
// cell. P behaves like the root of the distance before each distance where R bends or ends, so cells are
// split there and integrated over that root.
std::vector<cl_float4> tableTails(const Profile& profile, double end) {
    const double unit = profile.radius();
    const auto lineSpread = [&](double s) {
        Rgb P = profile.shape().lineSpread(s * unit);
        for (double& value : P) value *= unit;
        return P;
    };
    std::vector<double> mesh;
    for (int i = 0; i <= PEL_TAIL_CELLS; ++i) mesh.push_back(end * i / PEL_TAIL_CELLS * i / PEL_TAIL_CELLS);
    const std::vector<double> borders = withKnots(mesh, tableKnots(profile));

    std::vector<cl_float4> tails(size_t(PEL_TAIL_CELLS + 1) * PEL_TAIL_VALUES);
    Rgb mass{}, first{}, second{}, third{};
    size_t border = borders.size() - 1;
    for (int i = PEL_TAIL_CELLS; i >= 0; --i) {
        while (borders[border] > mesh[i]) {
            const double b = borders[border], a = borders[--border], h = b - a;
            for (int c = 0; c < 3; ++c) {
                third[c] += h * (second[c] + h * (first[c] / 2 + h * mass[c] / 6));
                second[c] += h * (first[c] + h * mass[c] / 2);
                first[c] += h * mass[c];
            }
            for (int q = 0; q < 4; ++q) {
                const double x = 0.5 + 0.5 * gaussAt[q], t = h * (1 - x * x), weight = gaussWeight[q] * h * x;
                const Rgb P = lineSpread(a + t);
                for (int c = 0; c < 3; ++c) {
                    const double m = weight * P[c];
                    mass[c] += m;
                    first[c] += m * t;
                    second[c] += m * t * t / 2;
                    third[c] += m * t * t * t / 6;
                }
            }
        }
        cl_float4* out = tails.data() + size_t(i) * PEL_TAIL_VALUES;
        out[PEL_TAIL_SPREAD] = float4Of(lineSpread(mesh[i]), 0);
        out[PEL_TAIL_MASS] = float4Of(mass, 0);
        out[PEL_TAIL_FIRST] = float4Of(first, 0);
        out[PEL_TAIL_SECOND] = float4Of(second, 0);
        out[PEL_TAIL_THIRD] = float4Of(third, 0);
    }
    return tails;
}

// Two points in each cell, weighted so that linear f are exact for any R within the cell. Cells are narrow
// near the shaded point, and at the end, where the circle round a sphere closes.
std::vector<cl_float4> tablePoints(const std::vector<cl_float4>& knots, double diameter) {
    constexpr int cells = 128;
    const double end = std::min<double>(knots.back().s[3], diameter);
    std::vector<double> borders;
    for (int i = 0; i <= cells; ++i)
        borders.push_back(end * std::sin(std::numbers::pi / 2 * i / cells * i / cells));
    // Opposite to the light the mean over a circle has a corner where the circle is a great circle.
    const double quarter = diameter / std::numbers::sqrt2;
    if (quarter < end) borders.insert(std::upper_bound(borders.begin(), borders.end(), quarter), quarter);
    borders = withKnots(borders, knots);

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
                const double d = (a + b) / 2 + h * gaussAt[q],
                             f = (d - low.s[3]) / (double(high.s[3]) - low.s[3]);
                for (int c = 0; c < 3; ++c) {
                    const double m = gaussWeight[q] * h * d * (low.s[c] + f * (double(high.s[c]) - low.s[c]));
                    sum[c] += m;
                    moment[c] += m * (d - middle) / half;
                }
            }
            a = b;
        }
        for (double sign : {-1.0, 1.0}) {
            const double at = sign / std::numbers::sqrt3;
            Rgb weight;
            for (int c = 0; c < 3; ++c) {
                weight[c] = (sum[c] + moment[c] / at) / 2;
                all[c] += weight[c];
            }
            points.push_back({weight, middle + half * at});
        }
    }
    // A table may have no energy so near in some channel: then nothing scatters.
    Rgb none{};
    for (int c = 0; c < 3; ++c)
        if (!(all[c] > 0)) none[c] = 1;
    std::vector<cl_float4> result{float4Of(none, 0)};
    for (auto& [weight, d] : points) {
        for (int c = 0; c < 3; ++c) weight[c] = all[c] > 0 ? weight[c] / all[c] : 0;
        result.push_back(float4Of(weight, d));
    }
    return result;
}

}  // namespace pel
