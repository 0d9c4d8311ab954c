// What every subcommand of `pellucid` shares: the device, the report, progress, exit codes.
#pragma once
#include <chrono>
#include <nlohmann/json.hpp>
#include <pellucid/pellucid.hpp>
#include <stdexcept>
#include <string>

#include "options.h"
#include "values.h"

namespace pellucid::cli {

// exitWorse: `bench compare` found something slower or less accurate.
enum ExitCode { exitDone = 0, exitWorse = 1, exitWrongUse = 2, exitBadInput = 3, exitNoDevice = 4 };

// Wrong use that only shows once the arguments are looked at together.
class UsageError : public std::runtime_error {
    using runtime_error::runtime_error;
};

// A bad input file found by the library: the message names the file.
class InputError : public std::runtime_error {
    using runtime_error::runtime_error;
};

// Ends the command with this code and without a message.
struct ExitWith : std::runtime_error {
    explicit ExitWith(ExitCode c) : std::runtime_error(""), code(c) {}
    ExitCode code;
};

// One run of a subcommand: opens the device, shows progress on stderr, prints the report on stdout at the
// end.
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

    // Shows progress of work on the host. Throws Error after Ctrl-C.
    void progress(double fraction, const char* what);
    void note(const std::string& text) const;  // to stderr, for people
    // To stderr, and into the report; with --strict an InputError. Before anything is written.
    void warn(const std::string& text);
    // Key and value of the report, in this order. Numbers, texts, arrays and objects alike.
    nlohmann::ordered_json report;

    // Prints the report: one JSON object with --json, else a line per entry.
    void finish();

  private:
    Options options_;
    Device device_;
    PelDeviceStats before_;
    std::chrono::steady_clock::time_point start_;
    nlohmann::ordered_json warnings_ = nlohmann::ordered_json::array();
    bool progressShown_ = false;
    static int onProgress(void* user, double fraction, const char* what);
};

// One JSON object on standard output. Names of files that are no UTF-8 come with U+FFFD for what is none:
// JSON has no other bytes.
void printJson(const nlohmann::ordered_json& report);
std::string jsonText(const nlohmann::ordered_json& value, int indent = 2);

// Adds --device, --json and --strict.
void addRunOptions(Command& command, Run::Options& options);

// "WxH" to two numbers; throws UsageError.
void parseSize(const std::string& text, uint32_t& width, uint32_t& height);

// Each file of this folder adds one subcommand.
void addDevices(Command& app);
void addCurvature(Command& app);
void addLut(Command& app);
void addProfile(Command& app);
void addBatch(Command& app);
void addShade(Command& app);
void addReference(Command& app);
void addImport(Command& app);
void addCompare(Command& app);
void addWarmUp(Command& app);
void addDemo(Command& app);
void addBench(Command& app);
void addView(Command& app);  // and gallery
void addDescribe(Command& app, const CLI::App& parser);

// Names of types (Option::typeName) for which shells complete values. A text without a name of its own is a
// path.
constexpr const char *deviceWord = "DEVICE", *profileWord = "PROFILE";

}  // namespace pellucid::cli
