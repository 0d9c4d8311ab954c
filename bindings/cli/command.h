// Shared by every subcommand of `pellucid`: the device, the report, progress, exit codes.
#pragma once
#include <CLI/CLI.hpp>
#include <chrono>
#include <nlohmann/json.hpp>
#include <pellucid/pellucid.hpp>
#include <span>
#include <string_view>

namespace pellucid::cli {

// exitWorse: `bench compare` found something slower or less accurate.
enum ExitCode { exitDone = 0, exitWorse = 1, exitWrongUse = 2, exitBadInput = 3, exitNoDevice = 4 };

// Wrong use that only a check of several arguments together can find.
class UsageError : public std::runtime_error {
    using runtime_error::runtime_error;
};

// A bad input file found by the library: the message names the file.
class InputError : public std::runtime_error {
    using runtime_error::runtime_error;
};

// Runs `work`. What the library refuses of its arguments becomes an InputError about `source`.
void withInput(const std::string& source, const std::function<void()>& work);

// Ends the command with this code and without a message.
struct ExitWith : std::runtime_error {
    explicit ExitWith(ExitCode c) : std::runtime_error(""), code(c) {}
    ExitCode code;
};

// Shows progress on stderr after the first second of a command, and cancels the command on Ctrl-C.
class Progress {
  public:
    Progress();
    ~Progress();
    Progress(const Progress&) = delete;
    bool goesOn(double fraction, const char* what);      // false after Ctrl-C
    void operator()(double fraction, const char* what);  // throws Error after Ctrl-C
    double milliseconds() const;                         // since it began

  private:
    std::chrono::steady_clock::time_point start_;
    bool shown_ = false;
};

// Whether Ctrl-C was pressed since a Progress began.
bool wasInterrupted();

// One run of a subcommand: opens the device, shows progress on stderr, prints the report at the end.
class Run {
  public:
    struct Options {
        std::string device;  // selector; "" for the standard one
        bool json = false;
        bool strict = false;  // a warning is an error
    };
    explicit Run(const Options& options);
    ~Run();
    Run(const Run&) = delete;

    const Device& device() const { return device_; }
    double deviceMilliseconds() const;  // kernels since this run began

    void progress(double fraction, const char* what) { progress_(fraction, what); }  // of work on the host
    void note(const std::string& text) const { std::fprintf(stderr, "%s\n", text.c_str()); }  // for people
    // To stderr, and into the report; with --strict an InputError. Before anything is written.
    void warn(const std::string& text);
    // The keys and values of the report, in this order: numbers, texts, arrays and objects.
    nlohmann::ordered_json report;

    // Prints the report: one JSON object with --json, else a line per entry.
    void finish();

  private:
    Options options_;
    Progress progress_;                   // first: the time of opening the device counts
    std::vector<std::string> ofOpening_;  // warnings
    Device device_;
    PelDeviceStats before_;
    nlohmann::ordered_json warnings_ = nlohmann::ordered_json::array();
};

// The time that `work` takes.
template <class Work>
double milliseconds(Work&& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

// Prints one JSON object on standard output. Bytes of file names that are not UTF-8 become U+FFFD.
void printJson(const nlohmann::ordered_json& report);
std::string jsonText(const nlohmann::ordered_json& value, int indent = 2);
// Prints that object, or a line per value, with the values in column `width`.
void printReport(const nlohmann::ordered_json& report, bool json, int width);

// "there is no WHAT; did you mean NEAREST? there are KNOWN" for a word that is not known.
std::string thereIsNo(const std::string& what, const std::string& word,
                      const std::vector<std::string>& known);

// Checks of option values. CLI11's own checks answer a wrong value with lists of names and numbers, let NaN
// pass, and print the largest double in full. The description of a check is its range, "0 to 1000", or its
// words, "{y,z}".
//
// One of these words, in small or capital letters.
CLI::Validator isOneOf(std::vector<std::string> names);

// Choices by the names that files have for them (io/choice_keys.h).
CLI::Validator isOneOf(std::span<const std::string_view> names, const std::vector<std::string>& more = {});
template <class Enum>
Enum chosen(std::span<const std::string_view> names, const std::string& name) {
    return Enum(std::find(names.begin(), names.end(), name) - names.begin());
}

// Whole numbers, and numbers, from `low` to `high`; both belong to them.
CLI::Validator inRange(int low, int high);
CLI::Validator inRange(double low, double high);

// Whether the whole text is a number.
bool readNumber(const std::string& text, float& number);

// Finite numbers above 0, and from 0 on, that fit a float.
CLI::Validator isPositive();
CLI::Validator isNotNegative();

// Further arguments after the help of an option, besides the check of its values.
struct Word {
    const char* of;  // the value, in the help; without one a text is a path
};
struct Count {
    int values;
};
struct Needs {
    CLI::Option* other;
};
// shown: the help shows the variable's current value as the default. oneEach: the option is repeated for each
// of several values. separated: the values are separated by commas.
enum class Mark { required, shown, oneEach, separated, hidden };
using enum Mark;

void apply(CLI::Option& option, Word word);
void apply(CLI::Option& option, Count count);
void apply(CLI::Option& option, Needs needs);
void apply(CLI::Option& option, Mark mark);
void apply(CLI::Option& option, const CLI::Validator& check);

// Adds an option, or a flag where the value is a bool.
template <class Value, class... More>
CLI::Option* option(CLI::App& app, const char* names, Value& value, const std::string& help,
                    const More&... more) {
    CLI::Option* added = nullptr;
    if constexpr (std::is_same_v<Value, bool>)
        added = app.add_flag(names, value, help);
    else
        added = app.add_option(names, value, help);
    (apply(*added, more), ...);
    return added;
}
void jsonOption(CLI::App& app, bool& json);

// A subcommand that calls `run` with the arguments filled in by its options, which the caller adds.
template <class Arguments, class Function>
auto subcommand(CLI::App& app, const char* name, const char* what, Function run) {
    const auto arguments = std::make_shared<Arguments>();
    CLI::App* const command = app.add_subcommand(name, what);
    command->callback([arguments, run] { run(*arguments); });
    return std::pair<CLI::App&, Arguments&>(*command, *arguments);
}

// Before any work, throw UsageError unless the file, of one of these extensions, can be written; or `file` in
// the folder of -o, which is made if need be. `inputs`: files that are read, which it may not overwrite.
void checkOutput(const std::string& path, std::initializer_list<std::string_view> extensions,
                 const std::vector<std::string>& inputs = {});
void keepInputs(const std::string& output, const std::vector<std::string>& inputs);
void checkFolder(const std::string& folder, const std::string& file);

// Whether a constant or harmonics give light.
bool isLit(const PelAmbient& ambient);

// Adds --device, --json and --strict.
void addRunOptions(CLI::App& command, Run::Options& options);

// The path of data that come with the command, such as "heads/head_female.obj": in share/pellucid where it is
// installed, else in the source code. "" if they are not there.
std::string installed(const std::string& data);

// "WxH" or "WxHxD" to its numbers; throws UsageError.
void parseSize(const std::string& text, std::initializer_list<uint32_t*> sides);

// Each file of this folder adds one subcommand.
void addDevices(CLI::App& app);
void addCurvature(CLI::App& app);
void addLut(CLI::App& app);
void addProfile(CLI::App& app);
void addSkin(CLI::App& profile);
void addBatch(CLI::App& app);
void addShade(CLI::App& app);
void addReference(CLI::App& app);
void addImport(CLI::App& app);
void addCompare(CLI::App& app);
void addWarmUp(CLI::App& app);
void addDemo(CLI::App& app);
void addBench(CLI::App& app);
void addTune(CLI::App& app);
void addView(CLI::App& app);  // and gallery
void addDescribe(CLI::App& app);

std::shared_ptr<CLI::FormatterBase> helpFormatter();
// For CLI::ExtrasError: lists the unexpected words, and suggests similar options.
std::string unknownOptions(const CLI::App& app);

// Names of types (Word) whose values shells complete. A text without a name of its own is a path.
constexpr const char *deviceWord = "DEVICE", *profileWord = "PROFILE";

}  // namespace pellucid::cli
