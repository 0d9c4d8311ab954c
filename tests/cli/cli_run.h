// Runs the built `pellucid` command as its users do, and keeps what it says.
#pragma once
#include <sys/wait.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/io_files.h"

class CommandTest : public FolderTest {
  protected:
    struct Result {
        int exitCode;
        std::string out, err;
        nlohmann::json json() const { return nlohmann::json::parse(out); }
    };

    // `environment`: "NAME=value" words put before the command.
    Result run(const std::vector<std::string>& arguments, const std::string& environment = "") const {
        const std::string out = scratch_ + "/stdout", err = scratch_ + "/stderr";
        std::string line = environment + " " + quoted(PELLUCID_COMMAND);
        for (const std::string& argument : arguments) line.append(" ").append(quoted(argument));
        line += " >" + quoted(out) + " 2>" + quoted(err) + " </dev/null";
        const int status = std::system(line.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(out), read(err)};
    }

    // Wrong use or bad input: this exit code, this text on stderr, nothing on stdout, no file left behind.
    void expectRefused(const std::vector<std::string>& arguments, int exitCode, const std::string& message,
                       const std::string& environment = "") const {
        const size_t files = filesInFolder();
        const Result result = run(arguments, environment);
        std::string line;
        for (const std::string& argument : arguments) line += argument + " ";
        EXPECT_EQ(result.exitCode, exitCode) << line << "\n" << result.err;
        EXPECT_TRUE(contains(result.err, message)) << line;
        EXPECT_EQ(result.out, "") << line;
        EXPECT_EQ(filesInFolder(), files) << line;
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

    // A folder whose files are not counted.
    const std::string& scratch() const { return scratch_; }

  private:
    static std::string quoted(const std::string& text) {
        std::string out = "'";
        for (char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
        return out + "'";
    }
    std::string scratch_;
};
