#include "cl/private_folder.h"

#include <pwd.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "cl/error.h"

namespace pel::cl {
namespace fs = std::filesystem;
namespace {

std::string homeInSystem() {
    std::vector<char> room(1 << 14);
    struct passwd entry {
    }, *found = nullptr;
    if (::getpwuid_r(::geteuid(), &entry, room.data(), room.size(), &found) != 0 || !found || !entry.pw_dir)
        return {};
    return entry.pw_dir;
}

std::string whyNotPrivate(const fs::path& part, bool last) {
    struct stat status {};
    if (::stat(part.c_str(), &status) != 0) return text(part.string(), " cannot be looked at");
    if (!S_ISDIR(status.st_mode)) return text(part.string(), " is not a folder");
    if (status.st_uid != 0 && status.st_uid != ::geteuid())
        return text(part.string(), " belongs to user ", status.st_uid, ", not to user ", ::geteuid());
    const bool ofOthers = status.st_mode & (S_IWGRP | S_IWOTH);
    if (ofOthers && (last || !(status.st_mode & S_ISVTX))) return text("others may write to ", part.string());
    return {};
}

}  // namespace

std::vector<fs::path> cacheHomes() {
    std::vector<fs::path> all;
    const auto add = [&](const fs::path& base, const char* below) {
        if (base.is_absolute()) all.push_back(base / below);
    };
    if (const char* cache = std::getenv("XDG_CACHE_HOME")) add(cache, "");
    if (const char* home = std::getenv("HOME")) add(home, ".cache");
    add(homeInSystem(), ".cache");
    return all;
}

bool makePrivateFolder(const fs::path& folder) {
    struct stat status {};
    if (::stat(folder.c_str(), &status) == 0) return S_ISDIR(status.st_mode);
    const fs::path above = folder.parent_path();
    if (above.empty() || above == folder || !makePrivateFolder(above)) return false;
    return ::mkdir(folder.c_str(), 0700) == 0 ||
           (::stat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode));
}

std::string whyNotPrivate(const fs::path& folder) {
    std::error_code error;
    const fs::path named = fs::absolute(folder, error).lexically_normal(),
                   real = fs::canonical(folder, error);
    if (error) return text(folder.string(), " cannot be looked at");
    // A link may lead elsewhere: who may replace the link matters as much as who may write to its target.
    for (const fs::path& whole : {named, real}) {
        fs::path part;
        for (const fs::path& piece : whole) {
            if (piece.empty()) continue;
            part /= piece;
            if (const std::string why = whyNotPrivate(part, part == real); !why.empty()) return why;
        }
    }
    return {};
}

std::string whyNotWritable(const fs::path& folder) {
    return ::access(folder.c_str(), W_OK | X_OK) == 0 ? "" : std::strerror(errno);
}

uint64_t roomIn(const fs::path& folder) {
    struct statvfs status {};
    if (::statvfs(folder.c_str(), &status) != 0 || (status.f_flag & ST_RDONLY) ||
        ::access(folder.c_str(), W_OK | X_OK) != 0)
        return 0;
    if (status.f_files != 0 && status.f_favail < 64) return 0;  // of file systems that count files
    return uint64_t(status.f_bavail) * status.f_frsize;
}

}  // namespace pel::cl
