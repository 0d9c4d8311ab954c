// PNG files by libpng: the same pixels, channels and refusals as by OpenImageIO.
#include <OpenImageIO/imageio.h>

#include "io/image/picture_library.h"
#include "io/io_files.h"

using namespace pellucid::io;

namespace {

class Png : public FolderTest {
  protected:
    // A picture of random bytes, as OpenImageIO writes it.
    std::string picture(int width, int height, int channels, OIIO::TypeDesc type) {
        const std::string file = path("p.png");
        OIIO::ImageSpec spec(width, height, channels, type);
        spec.attribute("oiio:UnassociatedAlpha", 1);
        std::mt19937 random(unsigned(width * 31 + height * 7 + channels));
        std::vector<uint16_t> values(size_t(width * height * channels));
        for (uint16_t& value : values) value = uint16_t(random());
        auto out = OIIO::ImageOutput::create(file);
        EXPECT_TRUE(out && out->open(file, spec) && out->write_image(OIIO::TypeDesc::UINT16, values.data()) &&
                    out->close());
        return read(file);
    }

    Image decoded(const PictureLibrary& library, const std::string& bytes) {
        Image image;
        image.source = "p.png";
        library.decode(image, imageFormat("p.png", bytes, uint64_t{1} << 30), {}, uint64_t{1} << 30);
        return image;
    }

    void expectSame(const std::string& bytes) {
        const Image a = decoded(pngPictures, bytes), b = decoded(pictureLibrary("p.png"), bytes);
        EXPECT_EQ(a.width, b.width);
        EXPECT_EQ(a.height, b.height);
        ASSERT_EQ(a.channels.size(), b.channels.size());
        for (size_t c = 0; c < a.channels.size(); ++c) {
            EXPECT_EQ(a.channels[c].name, b.channels[c].name);
            ASSERT_EQ(a.channels[c].pixels.size(), b.channels[c].pixels.size());
            for (size_t i = 0; i < a.channels[c].pixels.size(); ++i)
                ASSERT_NEAR(a.channels[c].pixels[i], b.channels[c].pixels[i], 1e-6) << c << " " << i;
        }
    }
};

}  // namespace

TEST_F(Png, ReadsWhatOpenImageIoReads) {
    for (const int channels : {1, 2, 3, 4})
        for (const OIIO::TypeDesc type : {OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16})
            for (const auto& [width, height] : {std::pair{1, 1}, {17, 5}, {64, 33}}) {
                SCOPED_TRACE(testing::Message() << channels << " channels of " << type.c_str() << ", "
                                                << width << " x " << height);
                expectSame(picture(width, height, channels, type));
            }
}

TEST_F(Png, WritesTheSamePixels) {
    for (const int channels : {1, 3, 4})
        for (const bool srgb : {false, true}) {
            std::vector<uint8_t> pixels(size_t(13 * 7 * channels));
            for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = uint8_t(i * 37);
            const std::string bytes = pngPictures.encode("p.png", 13, 7, channels, pixels, srgb);
            EXPECT_EQ(bytes.find("sRGB") != std::string::npos, srgb);
            expectSame(bytes);
            const Image image = decoded(pngPictures, bytes);
            for (size_t i = 0; i < pixels.size(); ++i)
                ASSERT_EQ(
                    std::lround(image.channels[i % size_t(channels)].pixels[i / size_t(channels)] * 255),
                    pixels[i]);
        }
}

TEST_F(Png, ADamagedFileIsAnError) {
    const std::string whole = picture(40, 30, 3, OIIO::TypeDesc::UINT8);
    EXPECT_NO_THROW(decoded(pngPictures, whole));
    size_t refused = 0;
    for (size_t at = 8; at < whole.size(); at += 7) {
        std::string damaged = whole;
        damaged[at] = char(damaged[at] ^ 0x55);
        refused += messageOf<FileError>([&] { decoded(pngPictures, damaged); }) != "";
        EXPECT_THROW(decoded(pngPictures, whole.substr(0, at)), FileError) << at;
    }
    EXPECT_GT(refused, whole.size() / 7 * 3 / 4);
}

TEST_F(Png, OtherPicturesAreRefusedWithWhatCanBeRead) {
    Image image;
    image.source = "p.jpg";
    const ImageFormat jpeg{"jpeg", "\xff\xd8\xff"};
    EXPECT_TRUE(contains(messageOf<FileError>([&] { pngPictures.decode(image, jpeg, {}, 1 << 20); }),
                         "PNG, EXR and NPY"));
}
