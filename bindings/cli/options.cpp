#include "options.h"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>

namespace pellucid::cli {

Option* Option::required() {
    option_->required();
    return this;
}
Option* Option::showDefault() {
    option_->capture_default_str();
    return this;
}
Option* Option::typeName(const std::string& word) {
    option_->type_name(word);
    return this;
}
Option* Option::check(Check check) {
    option_->check(CLI::Validator(std::move(check.test), std::move(check.description)));
    return this;
}
Option* Option::oneEach() {
    option_->allow_extra_args(false);
    return this;
}
Option* Option::separatedBy(char delimiter) {
    option_->delimiter(delimiter)->allow_extra_args(false);
    return this;
}
Option* Option::expected(int values) {
    option_->expected(values);
    return this;
}
Option* Option::excludes(const Option* other) {
    option_->excludes(other->option_);
    return this;
}
Option* Option::needs(const Option* other) {
    option_->needs(other->option_);
    return this;
}
Option* Option::hidden() {
    option_->group("");
    return this;
}
bool Option::given() const {
    return option_->count() > 0;
}

Command::Command(CLI::App& app) : app_(app) {}
Command::~Command() = default;

Command* Command::addCommand(const std::string& name, const std::string& help) {
    return commands_.emplace_back(std::make_unique<Command>(*app_.add_subcommand(name, help))).get();
}

Option* Command::keep(CLI::Option* option) {
    return options_.emplace_back(std::make_unique<Option>(option)).get();
}

template <class Value>
Option* Command::addOption(const std::string& names, Value& value, const std::string& help) {
    return keep(app_.add_option(names, value, help));
}
#define VALUE_TYPE(type) template Option* Command::addOption(const std::string&, type&, const std::string&);
VALUE_TYPE(std::string)
VALUE_TYPE(float)
VALUE_TYPE(double)
VALUE_TYPE(int)
VALUE_TYPE(uint32_t)
VALUE_TYPE(uint64_t)
VALUE_TYPE(std::optional<int>)
VALUE_TYPE(std::optional<double>)
VALUE_TYPE(std::vector<std::string>)
VALUE_TYPE(std::vector<float>)
VALUE_TYPE(std::vector<double>)

Option* Command::addOptionOf(const std::string& names, std::function<void(const std::string&)> take,
                             const std::string& help) {
    return keep(app_.add_option_function<std::string>(names, take, help));
}

Option* Command::addFlag(const std::string& names, bool& value, const std::string& help) {
    return keep(app_.add_flag(names, value, help));
}

bool Command::isGiven(const std::string& option) const {
    return app_.count(option) > 0;
}
void Command::requireCommand() {
    app_.require_subcommand(1);
}
bool Command::isUsed() const {
    return app_.parsed();
}
void Command::alias(const std::string& name) {
    app_.alias(name);
}
void Command::footer(const std::string& text) {
    app_.footer(text);
}
void Command::callback(std::function<void()> run) {
    app_.callback(std::move(run));
}
void Command::passOn(std::function<void(const std::vector<std::string>&)> run) {
    app_.prefix_command();
    app_.set_help_flag();
    app_.callback([this, run = std::move(run)] { run(app_.remaining()); });
}

bool readNumber(const std::string& text, float& number) {
    return CLI::detail::lexical_cast(text, number);
}

}  // namespace pellucid::cli
