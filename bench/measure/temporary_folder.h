#pragma once
#include <filesystem>
#include <stdexcept>

#include "system/process.h"

namespace pellucid::bench {

// A folder that only this user can enter, removed with its object, or by a later one of the same prefix.
class TemporaryFolder {
  public:
    explicit TemporaryFolder(const std::string& prefix) {
        std::error_code error;
        const std::string parent = std::filesystem::temp_directory_path(error).string();
        if (!error) path_ = pel::system::makeTemporaryFolder(parent, prefix);
        if (path_.empty())
            throw std::runtime_error(
                "no temporary folder can be made: TMPDIR must name a folder that may be "
                "written to (without it, /tmp)");
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    const std::string& path() const { return path_; }

  private:
    std::string path_;
};

}  // namespace pellucid::bench
