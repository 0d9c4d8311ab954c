#include "cl/module.h"

#include "cl/error.h"
#include "system/process.h"

namespace pel::cl {

void* moduleFunction(const char* module, const char* function) {
    std::string why;
    void* const library = system::openBeside(reinterpret_cast<const void*>(&pelVersion), module, why);
    void* const found = library ? system::symbolIn(library, function) : nullptr;
    if (!found) fail(PEL_ERROR_UNSUPPORTED, module, " cannot be loaded (", why, ")");
    return found;
}

}  // namespace pel::cl
