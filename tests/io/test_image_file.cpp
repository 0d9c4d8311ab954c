// host/io/image/image_file.h: EXR round trips to the bit, parts and data windows, look-up by name, 8-bit
// files. The two ways of reading OpenEXR files give the same values: scan lines without compression,
// with RLE and with ZIP by the C library, all others by the C++ one.
#include <OpenImageIO/imageio.h>

#include "io/image/image_file.h"
#include "io_files.h"

using namespace pellucid::io;

namespace {

class ImageFile : public FolderTest {};

bool sameBits(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), 4 * a.size()) == 0;
}

// As OpenImageIO writes it.
void writeForeign(const std::string& file, const OIIO::ImageSpec& spec, OIIO::TypeDesc type,
                  const void* pixels) {
    const auto out = OIIO::ImageOutput::create(file);
    ASSERT_TRUE(out && out->open(file, spec) && out->write_image(type, pixels) && out->close());
}

Image makeImage(int width, int height) {
    Image image;
    image.width = width;
    image.height = height;
    return image;
}

constexpr int width = 37, height = 70;  // more than two chunks of ZIP, more than one band

class ExrLines : public ImageFile {
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
        writeForeign(file, spec, OIIO::TypeDesc::UNKNOWN, pixels.data());
        return file;
    }
};

}  // namespace

TEST_F(ImageFile, ExrKeepsBitsTypesAndAttributes) {
    Image image = makeImage(4, 3);
    const float nan = std::bit_cast<float>(0x7fc12345u), inf = std::numeric_limits<float>::infinity();
    const std::vector<float> awkward = {0.0f, -0.0f, 1e-45f, 1.17549435e-38f, 3.4028235e38f, inf,
                                        -inf, nan,   0.1f,   -7.0f / 3.0f,    65504.0f,      1e10f};
    image.channels = {{"View.Z", ChannelType::Float, awkward},
                      {"View.A", ChannelType::Half, std::vector<float>(12, 6.1035156e-05f)},
                      {"View.H", ChannelType::Half, awkward}};
    image.attributes = {{"pellucid:form", std::string("arc")},
                        {"pellucid:radiusMin", 1.25f},
                        {"pellucid:version", 3},
                        {"pellucid:axes", std::vector<float>{1, 2, 3}},
                        {"pellucid:matrix", std::vector<float>(16, 0.5f)}};
    writeExr(path("a.exr"), image);
    EXPECT_EQ(filesInFolder(), 1u);
    const Image again = readImage(path("a.exr"));
    ASSERT_EQ(again.width, 4);
    ASSERT_EQ(again.height, 3);
    ASSERT_EQ(again.channels.size(), 3u);
    EXPECT_TRUE(sameBits(again.channel("View.Z").pixels, awkward));
    EXPECT_TRUE(sameBits(again.channel("A").pixels, image.channels[1].pixels));
    EXPECT_EQ(again.channel("Z").type, ChannelType::Float);
    EXPECT_EQ(again.channel("A").type, ChannelType::Half);
    const std::vector<float>& halves = again.channel("H").pixels;
    EXPECT_EQ(halves[8], 0.0999755859375f);  // the half nearest to 0.1
    EXPECT_EQ(halves[10], 65504.0f);
    EXPECT_TRUE(std::isinf(halves[11]));
    EXPECT_TRUE(std::isnan(halves[7]));
    for (const auto& [name, value] : image.attributes) {
        ASSERT_NE(again.attribute(name), nullptr) << name;
        EXPECT_EQ(*again.attribute(name), value) << name;
    }
    EXPECT_EQ(again.attribute("pellucid:none"), nullptr);
}

TEST_F(ImageFile, PartsAreWalkedAndPlacedByDataWindow) {
    using namespace OIIO;
    std::vector<ImageSpec> specs(2, ImageSpec(3, 2, 1, TypeDesc::FLOAT));
    for (ImageSpec& spec : specs) {
        spec.full_x = spec.full_y = 10;
        spec.full_width = spec.full_height = 4;
        spec.channelnames = {"Z"};
    }
    specs[0].attribute("oiio:subimagename", "near");
    specs[1].attribute("oiio:subimagename", "far");
    specs[0].x = 11, specs[0].y = 12;  // inside the display window
    specs[1].x = specs[1].y = 9;       // half outside it, to the left and above
    auto out = ImageOutput::create(path("p.exr"));
    ASSERT_TRUE(out->open(path("p.exr"), 2, specs.data()));
    const float near[6] = {1, 2, 3, 4, 5, 6}, far[6] = {10, 20, 30, 40, 50, 60};
    ASSERT_TRUE(out->write_image(TypeDesc::FLOAT, near));
    ASSERT_TRUE(out->open(path("p.exr"), specs[1], ImageOutput::AppendSubimage));
    ASSERT_TRUE(out->write_image(TypeDesc::FLOAT, far));
    ASSERT_TRUE(out->close());

    const Image image = readImage(path("p.exr"));
    EXPECT_EQ(image.width, 4);
    EXPECT_EQ(image.height, 4);
    EXPECT_EQ(image.channel("near.Z").pixels,
              (std::vector<float>{0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 0, 4, 5, 6}));
    EXPECT_EQ(image.channel("far.Z").pixels,
              (std::vector<float>{50, 60, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
    EXPECT_TRUE(contains(messageOf<FileError>([&] { image.channel("Z"); }), "near.Z, far.Z"));
    EXPECT_FALSE(image.has("Z"));
}

// Bands end inside the picture: 300 rows are no multiple of any chunk or tile.
TEST_F(ImageFile, EveryCompressionIsReadAsOpenImageIoReadsIt) {
    using namespace OIIO;
    const int rows = 300;
    std::vector<float> pixels(size_t(width) * rows * 2);
    for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = std::sin(0.01f * float(i));
    for (const char* how : {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"})
        for (const int tile : {0, 16}) {
            SCOPED_TRACE(std::string(how) + " " + std::to_string(tile));
            ImageSpec spec(width, rows, 2, TypeDesc::HALF);
            spec.channelnames = {"N.X", "Z"};
            spec.attribute("compression", how);
            spec.tile_width = spec.tile_height = tile;
            writeForeign(path("c.exr"), spec, TypeDesc::FLOAT, pixels.data());
            const auto in = ImageInput::open(path("c.exr"));
            std::vector<float> expected(pixels.size());
            ASSERT_TRUE(in->read_image(0, 0, 0, 2, TypeDesc::FLOAT, expected.data()));
            const Image image = readImage(path("c.exr"));
            EXPECT_TRUE(sameBits(image.interleaved(in->spec().channelnames), expected));
        }
}

TEST_F(ImageFile, OnlyTheNamedChannelsAreRead) {
    Image image = makeImage(3, 2);
    const std::string names[] = {"View.N.X", "View.N.Y", "View.Z", "Other.Z"};
    image.addInterleaved(names, std::vector<float>(24, 0.25f));
    writeExr(path("n.exr"), image);
    const Image some = readChannels(path("n.exr"), {"N.Y", "Z", "", "missing"});
    ASSERT_EQ(some.channels.size(), 4u);  // all are known, for messages
    for (const Channel& c : some.channels)
        EXPECT_EQ(c.pixels.size(), c.name == "View.N.Y" ? 6u : 0u) << c.name;
    EXPECT_EQ(some.interleaved(std::vector<std::string>{"N.Y"}), std::vector<float>(6, 0.25f));
    EXPECT_THROW(some.interleaved(std::vector<std::string>{"View.Z"}), std::logic_error);
    EXPECT_TRUE(contains(messageOf<FileError>([&] { some.channel("Z"); }), "several"));
}

TEST_F(ImageFile, ChannelsComeByLayerAndColour) {
    Image image;
    image.width = image.height = 1;
    const std::vector<std::string> order{"B",     "A",        "Z",     "one.R", "one.G",
                                         "one.A", "one.more", "two.B", "two.X"};
    for (const size_t i : {5, 1, 8, 3, 0, 7, 2, 6, 4})
        image.channels.push_back({order[i], ChannelType::Float, {float(i)}});
    writeExr(path("order.exr"), image);
    const Image read = readImage(path("order.exr"));
    ASSERT_EQ(read.channels.size(), order.size());
    for (size_t i = 0; i < order.size(); ++i) {
        EXPECT_EQ(read.channels[i].name, order[i]);
        EXPECT_EQ(read.channels[i].pixels[0], float(i));
    }
}

TEST_F(ImageFile, ChannelsAreFoundByNameOrTheErrorListsThem) {
    Image image = makeImage(1, 1);
    image.source = "g.exr";
    const std::string names[] = {"View.N.X", "View.N.Y", "View.NN.X"};
    image.addInterleaved(names, std::vector<float>{1, 2, 3});
    EXPECT_EQ(image.channel("N.Y").pixels[0], 2.0f);
    EXPECT_EQ(image.channel("NN.X").pixels[0], 3.0f);
    const std::string both[] = {"N.Y", "View.N.X"};
    EXPECT_EQ(image.interleaved(both), (std::vector<float>{2, 1}));
    const std::string message = messageOf<FileError>([&] { image.channel("N.Z"); });
    EXPECT_TRUE(contains(message, "g.exr: has no channel 'N.Z'; it has: View.N.X, View.N.Y, View.NN.X"));
    EXPECT_TRUE(
        contains(messageOf<FileError>([&] { image.channel(""); }), "'channel' names one of: View.N.X"));
    EXPECT_TRUE(contains(messageOf<FileError>([&] { image.channel("X"); }), "several"));
    EXPECT_THROW(image.addInterleaved(names, std::vector<float>{1}), std::invalid_argument);
}

TEST_F(ImageFile, EightBitFilesKeepTheirBytes) {
    for (const char* name : {"a.png", "a.bmp", "a.tga"}) {
        for (int channels : {3, 4}) {
            std::vector<uint8_t> bytes(static_cast<size_t>(5 * 3 * channels));
            for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<uint8_t>(37 * i + 11);
            writeImage8(path(name), 5, 3, channels, bytes);
            // TGA and PNG readers multiply by alpha unless told not to.
            OIIO::ImageSpec config;
            config.attribute("oiio:UnassociatedAlpha", 1);
            const auto in = OIIO::ImageInput::open(path(name), &config);
            ASSERT_TRUE(in) << name;
            ASSERT_EQ(in->spec().nchannels, channels) << name;
            std::vector<uint8_t> again(bytes.size());
            ASSERT_TRUE(in->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, again.data()));
            EXPECT_EQ(again, bytes) << name << ' ' << channels;
        }
    }
}

TEST_F(ExrLines, GiveTheSameBitsAsTheOtherLibrary) {
    const int windows[][4] = {{0, 0, width, height}, {0, 20, width, 33}, {5, 3, 12, 60}, {-4, -9, 60, 90}};
    for (const auto& [x, y, w, h] : windows) {
        const Image other = readImage(written("piz", x, y, w, h));
        ASSERT_EQ(other.channels.size(), 5u);
        if (w == width && h == height) {
            EXPECT_EQ(other.channel("I").pixels[0], 70000);  // integers keep their values
        }
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

TEST_F(ImageFile, BadFilesAndBadTargets) {
    EXPECT_TRUE(contains(messageOf<FileError>([&] { readImage(path("no.exr")); }), "No such file"));
    EXPECT_TRUE(
        contains(messageOf<FileError>([&] { readImage(write("t.exr", "not an image")); }), "is not OpenEXR"));
    Image image = makeImage(1, 1);
    image.channels = {{"Z", ChannelType::Float, {1}}};
    EXPECT_TRUE(contains(messageOf<FileError>([&] { writeExr(path("w.jpg"), image); }), "known here: .exr"));
    EXPECT_THROW(writeExr(path("no/w.exr"), image), FileError);
    EXPECT_THROW(writeImage8(path("no/w.png"), 1, 1, 1, std::vector<uint8_t>(1)), FileError);
}
