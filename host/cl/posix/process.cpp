#include "cl/process.h"

#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <new>

#include "cl/error.h"

namespace pel::cl {
namespace {

std::atomic<pid_t> owner{0};  // 0: no process yet
// 1 in the owner. Linux clears it in every fork. NULL if there is no such memory. Reading it takes a
// nanosecond; asking for the process number takes several hundred on virtual machines.
std::atomic<std::atomic<uint32_t>*> mark{nullptr};

std::atomic<uint32_t>* makeMark() {
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

}  // namespace

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
             "start a new program "
             "(in Python: multiprocessing's \"spawn\" or \"forkserver\")");
}

}  // namespace pel::cl
