#include "baselines.h"

#include <algorithm>
#include <cmath>

namespace baseline {
namespace {

constexpr float pi = 3.14159265f;
constexpr float profileEnd = 10;  // mm

void lineSpread(const std::vector<LutGaussian>& profile, float s, float (&rgb)[3]) {
    rgb[0] = rgb[1] = rgb[2] = 0;
    for (const LutGaussian& g : profile) {
        const float density = std::exp(-0.5f * s * s / (g.sigma * g.sigma)) * (0.39894228f / g.sigma);
        for (int c = 0; c < 3; ++c) rgb[c] += g.weight[c] * density;
    }
}

// Sum of f(s) P(s) over `samples` midpoints of [-end, end].
template <class F>
void sample(const std::vector<LutGaussian>& profile, float end, int samples, F&& f, float* texel) {
    const float step = 2 * end / float(samples);
    float sum[3] = {0, 0, 0};
    for (int i = 0; i < samples; ++i) {
        const float s = -end + (float(i) + 0.5f) * step;
        float p[3];
        lineSpread(profile, s, p);
        const float value = f(s);
        for (int c = 0; c < 3; ++c) sum[c] += value * p[c];
    }
    for (int c = 0; c < 3; ++c) texel[c] = sum[c] * step;
}

}  // namespace

void sampledCurvatureLut(const std::vector<LutGaussian>& profile, int width, int height, float radiusMin,
                         float radiusMax, int samples, std::vector<float>& texels) {
    texels.resize(size_t(width) * height * 3);
    for (int y = 0; y < height; ++y) {
        const float least = 1 / radiusMax, most = 1 / radiusMin;
        const float curvature = least + (float(y) + 0.5f) * (most - least) / float(height);
        const float end = std::min(pi / curvature, profileEnd);
        for (int x = 0; x < width; ++x) {
            const float theta = std::acos(-1 + (float(x) + 0.5f) * 2 / float(width));
            sample(
                profile, end, samples,
                [&](float s) { return std::max(0.0f, std::cos(theta - s * curvature)); },
                texels.data() + (size_t(y) * width + x) * 3);
        }
    }
}

void sampledShadowLut(const std::vector<LutGaussian>& profile, int width, int height, float widthMin,
                      float widthMax, float sharpening, int samples, std::vector<float>& texels) {
    texels.resize(size_t(width) * height * 3);
    for (int y = 0; y < height; ++y) {
        const float least = 1 / widthMax, most = 1 / widthMin;
        const float reciprocal = least + (float(y) + 0.5f) * (most - least) / float(height);
        for (int x = 0; x < width; ++x) {
            const float w = (float(x) + 0.5f) / float(width);
            const float p = 0.5f * (std::sqrt(w) - std::sqrt(1 - w)) + 0.5f;
            sample(
                profile, profileEnd, samples,
                [&](float s) {
                    const float t = (p + s * reciprocal) * sharpening + 0.5f * (1 - sharpening);
                    const float y01 = std::clamp(t, 0.0f, 1.0f);
                    return y01 * y01 * (3 - 2 * y01);
                },
                texels.data() + (size_t(y) * width + x) * 3);
        }
    }
}

}  // namespace baseline
