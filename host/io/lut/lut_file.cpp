#include "io/lut/lut_file.h"

#include <algorithm>

#include "io/atomic_file.h"
#include "io/image/texture_file.h"
#include "io/lut/lut_describe.h"

namespace pellucid::io {
namespace {

const std::vector<std::string> rgb{"R", "G", "B"};

template <class T>
const T& need(const Image& image, const char* name) {
    const Attribute* attribute = image.attribute(name);
    if (!attribute || !std::holds_alternative<T>(*attribute))
        throw FileError(image.source,
                        concat("no attribute \"", name,
                               "\": a look-up table written by `pellucid lut ... -o FILE.exr` is needed"));
    return std::get<T>(*attribute);
}

template <class Enum, size_t N>
Enum needChoice(const Image& image, const char* name, const std::string_view (&names)[N]) {
    const auto& value = need<std::string>(image, name);
    const auto* const found = std::ranges::find(names, value);
    if (found == std::end(names))
        throw FileError(image.source, concat("attribute \"", name, "\" is \"", value, "\"; one of ",
                                             joined(names), " is needed"));
    return Enum(found - names);
}

// The description in an image's attributes. Throws FileError if they do not describe a table.
PelLutInfo lutInfoOf(const Image& image) {
    const std::string& path = image.source;
    PelLutInfo info = pelLutInfoDefaults();
    const int format = need<int>(image, "pellucid:format");
    if (format != lutFormatVersion)
        throw FileError(
            path, concat("is written in format ", format, "; this program reads format ", lutFormatVersion));
    info.kind = needChoice<PelLutKind>(image, "pellucid:kind", lutKinds);
    if (info.kind != PEL_LUT_SPECULAR) {
        const auto& profile = need<std::string>(image, "pellucid:profile");
        if (profile.empty() || profile.size() >= sizeof info.profile)
            throw FileError(path, "attribute \"pellucid:profile\" has no name of 1 to 63 bytes");
        info.profile[profile.copy(info.profile, sizeof info.profile - 1)] = '\0';
    }
    if (info.kind == PEL_LUT_CURVATURE) {
        info.curvature.form = needChoice<PelCurvatureForm>(image, "pellucid:form", curvatureForms);
        info.curvature.axis = needChoice<PelLutAxis>(image, "pellucid:axis", lutAxes);
    }
    if (info.kind == PEL_LUT_SHADOW) {
        // Older files lack these attributes.
        info.shadow.axis = PEL_AXIS_LINEAR;
        info.shadow.closedEnds = 0;
        if (image.attribute("pellucid:axis"))
            info.shadow.axis = needChoice<PelLutAxis>(image, "pellucid:axis", lutAxes);
        if (image.attribute("pellucid:closedEnds"))
            info.shadow.closedEnds = uint32_t(need<int>(image, "pellucid:closedEnds"));
    }
    if (info.kind == PEL_LUT_EYE) {
        const int depth = need<int>(image, "pellucid:depth");
        if (depth < 1 || image.height % depth)
            throw FileError(path, concat("attribute \"pellucid:depth\" is ", depth,
                                         ", which does not divide the height, ", image.height));
        info.eye.width = uint32_t(image.width);
        info.eye.height = uint32_t(image.height / depth);
        info.eye.depth = uint32_t(depth);
    }
    info.curvature.width = info.shadow.width = info.specular.width = uint32_t(image.width);
    info.curvature.height = info.shadow.height = info.specular.height = uint32_t(image.height);
    visitLutNumbers(info, [&](const char* name, float& value) { value = need<float>(image, name); });
    for (const std::string& channel : rgb) image.channel(channel);
    return info;
}

// The contents of an EXR: channels in the storage type of the encoding, and the description of the table.
Image describedImage(const Lut& lut, PelLutEncoding encoding) {
    const PelLutInfo info = lut.info();
    const auto [width, height] = lutSize(info);
    Image image;
    image.width = int(width);
    image.height = int(height);
    image.addInterleaved(rgb, lut.read<float>(PEL_LUT_FLOAT),
                         encoding == PEL_LUT_HALF ? ChannelType::Half : ChannelType::Float);
    image.attributes = describeLut(info);
    return image;
}

std::vector<uint16_t> withAlpha(const std::vector<uint16_t>& rgbHalves) {
    constexpr uint16_t one = 0x3C00;
    std::vector<uint16_t> rgba;
    for (size_t i = 0; i < rgbHalves.size(); i += 3)
        rgba.insert(rgba.end(), {rgbHalves[i], rgbHalves[i + 1], rgbHalves[i + 2], one});
    return rgba;
}

std::map<std::string, std::string> keyValues(const Image& image) {
    std::map<std::string, std::string> pairs{{"KTXwriter", concat("pellucid ", pelVersion())}};
    for (const auto& [name, value] : image.attributes) {
        if (const auto* s = std::get_if<std::string>(&value)) pairs[name] = *s;
        if (const auto* i = std::get_if<int>(&value)) pairs[name] = concat(*i);
        if (const auto* f = std::get_if<float>(&value)) pairs[name] = concat(*f);
    }
    return pairs;
}

}  // namespace

PelLutEncoding checkLutPath(const std::string& path, std::optional<PelLutEncoding> encoding) {
    const std::string extension = requireExtension(path, {"exr", "npy", "png", "bmp", "tga", "dds", "ktx2"});
    const bool eightBit = extension == "png" || extension == "bmp" || extension == "tga";
    const bool texture = extension == "dds" || extension == "ktx2";
    const PelLutEncoding chosen = encoding.value_or(eightBit  ? PEL_LUT_FACEWORKS8
                                                    : texture ? PEL_LUT_HALF
                                                              : PEL_LUT_FLOAT);
    if (texture && chosen != PEL_LUT_HALF)
        throw std::invalid_argument("." + extension +
                                    " holds half texels: use --encoding half, or write .exr or .npy");
    if (eightBit && chosen != PEL_LUT_FACEWORKS8)
        throw std::invalid_argument("." + extension +
                                    " holds 8-bit texels: use --encoding faceworks8, or write .exr or .npy");
    if (extension == "exr" && chosen == PEL_LUT_FACEWORKS8)
        throw std::invalid_argument(
            ".exr holds float or half texels: write faceworks8 as .png, .bmp, .tga or .npy");
    checkWritable(path);
    return chosen;
}

void writeLut(const std::string& path, const Lut& lut, std::optional<PelLutEncoding> requested) {
    const PelLutEncoding encoding = checkLutPath(path, requested);
    const PelLutInfo info = lut.info();
    const auto [width, height] = lutSize(info);
    const std::string extension = extensionOf(path);
    if (encoding == PEL_LUT_FACEWORKS8) {
        const std::vector<uint8_t> texels = lut.read<uint8_t>(encoding);
        const size_t shape[] = {height, width, 4};
        if (extension == "npy")
            writeNpy(path, shape, texels);
        else
            writeImage8(path, int(width), int(height), 4, texels, info.kind == PEL_LUT_SHADOW);
        return;
    }
    if (extension == "dds" || extension == "ktx2") {
        const std::vector<uint16_t> halves = withAlpha(lut.read<uint16_t>(PEL_LUT_HALF));
        const Texture texture{width, height, halves};
        if (extension == "dds")
            writeDds(path, texture);
        else
            writeKtx2(path, texture, keyValues(describedImage(lut, PEL_LUT_HALF)));
        return;
    }
    if (extension == "npy") {
        // Halves are rounded when they are stored; in memory they are floats.
        const ChannelType type = encoding == PEL_LUT_HALF ? ChannelType::Half : ChannelType::Float;
        const size_t shape[] = {height, width, 3};
        writeNpy(path, shape, lut.read<float>(PEL_LUT_FLOAT), type);
        return;
    }
    writeExr(path, describedImage(lut, encoding));
}

void checkLutInfo(const std::string& path, const PelLutInfo& found, const PelLutInfo& wanted,
                  const std::vector<std::string>& keys) {
    const auto refuse = [&](const std::string& what, const auto& is, const auto& asked) {
        throw FileError(path, concat("is a table whose ", what, " is ", is, "; ", asked, " is asked for"));
    };
    if (found.kind != wanted.kind) refuse("kind", lutKinds[found.kind], lutKinds[wanted.kind]);
    const auto checkAxis = [&](PelLutAxis is, PelLutAxis asked) {
        if (is != asked) refuse("axis", lutAxes[is], lutAxes[asked]);
    };
// A special value asks for the profile's own, which may be any.
#define PELLUCID_SAME(type, name, value, least, most, special, unit, word, ...) \
    if (key == word && is.name != asked.name && asked.name != special) refuse(word, is.name, asked.name);
    for (const std::string& key : keys)
        if (found.kind == PEL_LUT_CURVATURE) {
            const PelCurvatureLutDesc &is = found.curvature, &asked = wanted.curvature;
            PEL_EACH_CURVATURE_LUT_FIELD(PELLUCID_SAME)
            if (key == "axis") checkAxis(is.axis, asked.axis);
            if (key == "form" && is.form != asked.form)
                refuse("form", curvatureForms[is.form], curvatureForms[asked.form]);
        } else {
            const PelShadowLutDesc &is = found.shadow, &asked = wanted.shadow;
            PEL_EACH_SHADOW_LUT_FIELD(PELLUCID_SAME)
            if (key == "axis") checkAxis(is.axis, asked.axis);
        }
#undef PELLUCID_SAME
}

LutTexels decodeLut(const std::string& path, std::string bytes) {
    LutTexels table;
    // Four copies exist: the channels, the interleaved texels, the device's buffer and a staging copy.
    const uint64_t limit = inputLimit() / 4;
    const Image image = decodeImage(
        path, std::move(bytes), [&](const Image& header) { table.info = lutInfoOf(header); }, limit);
    table.texels = image.interleaved(rgb);
    return table;
}

Lut readLut(const Device& device, const std::string& path) {
    const LutTexels table = decodeLut(path, readWholeFile(path));
    try {
        return Lut(device, table.info, table.texels);
    } catch (const Error& e) {
        throw FileError(path, e.what());
    }
}

}  // namespace pellucid::io
