// Numbers in texts.
#pragma once
#include <charconv>
#include <cstdio>
#include <string>

namespace pellucid::io {

// The fewest digits that are read back as the same number, in any locale.
template <class Number>
std::string shortest(Number value) {
    char digits[32];
    return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

// As std::printf writes them, up to 255 characters.
template <class... Values>
std::string printed(const char* format, Values... values) {
    char text[256];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

}  // namespace pellucid::io
