// Messages about wrong values, for every option of every subcommand.
#include "cli_run.h"

using CliValues = CommandTest;

namespace {

struct Option {
    std::vector<std::string> command;
    std::string name;
    std::vector<std::string> words;  // that it takes; empty: numbers
};

// Options of a subcommand, as `pellucid describe` gives them, and of those below it.
void collect(const nlohmann::json& app, const std::vector<std::string>& command,
             std::vector<Option>& options) {
    for (const auto& option : app.at("options")) {
        const std::string value = option.at("value"),
                          name = option.at("names").empty() ? "" : option["names"].back();
        const bool isChoice = !option.at("completions").empty() && contains(value, "|");
        if (!name.empty() && isChoice) options.push_back({command, name, option["completions"]});
        if (!name.empty() && option.at("range") != "") options.push_back({command, name, {}});
    }
    for (const auto& sub : app.at("subcommands")) {
        std::vector<std::string> words = command;
        words.push_back(sub.at("name"));
        collect(sub, words, options);
    }
}

}  // namespace

// --help shows the words of `pellucid describe`, and nothing of CLI11's own notation.
TEST_F(CliValues, HelpIsReadable) {
    for (const std::vector<std::string>& command :
         std::vector<std::vector<std::string>>{{"demo"}, {"lut", "curvature"}, {"bench"}, {"shade"}}) {
        std::vector<std::string> words = command;
        words.push_back("--help");
        const std::string help = run(words).out;
        for (const char* notation : {"{", "INT", "FLOAT", "TEXT", "REQUIRED", "NONNEGATIVE", "]="})
            EXPECT_FALSE(contains(help, notation)) << command[0] << ": " << notation << "\n" << help;
    }
    const std::string help = run({"demo", "--help"}).out;
    for (const char* line :
         {"--smooth N (0 to 1000; default: 2)", "--device DEVICE", "--up auto|y|z (default: auto)",
          "--size SIZE (default: 1280x720)", "-o,--output PATH", "  --orient  "})
        EXPECT_TRUE(contains(help, line)) << line << "\n" << help;
}

TEST_F(CliValues, EveryOptionNamesWhatItTakes) {
    std::vector<Option> options;
    collect(run({"describe"}).json(), {}, options);
    ASSERT_GT(options.size(), 30u);
    for (const Option& option : options) {
        std::string said = option.name;
        for (auto word = option.command.rbegin(); word != option.command.rend(); ++word)
            said = *word + " " + said;
        SCOPED_TRACE(said);
        const bool number = option.words.empty();
        for (const char* given : {"somthing", "nan", "1e999"}) {
            std::vector<std::string> arguments = option.command;
            arguments.insert(arguments.end(), {option.name, given});
            const Result result = run(arguments);
            EXPECT_EQ(result.exitCode, 2) << result.err;
            EXPECT_TRUE(contains(result.err, "pellucid: " + option.name + ": ")) << result.err;
            EXPECT_TRUE(contains(result.err, number ? "' is not a " : "there is no '")) << result.err;
            EXPECT_LT(result.err.size(), 250u) << result.err;
            EXPECT_FALSE(contains(result.err, "->")) << result.err;
            for (const std::string& word : option.words)
                EXPECT_TRUE(contains(result.err, word)) << result.err;
        }
    }
}

// The name of a file whose extension stands for no format is wrong use in every argument, and bad input in a
// file.
TEST_F(CliValues, AnUnknownExtensionIsWrongUseEverywhere) {
    const std::string gbuffer = path("g.exr"), scene = path("s.toml"), bad = path("a.foo");
    write("a.foo", "");
    write("s.toml",
          "version = 2\n[channels]\nnormal_shading = [\"N.X\", \"N.Y\", \"N.Z\"]\n[[material]]\nid = 1\n");
    for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
             {"curvature", bad, "-o", path("o.npy")},
             {"curvature", path("m.ply"), "-o", bad},
             {"curvature", path("m.ply"), "-o", path("o.npy"), "--picture", bad},
             {"lut", "shadow", "-o", bad},
             {"lut", "shadow", "--output=" + bad},
             {"profile", "plot", "skin", "-o", bad},
             {"profile", "fit", "skin", "-o", bad},
             {"shade", gbuffer, "--scene", scene, "-o", bad},
             {"shade", gbuffer, "--scene", scene, "-o", path("o.exr"), "--picture", bad},
             {"demo", bad, "-o", path("out")},
             {"import", bad, "-o", path("out")},
             {"reference", bad, "--scene", scene, "-o", path("o.npy")},
             {"reference", path("m.ply"), "--scene", scene, "-o", bad}}) {
        const Result result = run(arguments);
        EXPECT_EQ(result.exitCode, 2) << arguments[0] << " " << arguments[1] << ": " << result.err;
        EXPECT_TRUE(contains(result.err, "a.foo: has the unknown extension '.foo'; known here: "))
            << result.err;
    }
}

TEST_F(CliValues, AreNamedToThoseWhoMistypeThem) {
    const std::vector<std::string> shade{"shade", "a.exr", "--scene", "a.toml", "-o", path("a.exr")};
    const auto refused = [&](std::vector<std::string> arguments, const std::string& message) {
        std::vector<std::string> all = shade;
        all.insert(all.end(), arguments.begin(), arguments.end());
        expectRefused(all, 2, message);
    };
    refused({"--tonemap", "filmc"},
            "pellucid: --tonemap: there is no 'filmc'; did you mean filmic? there are soft, none, filmic, "
            "agx-like\n");
    refused({"--tonemap", "2"}, "there is no '2'");
    refused({"--outputs", "diffuse,speculr"}, "there is no 'speculr'; did you mean specular?");
    refused({"--exposure", "-1"}, "--exposure: '-1' is not a number above 0\n");
    refused({"--exposure", "0"}, "is not a number above 0");
    refused({"--scratch-mib", "1.5"}, "--scratch-mib: '1.5' is not a whole number from 0 to 1073741824\n");
    expectRefused({"profile", "fit", "skin", "--gaussians", "13"}, 2,
                  "'13' is not a whole number from 1 to 12");
    expectRefused({"curvature", "a.obj", "-o", path("a.npy"), "--smooth-crease", "180.5"}, 2,
                  "is not a number from 0 to 180");
    // Capital letters are as good; what is missing next is the scene.
    std::vector<std::string> capital = shade;
    capital.insert(capital.end(), {"--tonemap", "Filmic"});
    expectRefused(capital, 3, "a.toml: cannot be read");
}
