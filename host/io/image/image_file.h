// Images of named float channels: multi-part, multi-layer EXR in; EXR, 8-bit formats and NPY out.
#pragma once
#include <functional>
#include <span>
#include <variant>
#include <vector>

#include "io/input_file.h"

namespace pellucid::io {

enum class ChannelType { Float, Half };  // how a channel is stored in a file; in memory all are float32

struct Channel {
    std::string name;  // full: "ViewLayer.Normal.X", with the part's name before it in a multi-part file
    ChannelType type = ChannelType::Float;
    std::vector<float> pixels;  // width * height, row 0 on top

    static Channel halves(std::string name, std::vector<float> pixels);  // the nearest half floats
};

using Attribute = std::variant<int, float, std::string, std::vector<float>>;

struct Image {
    int width = 0;  // pixels
    int height = 0;
    std::vector<Channel> channels;
    std::vector<std::pair<std::string, Attribute>> attributes;  // of the file's first part
    std::string source;                                         // the file, for messages

    size_t pixelCount() const { return size_t(width) * size_t(height); }

    // The channel of that full name or, if there is none, the only one whose name ends with "." + name.
    // Throws FileError when none or several fit; the message lists the channels found.
    const Channel& channel(const std::string& name) const;
    bool has(const std::string& name) const;  // channel() would find exactly one

    // Those channels interleaved. Throws std::logic_error for one whose pixels were not read.
    std::vector<float> interleaved(std::span<const std::string> names) const;
    void interleave(std::span<const std::string> names, float* values) const;

    // Appends channels from interleaved values (names.size() * width * height of them).
    void addInterleaved(std::span<const std::string> names, std::span<const float> values,
                        ChannelType type = ChannelType::Float);

    const Attribute* attribute(const std::string& name) const;  // nullptr if there is none
};

// Reads all parts and channels of an .exr, .png, .jpg, .tga or .bmp file at full precision (8- and 16-bit
// integers become 0 to 1, those of 32 bits in EXR keep their values; colours are not multiplied by alpha).
// Each part is placed by its data window in the display window: pixels outside its data window are 0,
// pixels outside the display window are dropped. Throws FileError: missing, broken or deep file, another
// format, parts with different display windows, more than inputLimit() bytes of pixels as floats.
Image readImage(const std::string& path);
// The same from the bytes of a file; `path` names the format. `check` sees size, attributes and channel names
// before any pixel is read, and throws if the image is not the wanted one. `names`: as of readChannels.
Image decodeImage(const std::string& path, std::string bytes,
                  const std::function<void(const Image&)>& check = {}, uint64_t limit = inputLimit(),
                  const std::vector<std::string>* names = nullptr);
// Reads only the pixels of those channels, where that is faster (EXR). The image lists all channels of the
// file; the others have no pixels. Names are those of Image::channel(); one that fits no channel, or several,
// is no error here.
Image readChannels(const std::string& path, const std::vector<std::string>& names);

// Where a channel's values go: that of pixel i to first[i * stride]. nullptr: it is not wanted.
struct Place {
    float* first = nullptr;
    size_t stride = 1;
};
// One for each channel of an image that has no pixels yet. The memory holds zeros.
using PlaceChannels = std::function<std::vector<Place>(Image&)>;
// Reads channels straight to where they are wanted. The image that is returned has no pixels.
Image readChannelsTo(const std::string& path, const PlaceChannels& places);

// Writes a single-part scan-line EXR, each channel in its own type; float32 values keep their bits. ZIP makes
// files small; RLE is quick to read, and files are a third larger where much is background, or more.
enum class ExrCompression { Zip, Rle };
void writeExr(const std::string& path, const Image& image, ExrCompression compression = ExrCompression::Zip);

// Whether writeImage8 writes files of this extension. requirePicture returns it, or throws FileError.
bool isPicture(const std::string& path);
std::string requirePicture(const std::string& path);

// Writes interleaved 8-bit pixels (1, 3 or 4 channels) as .png, .bmp or .tga without changing the bytes, or
// (1 or 3 channels) as .jpg. `srgb` only says what a PNG declares the bytes to be: sRGB-encoded, or linear.
void writeImage8(const std::string& path, int width, int height, int channels,
                 std::span<const uint8_t> pixels, bool srgb = true);

// Writes a NumPy array, C order, float32 or float16 from float32 values, or uint8.
void writeNpy(const std::string& path, std::span<const size_t> shape, std::span<const float> values,
              ChannelType type = ChannelType::Float);
void writeNpy(const std::string& path, std::span<const size_t> shape, std::span<const uint8_t> values);

struct NpyArray {
    std::vector<size_t> shape;
    std::vector<float> values;  // C order
};

// Little-endian float16, float32, float64 or uint8 (values 0 to 255 unchanged), C order. Throws FileError:
// missing, damaged or truncated file, another type or order.
NpyArray readNpy(const std::string& path);

struct MipLevel {
    int width = 0, height = 0;
    size_t byteOffset = 0;  // of its first texel in `texels`
};

// RGB float32 texels of all levels, one after another, the finest first. Each texel of a level is the mean of
// the texels that it covers: two, or three where a side is odd, in each direction. Means of different normals
// are shorter than 1, as they should be.
struct MipChain {
    std::vector<MipLevel> levels;
    std::vector<float> texels;
};
MipChain mipChain(int width, int height, std::vector<float> rgb);

}  // namespace pellucid::io
