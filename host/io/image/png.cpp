// PNG files by libpng.
#include <png.h>

#include <csetjmp>
#include <cstring>

#include "io/image/picture_library.h"

namespace pellucid::io {
namespace {

struct Source {
    const char* at;
    size_t left;
};

// libpng reports errors by longjmp, which skips destructors. So objects with destructors live in the callers.
struct Reader {
    png_structp png = nullptr;
    png_infop info = nullptr;
    Source source{};
    std::string error = "it is damaged";
    std::vector<uint8_t> bytes;
    std::vector<png_bytep> rows;
    ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

struct Writer {
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::string error, bytes;
    ~Writer() { png_destroy_write_struct(&png, &info); }
};

template <class Owner>
[[noreturn]] void onError(png_structp png, png_const_charp message) {
    static_cast<Owner*>(png_get_error_ptr(png))->error = message;
    png_longjmp(png, 1);
}

void onWarning(png_structp, png_const_charp) {}

void readBytes(png_structp png, png_bytep to, size_t count) {
    Source& source = *static_cast<Source*>(png_get_io_ptr(png));
    if (count > source.left) png_error(png, "it is cut off");
    std::memcpy(to, source.at, count);
    source.at += count;
    source.left -= count;
}

void writeBytes(png_structp png, png_bytep from, size_t count) {
    static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(from), count);
}

bool readHeader(Reader& r) {
    if (setjmp(png_jmpbuf(r.png))) return false;
    png_set_read_fn(r.png, &r.source, readBytes);
    png_read_info(r.png, r.info);
    png_set_expand(r.png);  // palettes, fewer than 8 bits, a transparent colour
    png_set_interlace_handling(r.png);
    png_read_update_info(r.png, r.info);
    return true;
}

bool readRows(Reader& r) {
    if (setjmp(png_jmpbuf(r.png))) return false;
    png_read_image(r.png, r.rows.data());
    png_read_end(r.png, nullptr);
    return true;
}

bool writeAll(Writer& w, int width, int height, int colors, bool srgb, const png_bytep* rows) {
    if (setjmp(png_jmpbuf(w.png))) return false;
    png_set_write_fn(w.png, &w.bytes, writeBytes, [](png_structp) {});
    png_set_IHDR(w.png, w.info, png_uint_32(width), png_uint_32(height), 8, colors, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (srgb)
        png_set_sRGB(w.png, w.info, PNG_sRGB_INTENT_ABSOLUTE);
    else
        png_set_gAMA_fixed(w.png, w.info, PNG_FP_1);
    // 60 ms less for a shaded head at 720p than level 6 and a choice among filters take, and 12 % larger.
    png_set_compression_level(w.png, 3);
    png_set_filter(w.png, 0, PNG_FILTER_UP);
    png_write_info(w.png, w.info);
    png_write_image(w.png, const_cast<png_bytepp>(rows));
    png_write_end(w.png, nullptr);
    return true;
}

void decode(Image& image, const ImageFormat& format, const std::function<void(const Image&)>& check,
            uint64_t limit) {
    if (format.reader != std::string_view("png"))
        throw FileError(
            image.source,
            "is a JPEG, TGA or BMP file, which this build of pellucid cannot read; PNG, EXR and NPY it can");
    Reader r;
    r.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &r, onError<Reader>, onWarning);
    r.info = r.png ? png_create_info_struct(r.png) : nullptr;
    if (!r.info) throw std::bad_alloc();
    png_set_user_limits(r.png, 0x7fffffff, 0x7fffffff);  // ours is checked by the caller
    r.source = {format.bytes.data(), format.bytes.size()};
    const auto broken = [&] {
        throw FileError(image.source, "is not an image that can be read: " + r.error);
    };
    if (!readHeader(r)) broken();
    image.width = int(png_get_image_width(r.png, r.info));
    image.height = int(png_get_image_height(r.png, r.info));
    const size_t channels = png_get_channels(r.png, r.info), rowBytes = png_get_rowbytes(r.png, r.info);
    const bool wide = png_get_bit_depth(r.png, r.info) == 16;
    checkImageSize(image.source, image.width, image.height, double(channels), limit);
    constexpr const char *grey[] = {"Y", "A"}, *color[] = {"R", "G", "B", "A"};
    for (size_t c = 0; c < channels; ++c)
        image.channels.push_back({channels < 3 ? grey[c] : color[c], ChannelType::Float, {}});
    if (check) check(image);
    const size_t width = size_t(image.width), height = size_t(image.height);
    r.bytes.resize(rowBytes * height);
    for (size_t y = 0; y < height; ++y) r.rows.push_back(r.bytes.data() + y * rowBytes);
    if (!readRows(r)) broken();
    for (size_t c = 0; c < channels; ++c) {
        std::vector<float>& pixels = image.channels[c].pixels;
        pixels.resize(width * height);
        for (size_t y = 0; y < height; ++y)
            for (size_t x = 0; x < width; ++x) {
                const size_t i = x * channels + c;
                const uint8_t* const row = r.rows[y];
                pixels[y * width + x] =
                    wide ? float(row[2 * i] << 8 | row[2 * i + 1]) / 65535.0f : float(row[i]) / 255.0f;
            }
    }
}

std::string encode(const std::string& path, int width, int height, int channels,
                   std::span<const uint8_t> pixels, bool srgb) {
    Writer w;
    w.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &w, onError<Writer>, onWarning);
    w.info = w.png ? png_create_info_struct(w.png) : nullptr;
    if (!w.info) throw std::bad_alloc();
    std::vector<png_bytep> rows;
    for (int y = 0; y < height; ++y)
        rows.push_back(const_cast<png_bytep>(pixels.data()) + size_t(y) * size_t(width) * size_t(channels));
    const int colors = channels == 1   ? PNG_COLOR_TYPE_GRAY
                       : channels == 3 ? PNG_COLOR_TYPE_RGB
                                       : PNG_COLOR_TYPE_RGB_ALPHA;
    if (!writeAll(w, width, height, colors, srgb, rows.data()))
        throw FileError(path, "cannot be written: " + w.error);
    return std::move(w.bytes);
}

void drawText(uint8_t*, int, int, int, int, const std::string&, int, const float*) {}

int textWidth(const std::string&, int) {
    return 0;
}

}  // namespace

const PictureLibrary pngPictures = {PELLUCID_VERSION, decode, encode, drawText, textWidth};

}  // namespace pellucid::io
