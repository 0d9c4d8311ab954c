// How much memory is left for this process (Linux: proc(5), cgroups(7)).
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "cl/host_memory.h"

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

// The least of the control groups that this process is in. Files in the page cache can be dropped.
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
                 left, ", ", rest, " of which are kept for the driver");
}

}  // namespace pel::cl
