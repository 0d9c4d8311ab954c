#include "io/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "io/file_error.h"

namespace pellucid::io {
namespace fs = std::filesystem;
namespace {

constexpr const char* limitVariable = "PELLUCID_INPUT_LIMIT_MIB";

class Descriptor {
  public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    operator int() const { return fd_; }

  private:
    int fd_;
};

[[noreturn]] void unreadable(const std::string& path) {
    throw FileError(path, std::string("cannot be read: ") + std::strerror(errno));
}

std::string kindOf(mode_t mode) {
    if (S_ISREG(mode)) return "";
    if (S_ISDIR(mode)) return "a folder";
    if (S_ISFIFO(mode)) return "a pipe";
    if (S_ISSOCK(mode)) return "a socket";
    return "a device";
}

// Opens what is a regular file and tells its size.
int opened(const std::string& path, uint64_t& bytes) {
    const std::string other = otherThanFile(path);
    if (other.empty()) {
        // If it has become a pipe meanwhile, opening it must not wait for a writer.
        const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
        if (fd < 0) unreadable(path);
        struct stat status {};
        if (::fstat(fd, &status) == 0 && S_ISREG(status.st_mode)) {
            bytes = uint64_t(status.st_size);
            return fd;
        }
        ::close(fd);
    }
    throw FileError(path, "is " + (other.empty() ? "another thing by now" : other) + ", not a file");
}

}  // namespace

uint64_t inputLimit() {
    constexpr uint64_t standard = 2048;
    const char* text = std::getenv(limitVariable);
    if (!text || !*text) return standard << 20;
    uint64_t mib = 0;
    const char* end = text + std::strlen(text);
    const auto [at, error] = std::from_chars(text, end, mib);
    if (error != std::errc() || at != end || mib == 0 || mib > uint64_t{1} << 40)
        throw FileError(limitVariable,
                        std::string("is \"") + text + "\"; a whole number of MiB from 1 on would be right");
    return mib << 20;
}

std::string tooLarge(double bytes, uint64_t limit) {
    char text[160];
    std::snprintf(text, sizeof text, "%.1f MiB, more than the limit of %.0f MiB (%s raises it)",
                  bytes / (1 << 20), double(limit) / (1 << 20), limitVariable);
    return text;
}

std::string otherThanFile(const std::string& path) {
    struct stat status {};
    return ::stat(path.c_str(), &status) == 0 ? kindOf(status.st_mode) : "";
}

void checkReadable(const std::string& path) {
    uint64_t bytes = 0;
    const Descriptor file(opened(path, bytes));
}

std::string readWholeFile(const std::string& path, uint64_t limit) {
    uint64_t bytes = 0;
    const Descriptor file(opened(path, bytes));
    const auto refuse = [&](uint64_t found) {
        if (limit == inputLimit()) throw FileError(path, "takes " + tooLarge(double(found), limit));
        throw FileError(path, "has " + std::to_string(found) +
                                  " bytes or more; a text of this kind may have " + std::to_string(limit));
    };
    if (bytes > limit) refuse(bytes);
    std::string text;
    // One byte more than its size, to notice the end; files of /proc have no size.
    text.resize(size_t(bytes) + 1);
    size_t filled = 0;
    for (;;) {
        const ssize_t got = ::read(file, text.data() + filled, std::min(text.size() - filled, size_t{1} << 30));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) unreadable(path);
        if (got == 0) break;
        filled += size_t(got);
        if (filled > limit) refuse(filled);
        if (filled == text.size()) text.resize(2 * filled);  // it grew
    }
    text.resize(filled);
    return text;
}

std::string extensionOf(const std::string& path) {
    std::string extension = fs::path(path).extension().string();
    if (!extension.empty()) extension.erase(0, 1);
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

std::string requireExtension(const std::string& path, std::initializer_list<std::string_view> known) {
    const std::string extension = extensionOf(path);
    if (std::find(known.begin(), known.end(), extension) != known.end()) return extension;
    std::string list;
    for (std::string_view k : known) list.append(list.empty() ? "." : ", .").append(k);
    throw FileError(
        path, (extension.empty() ? "has no extension" : "has the unknown extension '." + extension + "'") +
                  "; known here: " + list);
}

}  // namespace pellucid::io
