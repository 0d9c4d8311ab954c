#include "cl/pocl_cache.h"

#include <utility>

#include "cl/error.h"
#include "cl/machine.h"
#include "system/process.h"

namespace pel::cl {
namespace fs = std::filesystem;
namespace {

constexpr uint64_t leastRoom = 32 << 20;  // bytes; the largest shading variant leaves less than 2 MB

// Never destroyed: devices may be used while the process ends.
fs::path& folderInUse() {
    static fs::path& folder = *new fs::path;
    return folder;
}

bool setByUs = false;

// "" if PoCL may use it.
std::string whyNot(const fs::path& folder) {
    if (!makePrivateFolder(folder)) return text(folder.string(), " cannot be created");
    if (const std::string why = whyNotPrivate(folder); !why.empty()) return why;
    if (roomIn(folder) < leastRoom)
        return text(folder.string(), " has less than ", leastRoom >> 20, " MiB free");
    return {};
}

// A folder for this process alone, deleted at its end.
fs::path temporaryFolder(std::string& why) {
    const char* base = std::getenv("TMPDIR");
    for (const fs::path& parent : {fs::path(base ? base : ""), fs::path("/tmp"), fs::path("/dev/shm")}) {
        if (!parent.is_absolute()) continue;
        const std::string name = system::makeTemporaryFolder(parent.string(), "pellucid-pocl-");
        if (name.empty()) {
            why += text("; no folder can be created in ", parent.string());
            continue;
        }
        if (const std::string reason = whyNot(name); !reason.empty()) {
            why += "; " + reason;
            std::error_code ignored;
            fs::remove(name, ignored);
            continue;
        }
        folderInUse() = name;
        std::atexit([] {
            std::error_code ignored;
            if (!isFork()) fs::remove_all(folderInUse(), ignored);
        });
        return name;
    }
    return {};
}

}  // namespace

void choosePoclCache() {
    static bool& chosen = *new bool(false);
    if (chosen) return;
    const char* set = std::getenv("POCL_CACHE_DIR");
    if (set && *set) {
        folderInUse() = set;
    } else {
        std::string why;
        fs::path folder;
        for (const fs::path& home : system::cacheHomes()) {
            folder = home / "pellucid" / "pocl";
            const std::string reason = whyNot(folder);
            if (reason.empty()) break;
            why += (why.empty() ? "" : "; ") + reason;
            folder.clear();
        }
        if (folder.empty())
            folder = temporaryFolder(why);
        else
            removeDamagedPrograms(folder);
        if (folder.empty())
            fail(PEL_ERROR_DEVICE,
                 "PoCL needs a writable folder for compiled kernels, and none was found: ", why,
                 ". Set POCL_CACHE_DIR to one");
        folderInUse() = folder;
        system::setVariable("POCL_CACHE_DIR", folder.string().c_str());
        setByUs = true;
    }
    chosen = true;
}

void poclCacheIsChosen() {
    if (std::exchange(setByUs, false)) system::setVariable("POCL_CACHE_DIR", nullptr);
}

void checkPoclCache() {
    const fs::path& folder = folderInUse();
    std::error_code error;
    if (folder.empty() || !fs::exists(folder, error)) return;  // PoCL makes it, or was loaded by the host
    const uint64_t room = roomIn(folder);
    if (room < leastRoom)
        fail(PEL_ERROR_DEVICE, "PoCL keeps compiled kernels in ", folder.string(),
             room ? text(", which has ", room >> 20, " MiB free") : ", which is full or may not be written",
             "; ", leastRoom >> 20,
             " MiB are needed, because PoCL ends the process when it cannot write. Free some space, or set "
             "POCL_CACHE_DIR");
}

}  // namespace pel::cl
