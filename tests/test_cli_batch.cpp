// pellucid batch, profile and the forms of lut through the command line.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "cli_run.h"
#include "io/lut_file.h"

namespace fs = std::filesystem;

class BatchCommand : public CommandTest {
  protected:
    std::string manifest(const std::string& text) const {
        std::ofstream(path("m.toml")) << text;
        return path("m.toml");
    }
    std::vector<fs::path> files() const {
        std::vector<fs::path> all;
        for (const auto& entry : fs::directory_iterator(path("out"))) all.push_back(entry.path());
        std::sort(all.begin(), all.end());
        return all;
    }
};

namespace {

const char* const grid = R"(
[[grid]]
kind = "curvature"
profile = ["skin", "marble"]
form = ["arc", "sphere"]
axis = "root"
size = [8, 16]
[[lut]]
kind = "shadow"
size = 12
encoding = "float"
[[lut]]
kind = "specular"
size = 9
[[lut]]
kind = "shadow"
size = 12
encoding = "float"
)";

}  // namespace

TEST_F(BatchCommand, MakesKeepsAndRepairs) {
    const std::string m = manifest(grid);
    auto first = run({"batch", m, "-o", path("out"), "--json"});
    ASSERT_EQ(first.exitCode, 0) << first.err;
    expectReport(first.json());
    EXPECT_EQ(first.json()["entries"], 10);
    EXPECT_EQ(first.json()["made"], 10);
    EXPECT_EQ(first.json()["duplicates"], 1);
    ASSERT_EQ(files().size(), 10u);

    // Nothing to do; then one file cut short, one with a changed byte, one missing.
    EXPECT_EQ(run({"batch", m, "-o", path("out"), "--json"}).json()["kept"], 10);
    const auto all = files();
    std::vector<std::string> before;
    for (const auto& file : all) before.push_back(read(file.string()));
    fs::resize_file(all[0], fs::file_size(all[0]) / 2);
    {
        std::fstream file(all[1], std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(-9, std::ios::end);
        file.put(char(before[1][before[1].size() - 9] ^ 0x55));
    }
    fs::remove(all[2]);
    const auto repaired = run({"batch", m, "-o", path("out"), "--json"}).json();
    EXPECT_EQ(repaired["made"], 3);
    EXPECT_EQ(repaired["redone"], 2);
    EXPECT_EQ(repaired["kept"], 7);
    EXPECT_EQ(files(), all);
    for (size_t i = 0; i < all.size(); ++i)
        EXPECT_EQ(pellucid::io::readLut(pellucid::Device(""), all[i].string()).info().structSize,
                  sizeof(PelLutInfo));
}

TEST_F(BatchCommand, ReportsWrongEntriesAndGoesOn) {
    const std::string m = manifest(
        "[[lut]]\nsize = 8\n\n[[lut]]\nsize = -3\n\n[[lut]]\nprofile = \"granite\"\n\n[[lut]]\nsize = "
        "9\ncolour = 1\n");
    const auto result = run({"batch", m, "-o", path("out"), "--json"});
    EXPECT_EQ(result.exitCode, 3);
    EXPECT_EQ(result.json()["made"], 1);
    EXPECT_EQ(result.json()["failed"], 3);
    for (const char* text : {"m.toml:5", "m.toml:8", "granite", "m.toml:12", "colour"})
        EXPECT_NE(result.err.find(text), std::string::npos) << text << "\n" << result.err;
}

TEST_F(BatchCommand, RefusesWhatIsNoManifest) {
    const std::string m = manifest("[[lut]\n");
    EXPECT_EQ(run({"batch", m, "-o", path("out")}).exitCode, 3);
    EXPECT_EQ(run({"batch", path("none.toml"), "-o", path("out")}).exitCode, 3);
    EXPECT_EQ(run({"batch", manifest("x = 1\n"), "-o", path("out")}).exitCode, 3);
    EXPECT_EQ(run({"batch", manifest("[[lut]]\n"), "-o", "/dev/null/folder"}).exitCode, 3);
    EXPECT_EQ(run({"batch", manifest("[[lut]]\n")}).exitCode, 2);
}

TEST_F(BatchCommand, KilledAtAnyMomentLeavesNoBrokenFile) {
    const std::string m = manifest(
        "[[grid]]\nsize = [64, 96, 128]\nform = [\"arc\", \"ring\", \"sphere\"]\n"
        "diffusion_radius = [0.5, 1.0, 1.5, 2.0, 2.5]\n");
    for (const char* delay : {"0.2", "0.5"}) {
        const std::string line = std::string("timeout -s KILL ") + delay + " '" + PELLUCID_COMMAND +
                                 "' batch '" + m + "' -o '" + path("out") + "' >/dev/null 2>&1";
        EXPECT_NE(std::system(line.c_str()), -1);
    }
    const auto result = run({"batch", m, "-o", path("out"), "--json"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.json()["redone"], 0) << "a file that had its name was broken";
    EXPECT_EQ(result.json()["made"].get<int>() + result.json()["kept"].get<int>(), 45);
}

TEST_F(BatchCommand, ProfilesAreListedShownDrawnAndFitted) {
    EXPECT_GE(run({"profile", "list", "--json"}).json()["profiles"].size(), 9u);
    EXPECT_EQ(run({"profile", "show", "marble", "--json"}).json()["kind"], "dipole");
    EXPECT_EQ(run({"profile", "plot", "jade", "-o", path("jade.png")}).exitCode, 0);
    EXPECT_GT(fs::file_size(path("jade.png")), 1000u);
    ASSERT_EQ(run({"profile", "fit", "marble", "--gaussians", "3", "-o", path("fit.toml")}).exitCode, 0);
    EXPECT_EQ(run({"profile", "show", path("fit.toml"), "--json"}).json()["gaussians"], 3);
    expectRefused({"profile", "show", "granite"}, 3, "granite");
    expectRefused({"profile", "plot", "jade", "-o", path("jade.gif")}, 3, ".png");
    expectRefused({"profile", "fit", "marble", "--gaussians", "0"}, 2, "--gaussians");
}

TEST_F(BatchCommand, LutFilesCarryWhatTheyAre) {
    ASSERT_EQ(run({"lut", "curvature", "-o", path("a.exr"), "--size", "8x6", "--form", "sphere", "--axis",
                   "root", "--profile", "ketchup"})
                  .exitCode,
              0);
    const PelLutInfo info = pellucid::io::readLut(pellucid::Device(""), path("a.exr")).info();
    EXPECT_EQ(info.curvature.form, PEL_FORM_SPHERE);
    EXPECT_EQ(info.curvature.axis, PEL_AXIS_ROOT);
    EXPECT_STREQ(info.profile, "ketchup");
    ASSERT_EQ(run({"lut", "specular", "-o", path("s.exr"), "--size", "8x6"}).exitCode, 0);
    EXPECT_EQ(pellucid::io::readLut(pellucid::Device(""), path("s.exr")).info().kind, PEL_LUT_SPECULAR);
    ASSERT_EQ(run({"lut", "shadow", "-o", path("s.tga"), "--size", "8x6"}).exitCode, 0);
    expectRefused({"lut", "curvature", "-o", path("b.exr"), "--profile", "granite"}, 3, "granite");
}
