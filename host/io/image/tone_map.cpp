#include "io/image/tone_map.h"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "io/image/color_map.h"

namespace pellucid::io {
namespace {

uint8_t byteOf(float code) {
    return uint8_t(std::lround(255.0f * std::clamp(code, 0.0f, 1.0f)));
}

float notNegative(float x) {
    return x > 0 ? std::min(x, FLT_MAX) : 0.0f;
}

// Hable's curve with the constants of his page, white at 11.2, twice exposed as there.
float filmic(float x) {
    const auto curve = [](double v) {
        constexpr double a = 0.15, b = 0.50, c = 0.10, d = 0.20, e = 0.02, f = 0.30;
        return (v * (a * v + c * b) + d * e) / (v * (a * v + b) + d * f) - e / f;
    };
    return float(std::min(1.0, curve(2.0 * std::min(double(x), 1e6)) / curve(11.2)));
}

// The code value of a colour: AgX's range of -10 to 6.5 stops about middle grey, and a sigmoid of slope 2
// through it that takes the ends to 0 and 1. Middle grey gets half of the code values.
float stops(float x) {
    constexpr double low = 10, high = 6.5, pivot = low / (low + high), slope = 2, power = 1.5;
    const double t = (std::log2(std::max(double(x), 1e-10) / 0.18) + low) / (low + high);
    const double from = std::clamp(t, 0.0, 1.0) - pivot;
    const double end = slope * (from < 0 ? pivot : 1 - pivot);  // where a straight line would arrive
    const double scale = end / std::pow(std::pow(end / 0.5, power) - 1, 1 / power);
    const double u = slope * std::abs(from);
    return float(0.5 + std::copysign(u / std::pow(1 + std::pow(u / scale, power), 1 / power), from));
}

// Grey that is mixed into a colour before the curve, and saturation after it, chosen by eye.
constexpr float inset = 0.1f, punch = 1.4f;

}  // namespace

float toneMapped(float radiance, const ToneMap& map) {
    const float x = map.exposure * radiance, s = map.shoulder;
    if (!(x > 0.0f)) return 0.0f;
    if (x <= s) return x;
    if (std::isinf(x)) return 1.0f;
    const float t = (x - s) / (1.0f - s);
    return s + (1.0f - s) * (t / (1.0f + t));
}

std::vector<uint8_t> toSrgb8(std::span<const float> rgb, const ToneMap& map) {
    std::vector<uint8_t> bytes(rgb.size());
    if (map.curve == ToneCurve::agxLike) {
        for (size_t i = 0; i + 3 <= rgb.size(); i += 3) {
            std::array<float, 3> c;
            for (size_t k = 0; k < 3; ++k) c[k] = notNegative(map.exposure * rgb[i + k]);
            const float grey = c[0] / 3 + c[1] / 3 + c[2] / 3;
            for (float& v : c) v = stops((1 - inset) * v + inset * grey);
            const float middle = (c[0] + c[1] + c[2]) / 3;
            for (size_t k = 0; k < 3; ++k) bytes[i + k] = byteOf(middle + punch * (c[k] - middle));
        }
        return bytes;
    }
    for (size_t i = 0; i < rgb.size(); ++i) {
        float shown = 0;
        switch (map.curve) {
            case ToneCurve::none:
                shown = std::min(notNegative(map.exposure * rgb[i]), 1.0f);
                break;
            case ToneCurve::filmic:
                shown = filmic(notNegative(map.exposure * rgb[i]));
                break;
            default:
                shown = toneMapped(rgb[i], map);
        }
        bytes[i] = byteOf(encodeSrgb(shown));
    }
    return bytes;
}

}  // namespace pellucid::io
