// pellucid bench: every operation on every device, its time and its error; bench compare: two reports against
// each other.
#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "command.h"
#include "io/atomic_file.h"
#include "io/file_error.h"
#include "io/input_file.h"
#include "measure/measure.h"
#include "measure/report.h"
#include "system/process.h"

namespace pellucid::cli {
namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
    std::vector<std::string> devices, only, without;
    std::string output, before, after;
    double limitSeconds = 0;  // 0: depends on `quick`
    bool quick = false, json = false, firstUse = false;
    bool events = false;  // in a child process: prints what it does, one JSON object a line
};

std::atomic<bool> stopped{false};

// Numbers of the devices to measure: those of --device, or all but simulators.
std::vector<std::string> chosenDevices(const Arguments& a) {
    if (!a.devices.empty()) return a.devices;
    std::vector<std::string> chosen;
    for (const PelDeviceInfo& d : Device::all()) {
        if (std::string(d.platform).find("Oclgrind") != std::string::npos)
            std::fprintf(stderr, "%u: %s is left out; --device %u measures it\n", d.index, d.name, d.index);
        else
            chosen.push_back(std::to_string(d.index));
    }
    if (chosen.empty()) chosen.push_back("");  // opening it gives the library's message
    return chosen;
}

bench::Request requestOf(const Arguments& a, const std::string& device) {
    bench::Request request;
    request.device = device;
    request.quick = a.quick;
    request.only = a.only;
    request.without = a.without;
    request.limitSeconds = a.limitSeconds > 0 ? a.limitSeconds : a.quick ? 60 : 120;
    return request;
}

// What the process that waits for this one reads.
void measureWithEvents(const Arguments& a) {
    // Drivers may print; not among the events.
    std::FILE* out = ::fdopen(::dup(STDOUT_FILENO), "w");
    ::dup2(STDERR_FILENO, STDOUT_FILENO);
    const auto tell = [out](const Json& event) {
        std::fprintf(out, "%s\n", jsonText(event, -1).c_str());
        std::fflush(out);
    };
    bench::Request request = requestOf(a, a.devices.empty() ? "" : a.devices[0]);
    request.event = tell;
    const Json report = bench::measureCases(request);
    tell({{"report", report}});
    std::fclose(out);
}

void measure(const Arguments& a) {
    if (a.events) return measureWithEvents(a);
    if (a.firstUse) {
        std::cout << jsonText(bench::firstUse(a.devices.empty() ? "" : a.devices[0]), -1) << std::endl;
        return;
    }
    if (a.output.empty()) throw UsageError("-o is needed: a folder for bench.json and bench.html");
    const std::string jsonPath = a.output + "/bench.json", htmlPath = a.output + "/bench.html";
    const std::vector<std::string> chosen = chosenDevices(a);
    checkFolder(a.output, "bench.json");
    std::signal(SIGINT, [](int signal) {
        stopped = true;
        std::signal(signal, SIG_DFL);
    });
    const auto start = std::chrono::steady_clock::now();
    Json report = {{"host", bench::describeHost()},
                   {"quick", a.quick},
                   {"limit_s", requestOf(a, "").limitSeconds},
                   {"devices", Json::array()}};
    std::string names;
    double deviceMilliseconds = 0;
    for (const std::string& selector : chosen) {
        bench::Request request = requestOf(a, selector);
        request.command = pel::system::programFile();
        request.progress = [&](const std::string& text) {
            std::fprintf(stderr, "device %s: %s\n", selector.c_str(), text.c_str());
        };
        request.cancelled = [] { return stopped.load(); };
        report["devices"].push_back(bench::measureDevice(request));
        const Json& d = report["devices"].back();
        names += (names.empty() ? "" : ", ") + d.at("name").get<std::string>();
        for (const Json& e : d.at("operations"))
            deviceMilliseconds += e.value("device_ms", 0.0) * e.value("runs", 0.0);
    }
    io::writeWholeFile(jsonPath, jsonText(report, 1) + "\n");
    io::writeWholeFile(htmlPath, bench::htmlPage(report));
    const std::chrono::duration<double, std::milli> total = std::chrono::steady_clock::now() - start;
    const Json said = {{"device", names},           {"report", jsonPath},
                       {"page", htmlPath},          {"device_ms", deviceMilliseconds},
                       {"total_ms", total.count()}, {"warnings", Json::array()}};
    if (a.json) {
        printJson(said);
        return;
    }
    for (const Json& d : report["devices"]) {
        std::printf("%s\n  %-28s %10s %9s %10s %10s %12s\n", d.at("name").get<std::string>().c_str(),
                    "operation", "median ms", "MAD", "bandwidth", "arithmetic", "largest error");
        for (const Json& e : d.at("operations")) {
            std::printf("  %-28s", e.at("name").get<std::string>().c_str());
            if (e.contains("failed")) {
                std::printf(" could not be done: %s\n", e["failed"].get<std::string>().c_str());
                continue;
            }
            const auto share = [&](const char* key) {
                if (e.contains(key))
                    std::printf(" %8.1f %%", 100 * e[key].get<double>());
                else
                    std::printf(" %10s", "");
            };
            std::printf(" %10.3f %9.3f", e["median_ms"].get<double>(), e["mad_ms"].get<double>());
            share("bandwidth_share");
            share("arithmetic_share");
            if (e.contains("error_max") && e["error_max"].is_number())
                std::printf(" %12.2e", e["error_max"].get<double>());
            std::printf("\n");
        }
    }
    std::printf("%s\n%s\n", jsonPath.c_str(), htmlPath.c_str());
}

// A report, or the folder that `pellucid bench -o` wrote it into.
Json readReport(std::string path) {
    if (std::filesystem::is_directory(path)) path += "/bench.json";
    Json report = bench::parseReport(io::readWholeFile(path, io::textLimit));
    if (report.is_discarded()) throw InputError(path + ": not a report of `pellucid bench` (its bench.json)");
    return report;
}

void compare(const Arguments& a) {
    const Json before = readReport(a.before), after = readReport(a.after);
    Json result;
    try {
        result = bench::compareReports(before, after);
    } catch (const nlohmann::json::exception& e) {
        throw InputError(a.before + " or " + a.after + ": not whole: " + e.what());
    }
    const auto number = [&](const char* key) { return result.at(key).get<int>(); };
    if (number("same") + number("faster") + number("slower") + number("less_accurate") + number("fails") == 0)
        throw InputError("nothing to compare in " + a.before + " and " + a.after + ": " +
                         (number("other_size") > 0
                              ? "all operations have other sizes; was one of the reports made with --quick?"
                              : "no operation was measured on one device in both"));
    if (a.json)
        printJson(result);
    else
        std::cout << bench::describeComparison(result) << std::flush;
    if (number("slower") + number("less_accurate") + number("fails") > 0) throw ExitWith(exitWorse);
}

}  // namespace

void addBench(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("bench", "Measure every operation: time, share of the device's limits, error");
    auto a = std::make_shared<Arguments>();
    option(*command, "-o,--output", a->output, "folder for bench.json and bench.html");
    option(*command, "--device", a->devices,
           "number, name or type; may be given several times (default: all but simulators)", Word{deviceWord},
           oneEach);
    option(*command, "--only", a->only,
           "part of an operation's name; may be given several times (default: all)", Word{"NAME"}, oneEach);
    option(*command, "--quick", a->quick, "small sizes and few repetitions: some seconds");
    option(*command, "--limit", a->limitSeconds,
           "seconds that an operation may take to be prepared, and again to be measured, before it is given "
           "up (120; with --quick 60)",
           isPositive());
    option(*command, "--events", a->events, "", hidden);
    option(*command, "--without", a->without, "", oneEach, hidden);
    jsonOption(*command, a->json);
    option(*command, "--first-use", a->firstUse,
           "time from nothing to the first table and frame, in this process alone");
    CLI::App* two = command->add_subcommand(
        "compare", "Two reports: what became slower, less accurate or fails (exit code 1), what faster");
    option(*two, "old", a->before, "bench.json, or the folder that -o wrote it into", required);
    option(*two, "new", a->after, "the same of the other run, or of another device", required);
    jsonOption(*two, a->json);
    two->callback([a] { compare(*a); });
    command->callback([a, two] {
        if (!two->parsed()) measure(*a);
    });
}

}  // namespace pellucid::cli
