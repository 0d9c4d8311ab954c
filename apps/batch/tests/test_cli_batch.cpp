// `pellucid batch`: manifests, files, the index, kills and full disks.
#include "batch/batch_manifest.h"
#include "cli/cli_run.h"
#include "io/choice_keys.h"
#include "io/content_hash.h"
#include "io/image/image_file.h"
#include "io/image/image_format.h"
#include "io/lut/lut_file.h"

namespace fs = std::filesystem;

class BatchCommand : public CommandTest {
  protected:
    // Runs a manifest of this text, m.toml, into the folder `out`.
    Result batch(const std::string& text, const std::string& more = "",
                 const std::string& environment = "") const {
        std::ofstream(path("m.toml")) << text;
        return cli("batch @m.toml -o @out --json " + more, environment);
    }
    nlohmann::json made(const std::string& text) const {
        const Result result = batch(text);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        expectReport(result.json());
        return result.json();
    }
    nlohmann::json index() const { return nlohmann::json::parse(read(path("out/m.index.json"))); }
    // Without the index; `hidden`: under temporary names.
    std::vector<fs::path> files(bool hidden = false) const {
        std::vector<fs::path> all;
        for (const auto& entry : fs::directory_iterator(path("out")))
            if (entry.path().extension() != ".json" && (entry.path().filename().string()[0] == '.') == hidden)
                all.push_back(entry.path());
        std::sort(all.begin(), all.end());
        return all;
    }
};

namespace {

std::string radii(int count, double step) {
    std::string list;
    for (int i = 0; i < count; ++i) list += (i ? ", " : "") + std::to_string(1 + step * i);
    return "diffusion_radius = [" + list + "]\n";
}

const std::string shadow = "[[lut]]\nkind = \"shadow\"\nname = \"s\"\n";

}  // namespace

TEST_F(BatchCommand, MakesKeepsAndRepairs) {
    const std::string text =
        "[[grid]]\nprofile = [\"skin\", \"marble\"]\nform = [\"arc\", \"sphere\"]\naxis = \"root\"\n"
        "size = [8, 16]\n" +
        shadow + "size = 12\n[[lut]]\nkind = \"specular\"\nsize = 9\n" + shadow + "size = 12\n";
    const auto first = made(text);
    EXPECT_EQ(first["entries"], 10);
    EXPECT_EQ(first["made"], 10);
    EXPECT_EQ(first["duplicates"], 1);
    const auto all = files();
    ASSERT_EQ(all.size(), 10u);
    EXPECT_EQ(made(text)["kept"], 10);
    // Each file is damaged in a different way, and made again with its original bytes.
    const size_t attribute = read(all[4].string()).find("root", read(all[4].string()).find("pellucid:axis"));
    ASSERT_NE(attribute, std::string::npos);
    std::vector<std::string> before;
    for (size_t i = 0; i < 5; ++i) before.push_back(read(all[i].string()));
    const std::function<void(std::string&)> damages[] = {
        [](std::string& bytes) { bytes.resize(bytes.size() / 2); },
        [](std::string& bytes) { bytes[bytes.size() - 9] ^= 0x55; },
        [](std::string& bytes) { bytes += '\0'; },
        [&](std::string& bytes) { bytes = before[0]; },  // another entry's
        [&](std::string& bytes) { bytes[attribute] ^= 1; }};
    for (size_t i = 0; i < std::size(damages); ++i) {
        std::string bytes = before[i];
        damages[i](bytes);
        std::ofstream(all[i], std::ios::binary) << bytes;
    }
    fs::remove(all[9]);
    const auto repaired = made(text);
    EXPECT_EQ(repaired["made"], 6);
    EXPECT_EQ(repaired["redone"], 5);
    EXPECT_EQ(repaired["kept"], 4);
    EXPECT_EQ(files(), all);
    for (size_t i = 0; i < before.size(); ++i) EXPECT_EQ(read(all[i].string()), before[i]) << i;
}

TEST_F(BatchCommand, NamesFilesAndWritesAnIndexOfThem) {
    const std::string text =
        "version = 1\n[[grid]]\nname = \"{profile}-{form}-{size}\"\nprofile = [\"skin\", \"marble\"]\n"
        "form = [\"arc\", \"sphere\"]\nsize = [8, 9]\n[[lut]]\nkind = \"specular\"\nname = \"shine\"\n"
        "size = 10\n[[lut]]\nkind = \"shadow\"\nsize = 8\nencoding = \"float\"\nwidth_min = 7.5\n";
    EXPECT_EQ(made(text)["index"], "m.index.json");
    const nlohmann::json written = index(), tables = written["tables"];
    EXPECT_EQ(written["version"], 1);
    EXPECT_EQ(written["manifest"], "m.toml");
    EXPECT_EQ(written["missing"], 0);
    ASSERT_EQ(tables.size(), 10u);
    EXPECT_EQ(files().size(), 10u);
    for (const nlohmann::json& table : tables) {
        const PelLutInfo info =
            pellucid::io::readLut(pellucid::Device(), path("out/" + table["file"].get<std::string>())).info();
        EXPECT_EQ(pellucid::io::lutKinds[info.kind], table["kind"].get<std::string>());
        if (info.kind != PEL_LUT_CURVATURE) continue;
        EXPECT_EQ(table["name"].get<std::string>() + ".exr", table["file"]);
        EXPECT_EQ(table["name"], table["profile"].get<std::string>() + "-" +
                                     table["form"].get<std::string>() + "-" +
                                     std::to_string(info.curvature.width));
        EXPECT_EQ(table["width"], info.curvature.width);
        EXPECT_EQ(table["radius_max"], info.curvature.radiusMax);
    }
    EXPECT_EQ(tables[0]["file"], "shine.exr");  // [[lut]] before [[grid]]
    EXPECT_EQ(tables[1]["width_min"], 7.5);
    EXPECT_FALSE(tables[1].contains("name"));
    EXPECT_NEAR(tables[1]["diffusion_radius"].get<double>(), 2.7, 0.1);  // the profile's own
    // A table that cannot be made is counted and not listed.
    EXPECT_EQ(batch(text + "[[lut]]\nprofile = \"granite\"\n").exitCode, 3);
    EXPECT_EQ(index()["missing"], 1);
    EXPECT_EQ(index()["tables"], tables);
    EXPECT_EQ(made("[[lut]]\nname = \"shine\"\nsize = 8\n")["redone"], 1) << "another request of this name";
    // What is no file is in the way of its own entry alone.
    fs::create_directory(path("out/folder.exr"));
    fs::create_symlink("loop.exr", path("out/loop.exr"));
    const Result beside = batch(
        "[[lut]]\nname = \"folder\"\nsize = 8\n[[lut]]\nname = \"loop\"\nsize = 8\n"
        "[[lut]]\nname = \"free\"\nsize = 8\n");
    EXPECT_EQ(beside.exitCode, 3);
    EXPECT_EQ(beside.json()["made"], 1);
    for (const char* name : {"m.toml:1", "folder.exr is in the way", "m.toml:4", "loop.exr is in the way"})
        EXPECT_TRUE(contains(beside.err, name)) << beside.err;
}

// Requests that differ in one field alone.
TEST(BatchManifest, EveryFieldOfATableIsInItsName) {
    std::string text = "version = 2\n";
    for (const char* field : {"", "size = 9", "encoding = \"float\"", "profile = \"marble\"",
                              "form = \"arc\"", "axis = \"linear\"", "radius_min = 0.3", "radius_max = 70",
                              "diffusion_radius = 3", "melanin = 0.1", "blood = 0.1", "oxygenation = 0.5"})
        text += std::string("[[lut]]\n") + field + "\n";
    for (const char* field : {"", "size = 9", "axis = \"linear\"", "width_min = 0.3", "width_max = 70",
                              "sharpening = 2", "closed_ends = 0"})
        text += std::string("[[lut]]\nkind = \"shadow\"\n") + field + "\n";
    const auto manifest = pellucid::io::parseManifest("m.toml", text, {});
    EXPECT_TRUE(manifest.errors.empty());
    EXPECT_EQ(manifest.duplicates, 0u);
    EXPECT_EQ(manifest.text, text);
    std::set<std::string> names;
    for (const auto& entry : manifest.entries) names.insert(entry.file);
    EXPECT_EQ(names.size(), 19u);
    // And the whole of a profile's file, such as one row of a table.
    std::set<std::string> files;
    for (const char* value : {"0.5", "0.25"}) {
        std::string profile = "name = \"rows\"\nkind = \"table\"\nunit = \"mm\"\nsource = \"none\"\n";
        for (int i = 0; i < 40; ++i)
            profile += "[[sample]]\ndistance = 0." + std::to_string(10 + i) + "\nvalue = [1, 1, " +
                       (i == 20 ? value : "1") + "]\n";
        const auto made =
            pellucid::io::parseManifest("m.toml", "[[lut]]\nprofile = \"p.toml\"\n", {{"p.toml", profile}});
        ASSERT_TRUE(made.errors.empty()) << made.errors[0].message;
        files.insert(made.entries.at(0).file);
    }
    EXPECT_EQ(files.size(), 2u);
}

// By default a manifest of version 1 makes FaceWorks' tables, one of version 2 those that a material makes of
// its profile. What these are: test_cli_lut.cpp.
TEST_F(BatchCommand, TablesBeginAsTheVersionOrThePresetSays) {
    const auto tables = [&](const std::string& text) { return made(text), index()["tables"]; };
    for (const auto& [version, preset, faceworks] : {std::tuple{"", "", true},
                                                     {"", "preset = \"material\"\n", false},
                                                     {"version = 2\n", "", false},
                                                     {"version = 2\n", "preset = \"faceworks\"\n", true}}) {
        const auto both = tables(version + ("[[lut]]\nname = \"c\"\n" + (preset + shadow)) + preset);
        EXPECT_EQ(both[0]["form"], faceworks ? "arc" : "sphere") << version << preset;
        EXPECT_EQ(both[1]["closed_ends"], faceworks ? 0 : 1) << version << preset;
        EXPECT_EQ(both[1]["width_min"] == 8, faceworks) << version << preset;
    }
    // A shadow has no form.
    const auto shadows = made("[[grid]]\nkind = \"shadow\"\nform = [\"arc\", \"sphere\"]\nsize = 8\n");
    EXPECT_EQ(shadows["entries"].get<int>() + shadows["duplicates"].get<int>(), 1);
    // The axis of shadow tables counts, unless an older manifest has one that did not.
    const std::string small = shadow + "size = 8\n";
    EXPECT_EQ(tables("version = 2\n" + small + "axis = \"linear\"\n")[0]["axis"], "linear");
    EXPECT_EQ(tables(small + "axis = \"root\"\n")[0]["axis"], "linear");
    EXPECT_EQ(tables("version = 2\n" + small +
                     "closed_ends = 0\nradius_min = 5\nradius_max = 1\n")[0]["closed_ends"],
              0);
}

// Tables of one size below each other in one file, the last of which is shorter.
TEST_F(BatchCommand, AStackHoldsTheTexelsOfItsTables) {
    const std::string grid = "[[grid]]\nmelanin = [0.01, 0.1, 0.3]\nblood = [0.02, 0.05]\nsize = 8\n",
                      stacked = grid + "stack = 4\n";
    made(grid + "name = \"{profile}\"\n");
    EXPECT_TRUE(fs::exists(path("out/skin-0.1-0.05-0.75.exr")));
    const auto texels = [&](const nlohmann::json& file) {
        const std::string rgb[] = {"R", "G", "B"};
        return pellucid::io::readImage(path("out/" + std::string(file["file"]))).interleaved(rgb);
    };
    std::map<std::string, std::vector<float>> single;
    const nlohmann::json tables = index()["tables"];
    for (const auto& table : tables) single[table["profile"]] = texels(table);
    fs::remove_all(path("out"));
    nlohmann::json report = made(stacked);
    EXPECT_EQ(report["entries"], 2);
    EXPECT_EQ(report["tables"], 6);
    const nlohmann::json files = index()["tables"];
    ASSERT_EQ(files.size(), 2u);
    EXPECT_EQ(files[0]["stack"].size(), 4u);
    EXPECT_EQ(files[1]["stack"].size(), 2u);
    for (const auto& file : files) {
        std::vector<float> expected;
        for (const auto& table : file["stack"]) {
            const std::vector<float>& one = single[table["profile"]];
            expected.insert(expected.end(), one.begin(), one.end());
        }
        EXPECT_EQ(texels(file), expected);
    }
    EXPECT_EQ(made(stacked)["kept"], 2);
    const auto after = batch("[[grid]]\nsize = 16\nstack = 3\nprofile = [\"skin\", \"none\"]\n" + stacked);
    EXPECT_EQ(after.json()["kept"], 2) << "nothing of an entry that failed: " << after.err;
    const std::string damaged = path("out/" + std::string(files[1]["file"]));
    fs::resize_file(damaged, fs::file_size(damaged) - 1);
    report = made(stacked);
    EXPECT_EQ(report["kept"], 1);
    EXPECT_EQ(report["redone"], 1);
    EXPECT_TRUE(contains(batch(stacked + "name = \"{profile}\"\n").err, "cannot stand beside 'stack'"));
    EXPECT_TRUE(contains(batch(grid + "stack = 5000\n").err, "stack"));
    EXPECT_TRUE(contains(batch("[[grid]]\nkind = \"specular\"\nsize = [4, 8]\nstack = 3\n").err,
                         "specular tables of one size are all the same"));
}

// Wrong entries are reported with their lines, and the others are made.
TEST_F(BatchCommand, SaysWhatIsWrong) {
    const struct {
        std::string text;
        std::vector<std::string> said;
        int made;
    } rows[] = {
        {"[[lut]]\nsize = 8\n\n[[lut]]\nsize = -3\n\n[[lut]]\nprofile = \"granite\"\n\n[[lut]]\nsize = 9\n"
         "colour = 1\n",
         {"m.toml:5", "m.toml:8", "granite", "m.toml:12", "colour"},
         1},
        {"[[lut]]\nsize = 8\n\n[[lut]]\nsize = 16384\n[[lut]]\nsize = 9\n", {"m.toml:4: "}, 1},
        {"[[lut]]\nsize = -3\n", {"m.toml:2"}, 0},
        {"[[grid]]\nname = \"a\"\nsize = [8, 9]\n", {"m.toml:2: 'name' in [[grid]] gives two tables"}, 1},
        {"[[lut]]\nname = \"b\"\nsize = 8\n[[lut]]\nname = \"b\"\nsize = 9\n",
         {"the one of line 1 has it"},
         1},
        {"[[grid]]\nsize = 8\nprofile = [\"skin\", \"marbel\", \"jade\"]\nform = [\"arc\", \"sphere\"]\n",
         {"m.toml:3", "marbel"},
         3},
        {"[[lut]]\nname = \"{colour}\"\n", {"'{colour}'; one of {axis}, "}, 0},
        {"[[grid]]\nmelanin = 0.1\nprofile = [\"jade\"]\n", {"cannot stand beside 'melanin'"}, 0},
        {"[[grid]]\nmelanin = [0.7]\n", {"melanin"}, 0},
        {"version = 3\n[[lut]]\nsize = 8\n", {"of a later pellucid"}, -1},
        {"version = 1.5\n[[lut]]\nsize = 8\n", {"'version'"}, -1},
        {"[[lut]\n", {"m.toml:"}, -1},
        {"x = 1\n", {"m.toml"}, -1},
    };
    for (const auto& [text, said, made] : rows) {
        SCOPED_TRACE(text);
        const fs::path last = path("out/m.index.json");
        const std::string before = fs::exists(last) ? read(last.string()) : "";
        const Result result = batch(text, "", "POCL_MEMORY_LIMIT=1");  // GiB: too little for the large one
        EXPECT_EQ(result.exitCode, 3);
        for (const std::string& part : said) EXPECT_TRUE(contains(result.err, part));
        if (made >= 0) {
            EXPECT_EQ(result.json()["made"], made);
            EXPECT_TRUE(contains(result.json()["warnings"][0].get<std::string>(), "m.toml:"));
        } else {
            EXPECT_EQ(result.out, "");
        }
        if (made <= 0) {  // the index of an earlier run stays as it is
            EXPECT_EQ(read(last.string()), before);
        }
    }
    for (const char* name : {"../a", "a/b", ".a", "-a", "a b", "{size", "", "\\u00e4"})
        EXPECT_TRUE(contains(batch("[[lut]]\nsize = 8\nname = \"" + std::string(name) + "\"\n").err,
                             "m.toml:3: 'name'"))
            << name;
    EXPECT_EQ(cli("batch @none.toml -o @out").exitCode, 3);
    EXPECT_EQ(cli("batch @m.toml -o /dev/null/folder").exitCode, 3);
    EXPECT_EQ(cli("batch @m.toml").exitCode, 2);
    EXPECT_EQ(cli("batch @m.toml -o @new").exitCode, 3);
    EXPECT_FALSE(fs::exists(path("new/m.index.json")));
}

// Kills the command at a random number of files; files with their final name are complete and are kept.
TEST_F(BatchCommand, KilledAtAnyMomentLosesWhatWasInFlight) {
    const std::string text = "[[grid]]\nsize = [24, 40]\n" + radii(300, 0.01);
    write("m.toml", text);
    fs::create_directories(path("out"));
    constexpr unsigned jobs = 6;
    unsigned random = 1;
    for (int round = 0; round < 5; ++round) {
        random = random * 1664525 + 1013904223;  // [Numerical Recipes]
        const size_t before = files().size(), left = files(true).size(), enough = before + (random >> 26);
        const std::string line =
            pellucid::io::concat("'", PELLUCID_COMMAND, "' batch '", path("m.toml"), "' -j ", jobs, " -o '",
                                 path("out"), "' >/dev/null 2>&1 & batch=$!; until [ $(ls '", path("out"),
                                 "' | wc -l) -gt ", enough, " ]; do :; done; kill -KILL $batch; wait $batch");
        EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 137) << "it ended before it was killed";
        EXPECT_GE(files().size(), before);
        EXPECT_LE(files(true).size(), left + jobs) << "more than was in flight";
    }
    const size_t whole = files().size();
    for (const bool hidden : {false, true})  // as if the kill had been a while ago
        for (const fs::path& file : files(hidden))
            fs::last_write_time(file, fs::last_write_time(file) - std::chrono::minutes(5));
    const auto result = made(text);
    EXPECT_EQ(result["kept"], whole);
    EXPECT_EQ(result["redone"], 0) << "a file that had its name was broken";
    EXPECT_EQ(result["made"], 600 - whole);
    // The last killed process may still have been waiting for its disk.
    for (int i = 0; i < 50 && !files(true).empty(); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        EXPECT_EQ(made(text)["kept"], 600);
    }
    EXPECT_TRUE(files(true).empty()) << "what the killed left behind is removed";
}

TEST_F(BatchCommand, SeveralDevicesShareAManifest) {
    const std::string text =
        "[[grid]]\nsize = [8, 12, 16, 20, 24, 28]\nform = [\"arc\", \"ring\"]\n"
        "axis = [\"linear\", \"root\"]\n";
    made(text);
    fs::rename(path("out"), path("one"));
    const auto result = batch(text, "--device '' --device '' -j 4");
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto devices = result.json()["devices"];
    ASSERT_EQ(devices.size(), 2u);
    EXPECT_EQ(devices[0]["made"].get<int>() + devices[1]["made"].get<int>(), 24);
    EXPECT_GT(devices[0]["made"], 0);
    EXPECT_GT(devices[1]["made"], 0);
    for (const fs::path& file : files())
        EXPECT_EQ(read(file.string()), read(path("one/" + file.filename().string()))) << "the same bytes";
    EXPECT_EQ(batch(text, "--device abacus").exitCode, 4);
}

TEST_F(BatchCommand, AFullDiskIsAClearError) {
    fs::create_directories(path("out"));
    if (std::system("unshare -rm true 2>/dev/null") != 0)
        GTEST_SKIP() << "no right to mount a small file system of one's own";
    const std::string text = "[[grid]]\nsize = [40, 44, 48, 52, 56, 60, 64, 68]\n",
                      full = "unshare -rm sh -c 'mount -t tmpfs -o size=64k none \"" + path("out") +
                             "\" && { \"$0\" $*; echo $? >\"" + path("code") + "\"; ls -A -I \"*.json\" \"" +
                             path("out") + "\" >\"" + path("left") + "\"; }'";
    const auto result = batch(text, "", full);
    EXPECT_EQ(read(path("code")), "3\n") << result.err;
    EXPECT_TRUE(contains(result.err, "cannot be written: No space left on device"));
    const std::string left = read(path("left"));
    EXPECT_EQ(left.find(".curvature"), std::string::npos) << "no leftovers";
    EXPECT_EQ(result.json()["made"].get<long>(), std::count(left.begin(), left.end(), '\n'));
    EXPECT_EQ(made(text)["made"], 8) << "with room it goes on";
}

TEST_F(BatchCommand, ProgressIsInPlaceOnATerminalAndLinesElsewhere) {
    const std::string m = write("m.toml", "[[grid]]\nsize = 16\n" + radii(1500, 0.001));
    const auto plain = cli("batch '" + m + "' -o @out");
    EXPECT_TRUE(contains(plain.err, "1500 of 1500, "));
    EXPECT_TRUE(contains(plain.err, " per second"));
    EXPECT_EQ(plain.err.find('\r'), std::string::npos);
    EXPECT_TRUE(contains(plain.out, "1500 tables: 1500 made"));
    fs::remove_all(path("out"));
    if (std::system("script --version >/dev/null 2>&1") != 0)
        GTEST_SKIP() << "script (bsdutils) is not installed";
    const std::string line = "script -qec \"'" + std::string(PELLUCID_COMMAND) + "' batch '" + m + "' -o '" +
                             path("out") + "'\" /dev/null >'" + path("terminal") + "' 2>&1 </dev/null";
    ASSERT_EQ(std::system(line.c_str()), 0);
    for (const char* part : {"\r", " of 1500, ", " per second, ", " s left", "1500 tables: 1500 made"})
        EXPECT_TRUE(contains(read(path("terminal")), part));
}

// The bytes of a batch's files are encoded in memory; OpenImageIO reads them, and writes the same header.
TEST_F(BatchCommand, FilesHoldTheTexelsOfTheTable) {
    const auto entries = pellucid::io::readManifest(write("m.toml",
                                                          "[[grid]]\nsize = [1, 7, 33]\naxis = \"root\"\n"
                                                          "encoding = [\"half\", \"float\"]\n"
                                                          "[[lut]]\nkind = \"shadow\"\nsize = 5\n"
                                                          "[[lut]]\nkind = \"specular\"\nsize = 6\n"))
                             .entries;
    ASSERT_EQ(entries.size(), 8u);
    const pellucid::Device device("");
    for (const auto& entry : entries) {
        const std::string bytes = pellucid::io::makeEntryFile(device, entry);
        EXPECT_EQ(pellucid::io::makeEntryFile(device, entry), bytes);
        write("t.exr", bytes);
        const bool half = entry.encoding == PEL_LUT_HALF;
        EXPECT_EQ(pellucid::io::readImage(path("t.exr")).channels.at(0).type,
                  half ? pellucid::io::ChannelType::Half : pellucid::io::ChannelType::Float);
        const pellucid::Lut lut = pellucid::io::readLut(device, path("t.exr"));
        const PelLutInfo info = entry.tables.front().filled();
        EXPECT_EQ(lut.info().kind, info.kind);
        const pellucid::Lut again = info.kind == PEL_LUT_CURVATURE ? pellucid::Lut(device, info.curvature)
                                    : info.kind == PEL_LUT_SHADOW  ? pellucid::Lut(device, info.shadow)
                                                                   : pellucid::Lut(device, info.specular);
        if (half)
            EXPECT_EQ(lut.read<uint16_t>(PEL_LUT_HALF), again.read<uint16_t>(PEL_LUT_HALF));
        else
            EXPECT_EQ(lut.read<float>(PEL_LUT_FLOAT), again.read<float>(PEL_LUT_FLOAT));
        pellucid::io::writeLut(path("t.exr"), again, entry.encoding);
        std::map<std::string_view, std::string_view> known;
        const std::string whole = read(path("t.exr"));
        for (pellucid::io::ExrAttributes from(whole); const auto a = from.next();) known[a->name] = a->value;
        for (pellucid::io::ExrAttributes from(bytes); const auto a = from.next();) {
            const bool own = a->name == "compression" || a->name.ends_with("key") || a->name.ends_with("sum");
            EXPECT_TRUE(own || known[a->name] == a->value) << a->name;
            known.erase(a->name);
        }
        for (const auto& [name, value] : known) EXPECT_FALSE(name.starts_with("pellucid:")) << name;
    }
}

// A value of the reference implementation; names of files depend on it.
TEST(ContentHash, IsXxh64) {
    EXPECT_EQ(pellucid::io::contentHash("Nobody inspects the spammish repetition"), 0xFBCEA83C8A378BF1u);
}
