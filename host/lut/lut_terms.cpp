#include "lut/lut_terms.h"

#include <numbers>

namespace pel {

// A Gaussian narrower than 1e-8 of the profile and of the table's smallest radius changes no texel by more
// than that. It is widened to that, since its density has no value at 0. Terms without weight in any channel
// are left out.
std::vector<LutGaussian> deviceTerms(const Profile& profile, double steepestRow) {
    std::vector<LutGaussian> terms;
    for (const GaussianTerm& term : profile.terms()) {
        if (largest(term.weight) < 1e-9) continue;
        const double sigma =
            std::max(std::sqrt(term.variance) / profile.radius(), 1e-8 / std::max(1.0, steepestRow));
        terms.push_back({float(sigma), float(term.weight[0]), float(term.weight[1]), float(term.weight[2])});
    }
    return terms;
}

double nodeAngle(int j, int nodes) {
    const double q = double(j) / nodes;
    return std::numbers::pi / 2 * q * q * q * q;
}

std::vector<LutNode> meshOfNodes(int nodes) {
    std::vector<LutNode> mesh;
    for (int j = 0; j <= nodes; ++j) {
        const double angle = nodeAngle(j, nodes), s = std::sin(angle / 2);
        mesh.push_back({float(angle), float(std::sin(angle)), float(std::cos(angle)), float(2 * s * s)});
    }
    return mesh;
}

// From u = -1 on. Linear columns are in the middle of texels, columns of the square-root axis run from end to
// end (lut/lut.cpp).
double columnElevation(uint32_t x, uint32_t width, PelLutAxis axis) {
    const double s = width > 1 ? 1 - 2.0 * x / (width - 1) : 0;
    return axis == PEL_AXIS_ROOT ? s * s : 1 - (x + 0.5) * 2 / width;
}

std::vector<LutColumn> curvatureColumns(uint32_t width, PelLutAxis axis, int nodes) {
    std::vector<LutColumn> columns;
    for (uint32_t x = 0; x < (width + 1) / 2; ++x) {
        const double elevation = columnElevation(x, width, axis);
        const double angle = std::asin(elevation);
        int j = std::min(nodes - 1, int(nodes * std::pow(angle / (std::numbers::pi / 2), 0.25)));
        while (j > 0 && nodeAngle(j, nodes) > angle) --j;
        const double low = nodeAngle(j, nodes), step = nodeAngle(j + 1, nodes) - low;
        const double t = (angle - low) / step;
        columns.push_back({float((1 + 2 * t) * (1 - t) * (1 - t)), float(-step * t * (1 - t) * (1 - t)),
                           float(t * t * (3 - 2 * t)), float(step * t * t * (1 - t)), float(elevation), j});
    }
    return columns;
}

RowAxis rowAxis(PelLutAxis axis, uint32_t height, double least, double most) {
    const bool root = axis == PEL_AXIS_ROOT;
    const double first = root ? std::sqrt(least) : least, last = root ? std::sqrt(most) : most;
    const double rows = root ? height - 1.0 : height, scale = last > first ? rows / (last - first) : 0.0;
    if (rows == 0) return {first, last - first, scale};
    const double step = (last - first) / rows;
    return {root ? first - 0.5 * step : first, step, scale};
}

RowRange rowRange(const Lut& lut) {
    const auto limit = [&](double length) { return std::clamp(lut.diffusionRadius() / length, 1e-9, 1e9); };
    const PelLutInfo& info = lut.info();
    if (info.kind == PEL_LUT_SHADOW) return {limit(info.shadow.widthMax), limit(info.shadow.widthMin)};
    return {limit(info.curvature.radiusMax), limit(info.curvature.radiusMin)};
}

RowAxis rowsOf(const Lut& lut) {
    const RowRange range = rowRange(lut);
    return rowAxis(PelLutAxis(lut.layout().axis), lut.height(), range.least, range.most);
}

}  // namespace pel
