// Shared by tests and measurements: the standard headers, sizes and halves.
#pragma once
#include <algorithm>
#include <atomic>
#include <bit>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <pellucid/pellucid.hpp>
#include <random>
#include <set>
#include <span>
#include <sstream>
#include <thread>
#include <type_traits>

// Where tests run that name no device.
inline const pellucid::Device& device() {
    static const pellucid::Device device("");
    return device;
}

// Smaller meshes, tables and images where every instruction is interpreted: ./run check oclgrind sets
// PELLUCID_TEST_SMALL.
inline bool testsAreSmall() {
    static const bool small = std::getenv("PELLUCID_TEST_SMALL") != nullptr;
    return small;
}

// A size or a count.
template <class T>
T sized(T usual, T small) {
    return testsAreSmall() ? small : usual;
}

// The description of a table with no more texels than small tests make.
template <class Desc>
Desc sizedTable(Desc desc) {
    if (!testsAreSmall()) return desc;
    desc.width = std::min(desc.width, decltype(desc.width)(24));
    desc.height = std::min(desc.height, decltype(desc.height)(6));
    return desc;
}

// The rows of a frame: fewer where there are many pixels.
inline uint32_t sizedRows(uint32_t width, uint32_t height) {
    return width * height > 3700 ? sized(height, std::max(1500 / width, 2u)) : height;
}

// float32 to half and back by bits, rounding to nearest even: what the kernels' vstore_half_rte must agree
// with. For values of half's range.
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
