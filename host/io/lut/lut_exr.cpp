#include "io/lut/lut_exr.h"

#include <bit>
#include <cstring>

#include "io/content_hash.h"
#include "io/image/image_format.h"
#include "io/lut/lut_describe.h"

namespace pellucid::io {
namespace {

static_assert(std::endian::native == std::endian::little, "EXR is little-endian");

constexpr uint32_t magic = 20000630, version = 2;
constexpr std::string_view noSum = "0000000000000000";  // takes this place while the sum is computed
constexpr const char *keyName = "pellucid:key", *sumName = "pellucid:checksum";

struct Bytes {
    std::string data;
    template <class T>
    Bytes& add(T value) {
        data.append(reinterpret_cast<const char*>(&value), sizeof value);
        return *this;
    }
    Bytes& text(std::string_view text) {  // includes the zero at its end
        data.append(text).push_back('\0');
        return *this;
    }
    // Name, type, size and value of an attribute.
    Bytes& attribute(std::string_view name, std::string_view type, std::string_view value) {
        text(name).text(type).add(uint32_t(value.size()));
        data.append(value);
        return *this;
    }
    template <class... T>
    Bytes& attributeOf(std::string_view name, std::string_view type, T... values) {
        Bytes value;
        (value.add(values), ...);
        return attribute(name, type, value.data);
    }
};

Bytes header(const PelLutInfo& info, PelLutEncoding encoding, const std::string& key, uint32_t stack,
             size_t& sumAt) {
    const auto [width, height] = lutSize(info);
    Bytes channels;
    for (const char* name : {"B", "G", "R"})  // alphabetical, as the format requires
        channels.text(name)
            .add(uint32_t(encoding == PEL_LUT_HALF ? 1 : 2))  // HALF or FLOAT
            .add(uint32_t(0))                                 // not perceptually linear; reserved
            .add(uint32_t(1))
            .add(uint32_t(1));  // sampling
    channels.add(uint8_t(0));
    Bytes b;
    b.add(magic).add(version);
    b.attribute("channels", "chlist", channels.data);
    b.attributeOf("compression", "compression", uint8_t(0));
    for (const char* window : {"dataWindow", "displayWindow"})
        b.attributeOf(window, "box2i", 0, 0, int(width) - 1, int(height * stack) - 1);
    b.attributeOf("lineOrder", "lineOrder", uint8_t(0));
    b.attributeOf("pixelAspectRatio", "float", 1.0f);
    b.attributeOf("screenWindowCenter", "v2f", 0.0f, 0.0f);
    b.attributeOf("screenWindowWidth", "float", 1.0f);
    if (stack > 1) b.attributeOf("pellucid:stack", "int", int(stack));
    for (const auto& [name, value] : stack > 1 ? decltype(describeLut(info))() : describeLut(info)) {
        if (const auto* s = std::get_if<std::string>(&value)) b.attribute(name, "string", *s);
        if (const auto* i = std::get_if<int>(&value)) b.attributeOf(name, "int", *i);
        if (const auto* f = std::get_if<float>(&value)) b.attributeOf(name, "float", *f);
    }
    b.attribute(keyName, "string", key);
    b.attribute(sumName, "string", noSum);
    sumAt = b.data.size() - noSum.size();
    b.add(uint8_t(0));
    return b;
}

template <class Texel>
void scanLines(Bytes& b, uint32_t width, uint32_t height, std::string_view texels) {
    const size_t rowBytes = size_t(width) * 3 * sizeof(Texel), chunk = 8 + rowBytes;
    if (texels.size() != rowBytes * height)
        throw std::invalid_argument("encodeLutExr: the number of bytes does not fit the size");
    uint64_t at = b.data.size() + size_t(height) * 8;
    for (uint32_t y = 0; y < height; ++y, at += chunk) b.add(at);
    const size_t start = b.data.size();
    b.data.resize(start + chunk * height);
    for (uint32_t y = 0; y < height; ++y) {
        char* to = b.data.data() + start + chunk * y;
        const auto size = uint32_t(rowBytes);
        std::memcpy(to, &y, 4);
        std::memcpy(to + 4, &size, 4);
        const char* from = texels.data() + rowBytes * y;
        for (size_t c = 0; c < 3; ++c)
            for (size_t x = 0; x < width; ++x)
                std::memcpy(to + 8 + (c * width + x) * sizeof(Texel), from + (3 * x + 2 - c) * sizeof(Texel),
                            sizeof(Texel));
    }
}

}  // namespace

std::string encodeLutExr(const PelLutInfo& info, PelLutEncoding encoding, std::string_view texels,
                         const std::string& key, uint32_t stack) {
    if (encoding != PEL_LUT_HALF && encoding != PEL_LUT_FLOAT)
        throw std::invalid_argument("encodeLutExr: the encoding must be half or float");
    const auto [width, height] = lutSize(info);
    size_t sumAt = 0;
    Bytes b = header(info, encoding, key, stack, sumAt);
    b.data.reserve(b.data.size() + texels.size() + 16 * size_t(height) * stack);
    if (encoding == PEL_LUT_HALF)
        scanLines<uint16_t>(b, width, height * stack, texels);
    else
        scanLines<float>(b, width, height * stack, texels);
    b.data.replace(sumAt, noSum.size(), hexDigits(contentHash(b.data)));
    return std::move(b.data);
}

bool verifyLutExr(std::string_view file, std::string_view key) {
    if (file.size() < 8) return false;
    ExrAttributes header(file);
    bool keyFits = false;
    while (const auto attribute = header.next()) {
        if (attribute->name == keyName) keyFits = attribute->value == key;
        if (attribute->name == sumName && attribute->value.size() == noSum.size())
            return keyFits && attribute->value == hexDigits(contentHash(std::string(file).replace(
                                                      attribute->valueAt, noSum.size(), noSum)));
    }
    return false;
}

}  // namespace pellucid::io
