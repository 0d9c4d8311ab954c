#include "cl/pages.h"

#include <sys/mman.h>
#include <unistd.h>

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

void* allocateAligned(size_t alignment, size_t bytes) {
    return std::aligned_alloc(alignment, bytes);
}

void freeAligned(void* at) {
    std::free(at);
}

}  // namespace pel::cl
