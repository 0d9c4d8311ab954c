// Subcommands and their options: a thin layer over CLI11, whose headers alone take seconds to compile.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace pellucid::cli {

// Checks a value, which it may rewrite. `test` returns "" or what is wrong; `description` is shown in the
// help: a range, "0 to 1000", or words, "{y,z}".
struct Check {
    std::function<std::string(std::string&)> test;
    std::string description;
};

class Option {
  public:
    explicit Option(CLI::Option* option) : option_(option) {}
    Option* required();
    Option* showDefault();                      // the value that the variable has now, in the help
    Option* typeName(const std::string& word);  // of the value in the help; without one a text is a path
    Option* check(Check check);
    Option* oneEach();  // of several values, each is given by the option's name
    Option* separatedBy(char delimiter);
    Option* expected(int values);
    Option* excludes(const Option* other);
    Option* needs(const Option* other);
    Option* hidden();
    bool given() const;

  private:
    CLI::Option* option_;
};

class Command {
  public:
    explicit Command(CLI::App& app);
    ~Command();
    Command(const Command&) = delete;

    Command* addCommand(const std::string& name, const std::string& help);
    // Types of values: text, numbers, a list of texts or numbers, an optional number.
    template <class Value>
    Option* addOption(const std::string& names, Value& value, const std::string& help);
    // Calls `take` with the text that is given.
    Option* addOptionOf(const std::string& names, std::function<void(const std::string&)> take,
                        const std::string& help);
    Option* addFlag(const std::string& names, bool& value, const std::string& help);
    bool isGiven(const std::string& option) const;

    void requireCommand();
    bool isUsed() const;
    void alias(const std::string& name);
    void footer(const std::string& text);
    // Runs the subcommand once its arguments are parsed.
    void callback(std::function<void()> run);
    // All arguments are those of another program.
    void passOn(std::function<void(const std::vector<std::string>&)> run);

  private:
    Option* keep(CLI::Option* option);
    CLI::App& app_;
    std::vector<std::unique_ptr<Command>> commands_;
    std::vector<std::unique_ptr<Option>> options_;
};

// Whether the whole text is a number.
bool readNumber(const std::string& text, float& number);

}  // namespace pellucid::cli
