// A picture whose middle shows the front of a ball, material 2, among material 1: for the cost of an eye.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace reference {

struct EyeSquare {
    std::vector<float> position, normal;  // xyz per pixel
    std::vector<uint8_t> id;

    // `share`: of the pixels, in the square.
    EyeSquare(uint32_t width, uint32_t height, double share) {
        const double side = std::sqrt(share * double(size_t(width) * height));
        for (uint32_t y = 0; y < height; ++y)
            for (uint32_t x = 0; x < width; ++x) {
                const double u = (x - 0.5 * width) / side * 2, v = (0.5 * height - y) / side * 2;
                const bool inside = std::abs(u) < 1 && std::abs(v) < 1;
                const double px = 8.4 * u, py = 8.4 * v,
                             pz = std::sqrt(std::max(144 - px * px - py * py, 1.0));
                for (const double c : {px, py, inside ? pz : -10.0}) position.push_back(float(c));
                const double length = std::hypot(px, py, pz);
                for (const double c : {px, py, pz}) normal.push_back(float(c / length));
                id.push_back(inside ? 2 : 1);
            }
    }
};

}  // namespace reference
