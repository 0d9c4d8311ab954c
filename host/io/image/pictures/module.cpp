// The module that io/image/picture_library.h loads: 8- and 16-bit pictures and text, by OpenImageIO.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <climits>
#include <filesystem>

#include "io/image/picture_library.h"

namespace pellucid::io {
namespace {

using namespace OIIO;

void decode(Image& image, const ImageFormat& format, const std::function<void(const Image&)>& check,
            uint64_t limit) {
    // OpenImageIO's own limit must not apply before ours.
    OIIO::attribute("limits:imagesize_MB", int(std::min<uint64_t>(limit >> 20, INT_MAX)));
    Filesystem::IOMemReader memory(format.bytes.data(), format.bytes.size());
    auto input = ImageInput::create(format.reader);
    ImageSpec spec, config;
    config.attribute("oiio:UnassociatedAlpha", 1);  // otherwise colours come multiplied by alpha
    if (!input || !input->set_ioproxy(&memory) || !input->open(image.source, spec, config))
        throw FileError(image.source, "is not an image that can be read: " +
                                          (input ? input->geterror() : OIIO::geterror()));
    image.width = spec.width;
    image.height = spec.height;
    const auto channels = size_t(std::max(spec.nchannels, 0)), width = size_t(std::max(spec.width, 0));
    if (spec.depth > 1 || channels == 0 || spec.channelnames.size() != channels)
        throw FileError(image.source, "is damaged: its channels have no names, or its pixels a depth");
    checkImageSize(image.source, image.width, image.height, double(channels), limit);
    for (const std::string& name : spec.channelnames)
        image.channels.push_back({name, ChannelType::Float, {}});
    if (check) check(image);
    for (Channel& c : image.channels) c.pixels.resize(image.pixelCount());
    constexpr int rows = 256;
    std::vector<float> band(std::min(size_t(rows), size_t(spec.height)) * width * channels);
    for (int top = 0; top < spec.height; top += rows) {
        const int end = std::min(top + rows, spec.height);
        if (!input->read_scanlines(0, 0, spec.y + top, spec.y + end, spec.z, 0, spec.nchannels,
                                   TypeDesc::FLOAT, band.data()))
            throw FileError(image.source, "is damaged or cut off: " + input->geterror());
        const size_t first = size_t(top) * width, count = size_t(end - top) * width;
        for (size_t c = 0; c < channels; ++c)
            for (size_t i = 0; i < count; ++i) image.channels[c].pixels[first + i] = band[i * channels + c];
    }
}

// Encodes in memory, so that only one place has to handle disk errors.
std::string encode(const std::string& path, int width, int height, int channels,
                   std::span<const uint8_t> pixels, bool srgb) {
    ImageSpec spec(width, height, channels, TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", srgb ? "sRGB" : "Linear");
    if (extensionOf(path).starts_with("jp")) spec.attribute("CompressionQuality", 95);
    spec.attribute("oiio:UnassociatedAlpha", 1);  // else some writers divide the colours by alpha
    std::vector<unsigned char> bytes;
    Filesystem::IOVecOutput memory(bytes);
    auto output = ImageOutput::create(path, &memory);
    if (!output) throw FileError(path, "cannot be written: " + OIIO::geterror());
    if (!output->set_ioproxy(&memory) || !output->open(path, spec) ||
        !output->write_image(TypeDesc::UINT8, pixels.data()) || !output->close())
        throw FileError(path, "cannot be written: " + output->geterror());
    return {bytes.begin(), bytes.end()};
}

// Where Debian puts it, else wherever OpenImageIO looks for fonts.
std::string font() {
    constexpr const char* fontFile = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
    return std::filesystem::exists(fontFile) ? fontFile : "DejaVuSans";
}

void drawText(uint8_t* rgb, int width, int height, int x, int y, const std::string& text, int size,
              const float* ink) {
    ImageBuf pixels(ImageSpec(width, height, 3, TypeDesc::UINT8), rgb);
    ImageBufAlgo::render_text(pixels, x, y, text, size, font(), {ink, 3});
}

int textWidth(const std::string& text, int size) {
    const ROI extent = ImageBufAlgo::text_size(text, size, font());
    return extent.defined() ? std::max(extent.xend, 0) : 0;
}

}  // namespace
}  // namespace pellucid::io

extern "C" __attribute__((visibility("default"))) const pellucid::io::PictureLibrary pellucidPictures = {
    PELLUCID_VERSION, pellucid::io::decode, pellucid::io::encode, pellucid::io::drawText,
    pellucid::io::textWidth};
