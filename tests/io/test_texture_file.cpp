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
    static void expectWords(const std::string& bytes, const std::vector<std::pair<size_t, uint32_t>>& words) {
        for (const auto& [at, value] : words) EXPECT_EQ(word(bytes, at), value) << "at byte " << at;
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
    // Own size, height, width, bytes of a row, size of the pixel format, R16G16B16A16_FLOAT, a 2D texture.
    expectWords(bytes, {{4, 124}, {12, 3}, {16, 5}, {20, 40}, {76, 32}, {128, 10}, {132, 3}});
    expectTexels(bytes, 148, lut);
    EXPECT_THROW(io::writeLut(path("u.dds"), lut, PEL_LUT_FLOAT), std::invalid_argument);
}

TEST_F(TextureFile, Ktx2) {
    const Lut lut = table();
    io::writeLut(path("t.ktx2"), lut);
    const std::string bytes = read(path("t.ktx2"));
    EXPECT_EQ(bytes.substr(0, 12), std::string("\xABKTX 20\xBB\r\n\x1A\n", 12));
    // VK_FORMAT_R16G16B16A16_SFLOAT, bytes of a component, width, height, faces, levels, the descriptor's
    // place and its own length, the pairs behind it, bytes of texels.
    const uint32_t length = word(bytes, 52), pairs = 104 + length;
    expectWords(bytes, {{12, 97},
                        {16, 2},
                        {20, 5},
                        {24, 3},
                        {36, 1},
                        {40, 1},
                        {48, 104},
                        {104, length},
                        {56, pairs},
                        {88, 120}});
    const std::string text = bytes.substr(pairs, word(bytes, 60));
    EXPECT_TRUE(contains(text, std::string("pellucid:form\0arc", 17)));
    EXPECT_TRUE(contains(text, std::string("pellucid:axis\0linear", 20)));
    EXPECT_EQ(word(bytes, 80) % 8, 0u);
    expectTexels(bytes, word(bytes, 80), lut);
}
