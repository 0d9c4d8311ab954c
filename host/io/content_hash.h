// 64-bit FNV-1a [Fowler, Noll, Vo]: names of files from their content.
#pragma once
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace pellucid::io {

// 16 hexadecimal digits.
inline std::string hexDigits(uint64_t value) {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(value));
    return digits;
}

class ContentHash {
  public:
    ContentHash& add(std::string_view bytes) {
        for (char c : bytes) hash_ = (hash_ ^ static_cast<unsigned char>(c)) * 1099511628211u;
        return *this;
    }
    std::string text() const { return hexDigits(hash_); }

  private:
    uint64_t hash_ = 14695981039346656037u;
};

}  // namespace pellucid::io
