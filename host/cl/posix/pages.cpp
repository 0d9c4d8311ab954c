#include "cl/pages.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

namespace pel::cl {

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

}  // namespace pel::cl
