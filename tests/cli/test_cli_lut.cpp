// `pellucid lut`: files of tables, presets, pictures; `pellucid profile`.
#include <pellucid/pellucid.hpp>

#include "cli_run.h"
#include "io/image/image_file.h"
#include "io/lut/lut_file.h"
#include "npy.h"
#include "tolerances.h"

using namespace pellucid;

using CliLut = CommandTest;

TEST_F(CliLut, LutFilesHoldTheLibrarysTexels) {
    const Device device("");
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = 24;
    desc.height = 10;
    desc.radiusMin = 2;
    desc.radiusMax = 50;
    const Lut expected(device, desc);
    const std::vector<std::string> common = {"lut",   "curvature",    "--preset", "faceworks",    "--size",
                                             "24x10", "--radius-min", "2",        "--radius-max", "50",
                                             "-o"};
    const auto make = [&](const std::string& name, const std::string& encoding) {
        std::vector<std::string> arguments = common;
        arguments.push_back(path(name));
        if (!encoding.empty()) arguments.insert(arguments.end(), {"--encoding", encoding});
        arguments.push_back("--json");
        const Result result = run(arguments);
        ASSERT_EQ(result.exitCode, 0) << result.err;
        expectReport(result.json());
        EXPECT_EQ(result.json().at("texels"), 240);
        EXPECT_GT(result.json().at("device_ms").get<double>(), 0.0);
    };
    make("f.npy", "");
    const auto array = npy::read<float>(path("f.npy"));
    EXPECT_EQ(array.shape, (std::vector<size_t>{10, 24, 3}));
    EXPECT_EQ(array.data, expected.read<float>(PEL_LUT_FLOAT));
    make("f.exr", "float");
    const Lut again = io::readLut(device, path("f.exr"));
    EXPECT_EQ(again.read<float>(PEL_LUT_FLOAT), array.data);
    EXPECT_EQ(again.info().curvature.radiusMax, 50.0f);
    make("b.npy", "faceworks8");
    const auto bytes = npy::read<uint8_t>(path("b.npy"));
    EXPECT_EQ(bytes.shape, (std::vector<size_t>{10, 24, 4}));
    EXPECT_EQ(bytes.data, expected.read<uint8_t>(PEL_LUT_FACEWORKS8));
    for (const char* name : {"b.png", "b.bmp"}) {
        make(name, "faceworks8");
        const io::Image image = io::readImage(path(name));
        ASSERT_EQ(image.channels.size(), 4u);
        for (size_t i = 0; i < bytes.data.size(); ++i) {
            ASSERT_EQ(std::lround(255 * image.channels[i % 4].pixels[i / 4]), bytes.data[i])
                << name << ' ' << i;
        }
    }
    EXPECT_EQ(run({"lut", "curvature", "--preset", "faceworks", "--size", "24x10", "--radius-min", "0.5",
                   "--encoding", "faceworks8", "-o", path("c.png"), "--json"})
                  .json()
                  .at("clipped_texels"),
              [&] {
                  desc = pelCurvatureLutDescFaceWorks();
                  desc.width = 24;
                  desc.height = 10;
                  desc.radiusMin = 0.5;
                  return Lut(device, desc).clippedTexels();
              }());
    make("h.exr", "half");
    EXPECT_EQ(io::readImage(path("h.exr")).channels[0].type, io::ChannelType::Half);
}

// The default tables are those that a material makes of its profile, --preset faceworks makes those of
// FaceWorks; an option of its own takes precedence.
TEST_F(CliLut, TablesAreAMaterialsUnlessAPresetSaysOtherwise) {
    const Device device("");
    const auto info = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "lut");
        arguments.insert(arguments.end(), {"-o", path("p.exr")});
        const Result result = run(arguments);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return io::readLut(device, path("p.exr")).info();
    };
    PelLutInfo i = info({"curvature"});
    EXPECT_EQ(i.curvature.form, PEL_FORM_SPHERE);
    EXPECT_EQ(i.curvature.axis, PEL_AXIS_ROOT);
    EXPECT_EQ(i.curvature.width, 64u);
    i = info({"curvature", "--preset", "faceworks", "--size", "32x8"});
    EXPECT_EQ(i.curvature.form, PEL_FORM_ARC);
    EXPECT_EQ(i.curvature.axis, PEL_AXIS_LINEAR);
    EXPECT_EQ(i.curvature.height, 8u);
    EXPECT_EQ(info({"curvature", "--preset", "faceworks", "--size", "32x8", "--axis", "root"}).curvature.axis,
              PEL_AXIS_ROOT);
    i = info({"shadow"});
    EXPECT_EQ(i.shadow.closedEnds, 1u);
    EXPECT_EQ(i.shadow.axis, PEL_AXIS_ROOT);
    EXPECT_EQ(i.shadow.width, 128u);
    EXPECT_EQ(i.shadow.height, 32u);
    EXPECT_NEAR(i.shadow.widthMax, 1000 * i.shadow.widthMin, 1e-3 * i.shadow.widthMax);
    EXPECT_EQ(info({"shadow", "--open-ends"}).shadow.closedEnds, 0u);
    i = info({"shadow", "--preset", "faceworks"});
    EXPECT_EQ(i.shadow.closedEnds, 0u);
    EXPECT_EQ(i.shadow.axis, PEL_AXIS_LINEAR);
    EXPECT_EQ(i.shadow.width, 512u);
    EXPECT_EQ(i.shadow.widthMin, 8);
    // What followed from the profile is shown.
    const nlohmann::json shown =
        run({"lut", "shadow", "--profile", "marble", "-o", path("p.exr"), "--json"}).json();
    const PelProfileInfo marble = Profile::named("marble").info();
    EXPECT_NEAR(shown["width_min"].get<float>(), 1.3f * *std::max_element(marble.width, marble.width + 3),
                1e-3);
    EXPECT_EQ(shown["closed_ends"], true);
    EXPECT_EQ(run({"lut", "curvature", "-o", path("p.exr"), "--json"}).json()["form"], "sphere");
    expectRefused({"lut", "shadow", "--preset", "unity", "-o", path("p.exr")}, 2, "faceworks");
}

// A .png without --encoding is a picture to look at, as the report states.
TEST_F(CliLut, ATableAsAPictureHasTheTablesValues) {
    const Result result = run({"lut", "shadow", "--size", "16x8", "-o", path("look.png"), "--json"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_TRUE(contains(result.json().at("encoding"), "picture"));
    ASSERT_EQ(run({"lut", "shadow", "--size", "16x8", "-o", path("t.exr"), "--json"}).json().at("encoding"),
              "float");
    const io::Image picture = io::readImage(path("look.png")), table = io::readImage(path("t.exr"));
    ASSERT_EQ(picture.channels.size(), 3u);
    for (const char* c : {"R", "G", "B"})
        for (size_t i = 0; i < 16 * 8; ++i) {
            const double x = std::clamp(double(table.channel(c).pixels[i]), 0.0, 1.0);
            const double srgb = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
            EXPECT_NEAR(255 * picture.channel(c).pixels[i], 255 * srgb, 0.51) << c << i;
        }
}

TEST_F(CliLut, ShadowLutAndItsFlags) {
    ASSERT_EQ(run({"lut", "shadow", "-o", path("s.exr"), "--size", "16x8", "--width-min", "4", "--width-max",
                   "40", "--sharpening", "5", "--diffusion-radius", "1.5"})
                  .exitCode,
              0);
    const PelLutInfo info = io::readLut(Device(""), path("s.exr")).info();
    EXPECT_EQ(info.kind, PEL_LUT_SHADOW);
    EXPECT_EQ(info.shadow.width, 16u);
    EXPECT_EQ(info.shadow.height, 8u);
    EXPECT_EQ(info.shadow.widthMin, 4.0f);
    EXPECT_EQ(info.shadow.widthMax, 40.0f);
    EXPECT_EQ(info.shadow.sharpening, 5.0f);
    EXPECT_EQ(info.shadow.diffusionRadius, 1.5f);
}

TEST_F(CliLut, ProfilesAreListedShownDrawnAndFitted) {
    EXPECT_GE(run({"profile", "list", "--json"}).json()["profiles"].size(), 9u);
    EXPECT_EQ(run({"profile", "show", "marble", "--json"}).json()["kind"], "dipole");
    for (const auto& [name, singular] : {std::pair{"skin", false}, {"skin-burley", true}, {"marble", false}})
        EXPECT_EQ(run({"profile", "show", name, "--json"}).json()["singular"], singular) << name;
    const auto rows = run({"profile", "show", "marble", "--json"}).json()["values"];
    ASSERT_EQ(rows.size(), 7u);
    for (const auto& row : rows) {
        const Profile marble = Profile::named("marble");
        const std::vector<double> at{row["distance_mm"].get<double>()};
        const auto radial = marble.radial(at), line = marble.lineSpread(at);
        for (size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(row["radial_per_mm2"][c].get<double>() / radial[c], 1, 1e-6);
            EXPECT_NEAR(row["line_spread_per_mm"][c].get<double>() / line[c], 1, 1e-6);
        }
    }
    EXPECT_EQ(run({"profile", "plot", "jade", "-o", path("jade.png")}).exitCode, 0);
    EXPECT_GT(std::filesystem::file_size(path("jade.png")), 1000u);
    ASSERT_EQ(run({"profile", "fit", "marble", "--gaussians", "3", "-o", path("fit.toml")}).exitCode, 0);
    EXPECT_EQ(run({"profile", "show", path("fit.toml"), "--json"}).json()["gaussians"], 3);
    expectRefused({"profile", "show", "granite"}, 3, "granite");
    expectRefused({"profile", "plot", "jade", "-o", path("jade.gif")}, 2, ".png");
    expectRefused({"profile", "fit", "marble", "--gaussians", "0"}, 2, "--gaussians");
}

TEST_F(CliLut, LutFilesCarryWhatTheyAre) {
    ASSERT_EQ(run({"lut", "curvature", "-o", path("a.exr"), "--size", "8x6", "--form", "sphere", "--axis",
                   "root", "--profile", "ketchup"})
                  .exitCode,
              0);
    const PelLutInfo info = io::readLut(Device(""), path("a.exr")).info();
    EXPECT_EQ(info.curvature.form, PEL_FORM_SPHERE);
    ASSERT_EQ(run({"lut", "curvature", "-o", path("r.exr"), "--size", "8x6", "--form", "arc"}).exitCode, 0);
    EXPECT_EQ(io::readLut(Device(""), path("r.exr")).info().curvature.form, PEL_FORM_ARC);
    EXPECT_EQ(info.curvature.axis, PEL_AXIS_ROOT);
    EXPECT_STREQ(info.profile, "ketchup");
    ASSERT_EQ(run({"lut", "specular", "-o", path("s.exr"), "--size", "8x6"}).exitCode, 0);
    EXPECT_EQ(io::readLut(Device(""), path("s.exr")).info().kind, PEL_LUT_SPECULAR);
    ASSERT_EQ(run({"lut", "shadow", "-o", path("s.tga"), "--size", "8x6"}).exitCode, 0);
    expectRefused({"lut", "curvature", "-o", path("b.exr"), "--profile", "granite"}, 3, "granite");
}
