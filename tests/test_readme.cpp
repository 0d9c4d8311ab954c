// The README quotes the minimal example; they must not drift apart, and its links must lead somewhere.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

namespace {

const std::filesystem::path root = PELLUCID_SOURCE_DIR;

std::string contents(const std::filesystem::path& path) {
    std::ifstream in(path);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

}  // namespace

TEST(Readme, QuotesTheMinimalExample) {
    const std::string example = contents(root / "examples/example_minimal.c");
    ASSERT_FALSE(example.empty());
    EXPECT_NE(contents(root / "README.md").find("```c\n" + example + "```"), std::string::npos)
        << "copy examples/example_minimal.c into README.md";
}

TEST(Readme, LinksLeadSomewhere) {
    int links = 0;
    const std::regex link(R"(\]\(([^)#:]+)(#[^)]*)?\))");
    auto check = [&](const std::filesystem::path& page) {
        const std::string text = contents(page);
        for (std::sregex_iterator it(text.begin(), text.end(), link), end; it != end; ++it) {
            ++links;
            EXPECT_TRUE(std::filesystem::exists(page.parent_path() / (*it)[1].str()))
                << page << " links to " << (*it)[1];
        }
    };
    check(root / "README.md");
    check(root / "CONTRIBUTING.md");
    for (const auto& entry : std::filesystem::directory_iterator(root / "docs"))
        if (entry.path().extension() == ".md") check(entry.path());
    EXPECT_GT(links, 5);
}
