// From linear radiance to bytes that a screen shows.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace pellucid::io {

struct ToneMap {
    float exposure = 1.0f;  // multiplies radiance
    // Displayed values below it are proportional to radiance, so that pictures can be compared; above it they
    // approach 1.
    float shoulder = 0.8f;
};

// The displayed value, still linear, of one channel: x = exposure * radiance up to the shoulder s, then
// s + (1 - s) t / (1 + t) with t = (x - s) / (1 - s): continuous with its slope. NaN and negative values give
// 0.
float toneMapped(float radiance, const ToneMap& map);

// RGB float (interleaved) to sRGB bytes, rounded to nearest.
std::vector<uint8_t> toSrgb8(std::span<const float> rgb, const ToneMap& map = {});

}  // namespace pellucid::io
