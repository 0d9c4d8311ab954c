// pellucid describe: every subcommand and option as one JSON object, taken from the parsers. Manual pages,
// shell completions and the tables of docs/guide/command-line.md are generated from it
// (packaging/command_pages). --help shows options in the same words.
#include "command.h"
#include "io/spelling.h"

namespace pellucid::cli {
namespace {

// The value of an option as the help shows it.
struct OptionValue {
    std::string word;                      // "N", "PATH", "y|z"; "" for a flag
    std::string range;                     // "0 to 1000", or ""
    std::vector<std::string> completions;  // that a shell offers
    bool path = false;                     // a shell offers files as well
};

OptionValue valueOf(const CLI::Option& option) {
    OptionValue value;
    if (option.get_type_size_max() == 0) return value;
    // CLI11 puts the description of the check behind the name of the type: "INT:0 to 1000", "TEXT:{y,z}".
    const std::string type = option.get_type_name(),
                      check = type.substr(std::min(type.find(':') + 1, type.size()));
    value.word = type.substr(0, type.find(':'));
    if (check.starts_with("{")) {
        value.completions = CLI::detail::split(check.substr(1, check.size() - 2), ',');
        value.word = CLI::detail::join(value.completions, "|");
        return value;
    }
    if (value.word != type) value.range = check;
    if (value.word == "INT" || value.word == "UINT") value.word = "N";
    if (value.word == "FLOAT") value.word = "NUMBER";
    if (value.word == "TEXT") value.word = "PATH", value.path = true;
    if (value.word == deviceWord) value.completions = {"cpu", "gpu", "accelerator"};
    if (value.word == profileWord) value.completions = Profile::libraryNames(), value.path = true;
    if (option.get_expected_max() > 1 || option.get_type_size_max() > 1) value.word += "...";
    return value;
}

class HelpFormatter : public CLI::Formatter {
    std::string make_option_opts(const CLI::Option* option) const override {
        const OptionValue value = valueOf(*option);
        const std::string standard = option->get_default_str();
        std::string notes = value.range;
        const auto add = [&notes](const std::string& note) { notes += (notes.empty() ? "" : "; ") + note; };
        if (option->get_required()) add("required");
        if (!standard.empty() && !option->get_required()) add("default: " + standard);
        const std::string word = value.word.empty() || option->get_positional() ? "" : " " + value.word;
        return notes.empty() ? word : word + " (" + notes + ")";
    }
};

nlohmann::ordered_json described(const CLI::Option& option) {
    nlohmann::ordered_json json;
    json["names"] = nlohmann::json::array();
    for (const std::string& name : option.get_snames()) json["names"].push_back("-" + name);
    for (const std::string& name : option.get_lnames()) json["names"].push_back("--" + name);
    if (option.get_positional()) json["positional"] = option.get_name(true, false);
    json["help"] = option.get_description();
    const OptionValue value = valueOf(option);
    json["value"] = value.word;
    json["range"] = value.range;
    json["completions"] = value.completions;
    json["path"] = value.path;
    json["required"] = option.get_required();
    json["default"] = option.get_default_str();
    return json;
}

nlohmann::ordered_json described(const CLI::App& app) {
    nlohmann::ordered_json json;
    json["name"] = app.get_name();
    json["help"] = app.get_description();
    if (!app.get_aliases().empty()) json["aliases"] = app.get_aliases();
    json["options"] = nlohmann::json::array();
    for (const CLI::Option* option : app.get_options())
        if (!option->get_group().empty())
            json["options"].push_back(described(*option));  // the others are hidden
    json["subcommands"] = nlohmann::json::array();
    for (const CLI::App* sub : app.get_subcommands({})) json["subcommands"].push_back(described(*sub));
    return json;
}

}  // namespace

void addDescribe(CLI::App& app) {
    app.add_subcommand("describe", "every subcommand and option, as JSON")->callback([&app] {
        printJson(described(app));
    });
}

std::shared_ptr<CLI::FormatterBase> helpFormatter() {
    return std::make_shared<HelpFormatter>();
}

std::string unknownOptions(const CLI::App& app) {
    const CLI::App* used = &app;
    std::string path = app.get_name();
    while (!used->get_subcommands().empty())
        used = used->get_subcommands().front(), path += " " + used->get_name();
    std::vector<std::string> known;
    for (const CLI::Option* option : used->get_options()) {
        for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
        for (const std::string& name : option->get_snames()) known.push_back("-" + name);
    }
    std::vector<std::string> words = app.remaining(true);
    const bool ended = std::erase(words, "--") > 0;  // no option stands behind it
    // The value of an unknown option is not reported as a second mistake.
    const auto isOption = [&](const std::string& word) { return !ended && word.starts_with("-"); };
    if (std::any_of(words.begin(), words.end(), isOption))
        std::erase_if(words, [&](const auto& word) { return !isOption(word); });
    std::string message;
    for (const std::string& given : words) {
        const std::string word = given.substr(0, given.find('='));
        const std::string nearest = isOption(word) ? io::nearestWord(word, known) : "";
        message += (message.empty() ? "" : "; ") + path +
                   (isOption(word) ? " has no " : " does not expect ") + "'" + word + "'" +
                   (nearest.empty() ? "" : "; did you mean " + nearest + "?");
    }
    return message + "\nRun '" + path + " --help' for all options.";
}

}  // namespace pellucid::cli
