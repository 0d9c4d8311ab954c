#include "io/image/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/half.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "io/atomic_file.h"
#include "io/file_error.h"
#include "io/input_file.h"

namespace pellucid::io {
namespace {

using namespace OIIO;

std::string listOf(const std::vector<std::string>& names) {
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    return list;
}

bool endsWith(const std::string& text, const std::string& end) {
    return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

void setAttribute(ImageSpec& spec, const std::string& name, const Attribute& value) {
    if (const int* i = std::get_if<int>(&value)) {
        spec.attribute(name, *i);
    } else if (const float* f = std::get_if<float>(&value)) {
        spec.attribute(name, *f);
    } else if (const std::string* s = std::get_if<std::string>(&value)) {
        spec.attribute(name, *s);
    } else {
        const auto& v = std::get<std::vector<float>>(value);
        if (v.size() == 16) {  // the one array of floats, beside vectors of 2 to 4, that OpenImageIO writes to EXR
            spec.attribute(name, TypeMatrix44, v.data());
        } else if (v.size() >= 2 && v.size() <= 4) {
            const auto aggregate = static_cast<TypeDesc::AGGREGATE>(v.size());
            spec.attribute(name, TypeDesc(TypeDesc::FLOAT, aggregate), v.data());
        } else {
            spec.attribute(name, TypeDesc(TypeDesc::FLOAT, static_cast<int>(v.size())), v.data());
        }
    }
}

// Encodes in memory, so that disk errors can only happen in one place.
void writeWithOiio(const std::string& path, const ImageSpec& spec, TypeDesc type, const void* pixels) {
    std::vector<unsigned char> bytes;
    Filesystem::IOVecOutput memory(bytes);
    auto output = ImageOutput::create(path, &memory);
    if (!output) throw FileError(path, "cannot be written: " + OIIO::geterror());
    if (!output->set_ioproxy(&memory) || !output->open(path, spec) || !output->write_image(type, pixels) ||
        !output->close())
        throw FileError(path, "cannot be written: " + output->geterror());
    writeWholeFile(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace

const Channel& Image::channel(const std::string& name) const {
    std::vector<std::string> all, fitting;
    const Channel* found = nullptr;
    for (const Channel& c : channels) {
        if (c.name == name) return c;
        all.push_back(c.name);
        if (endsWith(c.name, "." + name)) {
            fitting.push_back(c.name);
            found = &c;
        }
    }
    if (fitting.size() == 1) return *found;
    if (fitting.empty()) throw FileError(source, "has no channel '" + name + "'; it has: " + listOf(all));
    throw FileError(source, "has several channels that '" + name + "' could mean: " + listOf(fitting) +
                                "; give one of these full names");
}

bool Image::has(const std::string& name) const {
    size_t fitting = 0;
    for (const Channel& c : channels) {
        if (c.name == name) return true;
        fitting += endsWith(c.name, "." + name);
    }
    return fitting == 1;
}

std::vector<float> Image::interleaved(std::span<const std::string> names) const {
    std::vector<float> values(names.size() * pixelCount());
    for (size_t k = 0; k < names.size(); ++k) {
        const std::vector<float>& pixels = channel(names[k]).pixels;
        for (size_t i = 0; i < pixels.size(); ++i) values[i * names.size() + k] = pixels[i];
    }
    return values;
}

void Image::addInterleaved(std::span<const std::string> names, std::span<const float> values, ChannelType type) {
    if (values.size() != names.size() * pixelCount()) {
        throw std::invalid_argument("addInterleaved: " + std::to_string(values.size()) + " values for " +
                                    std::to_string(names.size()) + " channels of " + std::to_string(width) +
                                    " x " + std::to_string(height));
    }
    for (size_t k = 0; k < names.size(); ++k) {
        Channel c{names[k], type, std::vector<float>(pixelCount())};
        for (size_t i = 0; i < c.pixels.size(); ++i) c.pixels[i] = values[i * names.size() + k];
        channels.push_back(std::move(c));
    }
}

const Attribute* Image::attribute(const std::string& name) const {
    for (const auto& [key, value] : attributes) {
        if (key == name) return &value;
    }
    return nullptr;
}

void writeExr(const std::string& path, const Image& image) {
    requireExtension(path, {"exr"});
    const size_t count = image.channels.size();
    if (count == 0 || image.pixelCount() == 0) throw std::invalid_argument("writeExr: the image is empty");
    ImageSpec spec(image.width, image.height, static_cast<int>(count), TypeDesc::FLOAT);
    // The same input must give the same bytes: OpenImageIO would write the time here.
    spec.attribute("DateTime", "");
    spec.attribute("compression", "zip");
    spec.attribute("oiio:ColorSpace", "Linear");
    for (const auto& [name, value] : image.attributes) setAttribute(spec, name, value);
    spec.channelnames.clear();
    size_t pixelBytes = 0;
    for (const Channel& c : image.channels) {
        if (c.pixels.size() != image.pixelCount()) {
            throw std::invalid_argument("writeExr: channel " + c.name + " does not have the image's size");
        }
        spec.channelnames.push_back(c.name);
        spec.channelformats.push_back(c.type == ChannelType::Half ? TypeDesc::HALF : TypeDesc::FLOAT);
        pixelBytes += c.type == ChannelType::Half ? 2 : 4;
    }
    // Each pixel in the types of its channels, so that nothing is converted.
    std::vector<char> native(pixelBytes * image.pixelCount());
    size_t offset = 0;
    for (const Channel& c : image.channels) {
        char* to = native.data() + offset;
        for (float value : c.pixels) {
            if (c.type == ChannelType::Half) {
                const half h(value);
                std::memcpy(to, &h, 2);
            } else {
                std::memcpy(to, &value, 4);
            }
            to += pixelBytes;
        }
        offset += c.type == ChannelType::Half ? 2 : 4;
    }
    writeWithOiio(path, spec, TypeDesc::UNKNOWN, native.data());
}

namespace {
const std::initializer_list<std::string_view> pictureExtensions{"png", "jpg", "jpeg", "bmp", "tga"};
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
    if (pixels.size() !=
        static_cast<size_t>(width) * static_cast<size_t>(height) * static_cast<size_t>(channels)) {
        throw std::invalid_argument("writeImage8: the number of bytes does not fit the size");
    }
    ImageSpec spec(width, height, channels, TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", srgb ? "sRGB" : "Linear");
    if (jpeg) spec.attribute("CompressionQuality", 95);
    spec.attribute("oiio:UnassociatedAlpha", 1);  // else some writers divide the colours by alpha
    writeWithOiio(path, spec, TypeDesc::UINT8, pixels.data());
}

}  // namespace pellucid::io
