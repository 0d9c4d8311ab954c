#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "io/input_file.h"

namespace pellucid::io {
namespace fs = std::filesystem;
namespace {

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

std::unique_ptr<std::FILE, Close> opened(const std::string& path) {
    const std::string other = otherThanFile(path);
    if (!other.empty()) throw FileError(path, "is " + other + ", not a file");
    std::unique_ptr<std::FILE, Close> file(::_wfopen(fs::path(path).c_str(), L"rb"));
    if (!file) throw FileError(path, std::string("cannot be read: ") + std::strerror(errno));
    return file;
}

}  // namespace

std::string otherThanFile(const std::string& path) {
    if (path.find('\0') != std::string::npos) return "a name with a NUL character";
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    return !fs::exists(status) || fs::is_regular_file(status) ? ""
           : fs::is_directory(status)                         ? "a folder"
                                                              : "a device";
}

void checkReadable(const std::string& path) {
    (void)opened(path);
}

std::string readWholeFile(const std::string& path, uint64_t limit) {
    const auto file = opened(path);
    std::error_code error;
    const uint64_t bytes = fs::file_size(path, error);
    if (!error && bytes > limit) refuseTooLarge(path, bytes, limit);
    std::string text;
    text.resize(size_t(error ? 0 : bytes) + 1);  // one more, to notice the end
    size_t filled = 0;
    while (const size_t got = std::fread(text.data() + filled, 1, text.size() - filled, file.get())) {
        filled += got;
        if (filled > limit) refuseTooLarge(path, filled, limit);
        if (filled == text.size()) text.resize(2 * filled);  // it grew
    }
    if (std::ferror(file.get())) throw FileError(path, "cannot be read: the disk failed");
    text.resize(filled);
    return text;
}

}  // namespace pellucid::io
