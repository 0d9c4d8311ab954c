#include "io/image/picture_library.h"

#include <pellucid/pellucid.h>

#include "system/module.h"

namespace pellucid::io {
#ifdef PELLUCID_PNG_ONLY

const PictureLibrary& pictureLibrary(const std::string&) {
    return pngPictures;
}

#else
namespace {

struct Loaded {
    std::string why;
    const PictureLibrary* library = pel::system::tableOfModule<PictureLibrary>(
        reinterpret_cast<const void*>(&pelVersion), PELLUCID_PICTURES, "pellucidPictures", PELLUCID_VERSION,
        why);
};

}  // namespace

const PictureLibrary& pictureLibrary(const std::string& path) {
    static const Loaded loaded;
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
