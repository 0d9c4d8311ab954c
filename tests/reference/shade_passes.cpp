#include "reference/shade_passes.h"

namespace reference {
namespace {

// Whether a number is so near to a limit that it may be on the other side in single precision.
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
    return bilinearAt(u * level.width - 0.5, v * level.height - 0.5, [&](int i, int j) {
        const int x = (i % level.width + level.width) % level.width,
                  y = (j % level.height + level.height) % level.height;
        return level.texels[size_t(y) * level.width + x];
    });
}

double footprintLevel(const std::array<double, 4>& g, int width, int height) {
    return std::log2(
        std::max(std::hypot(g[0] * width, g[1] * height), std::hypot(g[2] * width, g[3] * height)));
}

Vec3 trilinear(const std::vector<NormalLevel>& levels, double u, double v, double level) {
    const double at = std::clamp(level, 0.0, double(levels.size() - 1));
    const size_t fine = size_t(at), coarse = std::min(fine + 1, levels.size() - 1);
    return mix(sampleRepeated(levels[fine], u, v), sampleRepeated(levels[coarse], u, v), at - double(fine));
}

Vec3 fromTangentSpace(Vec3 texel, Vec3 tangent, Vec3 normal, double side) {
    return normalized(texel.x * tangent + side * texel.y * cross(normal, tangent) + texel.z * normal);
}

namespace {

// Of the wide filter, at part r of its radius.
double diskWeight(double r) {
    const double t = 1 - r * r;
    return std::sqrt(t) / (1 + t) + std::atan(std::sqrt(t));
}

// A place as the light sees it: column and row in the map, texels' centres at whole numbers; its depth, and
// that by length; the length that the map spans there. along: from the light; not above 0: behind it.
struct OnMap {
    double along, across, x, y, z, zPerLength;
    Vec3 toLight;
    OnMap(const ShadowMap& map, const ShadowView& view, Vec3 position) {
        const Vec3 from = position - view.origin;
        const DepthDecoding& d = view.decoding;
        along = dot(from, view.forward);
        across = d.perspective ? view.extent * along : view.extent;
        x = (dot(from, view.right) / across + 0.5) * map.width - 0.5;
        y = (dot(from, view.down) / across + 0.5) * map.height - 0.5;
        z = d.perspective ? (1 / along - d.b) / d.a : along / d.range;
        zPerLength = d.perspective ? -1 / (d.a * along * along) : 1 / d.range;
        toLight = d.perspective ? from / -along : -1 * view.forward;
        if (!d.perspective) along = 1;
    }
};

// One texel under the filter, its weight, and the depth of the receiver's plane there, less the bias.
struct FilterSample {
    int texel;  // in map.depth; -1: outside of it
    double weight, receiver, zPerLength;
};
std::vector<FilterSample> filterSamples(const ShadowMap& map, const ShadowView& view, Vec3 position,
                                        Vec3 normal, const WideFilterParams& p) {
    std::vector<FilterSample> samples;
    const OnMap at(map, view, position);
    if (!(at.along > 0)) return samples;
    const double cosine = dot(normal, at.toLight), tilt = 1 / std::max(cosine, 0.2);
    const double receiver = at.z - (p.bias + 2 * p.width * max0(-cosine)) * at.zPerLength;
    const double texelU = at.across / map.width, texelV = at.across / map.height;
    const double radiusU = std::max(p.width / 2 / texelU, 2.0), radiusV = std::max(p.width / 2 / texelV, 2.0);
    const int step = std::max(1, int(std::ceil(2 * std::max(radiusU, radiusV) / p.maxTexels)));
    for (int j = int(std::floor(at.y - radiusV)); j <= at.y + radiusV + 1; ++j)
        for (int i = int(std::floor(at.x - radiusU)); i <= at.x + radiusU + 1; ++i) {
            if (i % step || j % step) continue;
            const double r = std::hypot((i - at.x) / radiusU, (j - at.y) / radiusV);
            if (r >= 1) continue;
            const bool inside = i >= 0 && j >= 0 && i < map.width && j < map.height;
            const double sideways =
                dot(normal, view.right) * (i - at.x) * texelU + dot(normal, view.down) * (j - at.y) * texelV;
            samples.push_back({inside ? j * map.width + i : -1, diskWeight(r),
                               receiver + (sideways - p.coneSlope * p.width / 2 * r) * tilt * at.zPerLength,
                               at.zPerLength});
        }
    return samples;
}

}  // namespace

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
    const OnMap at(map, view, position);
    if (!(at.along > 0)) return 1;
    const double size = at.across / map.width, x = at.x, y = at.y;  // the first: of a texel, length
    const double tilt = 1 / std::max(dot(normal, at.toLight), 0.05), tolerance = 0.5 * size * tilt;
    // Length along the light, to first order; NaN outside.
    const auto depth = [&](int i, int j) {
        const bool inside = i >= 0 && j >= 0 && i < map.width && j < map.height;
        return inside ? map.depth[size_t(j) * map.width + i] / at.zPerLength : NAN;
    };
    const auto share = [&](int i, int j) {
        const double plane =
            at.z / at.zPerLength +
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
                double nearest = INFINITY;
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

namespace {

struct Tangents {
    Vec3 right, down;
};
// x and -y, turned by the smallest rotation that takes z to `axis` (Rodrigues' formula).
Tangents tangents(Vec3 axis) {
    const Vec3 z{0, 0, 1}, k = cross(z, axis);
    const double sine = length(k), cosine = axis.z;
    const auto turned = [&](Vec3 v) {
        if (sine < 1e-12) return v;
        const Vec3 unit = k / sine;
        return cosine * v + sine * cross(unit, v) + (1 - cosine) * dot(unit, v) * unit;
    };
    return {turned({1, 0, 0}), turned({0, -1, 0})};
}

// Where a direction meets a face: the length along its axis, and the place in texels, centres at whole
// numbers.
struct OnFace {
    int face;
    double along, x, y;
    OnFace(Vec3 d, int size) : face(shadowCubeFace(d)), along(dot(d, cubeFaces[face].out)) {
        x = (dot(d, cubeFaces[face].right) / along + 1) / 2 * size - 0.5;
        y = (dot(d, cubeFaces[face].down) / along + 1) / 2 * size - 0.5;
    }
};
double depthAt(const CubeShadowMap& map, const OnFace& at) {
    const auto index = [&](double t) { return std::clamp(int(std::floor(t + 0.5)), 0, map.size - 1); };
    return map.depth[size_t((at.face * map.size + index(at.y)) * map.size + index(at.x))];
}

}  // namespace

int shadowCubeFace(Vec3 d) {
    const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
    if (x >= y && x >= z) return d.x < 0;
    if (y >= z) return 2 + (d.y < 0);
    return 4 + (d.z < 0);
}

Vec3 shadowCubeDirection(int face, double column, double row, int size) {
    return cubeDirection(face, (2 * column + 1) / size - 1, (2 * row + 1) / size - 1);
}

double CubeShadowMap::nearestReach(Vec3 direction) const {
    const OnFace at(direction, size);
    const double z = depthAt(*this, at);
    return radial ? decoding.range * z / length(direction) : decoding.distance(z) / at.along;
}

double CubeShadowMap::bilinearReach(Vec3 direction) const {
    const OnFace at(direction, size);
    const double value = bilinearAt(at.x, at.y, [&](int column, int row) {
        const OnFace texel(shadowCubeDirection(at.face, column, row, size), size);
        const double z = depthAt(*this, texel);
        return radial ? decoding.range * z : (decoding.a * z + decoding.b) * texel.along;
    });
    return radial ? value / length(direction) : 1 / (value * at.along);
}

double cubeThickness(const CubeShadowMap& map, Vec3 point, const std::vector<Vec2>& taps,
                     double filterRadius) {
    const double distance = length(point);
    const Vec3 axis = point / distance;
    const auto [right, down] = tangents(axis);
    double sum = 0;
    for (const Vec2& tap : taps)
        sum += max0(distance - map.bilinearReach(axis + 2 * filterRadius * (tap.x * right + tap.y * down)));
    return sum / double(taps.size());
}

double cubeWideShadow(const CubeShadowMap& map, Vec3 point, Vec3 normal, const WideFilterParams& p) {
    const double distance = length(point), near = 1 / distance, perLength = -near * near;
    const Vec3 axis = point / distance;
    const int face = shadowCubeFace(axis);
    const double reach = std::min(std::max(p.width / 2 / distance, 4.0 / map.size), 0.5);
    const double cosine = -dot(normal, axis), tilt = 1 / std::max(cosine, 0.2);
    const double receiver = near - (p.bias + 2 * p.width * max0(-cosine)) * perLength;
    // The rectangle round the disk on the face, from the planes that touch its cone.
    const double w = dot(axis, cubeFaces[face].out), sine2 = reach * reach / (1 + reach * reach);
    double low[2], high[2];
    for (int k = 0; k < 2; ++k) {
        const double a = dot(axis, k ? cubeFaces[face].down : cubeFaces[face].right),
                     middle = std::atan2(a, w), half = std::asin(std::sqrt(sine2 / (a * a + w * w)));
        low[k] = std::tan(middle - half), high[k] = std::tan(middle + half);
    }
    const auto texels = [&](double t) { return (t + 1) / 2 * map.size - 0.5; };
    const double across = std::max(high[0] - low[0], high[1] - low[1]) / 2 * map.size;
    const int step = std::max(1, int(std::ceil(across / p.maxTexels)));
    double sum = 0, total = 0;
    for (int row = int(std::floor(texels(low[1]))); row <= texels(high[1]) + 1; ++row)
        for (int column = int(std::floor(texels(low[0]))); column <= texels(high[0]) + 1; ++column) {
            if (row % step || column % step) continue;
            const Vec3 d = shadowCubeDirection(face, column, row, map.size), e = d / dot(d, axis),
                       aside = e - axis;
            const double r = length(aside) / reach;
            if (!(dot(d, axis) > 0) || r >= 1) continue;
            const double weight = diskWeight(r) * std::pow(dot(d, axis) * w, -3);
            const double seen = 1 / map.nearestReach(e);
            double shown = 1;
            if (std::isfinite(seen)) {
                const double plane =
                    receiver +
                    (dot(normal, aside) * distance - p.coneSlope * p.width / 2 * r) * tilt * perLength;
                shown = saturate(1 + (seen - plane) / (p.softness * p.width * perLength));
            }
            sum += weight * shown;
            total += weight;
        }
    return total > 0 ? sum / total : 1;
}

double uvPerLength(const Matrix4& m, int row) {
    return length(Vec3{m[row][0], m[row][1], m[row][2]}) / std::abs(m[3][3]);
}

int cascadeOf(const std::vector<Matrix4>& maps, Vec3 position, double radius) {
    for (size_t i = 0; i < maps.size(); ++i) {
        const Vec3 at = shadowCoordinates(maps[i], position, {0, 0, 0}, 0);
        const double u = radius * uvPerLength(maps[i], 0), v = radius * uvPerLength(maps[i], 1);
        if (at.x >= u && at.x <= 1 - u && at.y >= v && at.y <= 1 - v && at.z >= 0 && at.z <= 1) return int(i);
    }
    return -1;
}

double momentShadow(const ShadowMap& map, const std::vector<double>& second, const ShadowView& view,
                    Vec3 position, Vec3 normal, const WideFilterParams& params, const MomentParams& moments) {
    double total = 0, mean = 0, square = 0;
    for (const FilterSample& s : filterSamples(map, view, position, normal, params)) {
        total += s.weight;
        if (s.texel < 0 || !std::isfinite(map.depth[s.texel]) || !std::isfinite(second[s.texel])) continue;
        const double z = map.depth[s.texel], before = std::min(0.0, (z - s.receiver) / s.zPerLength);
        const double variance =
            before < 0 ? max0(second[s.texel] - z * z) / (s.zPerLength * s.zPerLength) : 0;
        mean += s.weight * before;
        square += s.weight * (before * before + variance);
    }
    if (!(total > 0)) return 1;
    mean /= total;
    const double variance =
        std::max(square / total - mean * mean, moments.minDeviation * moments.minDeviation);
    return saturate((variance / (variance + mean * mean) - moments.bleeding) / (1 - moments.bleeding));
}

double exponentialShadow(const ShadowMap& map, double c, const ShadowView& view, Vec3 position, Vec3 normal,
                         const WideFilterParams& params) {
    double total = 0, sum = 0;
    for (const FilterSample& s : filterSamples(map, view, position, normal, params)) {
        const double e = s.texel < 0 ? NAN : map.depth[s.texel];
        total += s.weight;
        sum += s.weight *
               (e > 0 && std::isfinite(e) ? std::min(1.0, std::exp(std::log(e) - c * s.receiver)) : 1.0);
    }
    return total > 0 ? sum / total : 1;
}

double exponentialThickness(const ShadowMap& map, double c, Vec3 uvDepth, const std::vector<Vec2>& taps,
                            double filterRadius, const DepthDecoding& decoding) {
    double sum = 0;
    for (const Vec2& tap : taps) {
        const double e = sampleMap(map, uvDepth.x + filterRadius * tap.x, uvDepth.y + filterRadius * tap.y);
        if (e > 0) sum += max0(decoding.distance(uvDepth.z) - decoding.distance(std::log(e) / c));
    }
    return sum / double(taps.size());
}

}  // namespace reference
