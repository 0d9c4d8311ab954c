#include "reference/shade.h"

#include <numbers>

#include "reference/lut.h"

namespace reference {
namespace {

struct Neighbours {
    int first, second;
    double fraction;
};
// The two texels round coordinate s in [0, 1] of an axis, clamped to the outermost centres.
Neighbours neighbours(double s, int count) {
    const double at = std::clamp(s * count - 0.5, 0.0, double(count - 1));
    const int first = int(std::floor(at));
    return {first, std::min(first + 1, count - 1), at - first};
}

}  // namespace

Rgb bilinear(const Table& table, double s, double t) {
    const Neighbours x = neighbours(s, table.width), y = neighbours(t, table.height);
    auto texel = [&](int i, int j) { return table.texels[size_t(j) * table.width + i]; };
    return mix(mix(texel(x.first, y.first), texel(x.second, y.first), x.fraction),
               mix(texel(x.first, y.second), texel(x.second, y.second), x.fraction), y.fraction);
}

double radiusRatio(double lutRadius, double materialRadius) {
    return lutRadius / materialRadius;
}

double curvatureRow(double curvature, double radiusMin, double radiusMax, double f) {
    const double least = f / radiusMax, most = f / radiusMin;
    return most > least ? (curvature - least) / (most - least) : 0;
}

double shadowRow(double cosine, double filterWidth, double widthMin, double widthMax, double f) {
    const double least = f / widthMax, most = f / widthMin;
    return most > least ? (saturate(cosine) / filterWidth - least) / (most - least) : 0;
}

double blurredNormalMip(double mapSize, double diffusionRadius, double uvScale) {
    return std::log2(std::max(mapSize * diffusionRadius, uvScale) / uvScale);
}

Rgb direct(Rgb delta, Vec3 shading, Vec3 blurred, Vec3 toLight, Rgb blend) {
    const double away = saturate(1 - dot(blurred, toLight)), s = away * away;
    Rgb lit;
    for (int c = 0; c < 3; ++c) {
        const Vec3 normal = normalized(mix(shading, blurred, blend[c] + (1 - blend[c]) * s));
        lit[c] = saturate(delta[c] + saturate(dot(toLight, normal)));
    }
    return lit;
}

double sharpenedShadow(double wide, double sharpening) {
    const double k = 0.9 * sharpening;
    return smoothstep01(saturate(wide * k + 0.5 * (1 - k)));
}

std::array<Vec3, 3> ambientNormals(Vec3 shading, Vec3 blurred, Rgb blend) {
    return {normalized(mix(shading, blurred, blend.x)), normalized(mix(shading, blurred, blend.y)),
            normalized(mix(shading, blurred, blend.z))};
}

Rgb irradiance(const Ambient& ambient, Vec3 n) {
    // Real orthonormal harmonics: the constants make each one's square integrate to 1 over the sphere.
    const double pi = std::numbers::pi;
    const double band0 = std::sqrt(1 / (4 * pi)), band1 = std::sqrt(3 / (4 * pi));
    const double band2 = std::sqrt(15 / (4 * pi)), zonal = std::sqrt(5 / (16 * pi));
    const double basis[9] = {band0,
                             band1 * n.y,
                             band1 * n.z,
                             band1 * n.x,
                             band2 * n.x * n.y,
                             band2 * n.y * n.z,
                             zonal * (3 * n.z * n.z - 1),
                             band2 * n.x * n.z,
                             0.5 * band2 * (n.x * n.x - n.y * n.y)};
    Rgb sum = ambient.constant;
    for (int i = 0; i < 9; ++i) sum = sum + basis[i] * ambient.harmonics[i];
    sum = {max0(sum.x), max0(sum.y), max0(sum.z)};
    return ambient.cube ? sum + sampleCube(*ambient.cube, n) : sum;
}

Rgb ambientTerm(const Ambient& ambient, Vec3 shading, Vec3 blurred, Rgb blend) {
    const auto normals = ambientNormals(shading, blurred, blend);
    Rgb light;
    for (int c = 0; c < 3; ++c) light[c] = irradiance(ambient, normals[c])[c];
    return light;
}

double sampleMap(const ShadowMap& map, double u, double v, MapFilter filter) {
    auto depth = [&](int i, int j) { return map.depth[size_t(j) * map.width + i]; };
    if (filter == MapFilter::nearest)
        return depth(std::clamp(int(std::floor(u * map.width)), 0, map.width - 1),
                     std::clamp(int(std::floor(v * map.height)), 0, map.height - 1));
    const Neighbours x = neighbours(u, map.width), y = neighbours(v, map.height);
    return std::lerp(std::lerp(depth(x.first, y.first), depth(x.second, y.first), x.fraction),
                     std::lerp(depth(x.first, y.second), depth(x.second, y.second), x.fraction), y.fraction);
}

DepthDecoding perspectiveDecoding(double m22, double m23, double handedness) {
    // depth = handedness * m22 + m23 / distance, where clip w is the distance.
    return {true, 1, 1 / m23, -handedness * m22 / m23};
}

Vec3 shadowCoordinates(const Matrix4& m, Vec3 position, Vec3 normal, double offset) {
    const Vec3 inside = position - offset * normal;
    double h[4];
    for (int i = 0; i < 4; ++i) h[i] = m[i][0] * inside.x + m[i][1] * inside.y + m[i][2] * inside.z + m[i][3];
    return {h[0] / h[3], h[1] / h[3], h[2] / h[3]};
}

double thickness(const ShadowMap& map, Vec3 uvDepth, const std::vector<Vec2>& taps, double filterRadius,
                 const DepthDecoding& decoding, MapFilter filter) {
    const double receiver = decoding.distance(uvDepth.z);
    double sum = 0;
    for (const Vec2& tap : taps)
        sum += max0(receiver - decoding.distance(sampleMap(map, uvDepth.x + filterRadius * tap.x,
                                                           uvDepth.y + filterRadius * tap.y, filter)));
    return sum / double(taps.size());
}

std::vector<Vec2> turnedTaps(std::vector<Vec2> taps, uint32_t column, uint32_t row) {
    const double plastic = 1.32471795724474602596;  // p³ = p + 1
    const auto turns = [](double fraction) { return std::floor(fraction * 0x1p32) * 0x1p-32; };
    const double turn = std::fmod(column * turns(1 / plastic) + row * turns(1 / (plastic * plastic)), 1.0);
    const double angle = 2 * std::numbers::pi * turn;
    for (Vec2& tap : taps)
        tap = {tap.x * std::cos(angle) - tap.y * std::sin(angle),
               tap.x * std::sin(angle) + tap.y * std::cos(angle)};
    return taps;
}

double deepScatter(double t, double radius, Vec3 blurred, Vec3 toLight) {
    return std::exp(-t * t / (2 * radius * radius)) * saturate(0.3 - dot(blurred, toLight));
}

double schlick(double cosine, double f0) {
    return f0 + (1 - f0) * std::pow(1 - cosine, 5);
}

double specular(Vec3 shading, Vec3 toLight, Vec3 toViewer, double roughness, double intensity, double f0) {
    const Vec3 sum = toLight + toViewer;
    const double cosine = dot(shading, toLight), squared = dot(sum, sum);
    if (!(cosine > 0) || !(squared > 0)) return 0;
    const Vec3 half = normalized(sum);
    const double lobe = beckmann(dot(shading, half), roughness);
    return intensity * cosine * max0(lobe * schlick(dot(toViewer, half), f0) / squared);
}

double ggxLobe(Vec3 n, Vec3 l, Vec3 v, double a) {
    const double nh = dot(n, normalized(l + v)), nl = dot(n, l), nv = std::max(dot(n, v), 1e-3);
    const double d = a * a / (std::numbers::pi * std::pow(nh * nh * (a * a - 1) + 1, 2));
    const auto hidden = [&](double c) { return (std::sqrt(1 + a * a * (1 / (c * c) - 1)) - 1) / 2; };
    return d / (1 + hidden(nl) + hidden(nv)) / (4 * nl * nv);
}

double specularGgx(Vec3 n, Vec3 l, Vec3 v, double roughness, double roughness2, double lobeMix,
                   double intensity, double f0) {
    const double nl = dot(n, l);
    if (!(nl > 0) || !(dot(n, l + v) > 0)) return 0;
    const double lobes = std::lerp(ggxLobe(n, l, v, roughness), ggxLobe(n, l, v, roughness2), lobeMix);
    return intensity * nl * std::numbers::pi * schlick(dot(v, normalized(l + v)), f0) * lobes;
}

}  // namespace reference
