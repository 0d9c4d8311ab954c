#include "cl/binary_files.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>

#include "cl/error.h"
#include "cl/machine.h"
#include "system/process.h"

namespace pel::cl {
namespace fs = std::filesystem;
namespace {

// Stored before the binary: damaged, truncated or renamed files do not match it.
std::string checksum(const Digest& name, const std::string& binary) {
    return Digest().addPart(name.text()).add(binary).text();
}

// Reads a file and marks it as just used. Empty if it is no file, larger than `limit` bytes, or unreadable.
std::optional<std::string> readFile(const fs::path& path, uint64_t limit) {
    std::error_code error;
    if (!fs::is_regular_file(path, error) || fs::file_size(path, error) > limit || error) return {};
    std::ifstream file(path, std::ios::binary);
    std::string bytes(size_t(fs::file_size(path, error)), '\0');
    if (error || !file.read(bytes.data(), std::streamsize(bytes.size()))) return {};
    fs::last_write_time(path, fs::file_time_type::clock::now(), error);
    return bytes;
}

constexpr size_t nameLength = Digest::length + 4;  // and ".bin"

bool isBinary(const std::string& name) {
    return name.size() == nameLength && name.ends_with(".bin");
}

bool isTemporary(const std::string& name) {
    return name.size() > nameLength && name[0] == '.' && name.ends_with(".tmp") &&
           name.compare(Digest::length + 1, 5, ".bin.") == 0;
}

}  // namespace

std::optional<std::string> BinaryFiles::load(const Digest& name) const {
    if (!whyNotPrivate(folder_).empty()) return {};
    const std::optional<std::string> file = readFile(pathOf(name), Digest::length + limit_);
    if (!file || file->size() < Digest::length) return {};
    std::string binary = file->substr(Digest::length);
    if (!file->starts_with(checksum(name, binary))) return {};
    return binary;
}

bool BinaryFiles::store(const Digest& name, const std::string& binary) const {
    if (binary.empty() || binary.size() > limit_) return false;
    if (!makePrivateFolder(folder_) || !whyNotPrivate(folder_).empty()) return false;
    // Written under a temporary name and renamed: other processes write and read the same programs.
    static std::atomic<unsigned> counter{0};
    const fs::path path = pathOf(name),
                   temporary = folder_ / text(".", path.filename().string(), ".", system::processId(), "-",
                                              counter++, ".tmp");
    std::ofstream file(temporary, std::ios::binary);
    file << checksum(name, binary) << binary;
    file.close();
    std::error_code error;
    if (file) fs::rename(temporary, path, error);
    if (!file || error) {
        fs::remove(temporary, error);
        return false;
    }
    trim();
    return true;
}

void BinaryFiles::trim() const {
    struct Kept {
        fs::path path;
        fs::file_time_type used;
        uint64_t bytes;
    };
    std::vector<Kept> files;
    uint64_t total = 0;
    std::error_code error;
    for (auto at = fs::directory_iterator(folder_, error); !error && at != fs::directory_iterator();
         at.increment(error)) {
        const std::string name = at->path().filename().string();
        if (!isBinary(name) && !isTemporary(name)) continue;
        std::error_code gone;  // by another process
        const Kept file{at->path(), at->last_write_time(gone), at->file_size(gone)};
        if (gone) continue;
        // Files that a killed process left behind.
        if (isTemporary(name)) {
            if (fs::file_time_type::clock::now() - file.used > std::chrono::hours(1))
                fs::remove(file.path, gone);
            continue;
        }
        total += file.bytes;
        files.push_back(file);
    }
    std::sort(files.begin(), files.end(), [](const Kept& a, const Kept& b) { return a.used < b.used; });
    for (const Kept& file : files) {
        if (total <= limit_) break;
        fs::remove(file.path, error);
        total -= file.bytes;
    }
}

}  // namespace pel::cl
