// BC6H, unsigned: RGB halves at one byte per texel, as graphics hardware samples them.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace pellucid::io {

// Largest and root-mean-square difference of any channel of any texel, in the texels' own (linear) units.
struct TexelError {
    double max = 0, rms = 0;
};

// Blocks of 4x4 texels, row by row, 16 bytes each, from three halves per texel. Texels beyond the right and
// bottom edge do not count. Negative values and NaN become 0, infinity becomes 65504. Chooses among the four
// modes with one line through colour space by the squared error of the decoded values; the ten modes with two
// lines would lower the RMS error of a table by 5 % (64x64) to 0.4 % (512x512). The same input gives the same
// bytes.
// `stop` is asked on the calling thread after each of its rows of blocks; if it ends the work, no blocks are
// returned.
std::vector<uint8_t> encodeBc6h(uint32_t width, uint32_t height, std::span<const uint16_t> texels,
                                const std::function<bool()>& stop = {});

// Three halves per texel, from blocks that encodeBc6h wrote; one of another mode is black.
std::vector<uint16_t> decodeBc6h(uint32_t width, uint32_t height, std::span<const uint8_t> blocks);

TexelError differenceOf(std::span<const uint16_t> halves, std::span<const uint16_t> others);

}  // namespace pellucid::io
