// Device memory on devices that compute in the host's memory: the library allocates it, because PoCL ends the
// process when an allocation fails.
#pragma once
#include "cl/handle.h"

namespace pel::cl {

// A buffer over memory that the library allocates. The memory is freed with the last reference to the cl_mem,
// whoever holds it. It contains `initial`, or zeros if `zeros`, else anything. NULL if the driver cannot
// report the last release. Throws PEL_ERROR_OUT_OF_MEMORY.
Memory createInHostMemory(cl_context context, size_t bytes, const void* initial, bool zeros);

}  // namespace pel::cl
