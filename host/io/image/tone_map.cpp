#include "io/image/tone_map.h"

#include <cmath>

#include "io/image/color_map.h"

namespace pellucid::io {

float toneMapped(float radiance, const ToneMap& map) {
    const float x = map.exposure * radiance, s = map.shoulder;
    if (!(x > 0.0f)) return 0.0f;
    if (x <= s) return x;
    if (std::isinf(x)) return 1.0f;
    const float t = (x - s) / (1.0f - s);
    return s + (1.0f - s) * (t / (1.0f + t));
}

std::vector<uint8_t> toSrgb8(std::span<const float> rgb, const ToneMap& map) {
    std::vector<uint8_t> bytes;
    bytes.reserve(rgb.size());
    for (float radiance : rgb) {
        bytes.push_back(static_cast<uint8_t>(std::lround(255.0f * encodeSrgb(toneMapped(radiance, map)))));
    }
    return bytes;
}

}  // namespace pellucid::io
