// Pictures of 8 and 16 bits: PNG by libpng; JPEG, TGA and BMP files and text by OpenImageIO. That brings
// some 250 shared libraries, which take a quarter of a second to load. So the code that calls it is a
// module of its own (host/io/image/pictures), which is loaded when such a file or a label is first needed;
// programs that read and write EXR, NPY and PNG files never load it.
#pragma once
#include "io/image/image_file.h"
#include "io/image/image_format.h"

namespace pellucid::io {

// Set by the module. Strings and images belong to the caller; FileError passes through.
struct PictureLibrary {
    const char* version;  // of Pellucid
    // decodeImage for bytes that imageFormat accepted.
    void (*decode)(Image& image, const ImageFormat& format, const std::function<void(const Image&)>& check,
                   uint64_t limit);
    // The bytes of a file as writeImage8 describes it.
    std::string (*encode)(const std::string& path, int width, int height, int channels,
                          std::span<const uint8_t> pixels, bool srgb);
    // Draws on RGB pixels; y is the baseline, ink three numbers from 0 to 1.
    void (*drawText)(uint8_t* rgb, int width, int height, int x, int y, const std::string& text, int size,
                     const float* ink);
    int (*textWidth)(const std::string& text, int size);  // pixels
};

// Only PNG files, by libpng; other files are a FileError. Draws no text.
extern const PictureLibrary pngPictures;

// The module, loaded the first time; in builds without OpenImageIO it is pngPictures. Throws FileError, which
// names `path`, if it cannot be loaded.
const PictureLibrary& pictureLibrary(const std::string& path);

// pngPictures where `kind`, an extension or a format's reader, is png, else pictureLibrary(path).
const PictureLibrary& pictureLibraryFor(std::string_view kind, const std::string& path);

}  // namespace pellucid::io
