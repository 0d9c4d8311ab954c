// Hostile images: other formats under a known name, impossible sizes, false headers.
#include <OpenImageIO/imageio.h>
#include <sys/resource.h>

#include "io/image/image_file.h"
#include "io/image/image_format.h"
#include "io/lut/lut_file.h"
#include "io_files.h"

using namespace pellucid;
using namespace pellucid::io;

namespace {

// An EXR of one pixel whose header can be modified.
struct Exr {
    int data[4] = {0, 0, 0, 0}, display[4] = {0, 0, 0, 0};
    std::vector<std::string> channels{"B", "G", "R"};
    int sampling = 1;
    uint32_t flags = 0;
    std::vector<uint32_t> tile;
    std::string more;  // attributes

    static std::string word(uint32_t v) { return std::string(reinterpret_cast<const char*>(&v), 4); }
    static std::string attribute(const std::string& name, const std::string& type, const std::string& value) {
        return name + '\0' + type + '\0' + word(uint32_t(value.size())) + value;
    }
    std::string bytes() const {
        std::string list, file = word(20000630) + word(2 | flags | (tile.empty() ? 0 : 0x200));
        for (const std::string& c : channels)
            list += c + '\0' + word(2) + word(0) + word(uint32_t(sampling)) + word(uint32_t(sampling));
        file += attribute("channels", "chlist", list + '\0') +
                attribute("compression", "compression", std::string(1, '\0'));
        const auto box = [](const int(&b)[4]) { return std::string(reinterpret_cast<const char*>(b), 16); };
        const std::string one = word(std::bit_cast<uint32_t>(1.0f));
        file += attribute("dataWindow", "box2i", box(data)) +
                attribute("displayWindow", "box2i", box(display)) +
                attribute("lineOrder", "lineOrder", std::string(1, '\0')) +
                attribute("pixelAspectRatio", "float", one) +
                attribute("screenWindowCenter", "v2f", word(0) + word(0)) +
                attribute("screenWindowWidth", "float", one);
        if (!tile.empty())
            file += attribute("tiles", "tiledesc", word(tile[0]) + word(tile[1]) + std::string(1, '\0'));
        file += more + '\0';
        file += word(uint32_t(file.size() + 8)) + word(0);
        file += tile.empty() ? word(uint32_t(data[1])) : word(0) + word(0) + word(0) + word(0);
        return file + word(uint32_t(4 * channels.size())) + std::string(4 * channels.size(), '\0');
    }
};

class HostileImage : public FolderTest {
  protected:
    // The error message, which must take less than 64 MiB of additional memory.
    std::string refusal(const std::string& name, const std::string& bytes,
                        uint64_t limit = inputLimit()) const {
        const double before = peak();
        const std::string message = messageOf<FileError>([&] { decodeImage(name, bytes, {}, limit); });
        EXPECT_LT(peak() - before, 64) << name << " took MiB";
        return message;
    }
    static double peak() {
        rusage usage{};
        ::getrusage(RUSAGE_SELF, &usage);
        return double(usage.ru_maxrss) / 1024;
    }
    // As OpenImageIO writes it, under its own extension; "" where this build of it cannot.
    std::string written(const std::string& extension, int channels = 3) const {
        constexpr int side = 8;
        const std::string file = path("w." + extension);
        OIIO::ImageSpec spec(side, side, channels, OIIO::TypeDesc::UINT8);
        spec.attribute("oiio:UnassociatedAlpha", 1);  // the bytes as they are
        auto out = OIIO::ImageOutput::create(file);
        std::vector<uint8_t> pixels(size_t(side) * size_t(side) * size_t(channels));
        for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = uint8_t(7 * i);
        const bool ok = out && out->open(file, spec) &&
                        out->write_image(OIIO::TypeDesc::UINT8, pixels.data()) && out->close();
        if (!ok) return "";
        return read(file);
    }
};

}  // namespace

TEST_F(HostileImage, TheFormatsThatAreNamedAreRead) {
    for (const char* extension : {"png", "jpg", "jpeg", "tga", "bmp", "exr"}) {
        const std::string bytes = written(extension);
        const Image image = decodeImage(std::string("a.") + extension, bytes);
        EXPECT_EQ(image.width, 8);
        ASSERT_EQ(image.channels.size(), 3u) << extension;
        EXPECT_NEAR(image.channels[1].pixels[1], 28 / 255.0, 0.1) << extension;
    }
    // Colours stay as they are stored, whatever alpha says.
    for (const char* extension : {"png", "tga"}) {
        const Image image = decodeImage(std::string("a.") + extension, written(extension, 4));
        ASSERT_EQ(image.channels.size(), 4u) << extension;
        EXPECT_NEAR(image.channel("G").pixels[1], 35 / 255.0, 1e-6) << extension;
    }
}

TEST_F(HostileImage, OtherFormatsAreRefusedWhateverTheirName) {
    for (const char* extension :
         {"fits", "dpx", "hdr", "iff", "rla", "sgi", "tif", "pnm", "gif", "webp", "ico", "zfile"}) {
        const std::string bytes = written(extension);
        if (bytes.empty()) continue;  // not in every build of OpenImageIO
        EXPECT_TRUE(contains(refusal(std::string("a.") + extension, bytes),
                             "known here: .exr, .png, .jpg, .jpeg, .tga, .bmp"));
        for (const char* name : {"a.exr", "a.png", "a.jpg", "a.bmp"})
            EXPECT_TRUE(contains(refusal(name, bytes), "although its name says")) << extension;
        EXPECT_NE(refusal("a.tga", bytes), "") << extension;
    }
    EXPECT_TRUE(contains(refusal("a.exr", written("png")),
                         "is not OpenEXR, although its name says so: its content is PNG"));
    EXPECT_TRUE(contains(refusal("a.png", Exr().bytes()), "its content is OpenEXR"));
    EXPECT_TRUE(contains(refusal("a.exr", ""), "its beginning is another"));
    EXPECT_TRUE(contains(refusal("a", Exr().bytes()), "has no extension"));
}

// Sizes are checked before anything is allocated.
TEST_F(HostileImage, HeadersThatLie) {
    ASSERT_EQ(refusal("a.exr", Exr().bytes()), "");
    const auto chunks = [](uint32_t count) {
        return [count](Exr& e) { e.more = Exr::attribute("chunkCount", "int", Exr::word(count)); };
    };
    const struct {
        std::function<void(Exr&)> edit;
        const char* message;
    } rows[] = {
        {chunks(0), "a.exr: is damaged or cut off: its attribute chunkCount"},
        {chunks(uint32_t(-1)), "its attribute chunkCount"},
        {chunks(1u << 31), "its attribute chunkCount"},
        {chunks((1u << 31) - 1), "its attribute chunkCount"},
        {[](Exr& e) { e.channels.assign(50, "c"), e.display[2] = e.display[3] = 4095; },
         "4096 x 4096 pixels (1 x 1 of them stored) of 50 channels take 3200.0 MiB, more than the limit of "
         "2048 MiB"},
        {[](Exr& e) { e.display[2] = e.display[3] = 19999; },
         "20000 x 20000 pixels (1 x 1 of them stored) of 3 channels take 4577.6 MiB"},
        {[](Exr& e) { e.data[2] = e.data[3] = 29999; }, "take 10299.7 MiB"},
        {[](Exr& e) { e.data[3] = 99999; }, "too short for 1 x 100000 pixels"},
        {[](Exr& e) { e.data[2] = -1; }, "a window of 0 x 1"},
        {[](Exr& e) { e.data[0] = INT32_MIN; }, "a window of"},
        {[](Exr& e) { e.data[2] = INT32_MAX; }, "a window of"},
        {[](Exr& e) { e.display[0] = INT32_MIN, e.display[2] = INT32_MAX; }, "a window of"},
        {[](Exr& e) { e.channels.clear(); }, "no channels"},
        {[](Exr& e) { e.channels.assign(2000, "c"); }, "more than 1024 channels"},
        {[](Exr& e) { e.sampling = 2; }, "in another resolution"},
        {[](Exr& e) { e.flags = 0x800; }, "deep pixels"},
        {[](Exr& e) {
             e.tile = {0, 16};
         },
         "tiles are empty"},
        {[](Exr& e) {
             e.tile = {1u << 31, 1u << 31};
         },
         "more than the limit"},
        {[](Exr& e) { e.more = Exr::attribute("dataWindow", "box2i", "short"); }, "is not a box2i"},
        {[](Exr& e) {
             e.more = Exr::attribute("dataWindow", "box2i",
                                     Exr::word(UINT32_MAX) + Exr::word(0) + std::string(8, '\x3f'));
         },
         "more than the limit"},
        {[](Exr& e) { e.more = Exr::attribute("type", "string", "deepscanline"); }, "deep pixels"},
        {[](Exr& e) { e.more = Exr::attribute("compression", "compression", "\x4d"); },
         "has compression 77, which is not supported"},
        {[](Exr& e) { e.more = "x"; }, "is damaged or cut off"},
    };
    for (const auto& row : rows) {
        Exr exr;
        row.edit(exr);
        EXPECT_TRUE(contains(refusal("a.exr", exr.bytes()), row.message));
    }
    // A limit can be set.
    Exr large;
    large.display[2] = large.display[3] = 999;
    EXPECT_TRUE(contains(refusal("a.exr", large.bytes(), 1 << 20),
                         "take 11.4 MiB, more than the limit of 1 MiB (PELLUCID_INPUT_LIMIT_MIB raises it)"));
    EXPECT_EQ(refusal("a.exr", large.bytes(), 12 << 20), "");
    for (size_t cut = 0; cut < Exr().bytes().size(); ++cut)
        EXPECT_NE(refusal("a.exr", Exr().bytes().substr(0, cut)), "") << cut;
}

TEST_F(HostileImage, AttributesEndWithTheFile) {
    const std::string start(ExrAttributes::start, ' '),
        whole = start + Exr::attribute("name", "type", "four");
    const auto found = ExrAttributes(whole).next();
    ASSERT_TRUE(found);
    EXPECT_EQ(found->value, "four");
    for (size_t length = start.size(); length < whole.size(); ++length)
        EXPECT_FALSE(ExrAttributes(std::string_view(whole).substr(0, length)).next()) << length;
}

TEST_F(HostileImage, SizesInOtherHeadersToo) {
    const auto with = [](std::string bytes, size_t at, const std::string& what) {
        return bytes.replace(at, what.size(), what);
    };
    const std::string huge("\x00\x00\xea\x60", 4);  // 60000, big-endian
    const std::string jpeg = written("jpg");
    const size_t frame = jpeg.find("\xff\xc0");
    ASSERT_NE(frame, std::string::npos);
    // A map of two colours, one byte a pixel; a map of none is no map.
    const auto mapped = [](char colors, char bits = 24) {
        const char header[] = {0, 1, 1, 0, 0, colors, 0, bits, 0, 0, 0, 0, 2, 0, 1, 0, 8, 0x20};
        return std::string(header, sizeof header) + std::string("\1\2\3\4\5\6", 6) + std::string("\0\1", 2);
    };
    EXPECT_EQ(refusal("m.tga", mapped(2)), "");
    for (const auto& [name, bytes, message] :
         {std::tuple{"a.png", with(written("png"), 16, huge + huge),
                     "60000 x 60000 pixels of 4 channels take"},
          {"a.png", with(written("png"), 16, std::string(8, '\0')), "a.png"},
          {"a.tga", with(written("tga"), 12, "\x60\xea\x60\xea"), "60000 x 60000 pixels"},
          {"a.tga", with(written("tga"), 12, std::string("\0\x10\0\x10", 4)), "too short for its pixels"},
          {"m.tga", mapped(0), "is not a TGA of a known kind"},
          {"m.tga", mapped(2, 8), "is not a TGA of a known kind"},
          {"a.bmp", with(written("bmp"), 18, std::string("\x60\xea\0\0\x60\xea\0\0", 8)),
           "60000 x 60000 pixels"},
          {"a.jpg", with(jpeg, frame + 5, "\xea\x60\xea\x60"), "60000 x 60000 pixels of 3 channels"}})
        EXPECT_TRUE(contains(refusal(name, bytes), message));
    for (const char* extension : {"png", "jpg", "tga", "bmp"}) {
        const std::string bytes = written(extension);
        for (size_t cut = 0; cut < std::min<size_t>(bytes.size() / 2, 200); ++cut)
            EXPECT_NE(refusal(std::string("a.") + extension, bytes.substr(0, cut)), "")
                << extension << " of " << cut << " bytes";
    }
}

// A thumbnail behind the end of the file, to which the footer leads.
TEST_F(HostileImage, TheFooterOfATgaIsNotFollowed) {
    const std::string picture = written("tga"), end("TRUEVISION-XFILE.\0", 18);
    const size_t body = picture.ends_with(end) ? picture.size() - 26 : picture.size();
    std::string extension = Exr::word(495) + std::string(491, '\0');
    extension.replace(0, 2, "\xef\x01", 2), extension.replace(486, 4, Exr::word(uint32_t(body) + 490));
    const Image expected = decodeImage("a.tga", picture, {}, inputLimit());
    for (const uint32_t at : {uint32_t(body), uint32_t(1) << 30}) {
        const std::string file = picture.substr(0, body) + extension + Exr::word(at) + Exr::word(0) + end;
        EXPECT_EQ(decodeImage("a.tga", file, {}, inputLimit()).channels[0].pixels,
                  expected.channels[0].pixels);
    }
}

TEST_F(HostileImage, ATableIsOneBeforeItsPixelsAreRead) {
    Exr exr;
    exr.display[2] = exr.display[3] = 9999;
    const std::string large = exr.bytes();
    EXPECT_TRUE(
        contains(messageOf<FileError>([&] { decodeLut("t.exr", large); }), "more than the limit of 512 MiB"));
    exr.display[2] = exr.display[3] = 4999;
    const double before = peak();
    EXPECT_TRUE(contains(messageOf<FileError>([&] { decodeLut("t.exr", exr.bytes()); }),
                         "no attribute \"pellucid:format\""));
    EXPECT_LT(peak() - before, 64);
}
