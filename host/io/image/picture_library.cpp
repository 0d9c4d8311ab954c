#include "io/image/picture_library.h"

#include <dlfcn.h>
#include <pellucid/pellucid.h>

#include <cstring>

#include "io/file_error.h"

namespace pellucid::io {
namespace {

struct Loaded {
    const PictureLibrary* library = nullptr;
    std::string why;
};

// Beside libpellucid, wherever that was found: in a build, in an installed tree that may have been moved, in the Python package.
std::string besideLibrary() {
    Dl_info where{};
    if (!::dladdr(reinterpret_cast<const void*>(&pelVersion), &where) || !where.dli_fname) return "";
    const std::string file = where.dli_fname;
    const size_t slash = file.rfind('/');
    return slash == std::string::npos ? "" : file.substr(0, slash + 1) + PELLUCID_PICTURES;
}

Loaded load() {
    Loaded loaded;
    // By name alone, the program's own search path decides.
    for (const std::string& file : {besideLibrary(), std::string(PELLUCID_PICTURES)}) {
        if (file.empty()) continue;
        void* module = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
        if (!module) {
            loaded.why += (loaded.why.empty() ? "" : "; ") + std::string(::dlerror());
            continue;
        }
        const auto* library = static_cast<const PictureLibrary*>(::dlsym(module, "pellucidPictures"));
        if (library && std::strcmp(library->version, PELLUCID_VERSION) == 0) return {library, ""};
        loaded.why = file + " belongs to another version of pellucid";
        return loaded;
    }
    return loaded;
}

}  // namespace

const PictureLibrary& pictureLibrary(const std::string& path) {
    static const Loaded loaded = load();
    if (!loaded.library)
        throw FileError(path, "needs " PELLUCID_PICTURES ", which cannot be loaded (" + loaded.why +
                                  "); EXR and NPY files can be read and written without it");
    return *loaded.library;
}

}  // namespace pellucid::io
