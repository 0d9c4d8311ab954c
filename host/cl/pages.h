// Memory from the system.
#pragma once
#include <cstddef>

namespace pel::cl {

// Whole pages of zeros, all committed: systems promise more memory than they have, and end the process that
// touches the last page.
// nullptr if there is not enough.
void* mapPages(size_t bytes);
// Zeros whose pages come when they are touched, by whichever thread does so.
void* mapZeros(size_t bytes);
// Of either.
void unmapPages(void* at, size_t bytes);

// nullptr if there is not enough. `bytes` is a multiple of `alignment`, a power of two.
void* allocateAligned(size_t alignment, size_t bytes);
void freeAligned(void* at);

}  // namespace pel::cl
