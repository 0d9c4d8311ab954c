// Compiled programs on disk: a second process compiles nothing and computes the same bits; whatever is wrong
// with the files is no error. Each process is the `pellucid` command, with PELLUCID_CACHE=on, for PoCL keeps
// programs itself.
#include <unistd.h>

#include <pellucid/pellucid.hpp>
#include <thread>

#include "cl/digest.h"
#include "cli_run.h"

namespace fs = std::filesystem;
using pel::cl::Digest;

namespace {

class ProgramsOnDisk : public CommandTest {
  protected:
    // Builds the programs of tables; returns the report.
    nlohmann::json warmUp(const std::string& environment) const {
        const Result result = run({"warm-up", "--luts", "--threads", "1", "--json"}, environment);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return result.exitCode ? nlohmann::json() : result.json();
    }
    std::string table(const std::string& environment, const std::string& name) const {
        const Result result = run({"lut", "shadow", "--size", "24x16", "-o", path(name)}, environment);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return read(path(name));
    }
    std::string on(const std::string& more = "") const {
        return "PELLUCID_CACHE=on PELLUCID_CACHE_DIR='" + path("cache") + "' " + more;
    }
    std::vector<fs::path> files() const {
        std::vector<fs::path> found;
        std::error_code none;
        for (const auto& entry : fs::directory_iterator(path("cache"), none)) found.push_back(entry.path());
        return found;
    }
};

}  // namespace

TEST_F(ProgramsOnDisk, ASecondProcessCompilesNothingAndComputesTheSameBits) {
    const std::string truth = table("PELLUCID_CACHE=off", "off.npy");
    const nlohmann::json first = warmUp(on());
    const int programs = first.at("programs");
    ASSERT_GT(programs, 3);
    EXPECT_EQ(first.at("loaded"), 0);
    EXPECT_EQ(first.at("stored"), programs);
    EXPECT_EQ(int(files().size()), programs);
    const nlohmann::json second = warmUp(on());
    EXPECT_EQ(second.at("programs"), programs);
    EXPECT_EQ(second.at("loaded"), programs);
    EXPECT_EQ(second.at("stored"), 0);
    EXPECT_EQ(table(on(), "on.npy"), truth);
    EXPECT_EQ(int(files().size()), programs) << "the table's programs were among them";

    // Another width is another program.
    const bool eight = pellucid::Device("").info().mathWidth == 8;
    const nlohmann::json other = warmUp(on(eight ? "PELLUCID_MATH_WIDTH=16" : "PELLUCID_MATH_WIDTH=8"));
    EXPECT_EQ(other.at("loaded"), 0);
    EXPECT_EQ(other.at("stored"), programs);

    // A file that is damaged, cut short or of another program: compiled again and replaced.
    const std::vector<fs::path> all = files();
    for (size_t i = 0; i < all.size(); ++i) {
        std::string text = read(all[i].string());
        if (i % 3 == 0) text[text.size() / 2] ^= 1;
        if (i % 3 == 1) text.resize(text.size() / 2);
        if (i % 3 == 2) text = "not a program";
        std::ofstream(all[i], std::ios::binary) << text;
    }
    const nlohmann::json mended = warmUp(on());
    EXPECT_EQ(mended.at("loaded"), 0);
    EXPECT_EQ(mended.at("stored"), programs);
    EXPECT_EQ(warmUp(on()).at("loaded"), programs);
    EXPECT_EQ(table(on(), "mended.npy"), truth);
}

TEST_F(ProgramsOnDisk, AWarmUpMakesBinariesForPoclAndOthersLoadThem) {
    const std::string folder = "PELLUCID_CACHE_DIR='" + path("cache") + "' ";
    const std::string truth = table(folder, "before.npy");
    if (pellucid::Device("").info().platform != std::string("Portable Computing Language"))
        GTEST_SKIP() << "PoCL is not the device";
    EXPECT_TRUE(files().empty()) << "a table alone makes none: that would compile everything once more";
    const nlohmann::json made = warmUp(folder);
    EXPECT_EQ(made.at("stored"), made.at("programs"));
    const nlohmann::json quick = warmUp(folder + "PELLUCID_CACHE=auto");
    EXPECT_EQ(quick.at("loaded"), made.at("programs"));
    EXPECT_EQ(quick.at("stored"), 0);
    EXPECT_EQ(table(folder, "after.npy"), truth);
    // Not from a folder where others may write.
    fs::permissions(path("cache"), fs::perms::all);
    const nlohmann::json open = warmUp(folder + "PELLUCID_CACHE=auto");
    EXPECT_EQ(open.at("loaded"), 0);
    EXPECT_EQ(open.at("programs"), made.at("programs"));
}

TEST_F(ProgramsOnDisk, ABinaryThatTheDriverRefusesIsCompiledAgain) {
    const nlohmann::json first = warmUp(on());
    // Complete files with the right checksum of something that is not a program.
    for (const fs::path& file : files()) {
        const std::string nonsense(1000, 'n');
        const Digest sum = Digest().addPart(file.stem().string()).add(nonsense);
        std::ofstream(file, std::ios::binary) << sum.text() << nonsense;
    }
    const nlohmann::json again = warmUp(on());
    EXPECT_EQ(again.at("loaded"), 0);
    EXPECT_EQ(again.at("stored"), first.at("programs"));
}

TEST_F(ProgramsOnDisk, AFolderThatCannotBeWrittenIsNoError) {
    // A file where the folder should be: root may write wherever there is a folder.
    write("cache", "a file");
    const nlohmann::json blocked = warmUp(on());
    EXPECT_GT(blocked.at("programs"), 3);
    EXPECT_EQ(blocked.at("loaded"), 0);
    EXPECT_EQ(blocked.at("stored"), 0);
    fs::remove(path("cache"));
    if (::geteuid() == 0) return;
    fs::create_directories(path("cache"));
    fs::permissions(path("cache"), fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_EQ(warmUp(on()).at("stored"), 0);
    fs::permissions(path("cache"), fs::perms::owner_all);
}

TEST_F(ProgramsOnDisk, TwoProcessesAtOnceAndTheSwitch) {
    nlohmann::json said[2];
    const auto one = [&](int i) {
        // Not by run(), which has one place for what is printed.
        const std::string out = path("said" + std::to_string(i));
        const std::string line =
            on() + PELLUCID_COMMAND + " prefill --luts --threads 1 --json >" + out + " 2>/dev/null";
        ASSERT_EQ(std::system(line.c_str()), 0);
        said[i] = nlohmann::json::parse(read(out));
    };
    std::thread other(one, 0);
    one(1);
    other.join();
    const int programs = said[0].at("programs");
    for (const auto& s : said) EXPECT_EQ(s.at("loaded").get<int>() + s.at("stored").get<int>(), programs);
    EXPECT_EQ(int(files().size()), programs);
    for (const fs::path& file : files()) EXPECT_EQ(file.extension(), ".bin");
    EXPECT_EQ(warmUp(on()).at("loaded"), programs);

    for (const char* off : {"PELLUCID_CACHE=off", "PELLUCID_CACHE_DIR=", "PELLUCID_CACHE_DIR=off"}) {
        const nlohmann::json none = warmUp(on(off));
        EXPECT_EQ(none.at("loaded").get<int>() + none.at("stored").get<int>(), 0) << off;
    }
    expectRefused({"warm-up", "--luts"}, 2, "PELLUCID_CACHE is \"perhaps\"; it can be on, off or auto",
                  "PELLUCID_CACHE=perhaps");
    expectRefused({"warm-up", "--luts"}, 2, "PELLUCID_CACHE_MB is \"much\"", on("PELLUCID_CACHE_MB=much"));
    // No room: built, not kept.
    EXPECT_EQ(warmUp(on("PELLUCID_CACHE_MB=0")).at("loaded"), 0);
}
