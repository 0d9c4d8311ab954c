// Colours for numbers, even in lightness, so that equal steps of a value look equal.
#pragma once
#include <array>
#include <cstdint>

namespace pellucid::io {

using Srgb8 = std::array<uint8_t, 3>;

// Dark blue (t = 0) over purple and red to light orange (t = 1): lightness rises linearly in OKLab [Ottosson
// 2020]. Clamps t; NaN is mid grey.
Srgb8 sequentialColor(float t);

// Blue (t = -1) over light grey (0) to red (1), lightest in the middle. Clamps t; NaN is mid grey.
Srgb8 divergingColor(float t);

// The colour of a value on a scale from low to high: sequential, or diverging about 0 when low is negative.
Srgb8 scaleColor(float value, float low, float high);

// The sRGB transfer (IEC 61966-2-1) of a linear value in [0, 1], and back.
float encodeSrgb(float linear);
float decodeSrgb(float encoded);

}  // namespace pellucid::io
