// A block of BC6H, unsigned: its 14 modes, the meaning of its 128 bits, and its colours [Khronos Data Format
// Specification 1.3, "BC6H"; Microsoft, BC6H Format].
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace pellucid::io::bc6h {

struct Mode {
    uint8_t code, codeBits;  // the first bits of the block
    uint8_t subsets;         // 1 or 2 lines through colour space
    bool transformed;        // the other end points are stored as differences from the first
    uint8_t bits;            // of an end point
    uint8_t stored[3];       // bits of the other end points as stored, red, green, blue
    // Where each bit goes, in the notation of the specification: end points w, x, y, z
    std::string_view layout;
};

inline constexpr int modeCount = 14, partitionCount = 32;
const Mode& mode(int index);

// Which of the two subsets a texel of a 4x4 block belongs to, and the texel of the second subset whose index
// has one bit less (in the first it is texel 0).
bool inSecond(int partition, int texel);
int secondAnchor(int partition);

using EndPoints = std::array<std::array<int, 3>, 4>;  // w, x: first subset; y, z: second

struct Block {
    int mode = 0, partition = 0;
    EndPoints ends{};  // quantised to mode bits, differences undone
    std::array<uint8_t, 16> index{};
};

using Bytes = std::array<uint8_t, 16>;
Bytes pack(const Block& block);                   // needs what fitsMode() asks and small anchor indices
std::optional<Block> unpack(const Bytes& bytes);  // none: a reserved mode, which decodes to black

// Whether the differences from the first end point can be stored.
bool fitsMode(const Mode& mode, const EndPoints& ends);

// An end point's value of 0 to 65535, and the half (as bits) that such a value decodes to.
int unquantised(int value, int bits);
inline uint16_t halfOf(int value) {
    return uint16_t(value * 31 >> 6);
}

// Sixty-fourths of the way from one end point to the other: 8 of them with two subsets, 16 with one.
std::span<const uint8_t> weights(int subsets);

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
