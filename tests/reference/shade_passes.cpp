#include "reference/shade_passes.h"

#include <limits>

#include <algorithm>
#include <cmath>

namespace reference {
namespace {

bool finite(Vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Whether a number so near to a limit might fall on its other side in single precision.
bool near(double value, double limit) {
    return std::abs(value - limit) < 1e-4 * std::max(1.0, std::abs(limit));
}

// One direction of the blur: means of `values` along (dx, dy).
std::vector<Vec3> blurAlong(const SurfacePixels& s, const std::vector<Vec3>& values, int dx, int dy,
                            std::vector<bool>& doubtful) {
    std::vector<Vec3> out = values;
    const auto index = [&](int x, int y) { return size_t(y) * s.width + x; };
    const auto valid = [&](size_t i) { return finite(s.normals[i]) && finite(s.positions[i]); };
    for (int y = 0; y < s.height; ++y)
        for (int x = 0; x < s.width; ++x) {
            const size_t at = index(x, y);
            const int id = s.ids[at];
            if (!id || !valid(at)) continue;
            const auto inside = [&](int qx, int qy) {
                return qx >= 0 && qy >= 0 && qx < s.width && qy < s.height && s.ids[index(qx, qy)] == id;
            };
            const double radius = s.radii[id];
            double spacing = INFINITY;
            for (int side : {-1, 1})
                if (inside(x + side * dx, y + side * dy) && valid(index(x + side * dx, y + side * dy)))
                    spacing = std::min(
                        spacing, length(s.positions[index(x + side * dx, y + side * dy)] - s.positions[at]));
            if (std::isinf(spacing)) continue;
            const double wanted = radius / (6 * spacing);
            const int step = int(std::clamp(std::ceil(wanted), 1.0, 64.0));
            if (near(wanted, std::round(wanted)) && wanted > 0.5) doubtful[at] = true;
            Vec3 sum = values[at];
            double total = 1;
            for (int side : {-1, 1}) {
                Vec3 before = s.positions[at];
                double longest = step * spacing;
                for (int k = 1; k <= 6; ++k) {
                    const int qx = x + side * k * step * dx, qy = y + side * k * step * dy;
                    if (!inside(qx, qy)) break;
                    const size_t q = index(qx, qy);
                    if (!valid(q)) continue;
                    const double gap = length(s.positions[q] - before),
                                 distance = length(s.positions[q] - s.positions[at]) / radius;
                    if (near(gap, 3 * longest)) doubtful[at] = true;
                    if (gap > 3 * longest || distance >= 1) break;
                    const double weight = (1 - distance * distance) * (1 - distance * distance);
                    if (doubtful[q]) doubtful[at] = true;
                    sum = sum + weight * values[q];
                    total += weight;
                    longest = std::max(longest, gap);
                    before = s.positions[q];
                }
            }
            out[at] = sum / total;
        }
    return out;
}

}  // namespace

std::vector<std::optional<Vec3>> blurredNormals(const SurfacePixels& s, std::vector<bool>* doubtful) {
    std::vector<bool> flags(s.normals.size());
    const auto along = blurAlong(s, blurAlong(s, s.normals, 1, 0, flags), 0, 1, flags);
    std::vector<std::optional<Vec3>> out(along.size());
    for (size_t i = 0; i < along.size(); ++i)
        if (s.ids[i] && finite(s.normals[i]) && finite(s.positions[i])) out[i] = normalized(along[i]);
    if (doubtful) *doubtful = flags;
    return out;
}

Vec3 sampleRepeated(const NormalLevel& level, double u, double v) {
    const auto texel = [&](int i, int j) {
        const int x = (i % level.width + level.width) % level.width,
                  y = (j % level.height + level.height) % level.height;
        return level.texels[size_t(y) * level.width + x];
    };
    const double x = u * level.width - 0.5, y = v * level.height - 0.5;
    const int i = int(std::floor(x)), j = int(std::floor(y));
    const double fx = x - i, fy = y - j;
    return (1 - fy) * ((1 - fx) * texel(i, j) + fx * texel(i + 1, j)) +
           fy * ((1 - fx) * texel(i, j + 1) + fx * texel(i + 1, j + 1));
}

double footprintLevel(const std::array<double, 4>& g, int width, int height) {
    return std::log2(
        std::max(std::hypot(g[0] * width, g[1] * height), std::hypot(g[2] * width, g[3] * height)));
}

Vec3 trilinear(const std::vector<NormalLevel>& levels, double u, double v, double level) {
    const double at = std::clamp(level, 0.0, double(levels.size() - 1));
    const size_t fine = size_t(at), coarse = std::min(fine + 1, levels.size() - 1);
    const double f = at - double(fine);
    return (1 - f) * sampleRepeated(levels[fine], u, v) + f * sampleRepeated(levels[coarse], u, v);
}

Vec3 fromTangentSpace(Vec3 texel, Vec3 tangent, Vec3 normal, double side) {
    return normalized(texel.x * tangent + side * texel.y * cross(normal, tangent) + texel.z * normal);
}

std::vector<FilterSample> filterSamples(const ShadowMap& map, const ShadowView& view, Vec3 position,
                                        Vec3 normal, const WideFilterParams& p) {
    std::vector<FilterSample> samples;
    const Vec3 from = position - view.origin;
    const double along = dot(from, view.forward),
                 across = view.decoding.perspective ? view.extent * along : view.extent;
    if (view.decoding.perspective && !(along > 0)) return samples;
    // Depth of a distance, and its derivative.
    const double a = view.decoding.a, b = view.decoding.b;
    const double z = view.decoding.perspective ? (1 / along - b) / a : along / view.decoding.range;
    const double zPerLength = view.decoding.perspective ? -1 / (a * along * along) : 1 / view.decoding.range;
    const double u = dot(from, view.right) / across + 0.5, v = dot(from, view.down) / across + 0.5;
    const Vec3 toLight = view.decoding.perspective ? from / -along : -1 * view.forward;
    const double cosine = dot(normal, toLight), tilt = 1 / std::max(cosine, 0.2);
    const double receiver = z - (p.bias + 2 * p.width * max0(-cosine)) * zPerLength;
    const double texelU = across / map.width, texelV = across / map.height;
    const double radiusU = std::max(p.width / 2 / texelU, 2.0), radiusV = std::max(p.width / 2 / texelV, 2.0);
    const int step = std::max(1, int(std::ceil(2 * std::max(radiusU, radiusV) / p.maxTexels)));
    const double x = u * map.width - 0.5, y = v * map.height - 0.5;
    for (int j = int(std::floor(y - radiusV)); j <= y + radiusV + 1; ++j)
        for (int i = int(std::floor(x - radiusU)); i <= x + radiusU + 1; ++i) {
            if (i % step || j % step) continue;
            const double r = std::hypot((i - x) / radiusU, (j - y) / radiusV);
            if (r >= 1) continue;
            const double t = 1 - r * r, weight = std::sqrt(t) / (1 + t) + std::atan(std::sqrt(t));
            const bool inside = i >= 0 && j >= 0 && i < map.width && j < map.height;
            const double sideways =
                dot(normal, view.right) * (i - x) * texelU + dot(normal, view.down) * (j - y) * texelV;
            samples.push_back({inside ? j * map.width + i : -1, weight,
                               receiver + (sideways - p.coneSlope * p.width / 2 * r) * tilt * zPerLength,
                               zPerLength});
        }
    return samples;
}

double wideShadow(const ShadowMap& map, const ShadowView& view, Vec3 position, Vec3 normal,
                  const WideFilterParams& p) {
    double sum = 0, total = 0;
    for (const FilterSample& s : filterSamples(map, view, position, normal, p)) {
        const double depth = s.texel < 0 ? NAN : map.depth[size_t(s.texel)];
        sum += s.weight * (std::isfinite(depth)
                               ? saturate(1 + (depth - s.receiver) / (p.softness * p.width * s.zPerLength))
                               : 1.0);
        total += s.weight;
    }
    return total > 0 ? sum / total : 1;
}

double sharpShadow(const ShadowMap& map, const ShadowView& view, Vec3 position, Vec3 normal) {
    const Vec3 from = position - view.origin;
    const double along = dot(from, view.forward),
                 across = view.decoding.perspective ? view.extent * along : view.extent;
    if (!(along > 0) && view.decoding.perspective) return 1;
    const double size = across / map.width;  // of a texel, length
    const double a = view.decoding.a, b = view.decoding.b;
    const double z = view.decoding.perspective ? (1 / along - b) / a : along / view.decoding.range;
    const double zPerLength = view.decoding.perspective ? -1 / (a * along * along) : 1 / view.decoding.range;
    const double x = (dot(from, view.right) / across + 0.5) * map.width - 0.5,
                 y = (dot(from, view.down) / across + 0.5) * map.height - 0.5;
    const Vec3 toLight = view.decoding.perspective ? from / -along : -1 * view.forward;
    const double tilt = 1 / std::max(dot(normal, toLight), 0.05), tolerance = 0.5 * size * tilt;
    // Length along the light, to first order; NaN outside.
    const auto depth = [&](int i, int j) {
        const bool inside = i >= 0 && j >= 0 && i < map.width && j < map.height;
        return inside ? map.depth[size_t(j) * map.width + i] / zPerLength : NAN;
    };
    const auto share = [&](int i, int j) {
        const double plane =
            z / zPerLength +
            (dot(normal, view.right) * (i - x) + dot(normal, view.down) * (j - y)) * size * tilt;
        const double behind = depth(i, j) - plane;
        return std::isfinite(behind) ? saturate(2 + behind / tolerance) : 1.0;
    };
    const auto dark = [&](int i, int j) { return share(i, j) < 0.5; };
    // From the middle of a dark texel towards the lit one at (i + di, j + dj).
    const auto fraction = [&](int i, int j, int di, int dj) {
        if (!dark(i - di, j - dj) || !dark(i - 2 * di, j - 2 * dj)) return 0.5;
        const double outer = depth(i, j) - depth(i - di, j - dj),
                     inner = depth(i - di, j - dj) - depth(i - 2 * di, j - 2 * dj);
        if (!(inner > 0 && outer > 1.1 * inner && outer < 6 * inner)) return 0.5;
        const double ratio = outer / inner;
        return 0.25 + 0.5 * saturate((0.0661 / (ratio - 1) + 0.1207) / (ratio - 1) - 0.1184);
    };
    const auto weight = [](double offset) { return std::pow(max0(1 - std::pow(offset / 1.5, 2)), 2); };
    double sum = 0, total = 0, least = 1, most = 0;
    const int middleX = int(std::floor(x + 0.5)), middleY = int(std::floor(y + 0.5));
    for (int j = middleY - 1; j <= middleY + 1; ++j)
        for (int i = middleX - 1; i <= middleX + 1; ++i) {
            double inverse = 0;
            for (int axis = 0; axis < 2; ++axis) {
                double nearest = std::numeric_limits<double>::infinity();
                for (int side : {-1, 1}) {
                    const int di = axis ? 0 : side, dj = axis ? side : 0;
                    if (dark(i, j) == dark(i + di, j + dj)) continue;
                    nearest = std::min(nearest, dark(i, j) ? fraction(i, j, di, dj)
                                                           : 1 - fraction(i + di, j + dj, -di, -dj));
                }
                inverse += 1 / (nearest * nearest);
            }
            const double beside = std::min(1 / std::sqrt(inverse), 0.5), w = weight(i - x) * weight(j - y);
            sum += w * (0.5 + beside * (2 * share(i, j) - 1));
            total += w;
            least = std::min(least, share(i, j)), most = std::max(most, share(i, j));
        }
    if (least == 1 || most == 0) return least;
    return saturate(3 * (sum / total - 0.5) + 0.5);
}

}  // namespace reference
