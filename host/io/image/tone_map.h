// Converts linear radiance to bytes for a screen.
#pragma once
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace pellucid::io {

enum class ToneCurve {
    soft,    // displayed values are proportional to radiance up to the shoulder, and approach 1 above it
    none,    // proportional up to 1, clamped there
    filmic,  // a toe and a long shoulder, per channel [Hable, Filmic Tonemapping Operators, 2010]
    // A sigmoid over stops, after bright colours were mixed with grey as on film [after Sobotka's AgX, 2022]
    agxLike
};
constexpr std::string_view toneCurves[] = {"soft", "none", "filmic", "agx-like"};  // ToneCurve

struct ToneMap {
    float exposure = 1.0f;  // multiplies radiance
    float shoulder = 0.8f;  // of `soft`
    ToneCurve curve = ToneCurve::soft;
};

// The displayed value, still linear, of one channel by `soft`: x = exposure * radiance up to the shoulder s,
// then s + (1 - s) t / (1 + t) with t = (x - s) / (1 - s), which is smooth. 0 for NaN and below 0.
float toneMapped(float radiance, const ToneMap& map);

// RGB float to sRGB bytes, rounded to nearest. NaN and below 0 count as 0, Inf as the largest float.
std::vector<uint8_t> toSrgb8(std::span<const float> rgb, const ToneMap& map = {});

}  // namespace pellucid::io
