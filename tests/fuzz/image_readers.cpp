#include <OpenImageIO/imageio.h>

#include <boost/crc.hpp>

#include "fuzz/readers.h"
#include "io/image/image_file.h"
#include "io/lut/lut_exr.h"
#include "io/lut/lut_file.h"

namespace fuzz {

using namespace pellucid;

namespace {

std::string parts(const Folder& folder) {
    const std::string file = folder / "parts.exr";
    std::vector<OIIO::ImageSpec> specs(2, OIIO::ImageSpec(9, 7, 3, OIIO::TypeDesc::HALF));
    specs[0].attribute("oiio:subimagename", "colour");
    specs[1].attribute("oiio:subimagename", "normal");
    const std::vector<float> pixels(9 * 7 * 3, 0.25f);
    auto out = OIIO::ImageOutput::create(file);
    out->open(file, 2, specs.data());
    out->write_image(OIIO::TypeDesc::FLOAT, pixels.data());
    out->open(file, specs[1], OIIO::ImageOutput::AppendSubimage);
    out->write_image(OIIO::TypeDesc::FLOAT, pixels.data());
    out->close();
    return bytesOf(file);
}

// CRC of each chunk [PNG Specification 1.2, annex D].
std::string mendPng(std::string b) {
    for (size_t at = 8; b.size() - std::min(at, b.size()) >= 12;) {
        uint32_t length = 0;
        for (size_t i = 0; i < 4; ++i) length = length << 8 | uint8_t(b[at + i]);
        if (length > b.size() - at - 12) break;
        boost::crc_32_type crc;
        crc.process_bytes(&b[at + 4], 4 + length);
        for (size_t i = 0; i < 4; ++i) b[at + 8 + length + i] = char(crc.checksum() >> (24 - 8 * i));
        at += 12 + length;
    }
    return b;
}

Reader image(const std::string& extension, std::vector<std::string> seeds) {
    return {extension,
            std::move(seeds),
            [file = "i." + extension](const std::string& bytes) {
                const io::Image image = io::decodeImage(file, bytes);
                for (const io::Channel& c : image.channels)
                    if (c.pixels.size() != image.pixelCount())
                        throw std::logic_error("a channel of another size");
            },
            extension == "png" ? mendPng : std::function<std::string(std::string)>(),
            {}};
}

std::string smallLut(const Folder& folder, const Lut& lut) {
    io::writeLut(folder / "t.exr", lut);
    return bytesOf(folder / "t.exr");
}

}  // namespace

std::string picture(const Folder& folder, const std::string& extension, int channels, const std::string& how,
                    int tile, const char* type) {
    const std::string file = folder / ("p." + extension);
    OIIO::ImageSpec spec(19, 13, channels, OIIO::TypeDesc(type));
    if (!how.empty()) spec.attribute("compression", how);
    if (tile) spec.tile_width = spec.tile_height = tile;
    spec.attribute("DateTime", "");
    std::vector<float> pixels(size_t(19 * 13) * size_t(channels));
    for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = float(i * 37 % 101) / 101;
    auto out = OIIO::ImageOutput::create(file);
    if (!out || !out->open(file, spec) || !out->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) ||
        !out->close())
        throw std::runtime_error("no seed " + extension + " " + how + ": " + OIIO::geterror());
    return bytesOf(file);
}

void addImages(std::vector<Reader>& all, const Folder& folder) {
    std::vector<std::string> exrs = {parts(folder), picture(folder, "exr", 4, "zip", 8, "half")};
    for (const char* how : {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"}) {
        exrs.push_back(picture(folder, "exr", 3, how, 0, "half"));
        exrs.push_back(picture(folder, "exr", 1, how, 0, "float"));
    }
    all.push_back(image("exr", exrs));
    all.push_back(image("png", {picture(folder, "png", 1), picture(folder, "png", 3),
                                picture(folder, "png", 4, "", 0, "uint16")}));
    all.push_back(image("jpg", {picture(folder, "jpg", 1), picture(folder, "jpg", 3)}));
    all.push_back(image(
        "tga", {picture(folder, "tga", 1), picture(folder, "tga", 3, "rle"), picture(folder, "tga", 4)}));
    all.push_back(
        image("bmp", {picture(folder, "bmp", 1), picture(folder, "bmp", 3), picture(folder, "bmp", 4)}));
}

Reader table(const Folder& folder, const Device& device) {
    PelCurvatureLutDesc c = pelCurvatureLutDescFaceWorks();
    PelShadowLutDesc s = pelShadowLutDescFaceWorks();
    c.width = c.height = s.width = s.height = 8;
    const Lut curvature(device, c);
    const std::vector<uint16_t> halves = curvature.read<uint16_t>(PEL_LUT_HALF);
    const std::string batch =
        io::encodeLutExr(curvature.info(), PEL_LUT_HALF,
                         {reinterpret_cast<const char*>(halves.data()), 2 * halves.size()}, "key");
    return {"table",
            {smallLut(folder, curvature), smallLut(folder, Lut(device, s)), batch},
            [](const std::string& bytes) {
                io::verifyLutExr(bytes, "key");
                io::decodeLut("t.exr", bytes);
            },
            {},
            {"pellucid:kind", "curvature", "shadow", "specular", "arc", "pellucid:checksum"}};
}

}  // namespace fuzz
