#include "io/atomic_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "io/content_hash.h"
#include "io/input_file.h"

#ifndef O_PATH
#define O_PATH O_SEARCH  // as POSIX calls it
#endif

namespace pellucid::io {
namespace fs = std::filesystem;
// 8 hexadecimal digits; see the header.
const std::string& machineTag() {
    static const std::string tag = [] {
        std::string name;
        std::ifstream("/proc/sys/kernel/random/boot_id") >> name;
        if (name.empty()) {
            char host[256] = {};
            ::gethostname(host, sizeof host - 1);
            name = host;
        }
        return hexDigits(contentHash(name)).substr(0, 8);
    }();
    return tag;
}

namespace {

// A folder, to name files in it and to flush it. Files can be written to it even if it cannot be listed.
int openFolder(const std::string& path) {
    const int fd = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    return fd >= 0 || errno != EACCES ? fd : ::open(path.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
}

// Flushes the names in this folder to the disk. Some file systems cannot flush folders, and report that.
bool flushed(int fd) {
#ifdef F_FULLFSYNC
    if (::fcntl(fd, F_FULLFSYNC) == 0) return true;  // fsync of macOS leaves bytes in the disk's own memory
#endif
    return ::fsync(fd) == 0 || errno == EINVAL || errno == EBADF || errno == ENOTSUP;
}

}  // namespace

AtomicFile::AtomicFile(std::string target)
    : target_(std::move(target)), name_(fs::path(target_).filename().string()) {
    refuseOtherThanFile(target_);
    if (name_.empty())
        throw FileError(target_.empty() ? "(no name)" : target_, "an output needs a file name");
    const std::string folder = folderOf(target_);
    folder_ = openFolder(folder);
    if (folder_ < 0 && errno == ENOENT)
        throw FileError(target_, "cannot be written: there is no folder '" + folder + "'; create it first");
    if (folder_ < 0) fail();
    if (const long most = ::fpathconf(folder_, _PC_NAME_MAX); most > 0 && name_.size() > size_t(most)) {
        ::close(folder_);
        throw FileError(
            target_, concat("has a name of ", name_.size(), " bytes; its file system allows at most ", most));
    }
    temporary_ = temporaryName(name_);
    file_ = ::openat(folder_, temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file_ < 0) {
        const int why = errno;
        ::close(folder_);
        errno = why;
        fail();
    }
    ::flock(file_, LOCK_EX | LOCK_NB);  // without locks only the age decides
}

AtomicFile::~AtomicFile() {
    if (!temporary_.empty()) ::unlinkat(folder_, temporary_.c_str(), 0);
    if (file_ >= 0) ::close(file_);
    ::close(folder_);
}

void AtomicFile::fail(const char* what) const {
    throw FileError(target_, what + std::string(std::strerror(errno)));
}

void AtomicFile::write(const void* bytes, size_t count) {
    const char* next = static_cast<const char*>(bytes);
    while (count > 0) {
        const ssize_t wrote = ::write(file_, next, std::min<size_t>(count, size_t{1} << 30));
        if (wrote < 0 && errno == EINTR) continue;
        if (wrote == 0) errno = ENOSPC;
        if (wrote <= 0) fail();
        next += wrote;
        count -= size_t(wrote);
    }
}

void AtomicFile::commit(bool folderToo) {
    if (::fsync(file_) != 0) fail();
    // Network file systems may report only now that they are full. The second descriptor keeps the lock.
    const int locked = ::fcntl(file_, F_DUPFD_CLOEXEC, 0);
    if (locked < 0) fail();
    const int closed = ::close(file_);
    file_ = locked;
    if (closed != 0 && errno != EINTR) fail();
    refuseOtherThanFile(target_);
    if (::renameat(folder_, temporary_.c_str(), folder_, name_.c_str()) != 0) fail();
    temporary_.clear();
    if (folderToo && !flushed(folder_)) fail("is written, but may be lost in a power cut: ");
}

void flushFolder(const std::string& path) {
    const int folder = openFolder(path);
    const bool done = folder >= 0 && flushed(folder);
    const int why = errno;
    if (folder >= 0) ::close(folder);
    if (!done)
        throw FileError(path, std::string("its new files may be lost in a power cut: ") + std::strerror(why));
}

size_t removeAbandonedFiles(const std::string& path) {
    const int folder = openFolder(path);
    if (folder < 0) return 0;
    size_t removed = 0;
    for (const auto& [name, abandonedAfter] : temporaryFiles(path)) {
        const int fd = ::openat(folder, name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
        if (fd < 0) continue;
        struct stat status {};
        if (::fstat(fd, &status) == 0 && S_ISREG(status.st_mode)) {
            const double age = std::difftime(std::time(nullptr), status.st_mtime);
            if (age > abandonedAfter && ::flock(fd, LOCK_EX | LOCK_NB) == 0)
                removed += ::unlinkat(folder, name.c_str(), 0) == 0;
        }
        ::close(fd);
    }
    ::close(folder);
    return removed;
}

}  // namespace pellucid::io
