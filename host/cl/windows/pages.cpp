#include "cl/pages.h"

#include <malloc.h>
#include <windows.h>

namespace pel::cl {

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

}  // namespace pel::cl
