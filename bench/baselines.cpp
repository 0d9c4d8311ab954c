#include "baselines.h"

#include <algorithm>
#include <cmath>

namespace baseline {
namespace {

float length(const float* a, const float* b) {
    const float x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
    return std::sqrt(x * x + y * y + z * z);
}

}  // namespace

void edgeCurvature(const std::vector<float>& positions, const std::vector<float>& normals,
                   const std::vector<uint32_t>& indices, uint32_t passes, CurvatureScratch& scratch,
                   std::vector<float>& curvature) {
    const size_t n = positions.size() / 3;
    std::vector<float>&low = scratch.low, &high = scratch.high, &weight = scratch.weight;
    low.assign(n, 1e30f);
    high.assign(n, 0.0f);
    curvature.resize(n);
    for (size_t t = 0; t < indices.size(); t += 3)
        for (int c = 0; c < 3; ++c) {
            const uint32_t a = indices[t + c], b = indices[t + (c + 1) % 3];
            const float k =
                length(&normals[3 * a], &normals[3 * b]) / length(&positions[3 * a], &positions[3 * b]);
            low[a] = std::min(low[a], k);
            low[b] = std::min(low[b], k);
            high[a] = std::max(high[a], k);
            high[b] = std::max(high[b], k);
        }
    for (size_t v = 0; v < n; ++v) curvature[v] = 0.5f * (low[v] + high[v]);
    for (uint32_t pass = 0; pass < passes; ++pass) {
        std::vector<float>& sum = low;
        sum.assign(n, 0.0f);
        weight.assign(n, 0.0f);
        for (size_t t = 0; t < indices.size(); t += 3) {
            const uint32_t a = indices[t], b = indices[t + 1], c = indices[t + 2];
            sum[a] += curvature[b] + curvature[c];
            sum[b] += curvature[c] + curvature[a];
            sum[c] += curvature[a] + curvature[b];
            weight[a] += 2.0f;
            weight[b] += 2.0f;
            weight[c] += 2.0f;
        }
        for (size_t v = 0; v < n; ++v) curvature[v] = sum[v] / std::max(1.0f, weight[v]);
    }
}

namespace {

using pellucid::bench::FrameImages;
constexpr int tableSize = 512;
constexpr float sharpening = 9;  // of the shadow of specular light

// Numbers of a frame that are the same for all pixels.
struct ShadeSettings {
    const ShadeInput& in;
    float ambient[9][3];                    // polynomial of the normal
    float rowsCurvature[2], rowsShadow[2];  // row in [0, 1] = scale * value + bias

    explicit ShadeSettings(const ShadeInput& input) : in(input) {
        const PelAmbient& a = in.frame.ambient;
        const float one = 0.48860251f, two = 1.09254843f;
        const float factors[9] = {0.28209479f, one, one, one, two, two, 0.31539157f, two, 0.5f * two};
        for (int i = 0; i < 9; ++i)
            for (int c = 0; c < 3; ++c) ambient[i][c] = factors[i] * a.sh[i][c] + (i ? 0 : a.constant[c]);
        rowsCurvature[0] = 1 / (1 - 0.01f), rowsCurvature[1] = -0.01f / (1 - 0.01f);
        rowsShadow[0] = 1 / (1 / 8.0f - 0.01f), rowsShadow[1] = -0.01f / (1 / 8.0f - 0.01f);
    }
};

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

V sample(const std::vector<float>& texels, float s, float v) {
    const float x = std::clamp(s * tableSize - 0.5f, 0.0f, tableSize - 1.0f);
    const float y = std::clamp(v * tableSize - 0.5f, 0.0f, tableSize - 1.0f);
    const int x0 = int(x), y0 = int(y), x1 = std::min(x0 + 1, tableSize - 1),
              y1 = std::min(y0 + 1, tableSize - 1);
    const auto texel = [&](int i, int j) { return load(texels, size_t(j) * tableSize + i); };
    return mix(mix(texel(x0, y0), texel(x1, y0), x - x0), mix(texel(x0, y1), texel(x1, y1), x - x0), y - y0);
}

float depthAt(const FrameImages& f, float u, float v) {
    const int n = int(f.mapSize);
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

float thickness(const ShadeInput& in, V p, V ng) {
    p = p - in.material.deepScatterNormalOffset * ng;
    const float* m = in.frame.light.worldToShadow;
    float h[4];
    for (int r = 0; r < 4; ++r)
        h[r] = m[4 * r] * p.x + m[4 * r + 1] * p.y + m[4 * r + 2] * p.z + m[4 * r + 3];
    const float radius = in.material.thicknessFilterRadius;
    float sum = 0;
    for (size_t i = 0; i < in.disk.size(); i += 2)
        sum += std::max(0.0f, (h[2] / h[3] - depthAt(in.frame, h[0] / h[3] + radius * in.disk[i],
                                                     h[1] / h[3] + radius * in.disk[i + 1])) *
                                  in.frame.light.shadowDepthRange);
    return 2 * sum / float(in.disk.size());
}

V shadePixel(const ShadeSettings& s, bool skipping, size_t i) {
    const FrameImages& f = s.in.frame;
    const PelMaterial& m = s.in.material;
    const V l = from(f.light.toLight), color = from(f.light.color), ng = load(f.geometric, i),
            n = load(f.shading, i), nb = load(f.blurred, i), p = load(f.position, i),
            albedo = load(f.albedo, i);
    const float bl = dot(nb, l), nl = dot(n, l), w = f.wideShadow[i];
    const V d = sample(s.in.curvatureTable, 0.5f * bl + 0.5f,
                       s.rowsCurvature[0] * f.curvature[i] + s.rowsCurvature[1]);
    const float away = sat(1 - bl) * sat(1 - bl), lambert = std::max(bl, 0.0f);
    const V direct{sat(d.x - lambert + sat(bl)),
                   sat(d.y - lambert + sat(dot(l, normalize(mix(n, nb, 0.3f + 0.7f * away))))),
                   sat(d.z - lambert + sat(dot(l, normalize(mix(n, nb, away)))))};
    const V t = sample(s.in.shadowTable, w,
                       s.rowsShadow[0] * sat(dot(ng, l)) / m.shadowFilterWidth + s.rowsShadow[1]);
    const V between = normalize(mix(n, nb, 0.3f));
    V diffuse{irradiance(s, nb, 0), irradiance(s, between, 1), irradiance(s, n, 2)};
    V lit = direct * t;
    const float back = sat(0.3f - bl);
    if (!s.in.disk.empty() && (back > 0 || !skipping)) {
        const float thick = thickness(s.in, p, ng);
        lit = lit + (std::exp(-thick * thick / (2 * m.deepScatterRadius * m.deepScatterRadius)) * back) *
                        from(m.deepScatterColor);
    }
    diffuse = diffuse + color * lit;
    V result = albedo * diffuse;
    if (nl > 0 || !skipping) {
        const V v = normalize(from(f.camera.position) - p), h = l + v, unit = normalize(h);
        const float nh = dot(n, unit), m2 = m.roughness * m.roughness;
        if (nh > 0) {
            const float tan2 = (1 - nh * nh) / (nh * nh);
            const float lobe = std::exp(-tan2 / m2) / (m2 * nh * nh * nh * nh);
            const float fresnel = m.f0 + (1 - m.f0) * std::pow(1 - dot(v, unit), 5.0f);
            const float k = sat(w * sharpening + 0.5f * (1 - sharpening));
            result =
                result +
                (k * k * (3 - 2 * k) * m.specular * std::max(nl, 0.0f) * lobe * fresnel / dot(h, h)) * color;
        }
    }
    return result;
}

}  // namespace

void shadeOpenMp(const ShadeInput& input, Effort effort, std::vector<float>& radiance) {
    const ShadeSettings settings(input);
    const bool skipping = effort == Effort::Skipping;
    const int width = int(input.frame.width), height = int(input.frame.height);
#pragma omp parallel for schedule(dynamic, 8)
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const size_t i = size_t(y) * width + x;
            if (!input.frame.id[i]) continue;
            const V color = shadePixel(settings, skipping, i);
            radiance[3 * i] = color.x;
            radiance[3 * i + 1] = color.y;
            radiance[3 * i + 2] = color.z;
        }
}

}  // namespace baseline
