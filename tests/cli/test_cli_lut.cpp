// `pellucid lut`: files of tables, presets, pictures; `pellucid profile`.
#include "cli_shade.h"
#include "io/image/color_map.h"
#include "io/lut/lut_file.h"
#include "npy.h"

using namespace pellucid;

namespace {

class CliLut : public CommandTest {
  protected:
    PelLutInfo info(const std::string& options) const {
        done("lut " + options + " -o @i.exr");
        return io::readLut(device_, path("i.exr")).info();
    }
    const Device device_{""};
};

}  // namespace

TEST_F(CliLut, LutFilesHoldTheLibrarysTexels) {
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = 24;
    desc.height = 10;
    desc.radiusMin = 2;
    desc.radiusMax = 50;
    const Lut expected(device_, desc);
    const auto make = [&](const std::string& file) {
        const auto report = reportOf(
            "lut curvature --preset faceworks --size 24x10 --radius-min 2 --radius-max 50 -o @" + file);
        expectReport(report);
        EXPECT_GT(report.at("device_ms").get<double>(), 0.0);
    };
    make("f.npy");
    const auto array = npy::read<float>(path("f.npy"));
    EXPECT_EQ(array.shape, (std::vector<size_t>{10, 24, 3}));
    EXPECT_EQ(array.data, expected.read<float>(PEL_LUT_FLOAT));
    make("f.exr --encoding float");
    EXPECT_EQ(io::readLut(device_, path("f.exr")).read<float>(PEL_LUT_FLOAT), array.data);
    make("b.npy --encoding faceworks8");
    const auto bytes = npy::read<uint8_t>(path("b.npy"));
    EXPECT_EQ(bytes.shape, (std::vector<size_t>{10, 24, 4}));
    EXPECT_EQ(bytes.data, expected.read<uint8_t>(PEL_LUT_FACEWORKS8));
    for (const std::string name : {"b.png", "b.bmp"}) {
        make(name + " --encoding faceworks8");
        const io::Image image = io::readImage(path(name));
        ASSERT_EQ(image.channels.size(), 4u);
        for (size_t i = 0; i < bytes.data.size(); ++i)
            ASSERT_EQ(std::lround(255 * image.channels[i % 4].pixels[i / 4]), bytes.data[i])
                << name << ' ' << i;
    }
    make("h.exr --encoding half");
    EXPECT_EQ(io::readImage(path("h.exr")).channels[0].type, io::ChannelType::Half);
    desc = pelCurvatureLutDescFaceWorks();
    desc.width = 24, desc.height = 10, desc.radiusMin = 0.5;
    EXPECT_EQ(reportOf("lut curvature --preset faceworks --size 24x10 --radius-min 0.5 --encoding faceworks8 "
                       "-o @c.png")
                  .at("clipped_texels"),
              Lut(device_, desc).clippedTexels());
}

TEST_F(CliLut, OptionsBecomeDescriptions) {
    EXPECT_STREQ(info("curvature --size 8x6 --profile ketchup").profile, "ketchup");
    EXPECT_EQ(info("shadow --size 8x6 --sharpening 5").shadow.sharpening, 5.0f);
    EXPECT_EQ(info("curvature --size 8x6 --axis LINEAR").curvature.axis, PEL_AXIS_LINEAR);
    EXPECT_EQ(info("specular --size 8x6").kind, PEL_LUT_SPECULAR);
    done("lut shadow -o @s.tga --size 8x6");
}

TEST_F(CliLut, TablesOfCaustics) {
    done("lut eye -o @e.exr --size 32x16x8 --chamber-depth 3.4 --iris-radius 5.5");
    const Lut lut = io::readLut(device_, path("e.exr"));
    EXPECT_EQ(lut.info().kind, PEL_LUT_EYE);
    EXPECT_STREQ(lut.info().profile, "none");
    PelEyeLutDesc desc = pelEyeLutDescDefaults();
    desc.width = 32, desc.height = 16, desc.depth = 8, desc.chamberDepth = 3.4f, desc.irisRadius = 5.5f;
    EXPECT_EQ(lut.read<float>(PEL_LUT_FLOAT), Lut(device_, desc).read<float>(PEL_LUT_FLOAT));
    desc.scleraRadius = 12, desc.corneaRadius = 7.7f, desc.corneaConic = -0.2f, desc.limbusRadius = 5.9f;
    desc.corneaIndex = 1.38f, desc.aqueousIndex = 1.34f, desc.irisConcavity = 0.1f,
    desc.millimetresPerUnit = 10;
    io::writeLut(path("own.exr"), Lut(device_, desc));
    const PelEyeLutDesc again = io::readLut(device_, path("own.exr")).info().eye;
#define SAME(type, name, ...) EXPECT_EQ(again.name, desc.name) << #name;
    PEL_EACH_EYE_LUT_FIELD(SAME)
    EXPECT_STREQ(info("eye --size 8x8x4 --encoding half --profile skin").profile, "skin");
    done("lut eye -o @e.ktx2 --size 8x8x4");
}

// A .png without --encoding is a picture to look at, as the report states.
TEST_F(CliLut, ATableAsAPictureHasTheTablesValues) {
    EXPECT_TRUE(contains(reportOf("lut shadow --size 16x8 -o @look.png").at("encoding"), "picture"));
    done("lut shadow --size 16x8 -o @t.exr");
    const std::vector<float> picture = io::readImage(path("look.png")).interleaved(shade_files::colorNames),
                             table = io::readImage(path("t.exr")).interleaved(shade_files::colorNames);
    for (size_t i = 0; i < table.size(); ++i)
        EXPECT_NEAR(255 * picture[i], 255 * io::encodeSrgb(std::clamp(table[i], 0.0f, 1.0f)), 0.51) << i;
}

// What the reports say: test_cli_shade.cpp.
TEST_F(CliLut, ProfilesAreShownDrawnAndFitted) {
    EXPECT_TRUE(contains(done("profile show marble").out, "d mm  R per mm^2"));
    done("profile plot jade -o @jade.png");
    expectKept("jade.png", "profile.png", "0.0003");
    done("profile fit marble --gaussians 3 -o @fit.toml");
    EXPECT_EQ(reportOf("profile show @fit.toml")["gaussians"], 3);
    // A name is written and shown with what it holds.
    write("name.toml",
          "name = 'a\"b\\c\u00e9'\nkind = 'burley'\nunit = 'mm'\nsource = \"\\u001b[1m\"\n"
          "distance = [1, 1, 1]\n");
    done("profile fit @name.toml --gaussians 2 -o @fit.toml");
    EXPECT_EQ(reportOf("profile show @fit.toml")["name"], "a\"b\\c\u00e9-2-gaussians");
    EXPECT_TRUE(contains(done("profile show @name.toml").out, "\\x1b[1m"));
}

TEST_F(CliLut, SkinIsDescribedDrawnAndTakenFromAPicture) {
    const auto skin = reportOf("profile skin --melanin 0.03 --blood 0.01 --plot @s.png -o @s.toml");
    PelSkin own = pelSkinDefaults();
    own.melanin = 0.03f;
    own.blood = 0.01f;
    const PelSkinInfo expected = skinInfo(own);
    const auto albedo = skin.at("albedo").get<std::vector<float>>();
    for (int c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(albedo[c], expected.albedo[c]);
    expectKept("s.png", "skin.png", "0.0003");
    EXPECT_EQ(reportOf("profile show @s.toml").at("kind"), "skin-layers");
    // The last pixel is green, as no skin is.
    io::writeExr(path("a.exr"),
                 shade_files::imageOf(4, 1, shade_files::colorNames, [&](int x, int, size_t c) {
                     return x < 3 ? albedo[c] : c == 1 ? 0.9f : 0.1f;
                 }));
    const auto found = reportOf("profile pigments @a.exr -o @m.exr");
    EXPECT_EQ(found.at("share_above_1"), 0.25);
    const io::Image maps = io::readImage(path("m.exr"));
    const std::vector<float>& difference = maps.channel("difference").pixels;
    for (int i = 0; i < 3; ++i) EXPECT_LT(difference[i], tolerance::skinRoundTrip);
    EXPECT_EQ(found.at("delta_e_median"), difference[0]);
    EXPECT_EQ(found.at("delta_e_max"), difference[3]);
    EXPECT_NEAR(maps.channel("melanin").pixels[0], 0.03f, 1e-3f);
    EXPECT_NEAR(maps.channel("blood").pixels[0], 0.01f, 1e-3f);
}

TEST_F(CliLut, TheSearchForPigmentsShowsProgressAndCanBeInterrupted) {
    if (std::system("script --version >/dev/null 2>&1") != 0)
        GTEST_SKIP() << "no command `script` for a terminal";
    io::writeExr(path("a.exr"),
                 shade_files::imageOf(2048, 2048, shade_files::colorNames, [](int x, int y, size_t c) {
                     return c ? 0.2 : (x + 2048.0 * y) / 2048 / 2048;
                 }));
    EXPECT_NE(std::system(filled("script -qec 'timeout --foreground -s INT 4 " PELLUCID_COMMAND
                                 " profile pigments @a.exr -o @m.exr' /dev/null >@out.txt 2>&1")
                              .c_str()),
              0);
    EXPECT_TRUE(contains(read(path("out.txt")), "% pigments"));
    EXPECT_TRUE(contains(read(path("out.txt")), "interrupted"));
    EXPECT_FALSE(std::filesystem::exists(path("m.exr")));
}

// While its kernels are compiled. Clang inside a driver sees Ctrl-C as well, and may fail instead.
TEST_F(CliLut, ATableCanBeInterrupted) {
    for (const char* later : {"0", "0.5"}) {
        const std::string command =
            filled(std::string("POCL_CACHE_DIR=@cache") + later +
                   " PELLUCID_CACHE_DIR=off " PELLUCID_COMMAND
                   " lut curvature --profile jade -o @t.exr 2>@err.txt & while [ ! -e "
                   "@cache" +
                   later + " ]; do sleep 0.01; done; sleep " + later + "; kill -INT $!; wait $!");
        const int status = std::system(command.c_str());
        EXPECT_EQ(WEXITSTATUS(status), 4) << later;
        EXPECT_EQ(read(path("err.txt")), "pellucid: interrupted\n") << later;
        EXPECT_FALSE(std::filesystem::exists(path("t.exr"))) << later;
    }
}
