// Compiled programs on disk: a second process compiles nothing and computes the same bits; damaged files are
// not an error. Each process is the `pellucid` command, with PELLUCID_CACHE=on, for PoCL keeps programs
// itself.
#include "cl/binary_files.h"
#include "cli_run.h"

namespace fs = std::filesystem;
using pel::cl::Digest;

namespace {

class ProgramsOnDisk : public CommandTest {
  protected:
    // Builds the programs of tables; returns the report.
    struct Counts {
        int programs, loaded, stored;
    };
    Counts warmUp(const std::string& environment) const {
        const nlohmann::json said = reportOf("warm-up --luts --threads 1", environment);
        return {said.at("programs"), said.at("loaded"), said.at("stored")};
    }
    void expectWarmUp(const std::string& environment, const Counts& expected) const {
        const Counts is = warmUp(environment);
        EXPECT_EQ(is.programs, expected.programs) << environment;
        EXPECT_EQ(is.loaded, expected.loaded) << environment;
        EXPECT_EQ(is.stored, expected.stored) << environment;
    }
    std::string table(const std::string& environment) const {
        done("lut shadow --size 24x16 -o @t.npy", environment);
        return read(path("t.npy"));
    }
    std::vector<fs::path> files() const {
        std::vector<fs::path> found;
        std::error_code none;
        for (const auto& entry : fs::directory_iterator(path("cache"), none)) found.push_back(entry.path());
        return found;
    }
};

const std::string cache = "PELLUCID_CACHE_DIR=@cache ", on = "PELLUCID_CACHE=on " + cache;

}  // namespace

TEST_F(ProgramsOnDisk, ASecondProcessCompilesNothingAndComputesTheSameBits) {
    const std::string truth = table("PELLUCID_CACHE=off");
    const int n = warmUp(on).stored;
    ASSERT_GT(n, 3);
    EXPECT_EQ(int(files().size()), n);
    expectWarmUp(on, {n, n, 0});
    EXPECT_EQ(table(on), truth);
    EXPECT_EQ(int(files().size()), n) << "the table's programs were among them";

    // A file with a right checksum that holds no program is compiled again and replaced.
    const fs::path file = files().front();
    const std::string nonsense(1000, 'n');
    const Digest sum = Digest().addPart(file.stem().string()).add(nonsense);
    std::ofstream(file, std::ios::binary) << sum.text() << nonsense;
    expectWarmUp(on, {n, n - 1, 1});
    expectWarmUp(on, {n, n, 0});
    EXPECT_EQ(table(on), truth);
    // No room: built, not kept.
    EXPECT_EQ(warmUp(on + "PELLUCID_CACHE_MB=0").loaded, 0);
    expectWarmUp(on + "PELLUCID_CACHE=off", {n, 0, 0});
}

TEST_F(ProgramsOnDisk, AWarmUpMakesBinariesForPoclAndOthersLoadThem) {
    const std::string truth = table(cache);
    if (pellucid::Device("").info().platform != std::string("Portable Computing Language"))
        GTEST_SKIP() << "PoCL is not the device";
    EXPECT_TRUE(files().empty()) << "a table alone makes none: that would compile everything once more";
    const Counts made = warmUp(cache);
    EXPECT_EQ(made.stored, made.programs);
    expectWarmUp(cache + "PELLUCID_CACHE=auto", {made.programs, made.programs, 0});
    EXPECT_EQ(table(cache), truth);
    // Not from a folder where others may write.
    fs::permissions(path("cache"), fs::perms::all);
    const Counts open = warmUp(cache + "PELLUCID_CACHE=auto");
    EXPECT_EQ(open.loaded, 0);
    EXPECT_EQ(open.programs, made.programs);
}

TEST_F(ProgramsOnDisk, AFolderThatCannotBeWrittenIsNoError) {
    // A file where the folder should be: root may write wherever there is a folder.
    write("cache", "a file");
    const Counts blocked = warmUp(on);
    EXPECT_GT(blocked.programs, 3);
    EXPECT_EQ(blocked.loaded, 0);
    EXPECT_EQ(blocked.stored, 0);
    fs::remove(path("cache"));
    if (::geteuid() == 0) return;
    fs::create_directories(path("cache"));
    fs::permissions(path("cache"), fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_EQ(warmUp(on).stored, 0);
    fs::permissions(path("cache"), fs::perms::owner_all);
}

TEST_F(ProgramsOnDisk, TwoProcessesAtOnce) {
    nlohmann::json said[2];
    const auto one = [&](int i) {
        // Not by cli(), which has one place for what is printed.
        const std::string out = path("said" + std::to_string(i));
        const std::string line =
            filled(on) + PELLUCID_COMMAND + " prefill --luts --threads 1 --json >" + out + " 2>/dev/null";
        ASSERT_EQ(std::system(line.c_str()), 0);
        said[i] = nlohmann::json::parse(read(out));
    };
    std::thread other(one, 0);
    one(1);
    other.join();
    const int n = said[0].at("programs");
    for (const auto& s : said) EXPECT_EQ(s.at("loaded").get<int>() + s.at("stored").get<int>(), n);
    EXPECT_EQ(int(files().size()), n);
    for (const fs::path& file : files()) EXPECT_EQ(file.extension(), ".bin");
    EXPECT_EQ(warmUp(on).loaded, n);
}
