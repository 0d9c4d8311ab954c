#include "io/atomic_file.h"

#include <io.h>
#include <windows.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <random>

#include "io/content_hash.h"
#include "io/file_error.h"
#include "io/input_file.h"

namespace pellucid::io {
namespace fs = std::filesystem;

const std::string& machineTag() {
    static const std::string tag = [] {
        char name[256] = {};
        DWORD length = sizeof name;
        ::GetComputerNameA(name, &length);
        return hexDigits(contentHash(name)).substr(0, 8);
    }();
    return tag;
}

namespace {

// Seconds after which a temporary file of another machine counts as abandoned. One of this machine that a
// program has open cannot be removed: Windows keeps it.
constexpr auto ownAge = std::chrono::seconds(60), foreignAge = std::chrono::seconds(86400);

std::string lastError() {
    return std::system_category().message(int(::GetLastError()));
}

std::string randomDigits() {
    std::random_device device;
    return hexDigits(uint64_t(device()) << 32 | device());
}

fs::path folderOf(const std::string& path) {
    const fs::path parent = fs::path(path).parent_path();
    return parent.empty() ? "." : parent;
}

HANDLE handleOf(int file) {
    return reinterpret_cast<HANDLE>(::_get_osfhandle(file));
}

}  // namespace

AtomicFile::AtomicFile(std::string target)
    : target_(std::move(target)), name_(fs::path(target_).filename().string()) {
    const std::string other = otherThanFile(target_);
    if (!other.empty()) throw FileError(target_, "is " + other + "; the output must be the name of a file");
    if (name_.empty())
        throw FileError(target_.empty() ? "(no name)" : target_, "an output needs a file name");
    const fs::path folder = folderOf(target_), name(name_);
    if (!fs::is_directory(folder))
        throw FileError(target_,
                        "cannot be written: there is no folder '" + folder.string() + "'; create it first");
    temporary_ = (folder / ("." + name.stem().string().substr(0, 120) + "." + machineTag() + "-" +
                            randomDigits() + ".tmp" + name.extension().string().substr(0, 40)))
                     .string();
    const HANDLE file = ::CreateFileW(fs::path(temporary_).c_str(), GENERIC_WRITE | DELETE, FILE_SHARE_READ,
                                      nullptr, CREATE_NEW, FILE_ATTRIBUTE_NORMAL, nullptr);
    if (file == INVALID_HANDLE_VALUE) {
        temporary_.clear();
        fail();
    }
    file_ = ::_open_osfhandle(reinterpret_cast<intptr_t>(file), 0);
}

AtomicFile::~AtomicFile() {
    if (file_ >= 0) ::_close(file_);
    std::error_code ignored;
    if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

void AtomicFile::fail(const char* what) const {
    throw FileError(target_, what + lastError());
}

void AtomicFile::write(const void* bytes, size_t count) {
    const char* next = static_cast<const char*>(bytes);
    while (count > 0) {
        DWORD wrote = 0;
        if (!::WriteFile(handleOf(file_), next, DWORD(std::min<size_t>(count, size_t{1} << 30)), &wrote,
                         nullptr) ||
            wrote == 0)
            fail();
        next += wrote;
        count -= wrote;
    }
}

void AtomicFile::commit(bool) {
    if (!::FlushFileBuffers(handleOf(file_))) fail();
    ::_close(file_);
    file_ = -1;
    const std::string other = otherThanFile(target_);
    if (!other.empty()) throw FileError(target_, "is " + other + "; the output must be the name of a file");
    if (!::MoveFileExW(fs::path(temporary_).c_str(), fs::path(target_).c_str(),
                       MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH))
        fail();
    temporary_.clear();
}

void writeWholeFile(const std::string& path, std::string_view bytes) {
    AtomicFile file(path);
    file.write(bytes.data(), bytes.size());
    file.commit();
}

void flushFolder(const std::string&) {}  // MOVEFILE_WRITE_THROUGH has done it

size_t removeAbandonedFiles(const std::string& path) {
    constexpr size_t tag = 8, random = 16, all = 1 + tag + 1 + random;
    size_t removed = 0;
    std::error_code error;
    for (fs::directory_iterator at(path, error), end; !error && at != end; at.increment(error)) {
        const std::string name = at->path().filename().string();
        const size_t to = name.rfind(".tmp");
        if (name[0] != '.' || to == std::string::npos || to < all || name[to - all] != '.' ||
            name[to - random - 1] != '-')
            continue;
        const std::string machine = name.substr(to - all + 1, tag), digits = name.substr(to - random, random);
        if ((machine + digits).find_first_not_of("0123456789abcdef") != std::string::npos) continue;
        std::error_code inner;
        const auto age = fs::file_time_type::clock::now() - at->last_write_time(inner);
        if (!inner && at->is_regular_file(inner) && age > (machine == machineTag() ? ownAge : foreignAge))
            removed += fs::remove(at->path(), inner);
    }
    return removed;
}

void checkWritable(const std::string& path) {
    const AtomicFile probe(path);  // making a file there is the only sure test; the destructor removes it
    removeAbandonedFiles(folderOf(path).string());
}

}  // namespace pellucid::io
