// A block of BC6H, unsigned, in the four modes with one line through colour space: the meaning of its 128
// bits, and its colours [Khronos Data Format Specification 1.3, "BC6H"; Microsoft, BC6H Format].
#pragma once
#include <array>
#include <cstdint>
#include <optional>

namespace pellucid::io::bc6h {

struct Mode {
    uint8_t code;  // the first five bits of the block
    uint8_t bits;  // of an end point
    uint8_t
        stored;  // bits of the second end point as stored: a difference from the first if fewer than `bits`
    bool transformed() const { return stored < bits; }
};
inline constexpr Mode modes[] = {{0x03, 10, 10}, {0x07, 11, 9}, {0x0B, 12, 8}, {0x0F, 16, 4}};

using EndPoints = std::array<std::array<int, 3>, 2>;

struct Block {
    int mode = 0;      // index of `modes`
    EndPoints ends{};  // quantised to the mode's bits, differences undone
    std::array<uint8_t, 16> index{};
};

using Bytes = std::array<uint8_t, 16>;
Bytes pack(const Block& block);  // needs what fitsMode() asks, and an index of texel 0 below 8
std::optional<Block> unpack(const Bytes& bytes);  // none: another mode

// Whether the difference from the first end point can be stored.
bool fitsMode(const Mode& mode, const EndPoints& ends);

// An end point's value of 0 to 65535, and the half (as bits) that such a value decodes to.
int unquantised(int value, int bits);
inline uint16_t halfOf(int value) {
    return uint16_t(value * 31 >> 6);
}

// Sixty-fourths of the way from one end point to the other, by index.
inline constexpr uint8_t weights[] = {0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64};

inline int interpolated(int a, int b, int weight) {
    return (a * (64 - weight) + b * weight + 32) >> 6;
}

// The wanted content of a block: halves as bits (0 to 0x7BFF), and which texels count.
struct Target {
    std::array<std::array<uint16_t, 3>, 16> texel{};
    uint16_t counts = 0xFFFF;  // one bit per texel; at least one is set
};

// The value of a half that is not negative.
float linearValue(uint16_t half);

Block bestBlock(const Target& target);

}  // namespace pellucid::io::bc6h
