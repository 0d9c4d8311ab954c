// The one exception type that crosses the library's layers. host/api turns it into a PelError and a message.
#pragma once
#include <pellucid/pellucid.h>

#include <charconv>
#include <locale>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

namespace pel {

class Error : public std::runtime_error {
  public:
    Error(PelError code, const std::string& message) : std::runtime_error(message), code_(code) {}
    PelError code() const { return code_; }

  private:
    PelError code_;
};

// Joins values into one text, the same in every locale. Floats have all their digits: one just beyond a limit
// must not look like the limit.
template <class... Parts>
std::string text(const Parts&... parts) {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    const auto add = [&out]<class Part>(const Part& part) {
        char digits[32];
        if constexpr (std::is_same_v<Part, float>)
            out << std::string_view(digits, std::to_chars(digits, digits + sizeof digits, part).ptr);
        else
            out << part;
    };
    (add(parts), ...);
    return out.str();
}

template <class... Parts>
[[noreturn]] void fail(PelError code, const Parts&... parts) {
    throw Error(code, text(parts...));
}

template <class... Parts>
[[noreturn]] void invalidArgument(const Parts&... parts) {
    fail(PEL_ERROR_INVALID_ARGUMENT, parts...);
}

// Returns the result of body(). Messages of errors that it throws begin with `parts`.
template <class Body, class... Parts>
auto about(Body&& body, const Parts&... parts) {
    try {
        return body();
    } catch (const Error& e) {
        fail(e.code(), parts..., ": ", e.what());
    }
}

}  // namespace pel
