#include "io/image/image_format.h"

#include "io/input_file.h"

namespace pellucid::io {
namespace {

using namespace std::string_view_literals;

[[noreturn]] void cutOff(const std::string& path) {
    throw FileError(path, "is damaged or cut off: it ends in its header");
}

uint32_t bigEndian(std::string_view bytes, size_t at, size_t count) {
    uint32_t value = 0;
    for (size_t i = 0; i < count; ++i) value = value << 8 | uint8_t(bytes[at + i]);
    return value;
}
uint32_t littleEndian(std::string_view bytes, size_t at, size_t count) {
    uint32_t value = 0;
    for (size_t i = count; i-- > 0;) value = value << 8 | uint8_t(bytes[at + i]);
    return value;
}

// Chunks [PNG Specification 1.2]: length, type, data, CRC. Kept: header, palette, transparency, pixels, end.
std::string png(const std::string& path, std::string_view file, uint64_t limit) {
    constexpr size_t signature = 8, around = 12;
    std::string kept(file.substr(0, signature));
    for (size_t at = signature; at < file.size();) {
        if (file.size() - at < around) cutOff(path);
        const size_t length = bigEndian(file, at, 4);
        const std::string_view type = file.substr(at + 4, 4);
        if (length > file.size() - at - around)
            throw FileError(path, "is damaged or cut off: a part of it is longer than the file");
        if (at == signature) {
            if (type != "IHDR" || length != 13)
                throw FileError(path, "is damaged: it does not start with its size");
            checkImageSize(path, bigEndian(file, at + 8, 4), bigEndian(file, at + 12, 4), 4, limit);
        }
        for (std::string_view wanted : {"IHDR"sv, "PLTE"sv, "tRNS"sv, "IDAT"sv, "IEND"sv})
            if (type == wanted) kept.append(file.substr(at, around + length));
        at += around + length;
        if (type == "IEND") return kept;
    }
    throw FileError(path, "is damaged or cut off: it has no end");
}

// Segments [ITU-T T.81, annex B]: a marker and, with few exceptions, a length. Left out: comments and
// application data, except those of JFIF and Adobe, which define the channels.
std::string jpeg(const std::string& path, std::string_view file, uint64_t limit) {
    std::string kept(file.substr(0, 2));
    for (size_t at = 2;;) {
        if (file.size() - at < 4 || uint8_t(file[at]) != 0xff) cutOff(path);
        const auto marker = uint8_t(file[at + 1]);
        if (marker == 0xff) {  // filling
            ++at;
            continue;
        }
        const size_t length = bigEndian(file, at + 2, 2) + size_t{2};
        if (length < 4 || length > file.size() - at) cutOff(path);
        const bool frame =
            marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
        if (frame) {
            if (length < 10) cutOff(path);
            checkImageSize(path, bigEndian(file, at + 7, 2), bigEndian(file, at + 5, 2),
                           bigEndian(file, at + 9, 1), limit);
        }
        const bool application = marker >= 0xe0 && marker <= 0xef && marker != 0xe0 && marker != 0xee;
        if (!application && marker != 0xfe) kept.append(file.substr(at, length));
        at += length;
        if (marker == 0xda) return kept.append(file.substr(at));  // the pixels and everything after them
    }
}

// The header of 18 bytes [Truevision TGA 2.0]. The footer, which leads to thumbnails, is cut off.
std::string tga(const std::string& path, std::string_view file, uint64_t limit) {
    constexpr size_t header = 18, footer = 26;
    if (file.size() < header) cutOff(path);
    const uint32_t mapType = littleEndian(file, 1, 1), type = littleEndian(file, 2, 1),
                   bits = littleEndian(file, 16, 1);
    const uint32_t mapCount = littleEndian(file, 5, 2), mapBits = littleEndian(file, 7, 1);
    const bool mapped = type == 1 || type == 9, grey = type == 3 || type == 11,
               color = type == 2 || type == 10;
    const bool depth = mapped || grey ? bits == 8 || (grey && bits == 16)
                                      : bits == 15 || bits == 16 || bits == 24 || bits == 32;
    const bool map = mapped ? mapType == 1 && mapCount > 0 &&
                                  (mapBits == 15 || mapBits == 16 || mapBits == 24 || mapBits == 32)
                            : mapType <= 1;
    if (!(mapped || grey || color) || !depth || !map) throw FileError(path, "is not a TGA of a known kind");
    const uint32_t width = littleEndian(file, 12, 2), height = littleEndian(file, 14, 2);
    checkImageSize(path, width, height, 4, limit);
    const double stored = type < 8 ? double(width) * height * ((bits + 7) / 8) : 1;
    const size_t before = header + littleEndian(file, 0, 1) + (mapType ? mapCount * ((mapBits + 7) / 8) : 0);
    if (double(before) + stored > double(file.size()))
        throw FileError(path, "is damaged or cut off: it is too short for its pixels");
    if (file.size() >= footer && file.substr(file.size() - 18) == "TRUEVISION-XFILE.\0"sv)
        file.remove_suffix(footer);
    return std::string(file);
}

// File header of 14 bytes, then one of 12 to 124 with the size [Microsoft, Bitmap Storage].
std::string bmp(const std::string& path, std::string file, uint64_t limit) {
    if (file.size() < 30) cutOff(path);
    const uint32_t header = littleEndian(file, 14, 4);
    const bool old = header == 12;
    const double width = old ? littleEndian(file, 18, 2) : double(int32_t(littleEndian(file, 18, 4)));
    const double height = old ? littleEndian(file, 20, 2) : double(int32_t(littleEndian(file, 22, 4)));
    checkImageSize(path, width, height < 0 ? -height : height, 4, limit);
    return file;
}

struct Known {
    std::string_view extension, name;
    const char* reader;
    std::string_view beginning;  // signature at the start of the content; TGA has none
};
constexpr Known formats[] = {{"exr", "OpenEXR", "openexr", "\x76\x2f\x31\x01"sv},
                             {"png", "PNG", "png", "\x89PNG\r\n\x1a\n"sv},
                             {"jpg", "JPEG", "jpeg", "\xff\xd8\xff"sv},
                             {"jpeg", "JPEG", "jpeg", "\xff\xd8\xff"sv},
                             {"bmp", "BMP", "bmp", "BM"sv},
                             {"tga", "TGA", "targa", ""sv}};

}  // namespace

void checkImageSize(const std::string& path, double width, double height, double channels, uint64_t limit) {
    const std::string size = printed("%.0f x %.0f pixels", width, height);
    if (!(width >= 1 && height >= 1 && width <= 1 << 30 && height <= 1 << 30 && channels >= 1))
        throw FileError(path, "is damaged: it announces " + size);
    const double bytes = width * height * channels * sizeof(float);
    if (bytes > double(limit))
        throw FileError(path, concat(size, " of ", int(channels), " channels take ", tooLarge(bytes, limit)));
}

ImageFormat imageFormat(const std::string& path, std::string bytes, uint64_t limit) {
    const std::string extension = requireExtension(path, {"exr", "png", "jpg", "jpeg", "tga", "bmp"});
    const Known *named = nullptr, *found = nullptr;
    for (const Known& k : formats) {
        if (k.extension == extension) named = &k;
        if (!found && !k.beginning.empty() && bytes.starts_with(k.beginning)) found = &k;
    }
    // A TGA file has no signature, and may begin like another format: its header decides.
    if (!named->beginning.empty() && (!found || found->name != named->name))
        throw FileError(
            path, "is not " + std::string(named->name) + ", although its name says so: " +
                      (found ? "its content is " + std::string(found->name) : "its beginning is another"));
    ImageFormat format{named->reader, {}};
    if (named->name == "OpenEXR") {
        checkExrHeader(path, bytes, limit);
        format.bytes = std::move(bytes);
    } else if (named->name == "PNG") {
        format.bytes = png(path, bytes, limit);
    } else if (named->name == "JPEG") {
        format.bytes = jpeg(path, bytes, limit);
    } else if (named->name == "BMP") {
        format.bytes = bmp(path, std::move(bytes), limit);
    } else {
        format.bytes = tga(path, bytes, limit);
    }
    return format;
}

}  // namespace pellucid::io
