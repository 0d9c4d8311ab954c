// G-buffer images in the compact formats that deferred renderers keep, made from float32 ones.
#pragma once
#include <pellucid/pellucid.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "half_bits.h"

namespace packing {

// Whole images, float32 in, bytes of the format out.
inline std::vector<uint16_t> halves(const std::vector<float>& values) {
    std::vector<uint16_t> out(values.size());
    std::transform(values.begin(), values.end(), out.begin(), toHalf);
    return out;
}

// RGB to RGBA16F, alpha 0.
inline std::vector<uint16_t> halvesOfFour(const std::vector<float>& rgb) {
    std::vector<uint16_t> out(rgb.size() / 3 * 4);
    for (size_t i = 0; i < rgb.size(); ++i) out[i / 3 * 4 + i % 3] = toHalf(rgb[i]);
    return out;
}

inline std::vector<uint8_t> unorm8(const std::vector<float>& values) {
    std::vector<uint8_t> out(values.size());
    std::transform(values.begin(), values.end(), out.begin(),
                   [](float v) { return uint8_t(std::lrint(std::clamp(v, 0.0f, 1.0f) * 255)); });
    return out;
}

// RGB to RGBA8_SRGB, alpha 0.
inline std::vector<uint8_t> srgb8(const std::vector<float>& rgb) {
    std::vector<uint8_t> out(rgb.size() / 3 * 4);
    for (size_t i = 0; i < rgb.size(); ++i) {
        const double v = std::clamp(rgb[i], 0.0f, 1.0f);
        const double code = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
        out[i / 3 * 4 + i % 3] = uint8_t(std::lrint(code * 255));
    }
    return out;
}

// Unit vectors to OCT16X2_SNORM.
inline std::vector<int16_t> octahedral(const std::vector<float>& normals) {
    std::vector<int16_t> out(normals.size() / 3 * 2);
    for (size_t i = 0; i < normals.size() / 3; ++i) {
        const float* n = &normals[3 * i];
        const float sum = std::max(std::fabs(n[0]) + std::fabs(n[1]) + std::fabs(n[2]), 1e-30f);
        float x = n[0] / sum, y = n[1] / sum;
        if (n[2] < 0) {
            const float folded = (1 - std::fabs(y)) * std::copysign(1.0f, x);
            y = (1 - std::fabs(x)) * std::copysign(1.0f, y);
            x = folded;
        }
        out[2 * i] = int16_t(std::lrint(x * 32767));
        out[2 * i + 1] = int16_t(std::lrint(y * 32767));
    }
    return out;
}

// Device depths of positions seen by a camera, by PelCamera.inverseViewProjection: where the pixel's ray comes nearest in the
// coordinate that depth moves most.
inline std::vector<float> depths(const std::vector<float>& positions, const PelCamera& camera, int width,
                                 int height) {
    const float* m = camera.inverseViewProjection;
    std::vector<float> out(positions.size() / 3);
    for (size_t i = 0; i < out.size(); ++i) {
        const double cx = (double(i % size_t(width)) + 0.5) * 2 / width - 1,
                     cy = 1 - (double(i / size_t(width)) + 0.5) * 2 / height;
        double best = 0;
        for (int r = 0; r < 3; ++r) {
            const auto atZero = [&](int row) { return m[4 * row] * cx + m[4 * row + 1] * cy + m[4 * row + 3]; };
            const double p = positions[3 * i + size_t(r)], slope = p * m[14] - m[4 * r + 2];
            if (std::fabs(slope) <= std::fabs(best)) continue;
            best = slope;
            out[i] = float((atZero(r) - p * atZero(3)) / slope);
        }
    }
    return out;
}

}  // namespace packing
