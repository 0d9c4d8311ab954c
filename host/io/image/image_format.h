// The image formats that are read: OpenEXR, PNG, JPEG, TGA and BMP, by name and content. OpenImageIO alone
// would open a file with any of its thirty readers.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace pellucid::io {

struct ImageFormat {
    const char* reader;  // OpenImageIO's name for it
    // Of the file, without text, colour profiles, thumbnails and EXIF
    std::string bytes;
};

// Takes the bytes of a file. Throws FileError if its extension or its content belongs to another format, or
// if the picture that its header announces takes more than `limit` bytes as floats.
ImageFormat imageFormat(const std::string& path, std::string bytes, uint64_t limit);

// Throws FileError if so many pixels and channels take more than `limit` bytes as floats.
void checkImageSize(const std::string& path, double width, double height, double channels, uint64_t limit);

// The header of an EXR file, checked before a library allocates memory for it [OpenEXR File Layout].

// Reads attributes one after another. Everything is checked against the end of the file.
class ExrAttributes {
  public:
    static constexpr size_t start = 8;  // after magic number and version
    explicit ExrAttributes(std::string_view file, size_t at = start) : file_(file), at_(at) {}

    struct Attribute {
        std::string_view name, type, value;
        size_t valueAt;
    };
    std::optional<Attribute> next();  // none at the end of the header, or if the file is damaged
    bool atEnd() const { return at_ < file_.size() && file_[at_] == '\0'; }
    size_t position() const { return at_; }

  private:
    std::optional<std::string_view> text();
    std::string_view file_;
    size_t at_;
};

// Throws FileError unless all parts have channels, windows and tiles that a file of this length can hold, and
// the pixels of their display or data windows take at most `limit` bytes as floats.
void checkExrHeader(const std::string& path, std::string_view file, uint64_t limit);

}  // namespace pellucid::io
