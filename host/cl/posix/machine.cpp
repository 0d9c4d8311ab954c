#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "cl/error.h"
#include "cl/machine.h"

namespace pel::cl {
namespace {

constexpr uint64_t unlimited = UINT64_MAX;
constexpr uint64_t restOfMachine = 128 << 20;       // for drivers, the host and other programs
constexpr uint64_t restOfAddressSpace = 256 << 20;  // LLVM needs up to 200 MB for the largest shading variant

uint64_t number(const std::string& path, uint64_t otherwise) {
    std::ifstream file(path);
    uint64_t value = 0;
    return file >> value ? value : otherwise;
}

// The value of "name value" or "name: value kB".
uint64_t field(const std::string& path, const std::string& name, uint64_t otherwise) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string key, unit;
        uint64_t value = 0;
        if (!(words >> key >> value) || key != name) continue;
        return words >> unit ? value << 10 : value;
    }
    return otherwise;
}

uint64_t leftOf(uint64_t limit, uint64_t used) {
    return limit > used ? limit - used : 0;
}

uint64_t leftInMachine() {
    const std::string path = "/proc/meminfo";
    const uint64_t memory = field(path, "MemAvailable:", unlimited);
    return memory == unlimited ? unlimited : memory + field(path, "SwapFree:", 0);
}

// The smallest free memory among the control groups of this process. Files in the page cache can be dropped.
uint64_t leftInGroups() {
    uint64_t left = unlimited;
    std::ifstream file("/proc/self/cgroup");
    for (std::string line; std::getline(file, line);) {
        const size_t first = line.find(':'), second = line.find(':', first + 1);
        if (second == std::string::npos) continue;
        const std::string controllers = line.substr(first + 1, second - first - 1);
        const bool old = ("," + controllers + ",").find(",memory,") != std::string::npos;
        if (!old && !controllers.empty()) continue;
        const std::string root = old ? "/sys/fs/cgroup/memory" : "/sys/fs/cgroup";
        for (std::string group = line.substr(second + 1);; group.resize(group.rfind('/'))) {
            while (group.ends_with('/')) group.pop_back();
            const std::string at = root + group + "/";
            const uint64_t limit = number(at + (old ? "memory.limit_in_bytes" : "memory.max"),
                                          unlimited);  // "max" is not a number: no limit
            const uint64_t used = number(at + (old ? "memory.usage_in_bytes" : "memory.current"), 0);
            const uint64_t cached =
                field(at + "memory.stat", old ? "total_inactive_file" : "inactive_file", 0);
            if (limit != unlimited) left = std::min(left, leftOf(limit, leftOf(used, cached)));
            if (group.empty()) break;
        }
    }
    return left;
}

uint64_t leftInAddressSpace() {
    struct rlimit limit {};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unlimited;
    return leftOf(limit.rlim_cur, number("/proc/self/statm", 0) * uint64_t(::sysconf(_SC_PAGESIZE)));
}

}  // namespace

void requireMemory(uint64_t bytes, const char* what) {
    const struct {
        const char* of;
        uint64_t left, rest;
    } limits[] = {{"this machine's memory", leftInMachine(), restOfMachine},
                  {"the memory that the process's control group may use", leftInGroups(), restOfMachine},
                  {"the process's address space (ulimit -v)", leftInAddressSpace(), restOfAddressSpace}};
    for (const auto& [of, left, rest] : limits)
        if (left != unlimited && bytes > leftOf(left, rest))
            fail(PEL_ERROR_OUT_OF_MEMORY, bytes, " bytes for ", what, " are more than is left of ", of, ": ",
                 left, " bytes, ", rest, " of which are reserved for the driver");
}

double uptime() {
    double seconds = 0;
    std::ifstream("/proc/uptime") >> seconds;
    return seconds;
}

void* mapZeros(size_t bytes) {
    void* const at = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return at == MAP_FAILED ? nullptr : at;
}

void* mapPages(size_t bytes) {
    void* const at = mapZeros(bytes);
    if (!at) return nullptr;
#ifdef MADV_HUGEPAGE
    (void)::madvise(at, bytes, MADV_HUGEPAGE);
#endif
#ifdef MADV_POPULATE_WRITE
    if (::madvise(at, bytes, MADV_POPULATE_WRITE) == 0) return at;
#endif
    constexpr size_t page = 4096;
    for (size_t i = 0; i < bytes; i += page) static_cast<volatile char*>(at)[i] = 0;
    return at;
}

void unmapPages(void* at, size_t bytes) {
    ::munmap(at, bytes);
}

// Not by std::aligned_alloc, with which glibc maps and unmaps blocks of 128 KiB and more each time, page
// fault by page fault: a freed block raises the threshold for mappings only by its size after alignment, so
// that the next block of this size exceeds the threshold again. The address of the whole block precedes the
// aligned one.
void* allocateAligned(size_t alignment, size_t bytes) {
    void* const whole = std::malloc(bytes + alignment);
    if (!whole) return nullptr;
    const auto at = (reinterpret_cast<uintptr_t>(whole) + alignment) & ~uintptr_t(alignment - 1);
    reinterpret_cast<void**>(at)[-1] = whole;
    return reinterpret_cast<void*>(at);
}

void freeAligned(void* at) {
    if (at) std::free(static_cast<void**>(at)[-1]);
}

namespace fs = std::filesystem;
static std::string whyNotPrivate(const fs::path& part, bool last) {
    struct stat status {};
    if (::stat(part.c_str(), &status) != 0) return text(part.string(), " cannot be examined");
    if (!S_ISDIR(status.st_mode)) return text(part.string(), " is not a folder");
    if (status.st_uid != 0 && status.st_uid != ::geteuid())
        return text(part.string(), " belongs to user ", status.st_uid, ", not to user ", ::geteuid());
    const bool ofOthers = status.st_mode & (S_IWGRP | S_IWOTH);
    if (ofOthers && (last || !(status.st_mode & S_ISVTX)))
        return text("other users may write to ", part.string());
    return {};
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
    if (error) return text(folder.string(), " cannot be examined");
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

static std::atomic<pid_t> owner{0};  // 0: no process yet
// 1 in the owner. Linux clears it in every fork. NULL if there is no such memory. Reading it takes a
// nanosecond; asking for the process number takes several hundred on virtual machines.
static std::atomic<std::atomic<uint32_t>*> mark{nullptr};

static std::atomic<uint32_t>* makeMark() {
#ifdef MADV_WIPEONFORK
    const size_t bytes = size_t(::sysconf(_SC_PAGESIZE));
    void* const page = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (page == MAP_FAILED) return nullptr;
    if (::madvise(page, bytes, MADV_WIPEONFORK) != 0) {
        ::munmap(page, bytes);
        return nullptr;
    }
    return new (page) std::atomic<uint32_t>(1);
#else
    return nullptr;
#endif
}

void claimProcess() {
    pid_t nobody = 0;
    if (owner.load(std::memory_order_acquire) == nobody && owner.compare_exchange_strong(nobody, ::getpid()))
        mark.store(makeMark(),
                   std::memory_order_release);  // until then, and without one, process numbers are compared
    checkProcess();
}

bool isFork() {
    if (const std::atomic<uint32_t>* const page = mark.load(std::memory_order_acquire))
        return page->load(std::memory_order_relaxed) == 0;
    const pid_t by = owner.load(std::memory_order_relaxed);
    return by != 0 && by != ::getpid();
}

void checkProcess() {
    if (isFork())
        fail(PEL_ERROR_INVALID_STATE, "process ", ::getpid(), " is a fork of process ", owner.load(),
             ", which uses OpenCL already, and OpenCL does not work in both: fork before the first call, or "
             "start a new program (in Python: multiprocessing's \"spawn\" or \"forkserver\")");
}

}  // namespace pel::cl
