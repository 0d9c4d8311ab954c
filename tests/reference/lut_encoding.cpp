
#include "reference/lut.h"

namespace reference {

double beckmann(double cosine, double m) {
    if (!(cosine > 0) || !(m > 0)) return 0;
    const double c = std::min(1.0, cosine), slope = std::sqrt((1 - c) * (1 + c)) / (c * m);
    // In logarithms: near grazing angles and for tiny m both factors leave the range of a double.
    return std::exp(-slope * slope - 2 * std::log(m) - 4 * std::log(c));
}

double beckmannEncoded(double cosine, double m) {
    return 0.5 * std::pow(beckmann(cosine, m), 0.1);
}

double srgbFromLinear(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double linearFromSrgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

Rgb faceworksCurvatureSteps(Rgb d, double u) {
    Rgb steps;
    for (int c = 0; c < 3; ++c) steps[c] = 255 * saturate(2 * (d[c] - max0(u)) + 0.5);
    return steps;
}

Rgb faceworksShadowSteps(Rgb t, int x, int width) {
    Rgb steps;
    for (int c = 0; c < 3; ++c) steps[c] = 255 * saturate(srgbFromLinear(shadowFade(x, width) * t[c]));
    return steps;
}

bool faceworksCurvatureClips(Rgb d, double u) {
    return magnitude(d - max0(u) * Rgb{1, 1, 1}) > 0.25;
}

Rgba8 roundedSteps(Rgb steps) {
    Rgba8 out{0, 0, 0, 255};
    for (int c = 0; c < 3; ++c) out[c] = uint8_t(std::floor(steps[c] + 0.5));
    return out;
}

}  // namespace reference
