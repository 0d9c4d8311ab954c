// Capitals, digits and signs as 5 x 7 dots, for labels where no font is installed.
#pragma once
#include <array>
#include <cstdint>

namespace pellucid::io {

// Seven rows from the top; bit 4 is the leftmost dot. A box for characters that are not there.
std::array<uint8_t, 7> glyph(char character);

constexpr int glyphWidth = 5, glyphHeight = 7, glyphAdvance = 6;

}  // namespace pellucid::io
