// Concatenates texts for messages.
#pragma once
#include <string_view>
#include <type_traits>

#include "io/shortest.h"

namespace pellucid::io {

// The parts as one text; numbers with the fewest digits that read back as the same value, in every locale.
template <class... Parts>
std::string concat(const Parts&... parts) {
    const auto text = [](const auto& part) {
        if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(part)>>)
            return shortest(part);
        else
            return std::string_view(part);
    };
    std::string all;
    (all.append(text(parts)), ...);
    return all;
}

// The texts with ", " between them.
template <class Texts>
std::string joined(const Texts& texts) {
    std::string list;
    for (const auto& text : texts) list.append(list.empty() ? "" : ", ").append(text);
    return list;
}

// `text` with control characters, which a terminal would obey, as \xNN. `lines`: but for line breaks.
inline std::string printable(std::string_view text, bool lines = false) {
    constexpr const char* digits = "0123456789abcdef";
    std::string all;
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if ((code >= ' ' && code != 127) || c == '\t' || (lines && c == '\n'))
            all += c;
        else
            all.append("\\x").append(1, digits[code >> 4]).append(1, digits[code & 15]);
    }
    return all;
}

}  // namespace pellucid::io
