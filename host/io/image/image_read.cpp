// Reading of images: OpenImageIO decodes from memory what imageFormat() accepted.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <climits>

#include "io/file_error.h"
#include "io/image/image_file.h"
#include "io/image/image_format.h"
#include "io/input_file.h"

namespace pellucid::io {
namespace {

using namespace OIIO;

// A channel with its part's name, unless the file has one part only or the name says it already.
std::string fullName(const ImageSpec& spec, const std::string& channel, bool severalParts) {
    const std::string part =
        spec.get_string_attribute("oiio:subimagename", spec.get_string_attribute("name"));
    if (!severalParts || part.empty() || channel.rfind(part + ".", 0) == 0) return channel;
    return part + "." + channel;
}

void copyAttributes(Image& image, const ImageSpec& spec) {
    for (const ParamValue& p : spec.extra_attribs) {
        const std::string name = p.name().string();
        const TypeDesc type = p.type();
        if (type == TypeDesc::STRING) {
            const char* text = *static_cast<const char* const*>(p.data());
            image.attributes.emplace_back(name, std::string(text ? text : ""));
        } else if (type == TypeDesc::INT) {
            image.attributes.emplace_back(name, *static_cast<const int*>(p.data()));
        } else if (type == TypeDesc::FLOAT) {
            image.attributes.emplace_back(name, *static_cast<const float*>(p.data()));
        } else if (type.basetype == TypeDesc::FLOAT) {
            const float* values = static_cast<const float*>(p.data());
            image.attributes.emplace_back(name, std::vector<float>(values, values + type.basevalues()));
        }
    }
}

// Part `part` of the file, without its pixels.
void readHeader(Image& image, ImageInput& input, int part, bool severalParts, uint64_t limit) {
    const ImageSpec spec = input.spec(part);
    if (spec.deep) throw FileError(image.source, "holds deep pixels; flatten it first");
    if (spec.full_width != image.width || spec.full_height != image.height) {
        throw FileError(image.source, "part " + std::to_string(part) + " is " + std::to_string(spec.full_width) +
                                          " x " + std::to_string(spec.full_height) + " pixels, part 0 is " +
                                          std::to_string(image.width) + " x " + std::to_string(image.height) +
                                          "; all parts must have one display window");
    }
    if (spec.depth > 1 || spec.nchannels < 1 || spec.channelnames.size() != size_t(spec.nchannels))
        throw FileError(image.source, "is damaged: its channels have no names, or its pixels a depth");
    checkImageSize(image.source, spec.width, spec.height, spec.nchannels, limit);
    for (size_t c = 0; c < spec.channelnames.size(); ++c) {
        const bool isHalf = spec.channelformat(int(c)) == TypeDesc::HALF;
        image.channels.push_back({fullName(spec, spec.channelnames[c], severalParts),
                                  isHalf ? ChannelType::Half : ChannelType::Float,
                                  {}});
    }
}

// Its pixels, some rows at a time, into the channels from `first` on, placed by its data window.
void readPixels(Image& image, ImageInput& input, int part, size_t first) {
    const ImageSpec spec = input.spec(part);
    const auto channels = size_t(spec.nchannels), width = size_t(spec.width);
    // Whole chunks of every compression, and whole tiles.
    const int rows = spec.tile_width ? std::max(spec.tile_height, 1) : 256;
    std::vector<float> band(std::min(size_t(rows), size_t(spec.height)) * width * channels);
    for (size_t c = 0; c < channels; ++c) image.channels[first + c].pixels.assign(image.pixelCount(), 0.0f);
    const int64_t left = int64_t(spec.x) - spec.full_x;
    const int64_t from = std::max<int64_t>(0, -left), to = std::min<int64_t>(spec.width, image.width - left);
    for (int top = 0; top < spec.height; top += rows) {
        const int begin = spec.y + top, end = spec.y + std::min(top + rows, spec.height);
        const bool read = spec.tile_width
                              ? input.read_tiles(part, 0, spec.x, spec.x + spec.width, begin, end, spec.z,
                                                 spec.z + 1, 0, spec.nchannels, TypeDesc::FLOAT, band.data())
                              : input.read_scanlines(part, 0, begin, end, spec.z, 0, spec.nchannels,
                                                     TypeDesc::FLOAT, band.data());
        if (!read) throw FileError(image.source, "is damaged or cut off: " + input.geterror());
        for (int y = begin; y < end; ++y) {
            const int64_t row = int64_t(y) - spec.full_y;
            if (row < 0 || row >= image.height) continue;
            const float* values = band.data() + size_t(y - begin) * width * channels;
            for (size_t c = 0; c < channels; ++c) {
                float* pixels = image.channels[first + c].pixels.data() + size_t(row) * size_t(image.width);
                for (int64_t x = from; x < to; ++x) pixels[x + left] = values[size_t(x) * channels + c];
            }
        }
    }
}

}  // namespace

Image decodeImage(const std::string& path, std::string bytes, const std::function<void(const Image&)>& check,
                  uint64_t limit) {
    ImageFormat format = imageFormat(path, std::move(bytes), limit);
    // OpenImageIO's own limit must not apply before ours.
    OIIO::attribute("limits:imagesize_MB", int(std::min<uint64_t>(limit >> 20, INT_MAX)));
    Filesystem::IOMemReader memory(format.bytes.data(), format.bytes.size());
    auto input = ImageInput::create(format.reader);
    ImageSpec first, config;
    config.attribute("oiio:UnassociatedAlpha", 1);  // otherwise colours come multiplied by alpha
    if (!input || !input->set_ioproxy(&memory) || !input->open(path, first, config))
        throw FileError(
            path, "is not an image that can be read: " + (input ? input->geterror() : OIIO::geterror()));
    int parts = 0;
    while (input->seek_subimage(parts, 0)) ++parts;
    Image image;
    image.source = path;
    first = input->spec(0);
    image.width = first.full_width;
    image.height = first.full_height;
    copyAttributes(image, first);
    std::vector<size_t> begin;
    for (int part = 0; part < parts; ++part) {
        begin.push_back(image.channels.size());
        readHeader(image, *input, part, parts > 1, limit);
    }
    checkImageSize(path, image.width, image.height, double(image.channels.size()), limit);
    if (check) check(image);
    for (int part = 0; part < parts; ++part) readPixels(image, *input, part, begin[size_t(part)]);
    return image;
}

Image readImage(const std::string& path, const std::function<void(const Image&)>& check, uint64_t limit) {
    return decodeImage(path, readWholeFile(path, limit), check, limit);
}

}  // namespace pellucid::io
