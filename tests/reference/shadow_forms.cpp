#include "reference/shadow_forms.h"

#include <algorithm>
#include <cmath>

#include "reference/cube.h"

namespace reference {
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

struct Texel {
    double depth;
    Vec3 direction;  // 1 along `axis`
    Vec3 axis;       // of the face that it lies on
};
Texel texelAt(const CubeShadowMap& map, Vec3 d) {
    const int face = shadowCubeFace(d);
    const double along = dot(d, cubeFaces[face].out);
    const auto index = [&](double t) {
        return std::clamp(int(std::floor((t / along + 1) / 2 * map.size)), 0, map.size - 1);
    };
    const int column = index(dot(d, cubeFaces[face].right)), row = index(dot(d, cubeFaces[face].down));
    return {map.depth[size_t((face * map.size + row) * map.size + column)], d, cubeFaces[face].out};
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
    const Texel t = texelAt(*this, direction);
    if (radial) return decoding.range * t.depth / length(direction);
    return decoding.distance(t.depth) / dot(direction, t.axis);
}

double CubeShadowMap::bilinearReach(Vec3 direction) const {
    const int face = shadowCubeFace(direction);
    const double along = dot(direction, cubeFaces[face].out);
    const double x = (dot(direction, cubeFaces[face].right) / along + 1) / 2 * size - 0.5,
                 y = (dot(direction, cubeFaces[face].down) / along + 1) / 2 * size - 0.5;
    double sum = 0;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const double column = std::floor(x) + i, row = std::floor(y) + j;
            const Vec3 d = shadowCubeDirection(face, column, row, size);
            const Texel t = texelAt(*this, d);
            const double value =
                radial ? decoding.range * t.depth : (decoding.a * t.depth + decoding.b) * dot(d, t.axis);
            sum += (1 - std::abs(x - column)) * (1 - std::abs(y - row)) * value;
        }
    return radial ? sum / length(direction) : 1 / (sum * along);
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
            const double t = 1 - r * r, solid = std::pow(dot(d, axis) * w, -3);
            const double weight = (std::sqrt(t) / (1 + t) + std::atan(std::sqrt(t))) * solid;
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
    return std::sqrt(m[row][0] * m[row][0] + m[row][1] * m[row][1] + m[row][2] * m[row][2]) /
           std::abs(m[3][3]);
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
        const double e = sampleMap(map, uvDepth.x + filterRadius * tap.x, uvDepth.y + filterRadius * tap.y,
                                   MapFilter::bilinear);
        if (e > 0) sum += max0(decoding.distance(uvDepth.z) - decoding.distance(std::log(e) / c));
    }
    return sum / double(taps.size());
}

}  // namespace reference
