#include "io/lut_file.h"

#include <cstdint>
#include <stdexcept>

#include "io/atomic_file.h"
#include "io/file_error.h"
#include "io/image_file.h"

namespace pellucid::io {
namespace {

const std::vector<std::string> rgb{"R", "G", "B"};

// One list of the description's numbers serves writing and reading.
template <class Info, class Visit>
void visitNumbers(Info& info, Visit&& visit) {
    if (info.kind == PEL_LUT_CURVATURE) {
        visit("pellucid:diffusionRadius", info.curvature.diffusionRadius);
        visit("pellucid:radiusMin", info.curvature.radiusMin);
        visit("pellucid:radiusMax", info.curvature.radiusMax);
    } else {
        visit("pellucid:diffusionRadius", info.shadow.diffusionRadius);
        visit("pellucid:widthMin", info.shadow.widthMin);
        visit("pellucid:widthMax", info.shadow.widthMax);
        visit("pellucid:sharpening", info.shadow.sharpening);
    }
}

std::pair<uint32_t, uint32_t> sizeOf(const PelLutInfo& info) {
    return info.kind == PEL_LUT_CURVATURE ? std::pair{info.curvature.width, info.curvature.height}
                                          : std::pair{info.shadow.width, info.shadow.height};
}

}  // namespace

PelLutEncoding checkLutPath(const std::string& path, std::optional<PelLutEncoding> encoding) {
    const std::string extension = requireExtension(path, {"exr", "npy", "png", "bmp"});
    const bool eightBit = extension == "png" || extension == "bmp";
    const PelLutEncoding chosen = encoding.value_or(eightBit ? PEL_LUT_FACEWORKS8 : PEL_LUT_FLOAT);
    if (eightBit && chosen != PEL_LUT_FACEWORKS8)
        throw std::invalid_argument("." + extension +
                                    " holds 8-bit texels: use --encoding faceworks8, or write .exr or .npy");
    if (extension == "exr" && chosen == PEL_LUT_FACEWORKS8)
        throw std::invalid_argument(
            ".exr holds float or half texels: write faceworks8 as .png, .bmp or .npy");
    checkWritable(path);
    return chosen;
}

void writeLut(const std::string& path, const Lut& lut, std::optional<PelLutEncoding> requested) {
    const PelLutEncoding encoding = checkLutPath(path, requested);
    const PelLutInfo info = lut.info();
    const auto [width, height] = sizeOf(info);
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
    // Halves are rounded where they are stored; in memory they are floats.
    const ChannelType type = encoding == PEL_LUT_HALF ? ChannelType::Half : ChannelType::Float;
    const std::vector<float> texels = lut.read<float>(PEL_LUT_FLOAT);
    if (extension == "npy") {
        const size_t shape[] = {height, width, 3};
        writeNpy(path, shape, texels, type);
        return;
    }
    Image image;
    image.width = int(width);
    image.height = int(height);
    image.addInterleaved(rgb, texels, type);
    image.attributes.emplace_back("pellucid:kind",
                                  std::string(info.kind == PEL_LUT_CURVATURE ? "curvature" : "shadow"));
    image.attributes.emplace_back("pellucid:version", int(pelVersion()));
    if (info.kind == PEL_LUT_CURVATURE) image.attributes.emplace_back("pellucid:form", std::string("arc"));
    visitNumbers(info, [&](const char* name, float value) { image.attributes.emplace_back(name, value); });
    writeExr(path, image);
}

Lut readLut(const Device& device, const std::string& path) {
    const Image image = readImage(path);
    auto need = [&]<class T>(const char* name, T*) -> const T& {
        const Attribute* attribute = image.attribute(name);
        if (!attribute || !std::holds_alternative<T>(*attribute))
            throw FileError(path,
                            std::string("no attribute \"") + name +
                                "\": a look-up table written by `pellucid lut ... -o FILE.exr` is needed");
        return std::get<T>(*attribute);
    };
    PelLutInfo info = pelLutInfoDefaults();
    const std::string& kind = need("pellucid:kind", static_cast<std::string*>(nullptr));
    if (kind != "curvature" && kind != "shadow")
        throw FileError(path,
                        "attribute \"pellucid:kind\" is \"" + kind + "\"; curvature or shadow is needed");
    info.kind = kind == "curvature" ? PEL_LUT_CURVATURE : PEL_LUT_SHADOW;
    info.curvature.width = info.shadow.width = uint32_t(image.width);
    info.curvature.height = info.shadow.height = uint32_t(image.height);
    visitNumbers(info,
                 [&](const char* name, float& value) { value = need(name, static_cast<float*>(nullptr)); });
    try {
        return Lut(device, info, image.interleaved(rgb));
    } catch (const Error& e) {
        throw FileError(path, e.what());
    }
}

}  // namespace pellucid::io
