#include "io/lut/bc6h_block.h"

#include <vector>

namespace pellucid::io::bc6h {
namespace {

// Bits follow the mode's code in this order, the lowest first; "rw9:0" is red of w, bits 0 to 9, "rw10:15"
// bit 15 first.
constexpr Mode modes[modeCount] = {
    {0x00,
     2,
     2,
     true,
     10,
     {5, 5, 5},
     "gy4 by4 bz4 rw9:0 gw9:0 bw9:0 rx4:0 gz4 gy3:0 gx4:0 bz0 gz3:0 bx4:0 bz1 by3:0 ry4:0 bz2 rz4:0 bz3"},
    {0x01,
     2,
     2,
     true,
     7,
     {6, 6, 6},
     "gy5 gz4 gz5 rw6:0 bz0 bz1 by4 gw6:0 by5 bz2 gy4 bw6:0 bz3 bz5 bz4 rx5:0 gy3:0 gx5:0 gz3:0 bx5:0 by3:0 "
     "ry5:0 rz5:0"},
    {0x02,
     5,
     2,
     true,
     11,
     {5, 4, 4},
     "rw9:0 gw9:0 bw9:0 rx4:0 rw10 gy3:0 gx3:0 gw10 bz0 gz3:0 bx3:0 bw10 bz1 by3:0 ry4:0 bz2 rz4:0 bz3"},
    {0x06,
     5,
     2,
     true,
     11,
     {4, 5, 4},
     "rw9:0 gw9:0 bw9:0 rx3:0 rw10 gz4 gy3:0 gx4:0 gw10 gz3:0 bx3:0 bw10 bz1 by3:0 ry3:0 bz0 bz2 rz3:0 gy4 "
     "bz3"},
    {0x0A,
     5,
     2,
     true,
     11,
     {4, 4, 5},
     "rw9:0 gw9:0 bw9:0 rx3:0 rw10 by4 gy3:0 gx3:0 gw10 bz0 gz3:0 bx4:0 bw10 by3:0 ry3:0 bz1 bz2 rz3:0 bz4 "
     "bz3"},
    {0x0E,
     5,
     2,
     true,
     9,
     {5, 5, 5},
     "rw8:0 by4 gw8:0 gy4 bw8:0 bz4 rx4:0 gz4 gy3:0 gx4:0 bz0 gz3:0 bx4:0 bz1 by3:0 ry4:0 bz2 rz4:0 bz3"},
    {0x12,
     5,
     2,
     true,
     8,
     {6, 5, 5},
     "rw7:0 gz4 by4 gw7:0 bz2 gy4 bw7:0 bz3 bz4 rx5:0 gy3:0 gx4:0 bz0 gz3:0 bx4:0 bz1 by3:0 ry5:0 rz5:0"},
    {0x16,
     5,
     2,
     true,
     8,
     {5, 6, 5},
     "rw7:0 bz0 by4 gw7:0 gy5 gy4 bw7:0 gz5 bz4 rx4:0 gz4 gy3:0 gx5:0 gz3:0 bx4:0 bz1 by3:0 ry4:0 bz2 rz4:0 "
     "bz3"},
    {0x1A,
     5,
     2,
     true,
     8,
     {5, 5, 6},
     "rw7:0 bz1 by4 gw7:0 by5 gy4 bw7:0 bz5 bz4 rx4:0 gz4 gy3:0 gx4:0 bz0 gz3:0 bx5:0 by3:0 ry4:0 bz2 rz4:0 "
     "bz3"},
    {0x1E,
     5,
     2,
     false,
     6,
     {6, 6, 6},
     "rw5:0 gz4 bz0 bz1 by4 gw5:0 gy5 by5 bz2 gy4 bw5:0 gz5 bz3 bz5 bz4 rx5:0 gy3:0 gx5:0 gz3:0 bx5:0 by3:0 "
     "ry5:0 rz5:0"},
    {0x03, 5, 1, false, 10, {10, 10, 10}, "rw9:0 gw9:0 bw9:0 rx9:0 gx9:0 bx9:0"},
    {0x07, 5, 1, true, 11, {9, 9, 9}, "rw9:0 gw9:0 bw9:0 rx8:0 rw10 gx8:0 gw10 bx8:0 bw10"},
    {0x0B, 5, 1, true, 12, {8, 8, 8}, "rw9:0 gw9:0 bw9:0 rx7:0 rw10:11 gx7:0 gw10:11 bx7:0 bw10:11"},
    {0x0F, 5, 1, true, 16, {4, 4, 4}, "rw9:0 gw9:0 bw9:0 rx3:0 rw10:15 gx3:0 gw10:15 bx3:0 bw10:15"},
};

// One bit per texel, texel 0 lowest.
constexpr uint16_t partitions[partitionCount] = {
    0xCCCC, 0x8888, 0xEEEE, 0xECC8, 0xC880, 0xFEEC, 0xFEC8, 0xEC80, 0xC800, 0xFFEC, 0xFE80,
    0xE800, 0xFFE8, 0xFF00, 0xFFF0, 0xF000, 0xF710, 0x008E, 0x7100, 0x08CE, 0x008C, 0x7310,
    0x3100, 0x8CCE, 0x088C, 0x3110, 0x6666, 0x366C, 0x17E8, 0x0FF0, 0x718E, 0x399C};
constexpr uint8_t anchors[partitionCount] = {15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15,
                                             15, 2,  8,  2,  2,  8,  8,  15, 2,  8,  2,  2,  8,  8,  2,  2};
constexpr uint8_t weights3[] = {0, 9, 18, 27, 37, 46, 55, 64};
constexpr uint8_t weights4[] = {0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64};

struct Bit {
    uint8_t end, channel, bit;
};

// The layout's text, as one entry per bit.
std::vector<Bit> parsed(std::string_view layout) {
    std::vector<Bit> bits;
    for (size_t at = 0; at < layout.size();) {
        const auto channel = uint8_t(std::string_view("rgb").find(layout[at])),
                   end = uint8_t(std::string_view("wxyz").find(layout[at + 1]));
        at += 2;
        const auto number = [&] {
            int n = 0;
            for (; at < layout.size() && layout[at] >= '0' && layout[at] <= '9'; ++at)
                n = 10 * n + layout[at] - '0';
            return n;
        };
        const int high = number();
        int low = high;
        if (at < layout.size() && layout[at] == ':') {
            ++at;
            low = number();
        }
        // In this notation the last one named comes first in the block.
        for (int b = low;; b += high > low ? 1 : -1) {
            bits.push_back({end, channel, uint8_t(b)});
            if (b == high) break;
        }
        ++at;  // the blank
    }
    return bits;
}

const std::vector<Bit>& layoutOf(int index) {
    static const auto all = [] {
        std::array<std::vector<Bit>, modeCount> layouts;
        for (int i = 0; i < modeCount; ++i) layouts[size_t(i)] = parsed(modes[i].layout);
        return layouts;
    }();
    return all[size_t(index)];
}

class BitStream {
  public:
    explicit BitStream(Bytes& bytes) : bytes_(bytes) {}
    void put(int value, int count) {
        for (int i = 0; i < count; ++i, ++at_)
            bytes_[size_t(at_ / 8)] |= uint8_t((value >> i & 1) << at_ % 8);
    }
    int take(int count) {
        int value = 0;
        for (int i = 0; i < count; ++i, ++at_) value |= (bytes_[size_t(at_ / 8)] >> at_ % 8 & 1) << i;
        return value;
    }

  private:
    Bytes& bytes_;
    int at_ = 0;
};

int indexBits(const Block& block, int texel) {
    const int full = modes[block.mode].subsets == 2 ? 3 : 4;
    const bool anchor =
        texel == 0 || (modes[block.mode].subsets == 2 && texel == secondAnchor(block.partition));
    return anchor ? full - 1 : full;
}

}  // namespace

const Mode& mode(int index) {
    return modes[index];
}

bool inSecond(int partition, int texel) {
    return partitions[partition] >> texel & 1;
}

int secondAnchor(int partition) {
    return anchors[partition];
}

Bytes pack(const Block& block) {
    const Mode& m = modes[block.mode];
    EndPoints stored = block.ends;
    if (m.transformed)
        for (size_t e = 1; e < 4; ++e)
            for (size_t c = 0; c < 3; ++c) stored[e][c] -= block.ends[0][c];
    Bytes bytes{};
    BitStream out(bytes);
    out.put(m.code, m.codeBits);
    for (const Bit& b : layoutOf(block.mode)) out.put(stored[b.end][b.channel] >> b.bit & 1, 1);
    if (m.subsets == 2) out.put(block.partition, 5);
    for (int i = 0; i < 16; ++i) out.put(block.index[size_t(i)], indexBits(block, i));
    return bytes;
}

std::optional<Block> unpack(const Bytes& bytes) {
    Bytes copy = bytes;
    const int low = bytes[0] & 3, code = low < 2 ? low : bytes[0] & 31;
    Block block;
    for (block.mode = 0; block.mode < modeCount; ++block.mode)
        if (modes[block.mode].code == code) break;
    if (block.mode == modeCount) return {};
    const Mode& m = modes[block.mode];
    BitStream in(copy);
    in.take(m.codeBits);
    for (const Bit& b : layoutOf(block.mode)) block.ends[b.end][b.channel] |= in.take(1) << b.bit;
    if (m.transformed)
        for (size_t e = 1; e < size_t(2 * m.subsets); ++e)
            for (size_t c = 0; c < 3; ++c) {
                int difference = block.ends[e][c];
                if (difference >> (m.stored[c] - 1) & 1) difference -= 1 << m.stored[c];
                block.ends[e][c] = (block.ends[0][c] + difference) & ((1 << m.bits) - 1);
            }
    if (m.subsets == 2) block.partition = in.take(5);
    for (int i = 0; i < 16; ++i) block.index[size_t(i)] = uint8_t(in.take(indexBits(block, i)));
    return block;
}

bool fitsMode(const Mode& m, const EndPoints& ends) {
    if (!m.transformed) return true;
    for (size_t e = 1; e < size_t(2 * m.subsets); ++e)
        for (size_t c = 0; c < 3; ++c) {
            const int difference = ends[e][c] - ends[0][c], limit = 1 << (m.stored[c] - 1);
            if (difference < -limit || difference >= limit) return false;
        }
    return true;
}

int unquantised(int value, int bits) {
    if (bits >= 15 || value == 0) return value;
    if (value == (1 << bits) - 1) return 0xFFFF;
    return ((value << 16) + 0x8000) >> bits;
}

std::span<const uint8_t> weights(int subsets) {
    if (subsets == 2) return weights3;
    return weights4;
}

}  // namespace pellucid::io::bc6h
