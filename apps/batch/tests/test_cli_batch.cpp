// `pellucid batch`: manifests, files, the index, kills and full disks.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "batch/batch_entry.h"
#include "cli/cli_run.h"
#include "io/choice_keys.h"
#include "io/content_hash.h"
#include "io/image/image_file.h"
#include "io/lut/lut_file.h"

namespace fs = std::filesystem;

class BatchCommand : public CommandTest {
  protected:
    std::string manifest(const std::string& text) const {
        std::ofstream(path("m.toml")) << text;
        return path("m.toml");
    }
    // Without the index.
    std::vector<fs::path> files() const {
        std::vector<fs::path> all;
        for (const auto& entry : fs::directory_iterator(path("out")))
            if (entry.path().extension() != ".json") all.push_back(entry.path());
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
    // A manifest of wrong entries alone leaves the index of an earlier run as it is, or makes none.
    const std::string before = read(path("out/m.index.json"));
    const std::string wrong = manifest("[[lut]]\nsize = -3\n");
    EXPECT_EQ(run({"batch", wrong, "-o", path("out")}).exitCode, 3);
    EXPECT_EQ(read(path("out/m.index.json")), before);
    EXPECT_EQ(run({"batch", wrong, "-o", path("new")}).exitCode, 3);
    EXPECT_FALSE(fs::exists(path("new/m.index.json")));
}

TEST_F(BatchCommand, NamesFilesAndWritesAnIndexOfThem) {
    const std::string text =
        "version = 1\n[[grid]]\nname = \"{profile}-{form}-{size}\"\nprofile = [\"skin\", \"marble\"]\nform = "
        "[\"arc\", \"sphere\"]\n"
        "size = [8, 9]\n[[lut]]\nkind = \"specular\"\nname = \"shine\"\nsize = 10\n[[lut]]\nkind = "
        "\"shadow\"\nsize = 8\n"
        "encoding = \"float\"\nwidth_min = 7.5\n";
    const auto first = run({"batch", manifest(text), "-o", path("out"), "--json"});
    ASSERT_EQ(first.exitCode, 0) << first.err;
    EXPECT_EQ(first.json()["index"], "m.index.json");
    const std::string bytes = read(path("out/m.index.json"));
    const nlohmann::json index = nlohmann::json::parse(bytes);
    EXPECT_EQ(index["version"], 1);
    EXPECT_EQ(index["manifest"], "m.toml");
    EXPECT_EQ(index["missing"], 0);
    ASSERT_EQ(index["tables"].size(), 10u);
    EXPECT_EQ(files().size(), 10u);
    for (const nlohmann::json& table : index["tables"]) {
        const std::string file = path("out/" + table["file"].get<std::string>());
        ASSERT_TRUE(fs::exists(file)) << file;
        const pellucid::Lut lut = pellucid::io::readLut(pellucid::Device(), file);
        const PelLutInfo info = lut.info();
        EXPECT_EQ(pellucid::io::lutKinds[info.kind], table["kind"].get<std::string>());
        if (info.kind != PEL_LUT_CURVATURE) continue;
        EXPECT_EQ(table["name"].get<std::string>() + ".exr", table["file"]);
        EXPECT_EQ(table["name"], table["profile"].get<std::string>() + "-" +
                                     table["form"].get<std::string>() + "-" +
                                     std::to_string(info.curvature.width));
        EXPECT_EQ(table["width"], info.curvature.width);
        EXPECT_EQ(table["radius_max"], info.curvature.radiusMax);
    }
    EXPECT_EQ(index["tables"][0]["file"], "shine.exr");  // [[lut]] before [[grid]]
    EXPECT_EQ(index["tables"][1]["width_min"], 7.5);
    EXPECT_FALSE(index["tables"][1].contains("name"));
    EXPECT_NEAR(index["tables"][1]["diffusion_radius"].get<double>(), 2.7, 0.1);  // the profile's own
    // Again the same; with a table that cannot be made, it is counted and not listed.
    EXPECT_EQ(run({"batch", path("m.toml"), "-o", path("out"), "--json"}).json()["kept"], 10);
    EXPECT_EQ(read(path("out/m.index.json")), bytes);
    run({"batch", manifest(text + "[[lut]]\nprofile = \"granite\"\n"), "-o", path("out")});
    const nlohmann::json after = nlohmann::json::parse(read(path("out/m.index.json")));
    EXPECT_EQ(after["missing"], 1);
    EXPECT_EQ(after["tables"], index["tables"]);
    // A name whose request changes is made anew.
    EXPECT_EQ(run({"batch", manifest("[[lut]]\nname = \"shine\"\nsize = 8\n"), "-o", path("out"), "--json"})
                  .json()["redone"],
              1);
}

// By default a manifest of version 1 makes FaceWorks' tables, one of version 2 those that a material makes of
// its profile.
TEST_F(BatchCommand, TablesBeginAsTheVersionOrThePresetSays) {
    const auto made = [&](const std::string& text) {
        const Result result = run({"batch", manifest(text), "-o", path("out"), "--json"});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return nlohmann::json::parse(read(path("out/m.index.json")))["tables"];
    };
    const std::string two = "[[lut]]\nname = \"c\"\n%[[lut]]\nkind = \"shadow\"\nname = \"s\"\n%";
    const auto with = [&](const std::string& head, const std::string& keys) {
        std::string text = head + two;
        for (size_t at; (at = text.find('%')) != std::string::npos;) text.replace(at, 1, keys);
        return made(text);
    };
    for (const auto& tables : {with("", ""), with("version = 2\n", "preset = \"faceworks\"\n")}) {
        EXPECT_EQ(tables[0]["form"], "arc");
        EXPECT_EQ(tables[0]["axis"], "linear");
        EXPECT_EQ(tables[0]["width"], 512);
        EXPECT_EQ(tables[0]["radius_max"], 100);
        EXPECT_EQ(tables[1]["axis"], "linear");
        EXPECT_EQ(tables[1]["closed_ends"], 0);
        EXPECT_EQ(tables[1]["width_min"], 8);
    }
    for (const auto& tables : {with("version = 2\n", ""), with("", "preset = \"material\"\n")}) {
        EXPECT_EQ(tables[0]["form"], "sphere");
        EXPECT_EQ(tables[0]["axis"], "root");
        EXPECT_EQ(tables[0]["width"], 64);
        EXPECT_NEAR(tables[0]["radius_min"].get<double>(), 0.25 * tables[0]["diffusion_radius"].get<double>(),
                    1e-6);
        EXPECT_EQ(tables[1]["axis"], "root");
        EXPECT_EQ(tables[1]["closed_ends"], 1);
        EXPECT_EQ(tables[1]["width"], 128);
        const pellucid::Lut lut = pellucid::io::readLut(pellucid::Device(), path("out/s.exr"));
        EXPECT_EQ(lut.info().shadow.widthMin, tables[1]["width_min"].get<float>());
    }
    // The axis of shadow tables counts, unless an older manifest has one that did not.
    const std::string shadow = "[[lut]]\nkind = \"shadow\"\nname = \"s\"\naxis = \"linear\"\nsize = 8\n";
    EXPECT_EQ(made("version = 2\n" + shadow)[0]["axis"], "linear");
    EXPECT_EQ(made("[[lut]]\nkind = \"shadow\"\nname = \"s\"\naxis = \"root\"\nsize = 8\n")[0]["axis"],
              "linear");
    EXPECT_EQ(made("version = 2\n[[lut]]\nkind = \"shadow\"\nname = \"s\"\nclosed_ends = 0\nsize = 8\n")
                  [0]["closed_ends"],
              0);
}

TEST_F(BatchCommand, RefusesNamesThatAreNone) {
    const auto said = [&](const std::string& text) {
        const Result result = run({"batch", manifest(text), "-o", path("out")});
        EXPECT_EQ(result.exitCode, 3) << text;
        return result.err;
    };
    EXPECT_TRUE(contains(said("[[grid]]\nname = \"a\"\nsize = [8, 9]\n"),
                         "m.toml:2: 'name' in [[grid]] gives two tables"));
    EXPECT_TRUE(contains(said("[[lut]]\nname = \"a\"\nsize = 8\n[[lut]]\nname = \"a\"\nsize = 9\n"),
                         "the one of line 1 has it"));
    EXPECT_TRUE(contains(said("[[lut]]\nname = \"{colour}\"\n"), "'{colour}'; one of {axis}, "));
    for (const char* name : {"../a", "a/b", ".a", "-a", "a b", "{size", "", "\\u00e4"})
        EXPECT_TRUE(
            contains(said("[[lut]]\nsize = 8\nname = \"" + std::string(name) + "\"\n"), "m.toml:3: 'name'"))
            << name;
    EXPECT_TRUE(contains(said("version = 3\n[[lut]]\nsize = 8\n"), "of a later pellucid"));
    EXPECT_TRUE(contains(said("version = 1.5\n[[lut]]\nsize = 8\n"), "'version'"));
    EXPECT_EQ(files().size(), 1u);  // the first of each pair
}

TEST_F(BatchCommand, RefusesWhatIsNoManifest) {
    const std::string m = manifest("[[lut]\n");
    EXPECT_EQ(run({"batch", m, "-o", path("out")}).exitCode, 3);
    EXPECT_EQ(run({"batch", path("none.toml"), "-o", path("out")}).exitCode, 3);
    EXPECT_EQ(run({"batch", manifest("x = 1\n"), "-o", path("out")}).exitCode, 3);
    EXPECT_EQ(run({"batch", manifest("[[lut]]\n"), "-o", "/dev/null/folder"}).exitCode, 3);
    EXPECT_EQ(run({"batch", manifest("[[lut]]\n")}).exitCode, 2);
}

// What the device refuses shows only when the table is made.
TEST_F(BatchCommand, AnEntryThatCannotBeMadeIsReportedWithItsLine) {
    const std::string m = manifest("[[lut]]\nsize = 8\n\n[[lut]]\nsize = 16384\n[[lut]]\nsize = 9\n");
    const auto result = run({"batch", m, "-o", path("out"), "--json"},
                            "POCL_MEMORY_LIMIT=1");  // GiB: too little for the large one
    EXPECT_EQ(result.exitCode, 3);
    EXPECT_EQ(result.json()["made"], 2);
    EXPECT_EQ(result.json()["failed"], 1);
    EXPECT_TRUE(contains(result.err, "m.toml:4: "));
    EXPECT_TRUE(contains(result.json()["warnings"][0].get<std::string>(), "m.toml:4: "));
}

TEST_F(BatchCommand, AChangedAttributeIsNoticed) {
    const std::string m = manifest("[[lut]]\nsize = 8\n");
    ASSERT_EQ(run({"batch", m, "-o", path("out")}).exitCode, 0);
    const std::string file = files().at(0).string();
    std::string bytes = read(file);
    const size_t at = bytes.find("linear", bytes.find("pellucid:axis"));
    ASSERT_NE(at, std::string::npos);
    const std::string good = bytes;
    bytes[at] ^= 1;
    std::ofstream(file, std::ios::binary) << bytes;
    EXPECT_EQ(run({"batch", m, "-o", path("out"), "--json"}).json()["redone"], 1);
    EXPECT_EQ(read(file), good);
    std::ofstream(file, std::ios::binary) << good << '\0';
    EXPECT_EQ(run({"batch", m, "-o", path("out"), "--json"}).json()["redone"], 1) << "longer than it was";
}

// Kills at moments that a seed chooses; what had its name then is whole and is kept.
TEST_F(BatchCommand, KilledAtAnyMomentLosesWhatWasInFlight) {
    std::string radii;
    for (int i = 0; i < 300; ++i) radii += (i ? ", " : "") + std::to_string(1 + 0.01 * i);
    const std::string m = manifest("[[grid]]\nsize = [24, 40]\ndiffusion_radius = [" + radii + "]\n");
    fs::create_directories(path("out"));
    const auto named = [&](bool hidden) {
        size_t count = 0;
        for (const fs::path& file : files()) count += (file.filename().string()[0] == '.') == hidden;
        return count;
    };
    constexpr unsigned jobs = 6;
    unsigned random = 1;
    size_t kills = 0;
    for (int round = 0; round < 5 && named(false) < 600; ++round) {
        random = random * 1664525 + 1013904223;  // [Numerical Recipes]
        const std::string line = "timeout -s KILL " + std::to_string(0.15 + (random >> 16) / 65536.0 * 0.35) +
                                 " '" + PELLUCID_COMMAND + "' batch '" + m + "' -j " + std::to_string(jobs) +
                                 " -o '" + path("out") + "' >/dev/null 2>&1";
        const size_t before = named(false), left = named(true);
        const int status = std::system(line.c_str());
        kills += WIFSIGNALED(status) || WEXITSTATUS(status) == 137;
        EXPECT_GE(named(false), before);
        EXPECT_LE(named(true), left + jobs) << "more than was in flight";
    }
    EXPECT_GE(kills, 1u);
    const size_t whole = named(false);
    for (const fs::path& file : files())  // as if the kill had been a while ago
        fs::last_write_time(file, fs::last_write_time(file) - std::chrono::minutes(5));
    const auto result = run({"batch", m, "-o", path("out"), "--json"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.json()["kept"], whole);
    EXPECT_EQ(result.json()["redone"], 0) << "a file that had its name was broken";
    EXPECT_EQ(result.json()["made"], 600 - whole);
    // The last one killed may still have been waiting for its disk.
    for (int i = 0; i < 50 && named(true) > 0; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        EXPECT_EQ(run({"batch", m, "-o", path("out"), "--json"}).json()["kept"], 600);
    }
    EXPECT_EQ(named(true), 0u) << "what the killed left behind is removed";
}

TEST_F(BatchCommand, SeveralDevicesShareAManifest) {
    const std::string m = manifest(
        "[[grid]]\nsize = [8, 12, 16, 20, 24, 28]\nform = [\"arc\", \"ring\"]\n"
        "axis = [\"linear\", \"root\"]\n");
    ASSERT_EQ(run({"batch", m, "-o", path("one")}).exitCode, 0);
    const auto result =
        run({"batch", m, "-o", path("out"), "--device", "", "--device", "", "-j", "4", "--json"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto devices = result.json()["devices"];
    ASSERT_EQ(devices.size(), 2u);
    EXPECT_EQ(devices[0]["made"].get<int>() + devices[1]["made"].get<int>(), 24);
    EXPECT_GT(devices[0]["made"], 0);
    EXPECT_GT(devices[1]["made"], 0);
    for (const fs::path& file : files())
        EXPECT_EQ(read(file.string()), read(path("one/" + file.filename().string()))) << "the same bytes";
    EXPECT_EQ(run({"batch", m, "-o", path("out"), "--device", "abacus"}).exitCode, 4);
}

TEST_F(BatchCommand, AFullDiskIsAClearError) {
    const std::string m = manifest("[[grid]]\nsize = [40, 44, 48, 52, 56, 60, 64, 68]\n");
    fs::create_directories(path("out"));
    // No file may become longer than 4 MiB (a shell's unit is 512 bytes): the device's compiler needs some.
    write("large.toml", "[[lut]]\nsize = 1200\n");
    const auto limited = run({"batch", path("large.toml"), "-o", path("out")}, "ulimit -f 8192;");
    EXPECT_EQ(limited.exitCode, 3);
    EXPECT_TRUE(contains(limited.err, "cannot be written: File too large"));
    for (const fs::path& file : files()) EXPECT_NE(file.filename().string()[0], '.') << "no leftovers";

    if (std::system("unshare -rm true 2>/dev/null") != 0)
        GTEST_SKIP() << "no right to mount a small file system of one's own";
    const std::string full = "unshare -rm sh -c 'mount -t tmpfs -o size=64k none \"" + path("out") +
                             "\" && { \"$0\" \"$@\"; echo $? >\"" + path("code") +
                             "\"; ls -A -I \"*.json\" \"" + path("out") + "\" >\"" + path("left") + "\"; }'";
    const auto result = run({"batch", m, "-o", path("out"), "--json"}, full);
    EXPECT_EQ(read(path("code")), "3\n") << result.err;
    EXPECT_TRUE(contains(result.err, "cannot be written: No space left on device"));
    const std::string left = read(path("left"));
    EXPECT_EQ(left.find(".curvature"), std::string::npos) << "no leftovers";
    EXPECT_EQ(result.json()["made"].get<long>(), std::count(left.begin(), left.end(), '\n'));
    EXPECT_EQ(run({"batch", m, "-o", path("out")}).exitCode, 0) << "with room it goes on";
}

TEST_F(BatchCommand, ProgressIsABarOnATerminalAndLinesElsewhere) {
    std::string radii;
    for (int i = 0; i < 4000; ++i) radii += (i ? ", " : "") + std::to_string(1 + 0.001 * i);
    const std::string m = manifest("[[grid]]\nsize = 16\ndiffusion_radius = [" + radii + "]\n");
    const auto plain = run({"batch", m, "-o", path("out")});
    EXPECT_TRUE(contains(plain.err, "4000 of 4000, "));
    EXPECT_TRUE(contains(plain.err, " per second"));
    EXPECT_EQ(plain.err.find('\r'), std::string::npos);
    EXPECT_TRUE(contains(plain.out, "4000 tables: 4000 made"));
    fs::remove_all(path("out"));
    if (std::system("script --version >/dev/null 2>&1") != 0)
        GTEST_SKIP() << "script (bsdutils) is not installed";
    const std::string line = "script -qec \"'" + std::string(PELLUCID_COMMAND) + "' batch '" + m + "' -o '" +
                             path("out") + "'\" /dev/null >'" + path("terminal") + "' 2>&1 </dev/null";
    ASSERT_EQ(std::system(line.c_str()), 0);
    const std::string shown = read(path("terminal"));
    for (const char* part : {"\r", "[#", "/4000, ", "/s", " s left", "4000 tables: 4000 made"})
        EXPECT_TRUE(contains(shown, part));
}

// The bytes of a batch's files are encoded in memory; OpenImageIO reads them.
TEST_F(BatchCommand, FilesHoldTheTexelsOfTheTable) {
    const std::string m = manifest(
        "[[grid]]\nsize = [1, 7, 33]\nencoding = [\"half\", \"float\"]\naxis = \"root\"\n"
        "[[lut]]\nkind = \"shadow\"\nsize = 5\n[[lut]]\nkind = \"specular\"\nsize = 6\n");
    const auto entries = pellucid::io::readManifest(m).entries;
    ASSERT_EQ(entries.size(), 8u);
    const pellucid::Device device("");
    for (const auto& entry : entries) {
        const std::string bytes = pellucid::io::makeEntryFile(device, entry);
        EXPECT_EQ(pellucid::io::makeEntryFile(device, entry), bytes);
        write("t.exr", bytes);
        const pellucid::io::Image image = pellucid::io::readImage(path("t.exr"));
        const bool half = entry.encoding == PEL_LUT_HALF;
        EXPECT_EQ(image.channels.at(0).type,
                  half ? pellucid::io::ChannelType::Half : pellucid::io::ChannelType::Float);
        const pellucid::Lut lut = pellucid::io::readLut(device, path("t.exr"));
        EXPECT_EQ(lut.info().kind, entry.info.kind);
        const auto& info = entry.info;
        const pellucid::Lut again = info.kind == PEL_LUT_CURVATURE ? pellucid::Lut(device, info.curvature)
                                    : info.kind == PEL_LUT_SHADOW  ? pellucid::Lut(device, info.shadow)
                                                                   : pellucid::Lut(device, info.specular);
        if (half)
            EXPECT_EQ(lut.read<uint16_t>(PEL_LUT_HALF), again.read<uint16_t>(PEL_LUT_HALF));
        else
            EXPECT_EQ(lut.read<float>(PEL_LUT_FLOAT), again.read<float>(PEL_LUT_FLOAT));
    }
}

// Values of the reference implementation.
TEST(ContentHash, IsXxh64) {
    using pellucid::io::contentHash;
    EXPECT_EQ(contentHash(""), 0xEF46DB3751D8E999u);
    EXPECT_EQ(contentHash("abc"), 0x44BC2CF5AD770999u);
    EXPECT_EQ(contentHash("Nobody inspects the spammish repetition"), 0xFBCEA83C8A378BF1u);
}
