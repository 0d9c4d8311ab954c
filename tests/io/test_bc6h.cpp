// BC6H: what the format can hold comes back exactly, everything else within what its numbers allow. Readers
// that are not ours: OpenImageIO here, Python's in tests/foreign.
#include <OpenImageIO/imageio.h>

#include "io/image/texture_file.h"
#include "io/lut/bc6h_block.h"
#include "io/lut/lut_file.h"
#include "io_files.h"

using namespace pellucid;
using io::TexelError;

namespace {

using Halves = std::vector<uint16_t>;

Halves table(uint32_t width, uint32_t height, PelLutAxis axis = PEL_AXIS_LINEAR) {
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = width;
    desc.height = height;
    desc.axis = axis;
    return Lut(Device(""), desc).read<uint16_t>(PEL_LUT_HALF);
}

TexelError errorOf(uint32_t width, uint32_t height, const Halves& texels) {
    return io::differenceOf(texels, io::decodeBc6h(width, height, io::encodeBc6h(width, height, texels)));
}

}  // namespace

TEST(Bc6h, EveryModeIsReadAsItIsWritten) {
    std::mt19937 random(1);
    std::set<int> modes;
    size_t written = 0;
    for (int i = 0; i < 20000; ++i) {
        io::bc6h::Bytes bytes;
        for (uint8_t& b : bytes) b = uint8_t(random());
        bytes[0] |= 3;  // as in all modes with one line
        const auto block = io::bc6h::unpack(bytes);
        if (!block) {
            EXPECT_EQ(bytes[0] & 0x13, 0x13) << "only these codes are reserved";
            continue;
        }
        modes.insert(block->mode);
        if (!io::bc6h::fitsMode(io::bc6h::modes[block->mode], block->ends)) continue;  // wrapped round
        ++written;
        EXPECT_EQ(io::bc6h::pack(*block), bytes) << "mode " << block->mode;
    }
    EXPECT_EQ(modes.size(), 4u);
    EXPECT_GT(written, 5000u);
}

TEST(Bc6h, AConstantIsExact) {
    for (uint16_t half : {0x0000, 0x0001, 0x2E66, 0x3800, 0x3BFF, 0x3C00, 0x5640, 0x7BFF}) {
        const Halves texels(16 * 3, half);
        EXPECT_EQ(io::decodeBc6h(4, 4, io::encodeBc6h(4, 4, texels)), texels) << half;
    }
}

TEST(Bc6h, TwoColoursAreExactInAnyPattern) {
    for (int pattern = 1; pattern < 0xffff; pattern += 2047) {
        Halves texels;
        for (int i = 0; i < 16; ++i)  // values that 10 bits hold
            for (int c = 0; c < 3; ++c) {
                const int q = pattern >> i & 1 ? 320 + 48 * c : 640 - 112 * c;
                texels.push_back(io::bc6h::halfOf(io::bc6h::unquantised(q, 10)));
            }
        EXPECT_EQ(io::decodeBc6h(4, 4, io::encodeBc6h(4, 4, texels)), texels) << "pattern " << pattern;
    }
}

// But for the first one, whose index has a bit less.
TEST(Bc6h, ThePlaceOfATexelDoesNotMatter) {
    std::mt19937 random(5);
    const auto exchanged = [](Halves texels, int one, int other) {
        std::swap_ranges(&texels[3 * size_t(one)], &texels[3 * size_t(one) + 3], &texels[3 * size_t(other)]);
        return texels;
    };
    const auto kept = [](const Halves& texels) { return io::decodeBc6h(4, 4, io::encodeBc6h(4, 4, texels)); };
    int same = 0;
    for (int i = 0; i < 100; ++i) {
        Halves texels(16 * 3);
        for (uint16_t& half : texels) half = uint16_t(0x3400 + random() % 0x800);
        const int one = 1 + i % 14;
        same += kept(exchanged(texels, one, 15)) == exchanged(kept(texels), one, 15);
    }
    EXPECT_GE(same, 95) << "sums in another order may choose another block of the same error";
}

TEST(Bc6h, TablesKeepTheirValues) {
    for (PelLutAxis axis : {PEL_AXIS_LINEAR, PEL_AXIS_ROOT}) {
        const TexelError small = errorOf(64, 64, table(64, 64, axis)),
                         large = errorOf(128, 128, table(128, 128, axis));
        EXPECT_LE(small.max, tolerance::bc6hMax);
        EXPECT_LE(small.rms, tolerance::bc6hRms);
        EXPECT_LT(large.rms, 0.8 * small.rms) << "smoother blocks are better held";
    }
}

TEST(Bc6h, AnySizeAndTheSameBytesEachTime) {
    for (const auto& [w, h] : {std::pair{1u, 1u}, {5u, 3u}, {4u, 7u}, {17u, 2u}}) {
        const Halves texels = table(w, h);
        const auto bytes = io::encodeBc6h(w, h, texels);
        EXPECT_EQ(bytes.size(), size_t((w + 3) / 4) * ((h + 3) / 4) * 16);
        EXPECT_EQ(io::encodeBc6h(w, h, texels), bytes);
        EXPECT_EQ(io::decodeBc6h(w, h, bytes).size(), texels.size());
    }
    EXPECT_LT(errorOf(1, 1, table(1, 1)).max, 1e-9) << "one texel is a constant";
}

TEST(Bc6h, NegativeNanAndInfinityBecomeNumbers) {
    const Halves texels = {0xBC00, 0x7E00, 0x7C00, 0xFC00, 0x8000, 0x3C00};  // -1, NaN, inf; -inf, -0, 1
    EXPECT_EQ(io::decodeBc6h(2, 1, io::encodeBc6h(2, 1, texels)), (Halves{0, 0, 0x7BFF, 0, 0, 0x3C00}));
}

class Bc6hFile : public FolderTest {};

// What OpenImageIO reads from a DDS file, with its own decoder: three floats per texel, if it knows BC6H.
std::vector<float> foreignTexels(const std::string& path, int width, int height) {
    const auto input = OIIO::ImageInput::open(path);
    if (!input) return {};
    EXPECT_EQ(input->spec().width, width);
    EXPECT_EQ(input->spec().height, height);
    EXPECT_EQ(input->spec().nchannels, 3);
    std::vector<float> texels(size_t(width) * size_t(height) * 3);
    EXPECT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, texels.data())) << input->geterror();
    return texels;
}

void expectSame(const std::vector<float>& found, const Halves& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) ASSERT_EQ(found[i], io::bc6h::linearValue(expected[i])) << i;
}

TEST_F(Bc6hFile, OpenImageIoReadsTheSame) {
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = 34;
    desc.height = 27;
    const Lut lut(Device(""), desc);
    const TexelError error = io::writeLutBc6h(path("t.dds"), lut);
    const Halves texels = lut.read<uint16_t>(PEL_LUT_HALF);
    const Halves expected = io::decodeBc6h(34, 27, io::encodeBc6h(34, 27, texels));
    EXPECT_EQ(error.max, io::differenceOf(texels, expected).max);
    EXPECT_EQ(error.rms, io::differenceOf(texels, expected).rms);
    EXPECT_EQ(io::differenceOf(texels, texels).rms, 0);
    // 1 of 4 values is off by 1/2.
    EXPECT_EQ(
        io::differenceOf(Halves{0x3c00, 0x3c00, 0x3c00, 0x3c00}, Halves{0x3c00, 0x3800, 0x3c00, 0x3c00}).rms,
        0.25);
    const std::vector<float> found = foreignTexels(path("t.dds"), 34, 27);
    if (found.empty()) GTEST_SKIP() << "this OpenImageIO reads no BC6H: " << OIIO::geterror();
    expectSame(found, expected);
}

// Blocks that our encoder would never write: random bits in its four modes, and in the black reserved ones.
TEST_F(Bc6hFile, OpenImageIoReadsRandomBlocksOfEveryMode) {
    constexpr int across = 32, down = 8 * 4;  // a row of blocks for each code, four times
    constexpr uint8_t codes[] = {0x03, 0x07, 0x0B, 0x0F, 0x13, 0x17, 0x1B, 0x1F};
    std::mt19937 random(7);
    std::vector<uint8_t> blocks(size_t(across) * down * 16);
    std::set<int> modes;
    for (size_t b = 0; b < blocks.size() / 16; ++b) {
        io::bc6h::Bytes bytes;
        for (uint8_t& byte : bytes) byte = uint8_t(random());
        bytes[0] = uint8_t((bytes[0] & ~31) | codes[b / across % std::size(codes)]);
        if (const auto block = io::bc6h::unpack(bytes)) modes.insert(block->mode);
        std::copy(bytes.begin(), bytes.end(), blocks.begin() + std::ptrdiff_t(16 * b));
    }
    EXPECT_EQ(modes.size(), 4u);
    io::writeDds(path("r.dds"), {io::Texture::Format::Bc6hUnsigned, 4 * across, 4 * down, blocks});
    const std::vector<float> found = foreignTexels(path("r.dds"), 4 * across, 4 * down);
    if (found.empty()) GTEST_SKIP() << "this OpenImageIO reads no BC6H: " << OIIO::geterror();
    expectSame(found, io::decodeBc6h(4 * across, 4 * down, blocks));
}
