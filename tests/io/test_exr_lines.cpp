// The two ways of reading OpenEXR files give the same values: scan lines without compression, with RLE and
// with ZIP by the C library, all others by the C++ one. Values may go anywhere.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "io/file_error.h"
#include "io/image/image_file.h"
#include "io_files.h"

using namespace pellucid::io;

namespace {

constexpr int width = 37, height = 70;  // more than two chunks of ZIP, more than one band

class ExrLines : public FolderTest {
  protected:
    // Channels of three types, the picture in a part of the display window or beyond it.
    std::string written(const std::string& compression, int x = 0, int y = 0, int w = width,
                        int h = height) const {
        const std::string file = path(compression + ".exr");
        OIIO::ImageSpec spec(w, h, 5, OIIO::TypeDesc::FLOAT);
        spec.x = x, spec.y = y;
        spec.full_width = width, spec.full_height = height;
        spec.channelnames = {"A.X", "B.X", "B.Y", "I", "Z"};
        spec.channelformats = {OIIO::TypeDesc::HALF, OIIO::TypeDesc::FLOAT, OIIO::TypeDesc::FLOAT,
                               OIIO::TypeDesc::UINT, OIIO::TypeDesc::HALF};
        spec.attribute("compression", compression);
        std::string pixels;
        const auto put = [&](auto value) {
            pixels.append(reinterpret_cast<const char*>(&value), sizeof value);
        };
        for (int i = 0; i < w * h; ++i) {
            put(uint16_t(i % 3 ? 0x3c00 + i : 0xfbff));  // to the largest half
            put(i == 5 ? NAN : i % 40 < 30 ? 0.0f : std::sin(float(i)));
            put(i == 7 ? -INFINITY : 1e-40f * float(i));  // denormals
            put(uint32_t(i % 5 ? i / 50 : 70000 + i));
            put(uint16_t(i % 7));
        }
        auto out = OIIO::ImageOutput::create(file);
        EXPECT_TRUE(out && out->open(file, spec) &&
                    out->write_image(OIIO::TypeDesc::UNKNOWN, pixels.data()) && out->close());
        return file;
    }
    static bool sameBits(const std::vector<float>& a, const std::vector<float>& b) {
        return a.size() == b.size() && !std::memcmp(a.data(), b.data(), a.size() * sizeof(float));
    }
};

TEST_F(ExrLines, GiveTheSameBitsAsTheOtherLibrary) {
    const int windows[][4] = {{0, 0, width, height}, {0, 20, width, 33}, {5, 3, 12, 60}, {-4, -9, 60, 90}};
    for (const auto& [x, y, w, h] : windows) {
        const Image other = readImage(written("piz", x, y, w, h));
        ASSERT_EQ(other.channels.size(), 5u);
        EXPECT_GT(other.channel("I").pixels[size_t((height / 2) * width + width / 3)], 0);
        for (const char* compression : {"none", "rle", "zips", "zip"}) {
            const Image image = readImage(written(compression, x, y, w, h));
            EXPECT_EQ(image.width, width);
            EXPECT_EQ(image.height, height);
            for (const Channel& c : other.channels) {
                EXPECT_TRUE(sameBits(image.channel(c.name).pixels, c.pixels)) << compression << c.name << x;
                EXPECT_EQ(image.channel(c.name).type, c.type);
                const Image one = readChannels(path(std::string(compression) + ".exr"), {c.name});
                EXPECT_TRUE(sameBits(one.channel(c.name).pixels, c.pixels)) << compression << c.name << x;
            }
        }
    }
}

TEST_F(ExrLines, ValuesGoWhereTheyAreWanted) {
    const Image whole = readImage(written("piz"));
    for (const char* compression : {"none", "rle", "zip", "piz"}) {
        std::vector<float> pairs(2 * whole.pixelCount()), alone(whole.pixelCount());
        const Image read = readChannelsTo(written(compression), [&](const Image& image) {
            EXPECT_TRUE(image.channels[1].pixels.empty());
            std::vector<Place> places(image.channels.size());
            for (size_t c = 0; c < places.size(); ++c) {
                const std::string& name = image.channels[c].name;
                if (name == "B.Y") places[c] = {&pairs[0], 2};
                if (name == "A.X") places[c] = {&pairs[1], 2};
                if (name == "I") places[c] = {alone.data(), 1};
            }
            return places;
        });
        for (const Channel& c : read.channels) EXPECT_TRUE(c.pixels.empty()) << c.name;
        const std::vector<std::string> names{"B.Y", "A.X"};
        EXPECT_TRUE(sameBits(pairs, whole.interleaved(names))) << compression;
        EXPECT_TRUE(sameBits(alone, whole.channel("I").pixels)) << compression;
    }
}

TEST_F(ExrLines, CutOffFilesAreRefused) {
    for (const char* compression : {"none", "rle", "zips", "zip"}) {
        const std::string bytes = read(written(compression));
        for (const size_t kept : {bytes.size() - 1, bytes.size() * 3 / 4, bytes.size() / 2})
            EXPECT_TRUE(contains(messageOf<FileError>([&] { decodeImage("a.exr", bytes.substr(0, kept)); }),
                                 "is damaged or cut off"))
                << compression << kept;
    }
}

}  // namespace
