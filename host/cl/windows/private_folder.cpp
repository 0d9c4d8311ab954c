// On Windows only this user and administrators may write to the folders of a user's profile. Access control
// lists are not read: a folder elsewhere does not count as private.
#include "cl/private_folder.h"

#include <algorithm>
#include <cstdlib>

#include "cl/error.h"

namespace pel::cl {
namespace fs = std::filesystem;
namespace {

constexpr const char* profiles[] = {"LOCALAPPDATA", "USERPROFILE"};

bool below(const fs::path& folder, const fs::path& top) {
    std::error_code error;
    const fs::path real = fs::weakly_canonical(folder, error), base = fs::weakly_canonical(top, error);
    return !error && std::mismatch(base.begin(), base.end(), real.begin(), real.end()).first == base.end();
}

}  // namespace

std::vector<fs::path> cacheHomes() {
    std::vector<fs::path> all;
    for (const char* name : profiles)
        if (const char* folder = std::getenv(name); folder && fs::path(folder).is_absolute())
            all.emplace_back(folder);
    return all;
}

bool makePrivateFolder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    return fs::is_directory(folder, error);
}

std::string whyNotPrivate(const fs::path& folder) {
    std::error_code error;
    if (!fs::is_directory(folder, error)) return text(folder.string(), " is not a folder");
    for (const fs::path& profile : cacheHomes())
        if (below(folder, profile)) return {};
    return text(folder.string(), " is not below the user's profile, where others may not write");
}

std::string whyNotWritable(const fs::path&) {
    return {};  // lists of rights are not read
}

uint64_t roomIn(const fs::path& folder) {
    std::error_code error;
    const fs::space_info space = fs::space(folder, error);
    return error ? 0 : uint64_t(space.available);
}

}  // namespace pel::cl
