// Runs the built `pellucid` command as its users do, and keeps its output.
#pragma once
#include <sys/wait.h>

#include <nlohmann/json.hpp>

#include "io/io_files.h"

class CommandTest : public FolderTest {
  protected:
    struct Result {
        int exitCode;
        std::string out, err;
        nlohmann::json json() const { return nlohmann::json::parse(out); }
    };

    // The words of a line as a shell reads them, with redirections; each @ stands for the test's folder.
    // `environment`: "NAME=value" words put before the command.
    Result cli(const std::string& line, const std::string& environment = "") const {
        const std::string out = scratch_ + "/stdout", err = scratch_ + "/stderr";
        const int status = std::system((filled(environment) + " '" PELLUCID_COMMAND "' >'" + out + "' 2>'" +
                                        err + "' </dev/null " + filled(line))
                                           .c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(out), read(err)};
    }
    // The same, which must succeed; and its report.
    Result done(const std::string& line, const std::string& environment = "") const {
        const Result result = cli(line, environment);
        EXPECT_EQ(result.exitCode, 0) << line << "\n" << result.err;
        return result;
    }
    nlohmann::json reportOf(const std::string& line, const std::string& environment = "") const {
        return done(line + " --json", environment).json();
    }

    // Wrong use or bad input: this exit code, this text on stderr, nothing on stdout, no file left behind.
    void refused(const std::string& line, int exitCode, const std::string& message,
                 const std::string& environment = "") const {
        const size_t files = filesInFolder();
        const Result result = cli(line, environment);
        EXPECT_EQ(result.exitCode, exitCode) << line << "\n" << result.err;
        EXPECT_TRUE(contains(result.err, message)) << line;
        EXPECT_EQ(result.out, "") << line;
        EXPECT_EQ(filesInFolder(), files) << line;
    }

    // Compares a picture of a command with the reviewed one in tests/cli/pictures. After a change that is
    // meant to be visible, look at the new pictures at full size and keep them: PELLUCID_KEEP_PICTURES=1.
    void expectKept(const std::string& made, const std::string& name, const std::string& maxRmse) const {
        const std::string kept = PELLUCID_SOURCE_DIR "/tests/cli/pictures/" + name;
        if (!keeps(made, kept)) done("compare @" + made + " '" + kept + "' --max-rmse " + maxRmse);
    }
    // The same of a text: words and numbers.
    void expectKeptText(const std::string& made, const std::string& name) const {
        const std::string kept = PELLUCID_SOURCE_DIR "/tests/cli/pictures/" + name;
        if (keeps(made, kept)) return;
        std::ifstream one(path(made)), two(kept);
        std::string word, known;
        while (two >> known) {
            ASSERT_TRUE(one >> word) << "instead of " << known;
            const char *begin = word.c_str(), *from = known.c_str();
            begin += *begin == '[', from += *from == '[';
            char *end = nullptr, *to = nullptr;
            const double value = std::strtod(begin, &end), wanted = std::strtod(from, &to);
            EXPECT_NEAR(value, wanted, 1e-3 * std::abs(wanted) + 1e-5) << name;
            EXPECT_STREQ(end, to) << name;
        }
        EXPECT_FALSE(one >> word) << word;
    }

    // The keys that every report has.
    static void expectReport(const nlohmann::json& report) {
        ASSERT_TRUE(report.is_object());
        EXPECT_TRUE(report.at("device").is_string());
        EXPECT_GE(report.at("device_ms").get<double>(), 0.0);
        EXPECT_GE(report.at("total_ms").get<double>(), report.at("device_ms").get<double>());
        EXPECT_TRUE(report.at("warnings").is_array());
    }

    void SetUp() override {
        FolderTest::SetUp();
        scratch_ = folder_.string() + ".said";  // beside the folder, whose files are counted
        std::filesystem::create_directories(scratch_);
    }
    void TearDown() override {
        std::filesystem::remove_all(scratch_);
        FolderTest::TearDown();
    }

    std::string filled(std::string line) const {
        for (size_t at; (at = line.find('@')) != std::string::npos;) line.replace(at, 1, path(""));
        return line;
    }

  private:
    bool keeps(const std::string& made, const std::string& kept) const {
        const char* keep = std::getenv("PELLUCID_KEEP_PICTURES");
        if (!keep || !*keep) return false;
        return std::filesystem::copy_file(path(made), kept,
                                          std::filesystem::copy_options::overwrite_existing);
    }

    std::string scratch_;
};
