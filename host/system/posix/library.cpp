#include "system/library.h"

#include <dlfcn.h>

namespace pel::system {

void* openLibrary(const std::string& name, std::string& why) {
    void* library = ::dlopen(name.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (!library) why = ::dlerror();
    return library;
}

void* symbolIn(void* library, const char* name) {
    return ::dlsym(library, name);
}

std::string folderOf(const void* address) {
    Dl_info where{};
    if (!::dladdr(address, &where) || !where.dli_fname) return {};
    const std::string file = where.dli_fname;
    return file.substr(0, file.rfind('/') + 1);
}

}  // namespace pel::system
