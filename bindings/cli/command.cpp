#include "command.h"

#include <atomic>
#include <charconv>
#include <csignal>

#include "io/atomic_file.h"
#include "io/input_file.h"
#include "io/spelling.h"
#include "system/process.h"

namespace pellucid::cli {
namespace {

std::atomic<bool> interrupted{false};

// The first Ctrl-C cancels at the next step of progress, the second one kills. Compilers inside a driver
// notice it too: their messages are discarded.
void onInterrupt(int signal) {
    interrupted = true;
    pel::system::discardErrors();
    std::signal(signal, SIG_DFL);
}

// `fits`: whether a number is allowed; `what` and `description` tell which are.
template <class Number>
CLI::Validator numbers(const std::string& what, const std::string& description,
                       std::function<bool(Number)> fits) {
    return CLI::Validator(
        [what, fits](std::string& given) {
            Number number{};
            const char *begin = given.data() + given.starts_with('+'), *end = given.data() + given.size();
            const auto [at, error] = std::from_chars(begin, end, number);
            const bool read = error == std::errc() && at == end;
            return read && fits(number) ? std::string() : "'" + given + "' is not " + what;
        },
        description);
}

template <class Number>
CLI::Validator range(const std::string& kind, Number low, Number high) {
    std::ostringstream limits;
    limits << low << " to " << high;
    return numbers<Number>("a " + kind + " from " + limits.str(), limits.str(),
                           [=](Number n) { return n >= low && n <= high; });
}

}  // namespace

std::string thereIsNo(const std::string& what, const std::string& word,
                      const std::vector<std::string>& known) {
    const std::string nearest = io::nearestWord(word, known);
    return "there is no " + what + "; " + (nearest.empty() ? "" : "did you mean " + nearest + "? ") +
           "there are " + CLI::detail::join(known, ", ");
}

void withInput(const std::string& source, const std::function<void()>& work) {
    try {
        work();
    } catch (const Error& e) {
        if (e.code() == PEL_ERROR_INVALID_ARGUMENT) throw InputError(source + ": " + e.what());
        throw;
    }
}

CLI::Validator isOneOf(std::vector<std::string> names) {
    const std::string description = "{" + CLI::detail::join(names, ",") + "}";
    return CLI::Validator(
        [names = std::move(names)](std::string& given) {
            const std::string small = CLI::detail::to_lower(given);
            if (std::ranges::find(names, small) == names.end())
                return thereIsNo("'" + given + "'", small, names);
            given = small;
            return std::string();
        },
        description);
}

CLI::Validator isOneOf(std::span<const std::string_view> names, const std::vector<std::string>& more) {
    std::vector<std::string> all(names.begin(), names.end());
    all.insert(all.end(), more.begin(), more.end());
    return isOneOf(std::move(all));
}

CLI::Validator inRange(int low, int high) {
    return range("whole number", low, high);
}
CLI::Validator inRange(double low, double high) {
    return range("number", low, high);
}

CLI::Validator isPositive() {
    return numbers<float>("a number above 0", "above 0", [](float n) { return std::isfinite(n) && n > 0; });
}
CLI::Validator isNotNegative() {
    return numbers<float>("a number from 0 on", "from 0 on",
                          [](float n) { return std::isfinite(n) && n >= 0; });
}

bool readNumber(const std::string& text, float& number) {
    return CLI::detail::lexical_cast(text, number);
}

bool wasInterrupted() {
    return interrupted;
}

Progress::Progress() : start_(std::chrono::steady_clock::now()) {
    std::signal(SIGINT, onInterrupt);
}

Progress::~Progress() {
    pel::system::restoreErrors();
    if (shown_) std::fputs("\n", stderr);
}

double Progress::milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
}

bool Progress::goesOn(double fraction, const char* what) {
    if (pel::system::errorsAreSeen() && milliseconds() > 1000) {
        std::fprintf(stderr, "\r%3.0f %% %-60.60s", fraction * 100, what);
        shown_ = fraction < 1;
        if (!shown_) std::fputs("\n", stderr);
    }
    return !interrupted;
}

void Progress::operator()(double fraction, const char* what) {
    if (!goesOn(fraction, what)) throw Error(PEL_ERROR_CANCELLED, "interrupted");
}

namespace {

Device opened(const std::string& device, std::vector<std::string>& warnings) {
    pelSetLogCallback(
        [](void* user, PelLogLevel level, const char*, const char* line) {
            if (level == PEL_LOG_WARNING) static_cast<std::vector<std::string>*>(user)->emplace_back(line);
        },
        &warnings);
    const auto silent = [](void*) { pelSetLogCallback(nullptr, nullptr); };
    const std::unique_ptr<void, decltype(silent)> end(&warnings, silent);
    return Device(device);
}

}  // namespace

Run::Run(const Options& options)
    : options_(options), device_(opened(options.device, ofOpening_)), before_(device_.stats()) {
    device_.setProgress(
        [](void* user, double fraction, const char* what) {
            return int(static_cast<Progress*>(user)->goesOn(fraction, what));
        },
        &progress_);
    report["device"] = device_.info().name;
    for (const std::string& warning : ofOpening_) warn(warning);
}

Run::~Run() {
    pelDeviceSetProgress(device_.get(), nullptr, nullptr);
}

double Run::deviceMilliseconds() const {
    return device_.stats().kernelMilliseconds - before_.kernelMilliseconds;
}

void Run::warn(const std::string& text) {
    if (options_.strict) throw InputError(text + " (--strict)");
    warnings_.push_back(text);
    std::fprintf(stderr, "warning: %s\n", io::printable(text).c_str());
}

static std::string lineOf(const nlohmann::ordered_json& value) {
    return value.is_string() ? io::printable(value.get<std::string>()) : jsonText(value, -1);
}

void Run::finish() {
    report["device_ms"] = deviceMilliseconds();
    report["total_ms"] = progress_.milliseconds();
    report["warnings"] = warnings_;
    if (options_.json) return printJson(report);
    for (const auto& [key, value] : report.items()) {
        // Tables are only for --json: in text mode they have been printed already.
        if (value.is_array() && (value.empty() || value[0].is_object())) continue;
        std::cout << key << ": " << lineOf(value) << "\n";
    }
    std::cout << std::flush;
}

void printJson(const nlohmann::ordered_json& report) {
    std::cout << jsonText(report) << std::endl;
}

std::string jsonText(const nlohmann::ordered_json& value, int indent) {
    return value.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

void printReport(const nlohmann::ordered_json& report, bool json, int width) {
    if (json) return printJson(report);
    for (const auto& [key, value] : report.items())
        std::printf("%-*s %s\n", width, key.c_str(), lineOf(value).c_str());
}

void apply(CLI::Option& option, Word word) {
    option.type_name(word.of);
}
void apply(CLI::Option& option, Count count) {
    option.expected(count.values);
}
void apply(CLI::Option& option, Needs needs) {
    option.needs(needs.other);
}
void apply(CLI::Option& option, const CLI::Validator& check) {
    option.transform(check);  // which check() would let pass in capital letters, and leave so
}
void apply(CLI::Option& option, Mark mark) {
    if (mark == required) option.required();
    if (mark == shown) option.capture_default_str();
    if (mark == oneEach || mark == separated) option.allow_extra_args(false);
    if (mark == separated) option.delimiter(',');
    if (mark == hidden) option.group("");
}

void keepInputs(const std::string& output, const std::vector<std::string>& inputs) {
    std::error_code same;  // files that do not exist are not the same
    for (const std::string& input : inputs)
        if (!input.empty() && std::filesystem::equivalent(output, input, same))
            throw UsageError(output + " is one of the files that are read, and would be lost; name another");
}

void checkOutput(const std::string& path, std::initializer_list<std::string_view> extensions,
                 const std::vector<std::string>& inputs) {
    keepInputs(path, inputs);
    try {
        io::requireExtension(path, extensions);
        io::checkWritable(path);
    } catch (const io::FileError& e) {
        throw UsageError(e.what());
    }
}

bool isLit(const PelAmbient& ambient) {
    bool lit = false;
    for (const float v : ambient.constant) lit |= v != 0;
    for (const auto& row : ambient.sh)
        for (const float v : row) lit |= v != 0;
    return lit;
}

void checkFolder(const std::string& folder, const std::string& file) {
    try {
        std::filesystem::create_directories(folder);
        io::checkWritable(folder + "/" + file);
    } catch (const std::exception& e) {
        throw UsageError("-o " + folder + ": " + e.what());
    }
}

void jsonOption(CLI::App& app, bool& json) {
    option(app, "--json", json, "print one JSON object on standard output");
}

void addRunOptions(CLI::App& command, Run::Options& options) {
    option(command, "--device", options.device,
           "OpenCL device: number, name or type (default: PELLUCID_DEVICE, best GPU, CPU)", Word{deviceWord});
    jsonOption(command, options.json);
    option(command, "--strict", options.strict,
           "what would be a warning is an error: exit code 3, and nothing is written");
}

std::string installed(const std::string& data) {
    std::error_code error;
    const std::filesystem::path bin = std::filesystem::path(pel::system::programFile()).parent_path();
    for (const char* folder : {"../share/pellucid", "../../../data"})
        if (std::filesystem::exists(bin / folder / data, error))
            return (bin / folder / data).lexically_normal().string();
    return "";
}

void parseSize(const std::string& text, std::initializer_list<uint32_t*> sides) {
    const char *at = text.c_str(), *end = at + text.size();
    for (size_t left = sides.size(); uint32_t* const side : sides) {
        const auto read = std::from_chars(at, end, *side);  // takes no sign and no blanks
        if (read.ec != std::errc() || *side == 0 || *read.ptr != (--left ? 'x' : '\0'))
            throw UsageError("--size " + text + ": " + (sides.size() == 2 ? "two" : "three") +
                             " whole numbers from 1 on are needed, such as 64x64" +
                             (sides.size() == 2 ? "" : "x32"));
        at = read.ptr + 1;
    }
}

}  // namespace pellucid::cli
