// What the pages say about the tree must be so: the README quotes the minimal example, links lead somewhere,
// files that are named exist. What they say about the command is in test_cli.cpp.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>

#include "pages.h"

TEST(Docs, ReadmeQuotesTheMinimalExample) {
    const std::string example = pages::contents(pages::root / "examples/example_minimal.c");
    ASSERT_FALSE(example.empty());
    EXPECT_NE(pages::contents(pages::root / "README.md").find("```c\n" + example + "```"), std::string::npos)
        << "copy examples/example_minimal.c into README.md";
}

TEST(Docs, LinksLeadSomewhere) {
    int links = 0;
    const std::regex link(R"(\]\(([^)#:]+)(#[^)]*)?\))");
    for (const auto& page : pages::all()) {
        const std::string text = pages::contents(page);
        for (std::sregex_iterator it(text.begin(), text.end(), link), end; it != end; ++it, ++links)
            EXPECT_TRUE(std::filesystem::exists(page.parent_path() / (*it)[1].str()))
                << page << " links to " << (*it)[1];
    }
    EXPECT_GT(links, 50);
}

// In code spans: paths whose first folder is one of the tree's, and sources by their name alone. `x.*` stands
// for any ending.
TEST(Docs, NamedFilesExist) {
    std::vector<std::filesystem::path> files;
    for (const auto& folder : pages::folders)
        for (const auto& entry : std::filesystem::recursive_directory_iterator(pages::root / folder))
            files.push_back(entry.path());
    const auto exists = [&](const std::string& path) {
        if (path.ends_with("/")) return std::filesystem::is_directory(pages::root / path);
        for (const std::filesystem::path& file : files) {
            const std::string any = (file.parent_path() / file.stem()).string() + ".*";
            if (file.string().ends_with("/" + path) || any.ends_with("/" + path)) return true;
        }
        return std::filesystem::exists(pages::root / path);
    };
    const std::regex span("`([^`\n]+)`"), source(R"([\w/-]+\.(cpp|c|h|hpp|cl|clh|py|md)\b)"),
        path(R"([\w.-]+/[\w./-]*(\.\*)?)");
    // attributes of Python objects
    const std::set<std::string> hosts = {"device.cl", "buffer.cl", "event.cl"};
    int named = 0;
    for (const auto& page : pages::all()) {
        if (page.filename() == "CHANGELOG.md") continue;  // history may name files that are gone
        const std::string text = pages::withoutBlocks(pages::contents(page));
        for (std::sregex_iterator it(text.begin(), text.end(), span), end; it != end; ++it) {
            for (const std::string& word : pages::words((*it)[1])) {
                const std::string first = word.substr(0, word.find('/'));
                const bool inTree = pages::folders.contains(first) && std::regex_match(word, path);
                if (!inTree && (!std::regex_match(word, source) || hosts.contains(word))) continue;
                ++named;
                EXPECT_TRUE(exists(word)) << page << " names " << word;
            }
        }
    }
    EXPECT_GT(named, 100);
}

TEST(Docs, FiguresAreShownAndSmall) {
    std::string text;
    for (const auto& page : pages::all()) text += pages::contents(page);
    for (const auto& entry : std::filesystem::directory_iterator(pages::root / "docs/figures")) {
        EXPECT_LT(entry.file_size(), 300u << 10) << entry.path();
        EXPECT_NE(text.find("figures/" + entry.path().filename().string()), std::string::npos)
            << entry.path();
    }
}
