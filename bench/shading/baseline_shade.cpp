#include "baseline_shade.h"

#include <algorithm>
#include <cmath>

namespace baseline {
namespace {

struct V {
    float x, y, z;
};
V operator+(V a, V b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
V operator-(V a, V b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
V operator*(float s, V a) {
    return {s * a.x, s * a.y, s * a.z};
}
V operator*(V a, V b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
float dot(V a, V b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
V normalize(V a) {
    return (1 / std::sqrt(dot(a, a))) * a;
}
V mix(V a, V b, float t) {
    return a + t * (b - a);
}
float sat(float x) {
    return std::min(std::max(x, 0.0f), 1.0f);
}
V load(const std::vector<float>& image, size_t i) {
    return {image[3 * i], image[3 * i + 1], image[3 * i + 2]};
}
V from(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

V sample(const ShadeTable& t, float s, float v) {
    const float x = std::clamp(s * t.width - 0.5f, 0.0f, t.width - 1.0f);
    const float y = std::clamp(v * t.height - 0.5f, 0.0f, t.height - 1.0f);
    const int x0 = int(x), y0 = int(y), x1 = std::min(x0 + 1, t.width - 1), y1 = std::min(y0 + 1, t.height - 1);
    const auto texel = [&](int i, int j) { return load(t.texels, size_t(j) * t.width + i); };
    return mix(mix(texel(x0, y0), texel(x1, y0), x - x0), mix(texel(x0, y1), texel(x1, y1), x - x0), y - y0);
}

float depthAt(const ShadeFrame& f, float u, float v) {
    const int n = f.mapSize;
    const float x = std::clamp(u * n - 0.5f, 0.0f, n - 1.0f), y = std::clamp(v * n - 0.5f, 0.0f, n - 1.0f);
    const int x0 = int(x), y0 = int(y), x1 = std::min(x0 + 1, n - 1), y1 = std::min(y0 + 1, n - 1);
    const float* m = f.map.data();
    const float upper = m[y0 * n + x0] + (x - x0) * (m[y0 * n + x1] - m[y0 * n + x0]);
    const float lower = m[y1 * n + x0] + (x - x0) * (m[y1 * n + x1] - m[y1 * n + x0]);
    return upper + (y - y0) * (lower - upper);
}

float irradiance(const ShadeSettings& s, V n, int c) {
    const auto& a = s.ambient;
    return std::max(0.0f, a[0][c] + a[1][c] * n.y + a[2][c] * n.z + a[3][c] * n.x + a[4][c] * n.x * n.y +
                              a[5][c] * n.y * n.z + a[6][c] * (3 * n.z * n.z - 1) + a[7][c] * n.x * n.z +
                              a[8][c] * (n.x * n.x - n.y * n.y));
}

float thickness(const ShadeFrame& f, const ShadeSettings& s, V p, V ng) {
    p = p - s.normalOffset * ng;
    const float* m = s.worldToShadow;
    float h[4];
    for (int r = 0; r < 4; ++r)
        h[r] = m[4 * r] * p.x + m[4 * r + 1] * p.y + m[4 * r + 2] * p.z + m[4 * r + 3];
    float sum = 0;
    for (int i = 0; i < s.taps; ++i)
        sum += std::max(0.0f, (h[2] / h[3] - depthAt(f, h[0] / h[3] + s.filterRadius * s.disk[2 * i],
                                                     h[1] / h[3] + s.filterRadius * s.disk[2 * i + 1])) *
                                  s.depthRange);
    return sum / s.taps;
}

V shadePixel(const ShadeFrame& f, const ShadeSettings& s, const ShadeTable& curvature,
             const ShadeTable& shadow, bool skipping, size_t i) {
    const V l = from(s.toLight), ng = load(f.geometric, i), n = load(f.shading, i), nb = load(f.blurred, i);
    const V p = load(f.position, i), albedo = load(f.albedo, i);
    const float bl = dot(nb, l), nl = dot(n, l), w = f.wide[i];
    const V d = sample(curvature, 0.5f * bl + 0.5f, s.rowsCurvature[0] * f.curvature[i] + s.rowsCurvature[1]);
    const float away = sat(1 - bl) * sat(1 - bl), lambert = std::max(bl, 0.0f);
    const V direct{sat(d.x - lambert + sat(bl)),
                   sat(d.y - lambert + sat(dot(l, normalize(mix(n, nb, 0.3f + 0.7f * away))))),
                   sat(d.z - lambert + sat(dot(l, normalize(mix(n, nb, away)))))};
    const V t = sample(shadow, w, s.rowsShadow[0] * sat(dot(ng, l)) * s.penumbraPerCosine + s.rowsShadow[1]);
    const V between = normalize(mix(n, nb, 0.3f));
    V diffuse{irradiance(s, nb, 0), irradiance(s, between, 1), irradiance(s, n, 2)};
    V lit = direct * t;
    const float back = sat(0.3f - bl);
    if (s.taps && (back > 0 || !skipping)) {
        const float thick = thickness(f, s, p, ng);
        lit = lit + (std::exp(-thick * thick / (2 * s.deepScatterRadius * s.deepScatterRadius)) * back) *
                        from(s.deepScatter);
    }
    diffuse = diffuse + from(s.light) * lit;
    V result = albedo * diffuse;
    if (nl > 0 || !skipping) {
        const V v = normalize(from(s.camera) - p), h = l + v, unit = normalize(h);
        const float nh = dot(n, unit), m2 = s.roughness * s.roughness;
        if (nh > 0) {
            const float tan2 = (1 - nh * nh) / (nh * nh);
            const float lobe = std::exp(-tan2 / m2) / (m2 * nh * nh * nh * nh);
            const float fresnel = s.f0 + (1 - s.f0) * std::pow(1 - dot(v, unit), 5.0f);
            const float k = sat(w * s.sharpening + 0.5f * (1 - s.sharpening));
            result =
                result + (k * k * (3 - 2 * k) * s.specular * std::max(nl, 0.0f) * lobe * fresnel / dot(h, h)) *
                             from(s.light);
        }
    }
    return result;
}

}  // namespace

void shadeOpenMp(const ShadeFrame& f, const ShadeSettings& s, const ShadeTable& curvature,
                 const ShadeTable& shadow, Effort effort, std::vector<float>& out) {
    const bool skipping = effort == Effort::Skipping;
#pragma omp parallel for schedule(dynamic, 8)
    for (int y = 0; y < f.height; ++y)
        for (int x = 0; x < f.width; ++x) {
            const size_t i = size_t(y) * f.width + x;
            if (!f.id[i]) continue;
            const V color = shadePixel(f, s, curvature, shadow, skipping, i);
            out[3 * i] = color.x;
            out[3 * i + 1] = color.y;
            out[3 * i + 2] = color.z;
        }
}

}  // namespace baseline
