// Compiled programs on disk, for drivers that keep none themselves.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "cl/digest.h"

namespace pel::cl {

// The folder that the environment names: PELLUCID_CACHE_DIR, else pellucid in XDG_CACHE_HOME or ~/.cache.
// Empty: none.
std::filesystem::path binaryFolder();

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
