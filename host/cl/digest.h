// Names and checksums of compiled programs: XXH3, 128 bits [Collet].
#pragma once
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

#define XXH_INLINE_ALL  // no library to link, and nothing of it leaves this one
#include <xxhash.h>

namespace pel::cl {

class Digest {
  public:
    Digest() { XXH3_128bits_reset(&state_); }
    Digest& add(std::string_view bytes) {
        XXH3_128bits_update(&state_, bytes.data(), bytes.size());
        return *this;
    }
    // Includes the length, so that bytes cannot move between neighbouring values.
    Digest& addPart(std::string_view part) { return add(std::to_string(part.size()) + ":").add(part); }

    static constexpr size_t length = 32;  // of text()
    std::string text() const {            // hexadecimal digits
        const XXH128_hash_t hash = XXH3_128bits_digest(&state_);
        char digits[length + 1];
        std::snprintf(digits, sizeof digits, "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                      static_cast<unsigned long long>(hash.low64));
        return digits;
    }

  private:
    XXH3_state_t state_;
};

}  // namespace pel::cl
