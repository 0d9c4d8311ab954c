#include "io/image/color_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pellucid::io {
namespace {

using Rgb = std::array<double, 3>;

// OKLab to linear sRGB [B. Ottosson, "A perceptual color space for image processing", 2020].
Rgb fromOklab(double L, double a, double b) {
    const double l = std::pow(L + 0.3963377774 * a + 0.2158037573 * b, 3);
    const double m = std::pow(L - 0.1055613458 * a - 0.0638541728 * b, 3);
    const double s = std::pow(L - 0.0894841775 * a - 1.2914855480 * b, 3);
    return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
            -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
            -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool displayable(const Rgb& c) {
    return std::all_of(c.begin(), c.end(), [](double x) { return x >= 0.0 && x <= 1.0; });
}

// Lightness and hue as given; as much chroma as sRGB can show, at most `chroma`.
Rgb shown(double lightness, double hueDegrees, double chroma) {
    const double hue = hueDegrees * std::numbers::pi / 180.0;
    double low = 0.0, high = chroma;
    const auto at = [&](double c) { return fromOklab(lightness, c * std::cos(hue), c * std::sin(hue)); };
    if (displayable(at(high))) return at(high);
    for (int i = 0; i < 40; ++i) {
        const double middle = (low + high) / 2;
        (displayable(at(middle)) ? low : high) = middle;
    }
    return at(low);
}

constexpr size_t tableSize = 257;
using Table = std::array<std::array<float, 3>, tableSize>;

// `color(t)` for t in [0, 1], sRGB-encoded, so that interpolation is nearly uniform perceptually.
template <class Color>
Table makeTable(Color&& color) {
    Table table;
    for (size_t i = 0; i < tableSize; ++i) {
        const Rgb c = color(double(i) / (tableSize - 1));
        for (size_t k = 0; k < 3; ++k) table[i][k] = encodeSrgb(float(c[k]));
    }
    return table;
}

// Hue from blue (264 degrees) up to orange (430 = 70 degrees), passing purple and red.
Rgb sequential(double t) {
    return shown(0.28 + 0.57 * t, 264.0 + 166.0 * t, 0.19);
}

// Blue and red (29 degrees) of equal lightness and chroma at the ends, nearly white in the middle.
Rgb diverging(double t) {
    const double side = std::abs(2 * t - 1);
    return shown(0.95 - 0.45 * side, t < 0.5 ? 264.0 : 29.0, 0.19 * side);
}

Srgb8 lookUp(const Table& table, float t) {
    if (std::isnan(t)) return {128, 128, 128};
    const float at = std::clamp(t, 0.0f, 1.0f) * (tableSize - 1);
    const size_t low = std::min(size_t(at), tableSize - 2);
    const float share = at - float(low);
    Srgb8 color;
    for (size_t k = 0; k < 3; ++k) {
        const float value = table[low][k] * (1 - share) + table[low + 1][k] * share;
        color[k] = uint8_t(std::lround(255.0f * std::clamp(value, 0.0f, 1.0f)));
    }
    return color;
}

}  // namespace

float encodeSrgb(float x) {
    return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
}
float decodeSrgb(float x) {
    return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

Srgb8 sequentialColor(float t) {
    static const Table table = makeTable(sequential);
    return lookUp(table, t);
}

Srgb8 divergingColor(float t) {
    static const Table table = makeTable(diverging);
    return lookUp(table, (t + 1) / 2);
}

Srgb8 scaleColor(float value, float low, float high) {
    if (low < 0) return divergingColor(value / std::max(-low, high));
    return sequentialColor(high > low ? (value - low) / (high - low) : 0.0f);
}

}  // namespace pellucid::io
