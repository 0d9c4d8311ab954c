// 128-bit FNV-1a [Fowler, Noll, Vo; draft-eastlake-fnv]: names and checksums of compiled programs.
#pragma once
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace pel::cl {

class Digest {
  public:
    Digest& add(std::string_view bytes) {
        for (const char c : bytes) state_ = (state_ ^ static_cast<unsigned char>(c)) * prime;
        return *this;
    }
    // Includes the length, so that bytes cannot move between neighbouring values.
    Digest& addPart(std::string_view part) { return add(std::to_string(part.size()) + ":").add(part); }

    uint64_t high() const { return uint64_t(state_ >> 64); }
    uint64_t low() const { return uint64_t(state_); }
    bool operator==(const Digest& other) const = default;
    std::string text() const {  // 32 hexadecimal digits
        char digits[33];
        std::snprintf(digits, sizeof digits, "%016llx%016llx", static_cast<unsigned long long>(high()),
                      static_cast<unsigned long long>(low()));
        return digits;
    }

  private:
    __extension__ using Word = unsigned __int128;
    static constexpr Word prime = Word(1) << 88 | 0x13b;
    Word state_ = Word(0x6c62272e07bb0142) << 64 | 0x62b821756295c58d;
};

}  // namespace pel::cl
