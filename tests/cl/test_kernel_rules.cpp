// What OpenCL C allows and kernels must not do, because a driver compiles it wrongly; and the rules for
// names in kernels.
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

// The first place in a function's body where it changes its own structure, or hands its address to somebody
// who may.
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
            for (std::sregex_iterator p(parameters.begin(), parameters.end(), structure); p != end;
                 ++p, ++checked)
                EXPECT_EQ(change(code, (*p)[1]), "")
                    << entry.path() << ": " << (*f)[1] << " changes " << (*p)[1] << "; let it work on a copy";
        }
    }
    EXPECT_GT(checked, 100);
}

// CONTRIBUTING.md, "Names".
TEST(KernelRules, NamesFollowTheRule) {
    const std::regex kernel(R"(__kernel[^{;]*?void\s+(\w+)\s*\()"),
        function(R"(\n(?:static )?inline [\w ]+\*?\s(\w+)\()"), macro(R"(\n\s*#\s*define\s+(\w+))");
    const std::regex entryName("[a-z0-9]+(_[a-z0-9]+)*"), functionName("(as_|convert_)?[a-z][a-zA-Z0-9]*"),
        publicName("PEL_[A-Z0-9_]+|[a-z]+w|(as|convert)_[a-z]+w"),
        ownName("[A-Z][A-Z0-9_]*(_[a-z][a-zA-Z0-9]*)?|kernel");
    int checked = 0;
    const fs::path root = fs::path(PELLUCID_SOURCE_DIR) / "kernels";
    const auto check = [&](const fs::path& file, const std::string& text, const std::regex& what,
                           const std::regex& rule, const char* form) {
        for (std::sregex_iterator m(text.begin(), text.end(), what), end; m != end; ++m, ++checked)
            EXPECT_TRUE(std::regex_match((*m)[1].str(), rule))
                << file << ": " << (*m)[1] << " should be " << form;
    };
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
        const fs::path file = fs::relative(entry.path(), root);
        const std::string folder = file.begin()->string();
        if (!entry.is_regular_file()) continue;
        const std::string text = "\n" + withoutComments(entry.path());
        check(file, text, kernel, entryName, "snake_case");
        check(file, text, function, functionName, "lowerCamelCase");
        if (folder == "lib" || folder == "shared")
            check(file, text, macro, publicName, "PEL_UPPER_CASE");
        else
            check(file, text, macro, ownName, "UPPER_CASE");
    }
    EXPECT_GT(checked, 500);
}
