#include "io/image/picture_library.h"

#include <pellucid/pellucid.h>

#include <cstring>

#include "system/process.h"

namespace pellucid::io {
#ifdef PELLUCID_PNG_ONLY

const PictureLibrary& pictureLibrary(const std::string&) {
    return pngPictures;
}

#else
namespace {

struct Loaded {
    const PictureLibrary* library = nullptr;
    std::string why;
};

Loaded load() {
    Loaded loaded;
    void* const module =
        pel::system::openBeside(reinterpret_cast<const void*>(&pelVersion), PELLUCID_PICTURES, loaded.why);
    if (!module) return loaded;
    const auto* library =
        static_cast<const PictureLibrary*>(pel::system::symbolIn(module, "pellucidPictures"));
    if (library && std::strcmp(library->version, PELLUCID_VERSION) == 0) return {library, ""};
    return {nullptr, PELLUCID_PICTURES " belongs to another version of pellucid"};
}

}  // namespace

const PictureLibrary& pictureLibrary(const std::string& path) {
    static const Loaded loaded = load();
    if (!loaded.library)
        throw FileError(path, "needs " PELLUCID_PICTURES ", which cannot be loaded (" + loaded.why +
                                  "); EXR, NPY and PNG files can be read and written without it");
    return *loaded.library;
}

#endif

const PictureLibrary& pictureLibraryFor(std::string_view kind, const std::string& path) {
    return kind == "png" ? pngPictures : pictureLibrary(path);
}

}  // namespace pellucid::io
