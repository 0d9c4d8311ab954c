// DDS and KTX2: every header field at its place, texels as they were.
#include "io/lut/lut_file.h"
#include "io_files.h"

using namespace pellucid;

class TextureFile : public FolderTest {
  protected:
    static uint32_t word(const std::string& bytes, size_t at) {
        uint32_t value = 0;
        std::memcpy(&value, bytes.data() + at, 4);
        return value;
    }
    // The words from `begin` to before `end`: these, others are 0.
    static void expectWords(const std::string& bytes, size_t begin, size_t end,
                            std::map<size_t, uint32_t> words) {
        for (size_t at = begin; at < end; at += 4) EXPECT_EQ(word(bytes, at), words[at]) << "at byte " << at;
    }
    static Lut table() {
        PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
        desc.width = 5;
        desc.height = 3;
        return Lut(Device(""), desc);
    }
    static void expectTexels(const std::string& bytes, size_t at, const Lut& lut) {
        const auto halves = lut.read<uint16_t>(PEL_LUT_HALF);
        ASSERT_EQ(bytes.size(), at + 5 * 3 * 8);
        for (size_t i = 0; i < 15; ++i) {
            uint16_t texel[4];
            std::memcpy(texel, bytes.data() + at + 8 * i, 8);
            for (int c = 0; c < 3; ++c) EXPECT_EQ(texel[c], halves[3 * i + c]) << i;
            EXPECT_EQ(texel[3], 0x3C00) << i;
        }
    }
};

TEST_F(TextureFile, Dds) {
    const Lut lut = table();
    io::writeLut(path("t.dds"), lut);
    const std::string bytes = read(path("t.dds"));
    EXPECT_EQ(bytes.substr(0, 4), "DDS ");
    EXPECT_EQ(bytes.substr(84, 4), "DX10");
    // Own size, what is given, height, width, bytes of a row, mip levels, size of the pixel format, that it
    // has a name; a texture; R16G16B16A16_FLOAT, of two dimensions, one.
    expectWords(bytes, 4, 84,
                {{4, 124}, {8, 0x100F}, {12, 3}, {16, 5}, {20, 40}, {28, 1}, {76, 32}, {80, 4}});
    expectWords(bytes, 88, 148, {{108, 0x1000}, {128, 10}, {132, 3}, {140, 1}});
    expectTexels(bytes, 148, lut);
    EXPECT_THROW(io::writeLut(path("u.dds"), lut, PEL_LUT_FLOAT), std::invalid_argument);
}

TEST_F(TextureFile, Ktx2) {
    const Lut lut = table();
    io::writeLut(path("t.ktx2"), lut);
    const std::string bytes = read(path("t.ktx2"));
    EXPECT_EQ(bytes.substr(0, 12), std::string("\xABKTX 20\xBB\r\n\x1A\n", 12));
    // VK_FORMAT_R16G16B16A16_SFLOAT, bytes of a component, width, height, faces, levels, the descriptor's
    // place and length, those of the pairs behind it, place of texels, their bytes, twice.
    const uint32_t pairs = 196, texels = word(bytes, 80);
    expectWords(bytes, 12, 104,
                {{12, 97},
                 {16, 2},
                 {20, 5},
                 {24, 3},
                 {36, 1},
                 {40, 1},
                 {48, 104},
                 {52, 92},
                 {56, pairs},
                 {60, word(bytes, 60)},
                 {80, texels},
                 {88, 120},
                 {96, 120}});
    // Version 1.3 and length of the block; RGBSDA, BT.709, linear; 8 bytes a texel. Of R, G, B and A: place,
    // bits less one, signed float and channel; -1 to 1.
    std::map<size_t, uint32_t> descriptor{{104, 92}, {112, 88 << 16 | 2}, {116, 0x010101}, {124, 8}};
    const uint32_t samples[] = {0xC00F0000, 0xC10F0010, 0xC20F0020, 0xCF0F0030};
    for (size_t k = 0; k < 4; ++k) {
        descriptor[132 + 16 * k] = samples[k];
        descriptor[140 + 16 * k] = 0xBF800000, descriptor[144 + 16 * k] = 0x3F800000;
    }
    expectWords(bytes, 104, pairs, descriptor);
    const std::string text = bytes.substr(pairs, word(bytes, 60));
    EXPECT_TRUE(contains(text, std::string("pellucid:form\0arc", 17)));
    EXPECT_TRUE(contains(text, std::string("pellucid:axis\0linear", 20)));
    EXPECT_EQ(texels, (pairs + word(bytes, 60) + 7) / 8 * 8);
    expectTexels(bytes, texels, lut);
}
