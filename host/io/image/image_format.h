// Which images are read: OpenEXR, PNG, JPEG, TGA and BMP, each by its name and its content. OpenImageIO alone
// would open whatever any of its thirty readers takes for its own.
#pragma once
#include <cstdint>
#include <string>

namespace pellucid::io {

struct ImageFormat {
    const char* reader;  // OpenImageIO's name for it
    std::string bytes;  // of the file, without what no picture needs: text, colour profiles, thumbnails, EXIF
};

// Takes the bytes of a file. Throws FileError when its extension or its content is another format's, and when
// the picture that its header announces takes more than `limit` bytes as floats.
ImageFormat imageFormat(const std::string& path, std::string bytes, uint64_t limit);

// Throws FileError when so many pixels and channels take more than `limit` bytes as floats.
void checkImageSize(const std::string& path, double width, double height, double channels, uint64_t limit);

}  // namespace pellucid::io
