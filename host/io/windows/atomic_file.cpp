#include "io/atomic_file.h"

#include <io.h>
#include <windows.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "io/content_hash.h"
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

static std::string lastError() {
    return std::system_category().message(int(::GetLastError()));
}

static HANDLE handleOf(int file) {
    return reinterpret_cast<HANDLE>(::_get_osfhandle(file));
}

AtomicFile::AtomicFile(std::string target)
    : target_(std::move(target)), name_(fs::path(target_).filename().string()) {
    refuseOtherThanFile(target_);
    if (name_.empty())
        throw FileError(target_.empty() ? "(no name)" : target_, "an output needs a file name");
    const std::string folder = folderOf(target_);
    if (!fs::is_directory(folder))
        throw FileError(target_, "cannot be written: there is no folder '" + folder + "'; create it first");
    temporary_ = (fs::path(folder) / temporaryName(name_)).string();
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
    refuseOtherThanFile(target_);
    if (!::MoveFileExW(fs::path(temporary_).c_str(), fs::path(target_).c_str(),
                       MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH))
        fail();
    temporary_.clear();
}

void flushFolder(const std::string&) {}  // MOVEFILE_WRITE_THROUGH has done it

// Windows does not remove a file that a program of this machine has open.
size_t removeAbandonedFiles(const std::string& path) {
    size_t removed = 0;
    for (const auto& [name, abandonedAfter] : temporaryFiles(path)) {
        const fs::path file = fs::path(path) / name;
        std::error_code error;
        const auto age = fs::file_time_type::clock::now() - fs::last_write_time(file, error);
        if (!error && fs::is_regular_file(file, error) && age > std::chrono::duration<double>(abandonedAfter))
            removed += fs::remove(file, error);
    }
    return removed;
}

}  // namespace pellucid::io
