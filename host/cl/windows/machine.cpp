#include <malloc.h>
#include <windows.h>
#include <algorithm>

#include "cl/error.h"
#include "cl/machine.h"
#include "system/process.h"

namespace pel::cl {

void requireMemory(uint64_t bytes, const char* what) {
    constexpr uint64_t rest = 128 << 20;  // for drivers, the host and other programs
    MEMORYSTATUSEX status{};
    status.dwLength = sizeof status;
    if (!::GlobalMemoryStatusEx(&status)) return;
    const uint64_t left = status.ullAvailPageFile;  // of memory and page file that this process may commit
    if (bytes > (left > rest ? left - rest : 0))
        fail(PEL_ERROR_OUT_OF_MEMORY, bytes, " bytes for ", what,
             " are more than is left of this machine's memory: ", left, " bytes, ", rest,
             " of which are reserved for the driver");
}

void* mapPages(size_t bytes) {
    return ::VirtualAlloc(nullptr, bytes, MEM_RESERVE | MEM_COMMIT, PAGE_READWRITE);  // committed
}

void* mapZeros(size_t bytes) {
    return mapPages(bytes);
}

void unmapPages(void* at, size_t) {
    ::VirtualFree(at, 0, MEM_RELEASE);
}

void* allocateAligned(size_t alignment, size_t bytes) {
    return ::_aligned_malloc(bytes, alignment);
}

void freeAligned(void* at) {
    ::_aligned_free(at);
}

// On Windows only this user and administrators may write to the folders of a user's profile. Access control
// lists are not read: a folder elsewhere does not count as private.

namespace fs = std::filesystem;

static bool below(const fs::path& folder, const fs::path& top) {
    std::error_code error;
    const fs::path real = fs::weakly_canonical(folder, error), base = fs::weakly_canonical(top, error);
    return !error && std::mismatch(base.begin(), base.end(), real.begin(), real.end()).first == base.end();
}

bool makePrivateFolder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    return fs::is_directory(folder, error);
}

std::string whyNotPrivate(const fs::path& folder) {
    std::error_code error;
    if (!fs::is_directory(folder, error)) return text(folder.string(), " is not a folder");
    for (const fs::path& profile : system::cacheHomes())
        if (below(folder, profile)) return {};
    return text(folder.string(), " is not below the user's profile, where other users may not write");
}

std::string whyNotWritable(const fs::path&) {
    return {};  // lists of rights are not read
}

double uptime() {
    return 1e-3 * double(GetTickCount64());
}

uint64_t roomIn(const fs::path& folder) {
    std::error_code error;
    const fs::space_info space = fs::space(folder, error);
    return error ? 0 : uint64_t(space.available);
}

void claimProcess() {}

bool isFork() {
    return false;
}

void checkProcess() {}

}  // namespace pel::cl
