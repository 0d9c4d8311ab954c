// The pages of the documentation as text.
#pragma once
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace pages {

inline const std::filesystem::path root = PELLUCID_SOURCE_DIR;
inline const std::set<std::string> folders = {"apps",     "bench", "bindings", "cmake", "docs",
                                              "examples", "host",  "kernels",  "tests"};

inline std::string contents(const std::filesystem::path& path) {
    std::ifstream in(path);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

inline std::vector<std::filesystem::path> all() {
    std::vector<std::filesystem::path> found = {root / "README.md", root / "CONTRIBUTING.md",
                                                root / "CHANGELOG.md", root / "bindings/python/README.md"};
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / "docs"))
        if (entry.path().extension() == ".md") found.push_back(entry.path());
    return found;
}

// Without what stands between lines of ```.
inline std::string withoutBlocks(const std::string& text) {
    std::istringstream in(text);
    std::string rest;
    bool inside = false;
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("```"))
            inside = !inside;
        else if (!inside)
            rest += line + "\n";
    }
    return rest;
}

// Between blanks; commas and colons behind a word do not belong to it.
inline std::vector<std::string> words(const std::string& text) {
    std::istringstream in(text);
    std::vector<std::string> all;
    for (std::string word; in >> word;) {
        while (!word.empty() && (word.back() == ',' || word.back() == ':' || word.back() == ';'))
            word.pop_back();
        if (!word.empty()) all.push_back(word);
    }
    return all;
}

}  // namespace pages
