// Texts put together for messages.
#pragma once
#include <string>
#include <string_view>
#include <type_traits>

namespace pellucid::io {

// The parts as one text; numbers as std::to_string writes them.
template <class... Parts>
std::string concat(const Parts&... parts) {
    const auto text = [](const auto& part) {
        if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(part)>>)
            return std::to_string(part);
        else
            return std::string_view(part);
    };
    std::string all;
    (all.append(text(parts)), ...);
    return all;
}

}  // namespace pellucid::io
