// Device memory on devices that compute in the host's: the library allocates it, since PoCL ends the process
// when it cannot.
#pragma once
#include "cl/handle.h"

namespace pel::cl {

// A buffer in place over memory of ours, which goes with the cl_mem, whoever holds that last. Holds
// `initial`, or zeros if `zeros`, else anything. Throws PEL_ERROR_OUT_OF_MEMORY.
Memory createInHostMemory(cl_context context, size_t bytes, const void* initial, bool zeros);

// Throws PEL_ERROR_OUT_OF_MEMORY when so many bytes more would leave the machine, the process's control group
// or its address space (ulimit -v) without the rest that drivers and others need: nobody gets an error when
// they run out.
void requireMemory(uint64_t bytes, const char* what);

// Bytes of such memory that are in use.
uint64_t hostMemoryInUse();

}  // namespace pel::cl
