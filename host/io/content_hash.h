// Names of files from their content, and checksums of whole files: XXH64 [Collet].
#pragma once
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace pellucid::io {

uint64_t contentHash(std::string_view bytes);

// 16 hexadecimal digits.
inline std::string hexDigits(uint64_t value) {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(value));
    return digits;
}

}  // namespace pellucid::io
