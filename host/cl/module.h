// Modules: parts of Pellucid that need libraries which the library itself does without.
#pragma once

namespace pel::cl {

// A function of a module, which is loaded from beside the library. Throws PEL_ERROR_UNSUPPORTED.
void* moduleFunction(const char* module, const char* function);

}  // namespace pel::cl
