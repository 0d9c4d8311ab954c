// Modules: parts of Pellucid with dependencies that the library itself does not have.
#pragma once

namespace pel::cl {

// A function of a module, which is loaded from beside the library. Throws PEL_ERROR_UNSUPPORTED.
void* moduleFunction(const char* module, const char* function);

}  // namespace pel::cl
