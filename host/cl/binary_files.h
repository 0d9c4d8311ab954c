// Compiled programs on disk, for drivers without such a cache.
#pragma once
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#define XXH_INLINE_ALL  // no library to link, no exported symbols
#include <xxhash.h>

namespace pel::cl {

// Names and checksums of compiled programs: XXH3, 128 bits [Collet].
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

// A folder with one file per program. A fault of a file is never an error: the program is then compiled.
class BinaryFiles {
  public:
    // The oldest files are deleted when there are more than `limit` bytes.
    BinaryFiles(std::filesystem::path folder, uint64_t limit) : folder_(std::move(folder)), limit_(limit) {}

    // The binary stored under this name. Empty if the file is missing or incomplete, or if others than this
    // user and root may write to the folder: it is machine code that this process will run.
    std::optional<std::string> load(const Digest& name) const;
    bool store(const Digest& name, const std::string& binary) const;

  private:
    std::filesystem::path pathOf(const Digest& name) const { return folder_ / (name.text() + ".bin"); }
    void trim() const;

    std::filesystem::path folder_;
    uint64_t limit_;  // bytes
};

}  // namespace pel::cl
