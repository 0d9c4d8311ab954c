// What kernels must not do though OpenCL C allows it, since a driver gets it wrong.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>

namespace fs = std::filesystem;

namespace {

std::string withoutComments(const fs::path& file) {
    std::ifstream stream(file);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    return std::regex_replace(text, std::regex(R"(//[^\n]*)"), "");
}

// The text between the brace before `begin` and the one that closes it.
std::string body(const std::string& text, size_t begin) {
    size_t end = begin;
    for (int depth = 1; depth && end < text.size(); ++end)
        depth += text[end] == '{' ? 1 : text[end] == '}' ? -1 : 0;
    return text.substr(begin, end - begin);
}

// The first place in a function's body where it changes its own structure, or hands its address to somebody who may.
std::string change(const std::string& code, const std::string& name) {
    const std::string member = "(\\.\\w+)*";
    for (const std::string& form :
         {"(^|[^\\w.>])" + name + member + "\\s*([-+*/|&^]|<<|>>)?=(?!=)", "(\\+\\+|--)" + name + "\\b",
          "\\b" + name + member + "(\\+\\+|--)", "[(,]\\s*&" + name + "\\b"}) {
        std::smatch found;
        if (std::regex_search(code, found, std::regex(form))) return found.str();
    }
    return "";
}

}  // namespace

// Mesa's rusticl 22.3 hands the caller's structure itself to a function that takes one by value.
TEST(KernelRules, NoFunctionChangesAStructureThatItTakesByValue) {
    const std::regex function(R"(\b(\w+)\s*\(([^(){};]*)\)\s*\{)"),
        structure(R"((?:^|,)\s*(?:const\s+)?[A-Z]\w*\s+(\w+)\s*(?=,|$))");
    int checked = 0;
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(PELLUCID_SOURCE_DIR) / "kernels")) {
        if (entry.path().extension() != ".cl" && entry.path().extension() != ".clh") continue;
        const std::string text = withoutComments(entry.path());
        for (std::sregex_iterator f(text.begin(), text.end(), function), end; f != end; ++f) {
            const std::string parameters = (*f)[2], code = body(text, size_t(f->position() + f->length()));
            for (std::sregex_iterator p(parameters.begin(), parameters.end(), structure); p != end; ++p, ++checked)
                EXPECT_EQ(change(code, (*p)[1]), "")
                    << entry.path() << ": " << (*f)[1] << " changes " << (*p)[1] << "; let it work on a copy";
        }
    }
    EXPECT_GT(checked, 100);
}
