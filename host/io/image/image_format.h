// The image formats that are read: OpenEXR, PNG, JPEG, TGA and BMP, by name and content. OpenImageIO alone
// would open a file with any of its thirty readers.
#pragma once
#include <cstdint>
#include <string>

namespace pellucid::io {

struct ImageFormat {
    const char* reader;  // OpenImageIO's name for it
    // Of the file, without what pictures do not need: text, colour profiles, thumbnails, EXIF
    std::string bytes;
};

// Takes the bytes of a file. Throws FileError if its extension or its content belongs to another format, or
// if the picture that its header announces takes more than `limit` bytes as floats.
ImageFormat imageFormat(const std::string& path, std::string bytes, uint64_t limit);

// Throws FileError if so many pixels and channels take more than `limit` bytes as floats.
void checkImageSize(const std::string& path, double width, double height, double channels, uint64_t limit);

}  // namespace pellucid::io
