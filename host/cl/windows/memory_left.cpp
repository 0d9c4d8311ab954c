// How much memory is left for this process.
#include <windows.h>

#include "cl/host_memory.h"

namespace pel::cl {

void requireMemory(uint64_t bytes, const char* what) {
    constexpr uint64_t rest = 128 << 20;  // for drivers, the host and other programs
    MEMORYSTATUSEX status{};
    status.dwLength = sizeof status;
    if (!::GlobalMemoryStatusEx(&status)) return;
    const uint64_t left = status.ullAvailPageFile;  // of memory and page file that this process may commit
    if (bytes > (left > rest ? left - rest : 0))
        fail(PEL_ERROR_OUT_OF_MEMORY, bytes, " bytes for ", what,
             " are more than is left of this machine's memory: ", left, ", ", rest,
             " of which are kept for the driver");
}

}  // namespace pel::cl
