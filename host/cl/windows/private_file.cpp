// The folder decides who may write (private_folder.h).
#include "cl/private_file.h"

#include <cstdio>
#include <fstream>

namespace pel::cl {
namespace fs = std::filesystem;

std::optional<std::string> readPrivateFile(const fs::path& path, uint64_t limit) {
    std::error_code error;
    if (!fs::is_regular_file(path, error) || fs::file_size(path, error) > limit || error) return {};
    std::ifstream file(path, std::ios::binary);
    std::string bytes(size_t(fs::file_size(path, error)), '\0');
    if (error || !file.read(bytes.data(), std::streamsize(bytes.size()))) return {};
    fs::last_write_time(path, fs::file_time_type::clock::now(), error);
    return bytes;
}

bool writePrivateFile(const fs::path& path, std::string_view head, std::string_view rest) {
    std::FILE* const file = ::_wfopen(path.c_str(), L"wbx");
    if (!file) return false;
    bool written = std::fwrite(head.data(), 1, head.size(), file) == head.size();
    written = std::fwrite(rest.data(), 1, rest.size(), file) == rest.size() && written;
    written = std::fclose(file) == 0 && written;
    std::error_code ignored;
    if (!written) fs::remove(path, ignored);
    return written;
}

}  // namespace pel::cl
