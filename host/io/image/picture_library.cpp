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
    // First beside libpellucid, or in a folder there: in a build, an installed tree that may have been moved,
    // or the Python package. Then by name, in the program's search path.
    const std::string beside = pel::system::folderOf(reinterpret_cast<const void*>(&pelVersion));
    for (const std::string& folder : {beside, beside + "pellucid/", std::string()}) {
        const std::string file = folder + PELLUCID_PICTURES;
        std::string why;
        void* const module = pel::system::openLibrary(file, why);
        if (!module) {
            loaded.why += (loaded.why.empty() ? "" : "; ") + why;
            continue;
        }
        const auto* library =
            static_cast<const PictureLibrary*>(pel::system::symbolIn(module, "pellucidPictures"));
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
                                  "); EXR, NPY and PNG files can be read and written without it");
    return *loaded.library;
}

#endif

const PictureLibrary& pictureLibraryFor(std::string_view kind, const std::string& path) {
    return kind == "png" ? pngPictures : pictureLibrary(path);
}

}  // namespace pellucid::io
