// Compiled programs on disk, for drivers that keep none themselves.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "cl/digest.h"

namespace pel::cl {

// Where the environment wants them: PELLUCID_CACHE_DIR, else pellucid in XDG_CACHE_HOME or ~/.cache. Empty: nowhere.
std::filesystem::path binaryFolder();

// A folder of one file per program. Whatever goes wrong with a file is no error: the program is then compiled.
class BinaryFiles {
  public:
    // The oldest files go when there are more than `limit` bytes.
    BinaryFiles(std::filesystem::path folder, uint64_t limit) : folder_(std::move(folder)), limit_(limit) {}

    // What was stored under this name; nothing if it is not there, not whole, or another user's (it is machine code that
    // this process will run; root's is taken).
    std::optional<std::string> load(const Digest& name) const;
    bool store(const Digest& name, const std::string& binary) const;

  private:
    std::filesystem::path pathOf(const Digest& name) const { return folder_ / (name.text() + ".bin"); }
    void trim() const;

    std::filesystem::path folder_;
    uint64_t limit_;  // bytes
};

}  // namespace pel::cl
