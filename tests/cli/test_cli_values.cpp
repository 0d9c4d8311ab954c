// What the command says to a value that an option does not take: of every option of every subcommand.
#include <pellucid/pellucid.hpp>
#include <regex>
#include <sstream>

#include "cli_run.h"

using CliValues = CommandTest;

namespace {

struct Option {
    std::vector<std::string> command;
    std::string name;
    std::vector<std::string> words;  // that it takes; empty: numbers
};

// Names of subcommands from their parent's help.
std::vector<std::string> subcommands(const std::string& help) {
    std::vector<std::string> names;
    const size_t from = help.find("Subcommands:");
    std::istringstream lines(from == std::string::npos ? "" : help.substr(from));
    std::string line;
    for (std::getline(lines, line); std::getline(lines, line);)
        if (std::smatch match; std::regex_search(line, match, std::regex("^  ([a-z][a-z-]*)")))
            names.push_back(match[1]);
    return names;
}

}  // namespace

TEST_F(CliValues, EveryOptionNamesWhatItTakes) {
    std::vector<Option> options;
    std::vector<std::vector<std::string>> waiting{{}};
    while (!waiting.empty()) {
        const std::vector<std::string> command = waiting.back();
        waiting.pop_back();
        if (!command.empty() && (command[0] == "view" || command[0] == "gallery"))
            continue;  // the Python package's
        std::vector<std::string> asked = command;
        asked.push_back("--help");
        const std::string help = run(asked).out;
        for (const std::string& name : subcommands(help)) {
            waiting.push_back(command);
            waiting.back().push_back(name);
        }
        std::istringstream lines(help);
        for (std::string line; std::getline(lines, line);) {
            std::smatch match;
            if (!std::regex_search(line, match, std::regex("^  (?:-[a-z],)?(--[a-z-]+) (.*)"))) continue;
            const std::string name = match[1], takes = match[2];
            if (std::regex_search(takes, match, std::regex(R"(^TEXT:\{([^}]*)\})"))) {
                options.push_back({command, name, {}});
                std::istringstream words(match[1]);
                for (std::string word; std::getline(words, word, ',');) options.back().words.push_back(word);
            } else if (std::regex_search(takes, std::regex("^(INT|UINT|FLOAT):"))) {
                options.push_back({command, name, {}});
            } else if (name == "--tonemap") {
                options.push_back({command, name, {"soft", "none", "filmic", "agx-like"}});
            }
        }
    }
    ASSERT_GT(options.size(), 30u);
    for (const Option& option : options) {
        std::string said = option.name;
        for (auto word = option.command.rbegin(); word != option.command.rend(); ++word)
            said = *word + " " + said;
        SCOPED_TRACE(said);
        const bool number = option.words.empty();
        for (const char* given : {"somthing", "nan", "1e999"}) {
            std::vector<std::string> arguments = option.command;
            arguments.insert(arguments.end(), {option.name, given});
            const Result result = run(arguments);
            EXPECT_EQ(result.exitCode, 2) << result.err;
            EXPECT_TRUE(contains(result.err, "pellucid: " + option.name + ": ")) << result.err;
            EXPECT_TRUE(contains(result.err, number ? "' is not a " : "there is no '")) << result.err;
            EXPECT_LT(result.err.size(), 250u) << result.err;
            EXPECT_FALSE(contains(result.err, "->")) << result.err;
            for (const std::string& word : option.words)
                EXPECT_TRUE(contains(result.err, word)) << result.err;
        }
    }
}

TEST_F(CliValues, AreNamedToThoseWhoMistypeThem) {
    const std::vector<std::string> shade{"shade", "a.exr", "--scene", "a.toml", "-o", path("a.exr")};
    const auto refused = [&](std::vector<std::string> arguments, const std::string& message) {
        std::vector<std::string> all = shade;
        all.insert(all.end(), arguments.begin(), arguments.end());
        expectRefused(all, 2, message);
    };
    refused({"--tonemap", "filmc"},
            "pellucid: --tonemap: there is no 'filmc'; did you mean filmic? there are soft, none, filmic, "
            "agx-like\n");
    refused({"--tonemap", "2"}, "there is no '2'");
    refused({"--outputs", "diffuse,speculr"}, "there is no 'speculr'; did you mean specular?");
    refused({"--exposure", "-1"}, "--exposure: '-1' is not a number above 0\n");
    refused({"--exposure", "0"}, "is not a number above 0");
    refused({"--scratch-mib", "1.5"}, "--scratch-mib: '1.5' is not a whole number from 0 to 1073741824\n");
    expectRefused({"profile", "fit", "skin", "--gaussians", "13"}, 2,
                  "'13' is not a whole number from 1 to 12");
    expectRefused({"curvature", "a.obj", "-o", path("a.npy"), "--smooth-crease", "180.5"}, 2,
                  "is not a number from 0 to 180");
    // Capital letters are as good; what is missing next is the scene.
    std::vector<std::string> capital = shade;
    capital.insert(capital.end(), {"--tonemap", "Filmic"});
    expectRefused(capital, 3, "a.toml: cannot be read");
}
