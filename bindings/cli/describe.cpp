// pellucid describe: every subcommand and option as one JSON object, from the parsers themselves. Manual pages, completions for shells and
// the tables of docs/guide/command-line.md are made from it (packaging/command_pages).
#include "command.h"
#include "io/spelling.h"

namespace pellucid::cli {
namespace {

nlohmann::ordered_json described(const CLI::Option& option) {
    nlohmann::ordered_json json;
    json["names"] = nlohmann::json::array();
    for (const std::string& name : option.get_snames()) json["names"].push_back("-" + name);
    for (const std::string& name : option.get_lnames()) json["names"].push_back("--" + name);
    if (option.get_positional()) json["positional"] = option.get_name(true, false);
    json["help"] = option.get_description();
    // What a value is, and the values that there are: "TEXT:{edge,tensor}", or "ENUM:value in {soft->0,none->1} OR {0,1}".
    std::string type = option.get_type_name();
    if (const size_t open = type.find('{'), close = type.find('}'); open < close && close != std::string::npos) {
        std::istringstream choices(type.substr(open + 1, close - open - 1));
        for (std::string choice; std::getline(choices, choice, ',');)
            json["choices"].push_back(choice.substr(0, choice.find("->")));
        type.resize(std::min(type.find(':'), open));
    }
    json["value"] = option.get_expected_max() > 0 && option.get_type_size_max() > 0;
    json["type"] = type;
    json["several"] = option.get_expected_max() > 1 || option.get_type_size_max() > 1;
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
    // A value behind an unknown option is not another mistake.
    const auto isOption = [](const std::string& word) { return word.starts_with("-"); };
    if (std::any_of(words.begin(), words.end(), isOption))
        std::erase_if(words, [&](const auto& word) { return !isOption(word); });
    std::string message;
    for (const std::string& given : words) {
        const std::string word = given.substr(0, given.find('='));
        const std::string nearest = isOption(word) ? io::nearestWord(word, known) : "";
        message += (message.empty() ? "" : "; ") + path + (isOption(word) ? " has no " : " does not expect ") +
                   "'" + word + "'" + (nearest.empty() ? "" : "; did you mean " + nearest + "?");
    }
    return message + "\nRun '" + path + " --help' for all options.";
}

}  // namespace pellucid::cli
