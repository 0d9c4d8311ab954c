#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "io/input_file.h"

namespace pellucid::io {
namespace {

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

// Opens a regular file and returns its size.
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
    throw FileError(path, "is " + (other.empty() ? "something else by now" : other) + ", not a file");
}

}  // namespace

std::string otherThanFile(const std::string& path) {
    if (path.find('\0') != std::string::npos) return "a name with a NUL character";
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
    if (bytes > limit) refuseTooLarge(path, bytes, limit);
    std::string text;
    // One byte more than its size, to notice the end; files of /proc have no size.
    text.resize(size_t(bytes) + 1);
    size_t filled = 0;
    for (;;) {
        const ssize_t got =
            ::read(file, text.data() + filled, std::min(text.size() - filled, size_t{1} << 30));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) unreadable(path);
        if (got == 0) break;
        filled += size_t(got);
        if (filled > limit) refuseTooLarge(path, filled, limit);
        if (filled == text.size()) text.resize(2 * filled);  // it grew
    }
    text.resize(filled);
    return text;
}

}  // namespace pellucid::io
