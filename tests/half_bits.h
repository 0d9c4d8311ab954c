// float32 to half and back by bits, rounding to nearest even: what the kernels' vstore_half_rte must agree
// with.
#pragma once
#include <cmath>
#include <cstdint>
#include <cstring>

// For values of half's range.
inline uint16_t toHalf(float value) {
    uint32_t bits;
    std::memcpy(&bits, &value, 4);
    const uint32_t sign = bits >> 16 & 0x8000;
    const float magnitude = std::fabs(value);
    if (magnitude < 0x1p-14f) return uint16_t(sign | uint32_t(std::lrint(magnitude * 0x1p24f)));
    const uint32_t exponent = (bits >> 23 & 255) - 112, mantissa = bits & 0x7fffff;
    const uint32_t kept = exponent << 10 | mantissa >> 13, rest = mantissa & 0x1fff;
    return uint16_t(sign | (kept + (rest > 0x1000 || (rest == 0x1000 && (kept & 1)))));
}

inline float fromHalf(uint16_t h) {
    const int exponent = h >> 10 & 31, mantissa = h & 1023;
    const float m =
        exponent ? std::ldexp(1024.0f + float(mantissa), exponent - 25) : std::ldexp(float(mantissa), -24);
    return h & 0x8000 ? -m : m;
}
