// Colours for numbers, even in lightness, so that equal steps of a value look equal.
#pragma once
#include <array>
#include <cstdint>

namespace pellucid::io {

using Srgb8 = std::array<uint8_t, 3>;

// Dark blue (t = 0) over purple and red to light orange (t = 1): lightness rises linearly in OKLab [Ottosson
// 2020]. Clamps t; NaN is mid grey.
Srgb8 sequentialColor(float t);

// The sRGB transfer (IEC 61966-2-1) of a linear value in [0, 1], and back.
float encodeSrgb(float linear);
float decodeSrgb(float encoded);

}  // namespace pellucid::io
