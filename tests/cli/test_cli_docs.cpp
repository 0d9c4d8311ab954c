// Every command and option that the pages show exists.
#include <cctype>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "cli_run.h"
#include "docs/pages.h"

namespace {

class CliDocs : public CommandTest {
  protected:
    // What --help lists for these subcommands: "  -o,--output FILE   text" has two names.
    const std::set<std::string>& names(const std::vector<std::string>& subcommands) {
        std::set<std::string>& known = names_[subcommands];
        if (!known.empty()) return known;
        std::vector<std::string> arguments = subcommands;
        arguments.push_back("--help");
        std::istringstream help(run(arguments).out);
        for (std::string line; std::getline(help, line);) {
            if (!line.starts_with("  ") || line.starts_with("   ")) continue;
            // "-o,--output TEXT REQUIRED  ...", "warm-up, prefill  ..."
            std::istringstream column(line.substr(2, line.find("  ", 2) - 2));
            for (std::string names, name; std::getline(column, names, ',');)
                if (std::istringstream(names) >> name) known.insert(name);
        }
        return known;
    }

  private:
    std::map<std::vector<std::string>, std::set<std::string>> names_;
};

// "pellucid ..." at the start of an indented line, in a block of code, or in a code span.
std::vector<std::string> commandsOf(const std::string& page) {
    std::vector<std::string> all;
    const std::regex line(R"((^|\n)(    )?pellucid ([^\n#;]*))"), span("`pellucid ([^`]*)`");
    for (const auto& [pattern, group] : {std::pair(line, 3), {span, 1}})
        for (std::sregex_iterator it(page.begin(), page.end(), pattern), end; it != end; ++it)
            all.push_back((*it)[size_t(group)]);
    return all;
}

}  // namespace

TEST_F(CliDocs, CommandsAndOptionsExist) {
    int commands = 0, options = 0;
    for (const auto& page : pages::all())
        for (const std::string& command : commandsOf(pages::contents(page))) {
            ++commands;
            std::vector<std::vector<std::string>> meant = {{}};  // `lut curvature|shadow` means two
            bool first = true;
            for (std::string word : pages::words(std::regex_replace(command, std::regex(R"([\[\]])"), " "))) {
                std::vector<std::vector<std::string>> deeper;
                std::istringstream choices(word);
                for (std::string choice; std::getline(choices, choice, '|');)
                    if (std::regex_match(choice, std::regex("[a-z][a-z-]*")) && meant.size() == 1 &&
                        names(meant[0]).contains(choice)) {
                        deeper.push_back(meant[0]);
                        deeper.back().push_back(choice);
                    }
                if (first && std::islower(word[0])) {
                    EXPECT_FALSE(deeper.empty()) << page << ": pellucid " << command << ": no " << word;
                }
                first = false;
                if (!deeper.empty()) meant = deeper;
                if (!std::regex_search(word, std::regex("^--?[a-z]"))) continue;
                word = word.substr(0, word.find_first_of("|="));
                ++options;
                bool known = false;  // to one of the subcommands that may be meant
                for (const auto& subcommands : meant) {
                    known |= names(subcommands).contains(word);
                    for (const char* kind : {"curvature", "shadow", "specular"})
                        if (subcommands == std::vector<std::string>{"lut"})
                            known |= names({"lut", kind}).contains(word);
                }
                EXPECT_TRUE(known) << page << ": pellucid " << command << ": no option " << word;
            }
        }
    EXPECT_GT(commands, 30);
    EXPECT_GT(options, 30);
}
