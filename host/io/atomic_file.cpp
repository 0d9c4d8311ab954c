#include "io/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>

#include "io/content_hash.h"
#include "io/file_error.h"

namespace pellucid::io {
namespace fs = std::filesystem;
namespace {

std::string systemMessage() {
    return std::strerror(errno);
}

// Flushes what is at `path`, which another writer (OpenImageIO) may have closed already.
bool flushToDisk(const std::string& path) {
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) return false;
    const bool ok = ::fsync(fd) == 0;
    ::close(fd);
    return ok;
}

// Which machine a temporary file belongs to: 4 hexadecimal digits.
std::string machineTag() {
    char name[256] = {};
    ::gethostname(name, sizeof name - 1);
    return ContentHash().add(name).text().substr(0, 4);
}

}  // namespace

AtomicFile::AtomicFile(std::string target) : target_(std::move(target)) {
    // Hidden, unique to process and call, and with the same extension: image writers choose their format by
    // it.
    static std::atomic<unsigned> counter{0};
    const fs::path path(target_);
    static const std::string machine = machineTag();
    const std::string unique = machine + "-" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
    std::string name(".");
    name.append(path.stem().string())
        .append(".")
        .append(unique)
        .append(".tmp")
        .append(path.extension().string());
    temporary_ = (path.parent_path() / name).string();
}

AtomicFile::~AtomicFile() {
    if (!done_) ::unlink(temporary_.c_str());
}

void AtomicFile::write(const void* bytes, size_t count) {
    const int fd = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (fd < 0) throw FileError(target_, "cannot be written: " + systemMessage());
    const char* next = static_cast<const char*>(bytes);
    while (count > 0) {
        const ssize_t wrote = ::write(fd, next, std::min<size_t>(count, size_t{1} << 30));
        if (wrote < 0 && errno == EINTR) continue;
        if (wrote <= 0) {
            const std::string why = systemMessage();
            ::close(fd);
            throw FileError(target_, "cannot be written: " + why);
        }
        next += wrote;
        count -= static_cast<size_t>(wrote);
    }
    flushed_ = ::fsync(fd) == 0;
    if (::close(fd) != 0 || !flushed_) throw FileError(target_, "cannot be written: " + systemMessage());
}

void AtomicFile::commit() {
    if ((!flushed_ && !flushToDisk(temporary_)) || std::rename(temporary_.c_str(), target_.c_str()) != 0)
        throw FileError(target_, "cannot be written: " + systemMessage());
    done_ = true;
}

size_t removeAbandonedFiles(const std::string& folder) {
    static const std::string machine = machineTag();
    size_t removed = 0;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        // .STEM.MACHINE-PROCESS-COUNT.tmp.EXTENSION
        const std::string name = entry.path().filename().string();
        const size_t end = name.rfind(".tmp.");
        if (name[0] != '.' || end == std::string::npos) continue;
        const size_t begin = name.rfind('.', end - 1) + 1;
        char tag[5] = {};
        long process = 0;
        unsigned count = 0;
        if (std::sscanf(name.substr(begin, end - begin).c_str(), "%4[0-9a-f]-%ld-%u", tag, &process,
                        &count) != 3)
            continue;
        struct stat status;
        if (::stat(entry.path().c_str(), &status) != 0) continue;
        const double age = std::difftime(std::time(nullptr), status.st_mtime);
        const bool gone = machine == tag && ::kill(pid_t(process), 0) != 0 && errno == ESRCH;
        if (age > 86400 || (gone && age > 60)) removed += ::unlink(entry.path().c_str()) == 0;
    }
    return removed;
}

void checkWritable(const std::string& path) {
    std::error_code ignored;
    if (path.empty()) throw FileError("(no name)", "an output needs a file name");
    if (fs::is_directory(path, ignored)) throw FileError(path, "is a folder; the output must be a file name");
    const fs::path parent = fs::path(path).parent_path();
    if (!parent.empty() && !fs::is_directory(parent, ignored))
        throw FileError(path,
                        "cannot be written: there is no folder '" + parent.string() + "'; create it first");
    AtomicFile probe(path);  // creating a file here is the only sure test; its destructor removes it
    probe.write("", 0);
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

void checkReadable(const std::string& path) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) throw FileError(path, "is a folder, not a file");
    if (::access(path.c_str(), R_OK) != 0) throw FileError(path, "cannot be read: " + systemMessage());
}

std::string readWholeFile(const std::string& path) {
    checkReadable(path);
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (!file) throw FileError(path, "cannot be read: " + systemMessage());
    std::string text;
    char block[1 << 16];
    size_t got;
    while ((got = std::fread(block, 1, sizeof block, file)) > 0) text.append(block, got);
    const bool failed = std::ferror(file) != 0;
    std::fclose(file);
    if (failed) throw FileError(path, "cannot be read: " + systemMessage());
    return text;
}

}  // namespace pellucid::io
