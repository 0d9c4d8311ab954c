// DDS and KTX2: every header field at its place, texels as they were.
#include <gtest/gtest.h>

#include <cstring>

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
    EXPECT_EQ(word(bytes, 4), 124u);
    EXPECT_EQ(word(bytes, 12), 3u) << "height";
    EXPECT_EQ(word(bytes, 16), 5u) << "width";
    EXPECT_EQ(word(bytes, 20), 40u) << "bytes of a row";
    EXPECT_EQ(word(bytes, 76), 32u) << "size of the pixel format";
    EXPECT_EQ(bytes.substr(84, 4), "DX10");
    EXPECT_EQ(word(bytes, 128), 10u) << "R16G16B16A16_FLOAT";
    EXPECT_EQ(word(bytes, 132), 3u) << "a 2D texture";
    expectTexels(bytes, 148, lut);
    EXPECT_THROW(io::writeLut(path("u.dds"), lut, PEL_LUT_FLOAT), std::invalid_argument);
}

TEST_F(TextureFile, Ktx2) {
    const Lut lut = table();
    io::writeLut(path("t.ktx2"), lut);
    const std::string bytes = read(path("t.ktx2"));
    EXPECT_EQ(bytes.substr(0, 12), std::string("\xABKTX 20\xBB\r\n\x1A\n", 12));
    EXPECT_EQ(word(bytes, 12), 97u) << "VK_FORMAT_R16G16B16A16_SFLOAT";
    EXPECT_EQ(word(bytes, 16), 2u) << "bytes of a component";
    EXPECT_EQ(word(bytes, 20), 5u);
    EXPECT_EQ(word(bytes, 24), 3u);
    EXPECT_EQ(word(bytes, 36), 1u) << "faces";
    EXPECT_EQ(word(bytes, 40), 1u) << "levels";
    const size_t descriptor = word(bytes, 48), pairs = word(bytes, 56);
    EXPECT_EQ(descriptor, 104u);
    EXPECT_EQ(word(bytes, descriptor), word(bytes, 52)) << "the descriptor knows its own length";
    EXPECT_EQ(pairs, descriptor + word(bytes, 52));
    const std::string text = bytes.substr(pairs, word(bytes, 60));
    EXPECT_NE(text.find(std::string("pellucid:form\0arc", 17)), std::string::npos);
    EXPECT_NE(text.find(std::string("pellucid:axis\0linear", 20)), std::string::npos);
    const size_t texels = word(bytes, 80);
    EXPECT_EQ(texels % 8, 0u);
    EXPECT_EQ(word(bytes, 88), 120u);
    expectTexels(bytes, texels, lut);
}

TEST_F(TextureFile, Bc6h) {
    const Lut lut = table();  // 5x3 texels: 2x1 blocks
    EXPECT_GT(io::writeLutBc6h(path("t.dds"), lut).max, 0);
    const std::string dds = read(path("t.dds"));
    EXPECT_EQ(word(dds, 8) & 0x80008u, 0x80000u) << "a size of all bytes, not of a row";
    EXPECT_EQ(word(dds, 20), 32u);
    EXPECT_EQ(word(dds, 128), 95u) << "BC6H_UF16";
    ASSERT_EQ(dds.size(), 148u + 32);

    io::writeLutBc6h(path("t.ktx2"), lut);
    const std::string ktx = read(path("t.ktx2"));
    EXPECT_EQ(word(ktx, 12), 143u) << "VK_FORMAT_BC6H_UFLOAT_BLOCK";
    EXPECT_EQ(word(ktx, 16), 1u);
    const size_t descriptor = word(ktx, 48), texels = word(ktx, 80);
    EXPECT_EQ(word(ktx, descriptor), 44u) << "one sample";
    EXPECT_EQ(uint8_t(ktx[descriptor + 12]), 133u) << "colour model BC6H";
    EXPECT_EQ(word(ktx, descriptor + 16), 0x0303u) << "4x4 texels";
    EXPECT_EQ(word(ktx, descriptor + 20), 16u) << "bytes of a block";
    EXPECT_EQ(texels % 16, 0u);
    EXPECT_EQ(word(ktx, 88), 32u);
    EXPECT_EQ(ktx.substr(texels), dds.substr(148)) << "the same blocks";
    EXPECT_THROW(io::writeLutBc6h(path("t.exr"), lut), std::invalid_argument);
}
