// Concatenates texts for messages.
#pragma once
#include <charconv>
#include <iterator>
#include <string>
#include <string_view>
#include <type_traits>

namespace pellucid::io {

// The parts as one text; numbers with the fewest digits that read back as the same value, in every locale.
template <class... Parts>
std::string concat(const Parts&... parts) {
    const auto text = [](const auto& part) {
        if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(part)>>) {
            char digits[32];  // the longest double has 24
            return std::string(digits, std::to_chars(digits, std::end(digits), part).ptr);
        } else
            return std::string_view(part);
    };
    std::string all;
    (all.append(text(parts)), ...);
    return all;
}

}  // namespace pellucid::io
