#include "cl/private_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace pel::cl {
namespace {

class File {
  public:
    File(const std::filesystem::path& path, int flags) : fd_(::open(path.c_str(), flags | O_CLOEXEC, 0600)) {}
    ~File() {
        if (fd_ >= 0) ::close(fd_);
    }
    File(const File&) = delete;
    int fd() const { return fd_; }
    explicit operator bool() const { return fd_ >= 0; }

    bool read(void* to, size_t bytes) const {
        return whole(bytes,
                     [&](size_t done) { return ::read(fd_, static_cast<char*>(to) + done, bytes - done); });
    }
    bool write(std::string_view from) const {
        return whole(from.size(),
                     [&](size_t done) { return ::write(fd_, from.data() + done, from.size() - done); });
    }

  private:
    template <class Some>
    static bool whole(size_t bytes, const Some& some) {
        for (size_t done = 0; done < bytes;) {
            const ssize_t now = some(done);
            if (now < 0 && errno == EINTR) continue;
            if (now <= 0) return false;
            done += size_t(now);
        }
        return true;
    }
    int fd_;
};

}  // namespace

std::optional<std::string> readPrivateFile(const std::filesystem::path& path, uint64_t limit) {
    const File file(path, O_RDONLY | O_NONBLOCK);  // opening a pipe of that name would block
    struct stat status {};
    if (!file || ::fstat(file.fd(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
    if (status.st_uid != ::geteuid() && status.st_uid != 0) return {};
    if (uint64_t(status.st_size) > limit) return {};
    std::string bytes(size_t(status.st_size), '\0');
    if (!file.read(bytes.data(), bytes.size())) return {};
    ::futimens(file.fd(), nullptr);
    return bytes;
}

bool writePrivateFile(const std::filesystem::path& path, std::string_view head, std::string_view rest) {
    const File file(path, O_WRONLY | O_CREAT | O_EXCL);
    if (!file) return false;
    if (file.write(head) && file.write(rest)) return true;
    ::unlink(path.c_str());
    return false;
}

}  // namespace pel::cl
