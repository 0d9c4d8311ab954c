#include "io/image/image_file.h"

#include <Imath/half.h>

#include <algorithm>

#include "io/atomic_file.h"
#include "io/image/picture_library.h"

namespace pellucid::io {
namespace {

#ifdef PELLUCID_PNG_ONLY
const std::initializer_list<std::string_view> pictureExtensions{"png"};
#else
const std::initializer_list<std::string_view> pictureExtensions{"png", "jpg", "jpeg", "bmp", "tga"};
#endif

}  // namespace

Channel Channel::halves(std::string name, std::vector<float> pixels) {
    for (float& v : pixels) v = half(v);
    return {std::move(name), ChannelType::Half, std::move(pixels)};
}

const Channel& Image::channel(const std::string& name) const {
    std::vector<std::string> all, fitting;
    const Channel* found = nullptr;
    for (const Channel& c : channels) {
        if (c.name == name) return c;
        all.push_back(c.name);
        if (c.name.ends_with("." + name)) {
            fitting.push_back(c.name);
            found = &c;
        }
    }
    if (fitting.size() == 1) return *found;
    if (name.empty())
        throw FileError(source,
                        "has several channels, and none is named; 'channel' names one of: " + joined(all));
    if (fitting.empty()) throw FileError(source, "has no channel '" + name + "'; it has: " + joined(all));
    throw FileError(source, "has several channels that '" + name + "' could mean: " + joined(fitting) +
                                "; give one of these full names");
}

bool Image::has(const std::string& name) const {
    size_t fitting = 0;
    for (const Channel& c : channels) {
        if (c.name == name) return true;
        fitting += c.name.ends_with("." + name);
    }
    return fitting == 1;
}

std::vector<float> Image::interleaved(std::span<const std::string> names) const {
    std::vector<float> values(names.size() * pixelCount());
    interleave(names, values.data());
    return values;
}

void Image::interleave(std::span<const std::string> names, float* values) const {
    for (size_t k = 0; k < names.size(); ++k) {
        const std::vector<float>& pixels = channel(names[k]).pixels;
        if (pixels.size() != pixelCount())
            throw std::logic_error("the channel " + names[k] + " was not read");
        for (size_t i = 0; i < pixels.size(); ++i) values[i * names.size() + k] = pixels[i];
    }
}

void Image::addInterleaved(std::span<const std::string> names, std::span<const float> values,
                           ChannelType type) {
    if (values.size() != names.size() * pixelCount())
        throw std::invalid_argument(concat("addInterleaved: ", values.size(), " values for ", names.size(),
                                           " channels of ", width, " x ", height));
    for (size_t k = 0; k < names.size(); ++k) {
        Channel c{names[k], type, std::vector<float>(pixelCount())};
        for (size_t i = 0; i < c.pixels.size(); ++i) c.pixels[i] = values[i * names.size() + k];
        channels.push_back(std::move(c));
    }
}

const Attribute* Image::attribute(const std::string& name) const {
    for (const auto& [key, value] : attributes)
        if (key == name) return &value;
    return nullptr;
}

bool isPicture(const std::string& path) {
    return std::ranges::find(pictureExtensions, extensionOf(path)) != pictureExtensions.end();
}

std::string requirePicture(const std::string& path) {
    return requireExtension(path, pictureExtensions);
}

void writeImage8(const std::string& path, int width, int height, int channels,
                 std::span<const uint8_t> pixels, bool srgb) {
    const std::string extension = requirePicture(path);
    const bool jpeg = extension == "jpg" || extension == "jpeg";
    if (jpeg && channels == 4) throw FileError(path, "JPEG holds no alpha; 1 or 3 channels do");
    if (pixels.size() != size_t(width) * size_t(height) * size_t(channels))
        throw std::invalid_argument("writeImage8: the number of bytes does not fit the size");
    writeWholeFile(path,
                   pictureLibraryFor(extension, path).encode(path, width, height, channels, pixels, srgb));
}

MipChain mipChain(int width, int height, std::vector<float> rgb) {
    MipChain chain{{{width, height, 0}}, std::move(rgb)};
    while (width > 1 || height > 1) {
        const int w = std::max(width / 2, 1), h = std::max(height / 2, 1);
        const size_t from = chain.levels.back().byteOffset / sizeof(float);
        chain.levels.push_back({w, h, chain.texels.size() * sizeof(float)});
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) {
                // The last texel of an odd side takes its third neighbour too.
                const int x0 = width > 1 ? 2 * x : 0, x1 = x + 1 == w ? width : x0 + 2;
                const int y0 = height > 1 ? 2 * y : 0, y1 = y + 1 == h ? height : y0 + 2;
                double sum[3] = {};
                for (int j = y0; j < y1; ++j)
                    for (int i = x0; i < x1; ++i)
                        for (int c = 0; c < 3; ++c)
                            sum[c] +=
                                chain.texels[from + 3 * (size_t(j) * size_t(width) + size_t(i)) + size_t(c)];
                for (double s : sum) chain.texels.push_back(float(s / double((x1 - x0) * (y1 - y0))));
            }
        width = w;
        height = h;
    }
    return chain;
}

}  // namespace pellucid::io
