// The header of an OpenEXR file, checked before a library allocates memory for what it announces [OpenEXR
// File Layout].
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace pellucid::io {

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
// whose pixels take at most `limit` bytes as floats, in the display window or the data window, whichever is
// larger.
void checkExrHeader(const std::string& path, std::string_view file, uint64_t limit);

}  // namespace pellucid::io
