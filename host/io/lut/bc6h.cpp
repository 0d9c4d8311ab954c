#include "io/lut/bc6h.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "io/lut/bc6h_block.h"

namespace pellucid::io {

constexpr uint16_t largest = 0x7BFF, infinity = 0x7C00;

static uint16_t storable(uint16_t half) {
    if (half & 0x8000 || half > infinity) return 0;
    return std::min(half, largest);
}

std::vector<uint8_t> encodeBc6h(uint32_t width, uint32_t height, std::span<const uint16_t> texels,
                                const std::function<bool()>& stop) {
    if (texels.size() != size_t(width) * height * 3)
        throw std::invalid_argument("three halves per texel are needed");
    const uint32_t across = (width + 3) / 4, down = (height + 3) / 4;
    std::vector<uint8_t> blocks(size_t(across) * down * 16);
    const auto encode = [&](uint32_t bx, uint32_t by) {
        bc6h::Target target;
        target.counts = 0;
        for (uint32_t i = 0; i < 16; ++i) {
            const uint32_t x = 4 * bx + i % 4, y = 4 * by + i / 4;
            if (x < width && y < height) target.counts |= uint16_t(1 << i);
            const uint16_t* from =
                &texels[(size_t(std::min(y, height - 1)) * width + std::min(x, width - 1)) * 3];
            for (size_t c = 0; c < 3; ++c) target.texel[i][c] = storable(from[c]);
        }
        const bc6h::Bytes bytes = bc6h::pack(bc6h::bestBlock(target));
        std::memcpy(&blocks[(size_t(by) * across + bx) * 16], bytes.data(), 16);
    };
    // Blocks are independent: the order in which threads take rows changes nothing.
    std::atomic<uint32_t> next{0};
    std::atomic<bool> stopped{false};
    const auto work = [&](bool asks) {
        for (uint32_t by; !stopped && (by = next++) < down;) {
            for (uint32_t bx = 0; bx < across; ++bx) encode(bx, by);
            if (asks && stop && stop()) stopped = true;
        }
    };
    std::vector<std::jthread> helpers;
    try {
        for (unsigned i = 1; i < std::min(down, std::max(1u, std::thread::hardware_concurrency())); ++i)
            helpers.emplace_back(work, false);
    } catch (const std::system_error&) {  // fewer threads are enough
    }
    work(true);
    helpers.clear();
    if (stopped) blocks.clear();
    return blocks;
}

std::vector<uint16_t> decodeBc6h(uint32_t width, uint32_t height, std::span<const uint8_t> blocks) {
    const uint32_t across = (width + 3) / 4, down = (height + 3) / 4;
    if (blocks.size() != size_t(across) * down * 16)
        throw std::invalid_argument("16 bytes per 4x4 texels are needed");
    std::vector<uint16_t> texels(size_t(width) * height * 3);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            bc6h::Bytes bytes;
            std::memcpy(bytes.data(), &blocks[(size_t(y / 4) * across + x / 4) * 16], 16);
            const auto block = bc6h::unpack(bytes);
            if (!block) continue;
            const auto& [first, second] = block->ends;
            const int bits = bc6h::modes[block->mode].bits,
                      weight = bc6h::weights[block->index[y % 4 * 4 + x % 4]];
            for (size_t c = 0; c < 3; ++c)
                texels[(size_t(y) * width + x) * 3 + c] = bc6h::halfOf(bc6h::interpolated(
                    bc6h::unquantised(first[c], bits), bc6h::unquantised(second[c], bits), weight));
        }
    return texels;
}

TexelError differenceOf(std::span<const uint16_t> halves, std::span<const uint16_t> others) {
    TexelError error;
    double sum = 0;
    for (size_t i = 0; i < halves.size(); ++i) {
        const double d =
            double(bc6h::linearValue(storable(halves[i]))) - bc6h::linearValue(storable(others[i]));
        error.max = std::max(error.max, std::abs(d));
        sum += d * d;
    }
    error.rms = halves.empty() ? 0 : std::sqrt(sum / double(halves.size()));
    return error;
}

}  // namespace pellucid::io
