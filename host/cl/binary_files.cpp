#include "cl/binary_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "cl/error.h"
#include "cl/private_folder.h"

namespace pel::cl {
namespace fs = std::filesystem;
namespace {

// Header before the binary, in the machine's byte order: a file of a machine with another order does not
// match.
struct Header {
    char magic[8] = {'P', 'E', 'L', 'B', 'I', 'N', '0', '1'};
    uint64_t name[2] = {};      // of the file: a renamed file is refused
    uint64_t bytes = 0;         // of the binary
    uint64_t checkSum[2] = {};  // of the binary
    bool operator==(const Header&) const = default;
};

Header headerOf(const Digest& name, const std::string& binary) {
    const Digest sum = Digest().add(binary);
    Header header;
    header.name[0] = name.high(), header.name[1] = name.low();
    header.bytes = binary.size();
    header.checkSum[0] = sum.high(), header.checkSum[1] = sum.low();
    return header;
}

class File {
  public:
    File(const fs::path& path, int flags) : fd_(::open(path.c_str(), flags | O_CLOEXEC, 0600)) {}
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
    bool write(const void* from, size_t bytes) const {
        return whole(bytes, [&](size_t done) {
            return ::write(fd_, static_cast<const char*>(from) + done, bytes - done);
        });
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

constexpr size_t nameLength = 36;  // 32 digits and ".bin"

bool isBinary(const std::string& name) {
    return name.size() == nameLength && name.ends_with(".bin");
}

bool isTemporary(const std::string& name) {
    return name.size() > nameLength && name[0] == '.' && name.ends_with(".tmp") &&
           name.compare(33, 5, ".bin.") == 0;
}

}  // namespace

fs::path binaryFolder() {
    if (const char* own = std::getenv("PELLUCID_CACHE_DIR")) {
        const std::string text = own;
        return text == "0" || text == "off" ? fs::path() : fs::path(text);
    }
    const std::vector<fs::path> homes = cacheHomes();
    return homes.empty() ? fs::path() : homes.front() / "pellucid";
}

std::optional<std::string> BinaryFiles::load(const Digest& name) const {
    if (!whyNotPrivate(folder_).empty()) return {};
    const File file(pathOf(name), O_RDONLY | O_NONBLOCK);  // opening a pipe of that name would block
    struct stat status {};
    Header header;
    if (!file || ::fstat(file.fd(), &status) != 0 || !S_ISREG(status.st_mode) ||
        !file.read(&header, sizeof header))
        return {};
    if (status.st_uid != ::geteuid() && status.st_uid != 0) return {};
    if (uint64_t(status.st_size) != sizeof header + header.bytes || header.bytes > limit_) return {};
    std::string binary(header.bytes, '\0');
    if (!file.read(binary.data(), binary.size()) || header != headerOf(name, binary)) return {};
    ::futimens(file.fd(), nullptr);  // the least recently used go first
    return binary;
}

bool BinaryFiles::store(const Digest& name, const std::string& binary) const {
    if (binary.empty() || binary.size() > limit_) return false;
    if (!makePrivateFolder(folder_) || !whyNotPrivate(folder_).empty()) return false;
    // Written under a temporary name and renamed when complete: other processes write and read the same
    // programs.
    static std::atomic<unsigned> counter{0};
    const fs::path path = pathOf(name), temporary = folder_ / text(".", path.filename().string(), ".",
                                                                   ::getpid(), "-", counter++, ".tmp");
    {
        const File file(temporary, O_WRONLY | O_CREAT | O_EXCL);
        const Header header = headerOf(name, binary);
        if (!file) return false;
        if (!file.write(&header, sizeof header) || !file.write(binary.data(), binary.size())) {
            ::unlink(temporary.c_str());
            return false;
        }
    }
    if (std::rename(temporary.c_str(), path.c_str()) != 0) {
        ::unlink(temporary.c_str());
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
