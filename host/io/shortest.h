// Numbers in texts.
#pragma once
#include <charconv>
#include <string>

namespace pellucid::io {

// The fewest digits that are read back as the same number, in any locale.
template <class Number>
std::string shortest(Number value) {
    char digits[32];
    return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

}  // namespace pellucid::io
