#include "command.h"

#include <atomic>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <iostream>

#include "system/process.h"

namespace pellucid::cli {
namespace {

std::atomic<bool> interrupted{false};

// The first Ctrl-C cancels at the next step of progress, the second one kills.
void onInterrupt(int signal) {
    interrupted = true;
    std::signal(signal, SIG_DFL);
}

}  // namespace

Run::Run(const Options& options)
    : options_(options),
      device_(options.device),
      before_(device_.stats()),
      start_(std::chrono::steady_clock::now()) {
    std::signal(SIGINT, onInterrupt);
    device_.setProgress(&Run::onProgress, this);
    report["device"] = device_.info().name;
}

Run::~Run() {
    if (progressShown_) std::fputs("\n", stderr);
    pelDeviceSetProgress(device_.get(), nullptr, nullptr);
}

int Run::onProgress(void* user, double fraction, const char* what) {
    Run& run = *static_cast<Run*>(user);
    const std::chrono::duration<double> since = std::chrono::steady_clock::now() - run.start_;
    if (pel::system::errorsAreSeen() && since.count() > 1) {
        std::fprintf(stderr, "\r%3.0f %% %-60.60s", fraction * 100, what);
        run.progressShown_ = fraction < 1;
        if (fraction >= 1) std::fputs("\n", stderr);
    }
    return !interrupted;
}

void Run::progress(double fraction, const char* what) {
    if (!onProgress(this, fraction, what)) throw Error(PEL_ERROR_CANCELLED, "interrupted");
}

double Run::deviceMilliseconds() const {
    return device_.stats().kernelMilliseconds - before_.kernelMilliseconds;
}

void Run::note(const std::string& text) const {
    std::fprintf(stderr, "%s\n", text.c_str());
}

void Run::warn(const std::string& text) {
    if (options_.strict) throw InputError(text + " (--strict)");
    warnings_.push_back(text);
    std::fprintf(stderr, "warning: %s\n", text.c_str());
}

void Run::finish() {
    const std::chrono::duration<double, std::milli> total = std::chrono::steady_clock::now() - start_;
    report["device_ms"] = deviceMilliseconds();
    report["total_ms"] = total.count();
    report["warnings"] = warnings_;
    if (options_.json) {
        printJson(report);
        return;
    }
    for (const auto& [key, value] : report.items()) {
        // Tables are for programs: people saw theirs on the way.
        if (value.is_array() && (value.empty() || value[0].is_object())) continue;
        std::cout << key << ": " << (value.is_string() ? value.get<std::string>() : jsonText(value, -1))
                  << "\n";
    }
    std::cout << std::flush;
}

void printJson(const nlohmann::ordered_json& report) {
    std::cout << jsonText(report) << std::endl;
}

std::string jsonText(const nlohmann::ordered_json& value, int indent) {
    return value.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

void addRunOptions(Command& command, Run::Options& options) {
    command
        .addOption("--device", options.device,
                   "OpenCL device: number, name or type (default: PELLUCID_DEVICE, best GPU, CPU)")
        ->typeName(deviceWord);
    command.addFlag("--json", options.json, "print one JSON object on standard output");
    command.addFlag("--strict", options.strict,
                    "what would be a warning is an error: exit code 3, and nothing is written");
}

void parseSize(const std::string& text, uint32_t& width, uint32_t& height) {
    const char *at = text.data(), *end = at + text.size();
    uint32_t w = 0, h = 0;
    auto read = std::from_chars(at, end, w);  // takes no sign and no blanks
    if (read.ec == std::errc() && read.ptr != end && *read.ptr == 'x')
        read = std::from_chars(read.ptr + 1, end, h);
    if (read.ec != std::errc() || read.ptr != end || w == 0 || h == 0)
        throw UsageError("--size " + text + ": two whole numbers from 1 on are needed, such as 512x512");
    width = w;
    height = h;
}

}  // namespace pellucid::cli
