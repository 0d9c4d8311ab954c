// The search for one BC6H block.
#pragma once
#include "io/lut/bc6h_block.h"

namespace pellucid::io::bc6h {

// The wanted content of a block: halves as bits (0 to 0x7BFF), and which texels count.
struct Target {
    std::array<std::array<uint16_t, 3>, 16> texel{};
    uint16_t counts = 0xFFFF;  // one bit per texel; at least one is set
};

// The value of a half that is not negative.
float linearValue(uint16_t half);

Block bestBlock(const Target& target);

}  // namespace pellucid::io::bc6h
