#include "io/lut/bc6h_block.h"

namespace pellucid::io::bc6h {
namespace {

constexpr int wordBits = 10;  // of an end point's low part

int indexBits(int texel) {
    return texel == 0 ? 3 : 4;
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

}  // namespace

Bytes pack(const Block& block) {
    const Mode& m = modes[block.mode];
    const auto& [first, second] = block.ends;
    Bytes bytes{};
    BitStream out(bytes);
    out.put(m.code, 5);
    for (const int value : first) out.put(value, wordBits);
    for (size_t c = 0; c < 3; ++c) {
        out.put(m.transformed() ? second[c] - first[c] : second[c], m.stored);
        for (int b = m.bits - 1; b >= wordBits; --b) out.put(first[c] >> b, 1);
    }
    for (int i = 0; i < 16; ++i) out.put(block.index[size_t(i)], indexBits(i));
    return bytes;
}

std::optional<Block> unpack(const Bytes& bytes) {
    Bytes copy = bytes;
    BitStream in(copy);
    const int code = in.take(5);
    Block block;
    while (block.mode < int(std::size(modes)) && modes[block.mode].code != code) ++block.mode;
    if (block.mode == int(std::size(modes))) return {};
    const Mode& m = modes[block.mode];
    auto& [first, second] = block.ends;
    for (int& value : first) value = in.take(wordBits);
    for (size_t c = 0; c < 3; ++c) {
        second[c] = in.take(m.stored);
        for (int b = m.bits - 1; b >= wordBits; --b) first[c] |= in.take(1) << b;
        if (!m.transformed()) continue;
        if (second[c] >> (m.stored - 1)) second[c] -= 1 << m.stored;
        second[c] = (first[c] + second[c]) & ((1 << m.bits) - 1);
    }
    for (int i = 0; i < 16; ++i) block.index[size_t(i)] = uint8_t(in.take(indexBits(i)));
    return block;
}

bool fitsMode(const Mode& m, const EndPoints& ends) {
    if (!m.transformed()) return true;
    const int limit = 1 << (m.stored - 1);
    for (size_t c = 0; c < 3; ++c) {
        const int difference = ends[1][c] - ends[0][c];
        if (difference < -limit || difference >= limit) return false;
    }
    return true;
}

int unquantised(int value, int bits) {
    if (bits >= 15 || value == 0) return value;
    if (value == (1 << bits) - 1) return 0xFFFF;
    return ((value << 16) + 0x8000) >> bits;
}

}  // namespace pellucid::io::bc6h
