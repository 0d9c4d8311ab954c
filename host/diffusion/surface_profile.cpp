#include "diffusion/surface_profile.h"

#include <numbers>

namespace pel {
namespace {

constexpr double whole = 0.5 / std::numbers::pi;  // M(inf) of a profile normalised on a plane
constexpr double leftOut = 1e-7;  // part of the energy that may lie beyond the table, at either end
constexpr int octavesIn = 60,
              octavesOut = 14;  // round the profile's width, in which the table's ends are looked for

// Gauss-Legendre on [0, 1], 5 points.
constexpr double gaussAt[5] = {0.04691007703066800, 0.23076534494715845, 0.5, 0.76923465505284155,
                               0.95308992296933200};
constexpr double gaussPart[5] = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                 0.23931433524968324, 0.11846344252809454};

// R. A tabulated profile, which ends, is continued with its last value.
Rgb radial(const ProfileShape& shape, const std::vector<double>& knots, double s) {
    return shape.radial(knots.empty() ? s : std::min(s, knots.back()));
}

// Integral of R(s) s ds over [a, b], split where R has kinks.
Rgb energyBetween(const ProfileShape& shape, const std::vector<double>& knots, double a, double b) {
    std::vector<double> borders{a};
    for (double k : knots)
        if (k > a && k < b) borders.push_back(k);
    borders.push_back(b);
    std::sort(borders.begin(), borders.end());
    Rgb sum{};
    for (size_t i = 0; i + 1 < borders.size(); ++i) {
        const double from = borders[i], length = borders[i + 1] - from;
        for (int q = 0; q < 5; ++q) {
            const double s = from + gaussAt[q] * length;
            sum += gaussPart[q] * length * s * radial(shape, knots, s);
        }
    }
    return sum;
}

}  // namespace

double SurfaceProfile::distance(size_t row) const {
    return std::exp2(firstLog2 + double(row) / PEL_SURFACE_ROWS);
}

SurfaceProfile tabulateProfile(const ProfileShape& shape, double scale, const Three& cutInPositions) {
    const std::vector<double> knots = shape.knots();
    Three cut = cutInPositions / scale;
    for (int c = 0; c < 3; ++c) {
        // A tabulated profile may end above 0.
        if (!knots.empty() && shape.radial(knots.back())[c] > 0 && !(cut[c] > 0 && cut[c] < knots.back()))
            cut[c] = knots.back();
    }
    const double first = std::log2(largest(shape.width())) - octavesIn;
    const int cells = (octavesIn + octavesOut) * PEL_SURFACE_ROWS;
    const auto at = [&](int i) { return std::exp2(first + double(i) / PEL_SURFACE_ROWS); };
    // Within the first distance R is taken as constant times 1/s.
    std::vector<Rgb> enclosed(size_t(cells) + 1);
    for (int i = 0; i < cells; ++i)
        enclosed[i + 1] = enclosed[i] + energyBetween(shape, knots, at(i), at(i + 1));
    Rgb all = enclosed[cells];
    for (int c = 0; c < 3; ++c) {
        if (!(cut[c] > 0)) continue;
        const int row = int(std::clamp((std::log2(cut[c]) - first) * PEL_SURFACE_ROWS, 0.0, double(cells)));
        all[c] = enclosed[row][c] + (cut[c] > at(row) ? energyBetween(shape, knots, at(row), cut[c])[c] : 0);
    }
    const char* const names[] = {"red", "green", "blue"};
    for (int c = 0; c < 3; ++c)
        if (!(all[c] > 0))
            invalidArgument("the profile has no ", names[c], " energy within ", cutInPositions[c],
                            " of its centre; a longer PelSurfaceIntegralDesc.cut, or 0, would be right");
    int low = cells, high = 0;
    for (int c = 0; c < 3; ++c) {
        int begin = 0, end = cells;
        while (begin + 1 < cells && enclosed[begin + 1][c] < leftOut * all[c]) ++begin;
        while (end > begin + 1 && enclosed[end - 1][c] > (1 - leftOut) * all[c]) --end;
        low = std::min(low, begin);
        high = std::max(high, end);
    }
    SurfaceProfile table;
    table.firstLog2 = first + double(low) / PEL_SURFACE_ROWS + std::log2(scale);
    table.reach = at(high) * scale;
    table.cut = scale * cut;
    // Where R steps or has kinks, the rule along edges has an error proportional to the step of s^2 R and
    // to the square of the interval.
    constexpr double atOnce = 1.25, wanted = 1e-5, errorOfStep = 2.5e-3, kinks = 0.2;
    double step = knots.empty() ? 0 : kinks;
    for (int c = 0; c < 3; ++c)
        if (cut[c] > 0)
            step = std::max(step, 2 * std::numbers::pi * cut[c] * cut[c] * radial(shape, knots, cut[c])[c] *
                                      whole / all[c]);
    table.piece = atOnce / std::max(1.0, std::sqrt(step * errorOfStep / wanted));
    // sup from the end inwards, for this profile in units of positions: R scales with 1/length^2.
    const int rows = high - low + 1;
    table.curving.resize(rows);
    table.fall.resize(rows);
    double curving = 0, fall = 0;
    for (int i = rows - 1; i >= 0; --i) {
        const double s = at(low + i), step = s * 1e-3;
        const Rgb before = radial(shape, knots, s - step), here = radial(shape, knots, s),
                  behind = radial(shape, knots, s + step);
        for (int c = 0; c < 3; ++c) {
            if (cut[c] > 0 && s > cut[c]) continue;
            const double norm = whole / all[c], first = norm * (behind[c] - before[c]) / (2 * step),
                         second = norm * (behind[c] - 2 * here[c] + before[c]) / (step * step);
            fall = std::max(fall, std::abs(first) / std::pow(scale, 3));
            curving = std::max(
                {curving, std::abs(first) / s / std::pow(scale, 4), std::abs(second) / std::pow(scale, 4)});
        }
        table.curving[i] = curving;
        table.fall[i] = fall;
    }
    for (int i = low; i <= high; ++i) {
        const double s = at(i);
        const Rgb R = radial(shape, knots, s);
        cl_float4 value{}, slope{};
        for (int c = 0; c < 3; ++c) {
            value.s[c] = float(enclosed[i][c] / all[c] * whole);
            slope.s[c] = float(R[c] * s * s * whole / all[c] * std::numbers::ln2 / PEL_SURFACE_ROWS);
        }
        table.rows.push_back(value);
        table.rows.push_back(slope);
    }
    return table;
}

}  // namespace pel
