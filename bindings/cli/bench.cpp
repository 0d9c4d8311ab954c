// pellucid bench: every operation and every method of scattering on every device, its time and its error, as
// a report and a page; bench compare: reports against the first of them.
#include <atomic>
#include <csignal>

#include "command.h"
#include "io/atomic_file.h"
#include "io/input_file.h"
#include "measurements.h"
#include "system/process.h"

namespace pellucid::cli {
namespace {

using Json = nlohmann::ordered_json;

struct BenchArguments {
    bench::Request request{.limitSeconds = 0};  // what options set of it; 0: depends on `quick`
    std::vector<std::string> devices, reports, budgets{"1ms"};
    std::vector<double> errors{2e-3};
    std::string output, slower, lessAccurate, truth;
    double stabilityShare = 0;  // 0: depends on `quick`
    bool json = false, firstUse = false, stability = false;
    std::string events;  // in a child process: what it measures; it prints one JSON object a line
};

// The folder with heads, frozen scenes' truth and the page's form.
std::string dataFolder() {
    const std::string bench = installed("bench");
    if (bench.empty())
        throw UsageError("the folder share/pellucid/bench, which comes with pellucid, is missing");
    return std::filesystem::path(bench).parent_path().string();
}

std::string text(const Json& e, const char* key) {
    return e.at(key);
}
double number(const Json& e, const char* key) {
    return e.at(key);
}
int count(const Json& e, const char* key) {
    return e.at(key);
}

// Reads a number with a unit, such as "1ms" or "10%".
double numberOf(const std::string& text, const std::string& unit, const char* option) {
    float value = 0;
    if (!text.ends_with(unit) || !readNumber(text.substr(0, text.size() - unit.size()), value) ||
        !(value >= 0))
        throw UsageError(std::string(option) + " " + text + ": a number and " + unit +
                         " is needed, such as 10" + unit);
    return value;
}

void writePage(const std::string& path, const Json& reports) {
    io::writeWholeFile(
        path,
        measurements().pageOf(io::readWholeFile(dataFolder() + "/bench/page.html", io::textLimit), reports));
}

std::atomic<bool> stopped{false};

// Numbers of the devices to measure: those of --device, or all but simulators; with --first-gpu all GPUs.
std::vector<std::string> chosenDevices(const BenchArguments& a) {
    if (!a.devices.empty()) return a.devices;
    std::vector<std::string> chosen;
    for (const PelDeviceInfo& d : Device::all()) {
        if (a.request.firstGpu && d.type != PEL_DEVICE_GPU) continue;
        if (std::string(d.platform).find("Oclgrind") != std::string::npos)
            std::fprintf(stderr, "%u: %s is left out; --device %u measures it\n", d.index, d.name, d.index);
        else
            chosen.push_back(std::to_string(d.index));
    }
    if (chosen.empty() && a.request.firstGpu)
        std::fprintf(stderr, "no GPU was found: measuring the best device instead\n");
    if (chosen.empty()) chosen.push_back("");  // opening it gives the library's message
    return chosen;
}

bench::Request requestOf(const BenchArguments& a, const std::string& device) {
    bench::Request request = a.request;
    request.device = device;
    request.stability = a.stabilityShare > 0 ? a.stabilityShare
                        : !a.stability       ? 0
                        : request.quick      ? 0.002
                                             : 0.05;
    request.data = dataFolder();
    if (request.limitSeconds == 0) request.limitSeconds = request.quick || request.firstGpu ? 60 : 120;
    return request;
}

// Measures in a child process and writes its events to the parent process.
void measureWithEvents(const BenchArguments& a) {
    // Drivers may print to standard output, which must not mix with the events.
    std::FILE* out = ::fdopen(::dup(STDOUT_FILENO), "w");
    ::dup2(STDERR_FILENO, STDOUT_FILENO);
    const auto tell = [out](const Json& event) {
        std::fprintf(out, "%s\n", jsonText(event, -1).c_str());
        std::fflush(out);
    };
    bench::Request request = requestOf(a, a.devices.empty() ? "" : a.devices[0]);
    request.event = tell;
    Json report = Json::object();
    if (a.events == "first")
        measurements().measureFirst(request);
    else
        report = a.events == "methods"     ? measurements().measureMethods(request)
                 : a.events == "stability" ? measurements().measureStability(request)
                                           : measurements().measureCases(request);
    tell({{"report", report}});
    std::fclose(out);
}

void makeTruth(const BenchArguments& a) {
    std::signal(SIGINT, [](int) { stopped = true; });
    measurements().makeTruth(
        Device(a.devices.empty() ? "" : a.devices[0]), a.truth, dataFolder() + "/heads/head_female.obj",
        [](const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); },
        [] { return stopped.load(); });
    pel::system::setVariable("PELLUCID_MATH_WIDTH", "1");
    bench::Request request = requestOf(a, a.devices.empty() ? "" : a.devices[0]);
    request.event = [](const Json&) {};
    measurements().keepPictures(request, a.truth);
}

// Prints the findings of --first-gpu; the page has the rest.
void printFirst(const Json& device) {
    const Json& first = device.at("first_gpu");
    std::printf("%s\n  %d pictures and operations judged, %d out of tolerance or not done\n",
                text(device, "name").c_str(), count(first, "checked"), int(first.at("out").size()));
    for (const Json& e : device.at("operations")) {
        if (e.contains("failed"))
            std::printf("  %s: could not be done: %s\n", text(e, "name").c_str(), text(e, "failed").c_str());
        if (!e.contains("passes")) continue;
        std::printf("  %-44s %9.2f ms:", text(e, "name").c_str(), number(e, "median_ms"));
        for (const Json& pass : e["passes"]) {
            std::printf(" %s %.2f", text(pass, "name").c_str(), number(pass, "ms"));
            if (pass["predicted_ms"].is_number()) std::printf(" (%.2f)", number(pass, "predicted_ms"));
        }
        std::printf("\n");
    }
    std::printf("  In brackets: predicted.\n");
}

// Prints the Pareto-optimal methods in time and error, fastest first.
void printMethods(const Json& device) {
    std::vector<Json> best;
    for (const Json& e : device.at("summary"))
        if (e.at("pareto")) best.push_back(e);
    if (best.empty()) return;
    std::ranges::sort(best, {}, [](const Json& e) { return number(e, "ns_per_pixel"); });
    std::printf("  %-40s %10s %10s %10s %12s\n", "methods that no other beats", "ns/pixel", "1080p ms",
                "4K ms", "from light");
    for (const Json& e : best)
        std::printf("  %-40s %10.0f %10.2f %10.2f %12.4f\n",
                    (text(e, "method") + " " + text(e, "setting")).c_str(), number(e, "ns_per_pixel"),
                    number(e.at("ms"), "1080p"), number(e.at("ms"), "4K"), number(e, "error"));
}

void printOperations(const Json& device) {
    std::printf("%s\n  %-28s %10s %9s %10s %10s %12s\n", text(device, "name").c_str(), "operation",
                "median ms", "MAD", "bandwidth", "arithmetic", "largest error");
    for (const Json& e : device.at("operations")) {
        if (e.contains("scene")) continue;  // there are hundreds: the page has them
        std::printf("  %-28s", text(e, "name").c_str());
        if (e.contains("failed")) {
            std::printf(" could not be done: %s\n", text(e, "failed").c_str());
            continue;
        }
        std::printf(" %10.3f %9.3f", number(e, "median_ms"), number(e, "mad_ms"));
        for (const char* key : {"bandwidth_share", "arithmetic_share"})
            if (e.contains(key) && e[key].is_number())
                std::printf(" %8.1f %%", 100 * number(e, key));
            else
                std::printf(" %10s", e.contains(key) ? "not known" : "");
        if (e.contains("error_max") && e["error_max"].is_number())
            std::printf(" %12.2e", number(e, "error_max"));
        std::printf("\n");
    }
    printMethods(device);
    if (const Json b = device.value("budgets", Json()); !b.is_null())
        std::printf(
            "  time budgets: %d of %d frames kept theirs; %d are within 1.3 of the best that is as fast, "
            "the worst at %.2f\n",
            count(b, "kept"), count(b, "frames"), count(b, "near"), number(b, "worst_ratio"));
}

void measure(const BenchArguments& a) {
    if (!a.truth.empty()) return makeTruth(a);
    if (!a.events.empty()) return measureWithEvents(a);
    if (a.firstUse) {
        std::cout << jsonText(measurements().firstUse(a.devices.empty() ? "" : a.devices[0]), -1)
                  << std::endl;
        return;
    }
    const std::string folder = a.output.empty() && a.request.firstGpu ? "pellucid-first-gpu" : a.output;
    if (folder.empty()) throw UsageError("-o is needed: a folder for bench.json");
    if (a.request.firstGpu && (a.stability || a.stabilityShare > 0))
        throw UsageError("--first-gpu does not search for the worst errors: leave --stability out");
    // One lane, as on GPUs: a window of pixels shared by several lanes gives slightly different results.
    if (a.request.firstGpu) pel::system::setVariable("PELLUCID_MATH_WIDTH", "1");
    const std::string jsonPath = folder + "/bench.json";
    std::vector<double> budgets;
    for (const std::string& text : a.budgets) {
        budgets.push_back(numberOf(text, "ms", "--budget"));
        if (budgets.back() == 0) throw UsageError("--budget " + text + ": it must be above 0ms");
    }
    const std::vector<std::string> chosen = chosenDevices(a);
    for (const std::string& selector : chosen) Device{selector};
    checkFolder(folder, "bench.json");
    // The processes that measure end with this one.
    for (const int signal : {SIGINT, SIGTERM})
        std::signal(signal, [](int given) {
            stopped = true;
            std::signal(given, SIG_DFL);
        });
    const auto start = std::chrono::steady_clock::now();
    Json report = {{"host", measurements().describeHost()},
                   {"quick", a.request.quick},
                   {"limit_s", requestOf(a, "").limitSeconds},
                   {"devices", Json::array()}};
    std::string names, out;
    Json pictures = Json::array();
    double deviceMilliseconds = 0;
    for (const std::string& selector : chosen) {
        bench::Request request = requestOf(a, selector);
        request.command = pel::system::programFile();
        request.progress = [&](const std::string& text) {
            std::fprintf(stderr, "device %s: %s\n", selector.c_str(), text.c_str());
        };
        request.cancelled = [] { return stopped.load(); };
        report["devices"].push_back(measurements().measureDevice(request));
        Json& d = report["devices"].back();
        for (const std::string& word : a.request.only)
            if (request.stability <= 0 && std::ranges::none_of(d.at("operations"), [&](const Json& e) {
                    return text(e, "name").find(word) != std::string::npos;
                }))
                throw UsageError("--only " + word +
                                 ": no operation has that in its name; a report without --only names all");
        measurements().summarize(d, budgets, a.errors);
        if (a.request.firstGpu) {
            measurements().judgeFirst(
                d, Json::parse(io::readWholeFile(dataFolder() + "/bench/warps.json", io::textLimit)));
            for (const Json& name : d.at("first_gpu").at("out")) out += "\n  " + name.get<std::string>();
        }
        pictures.push_back(d.value("pictures", Json::array()));
        d.erase("pictures");  // of the page alone
        names += (names.empty() ? "" : ", ") + text(d, "name");
        for (const Json& e : d.at("operations"))
            deviceMilliseconds += e.value("device_ms", 0.0) * e.value("runs", 0.0);
    }
    io::writeWholeFile(jsonPath, jsonText(report, 1) + "\n");
    std::string tuning;
    for (const Json& d : report["devices"]) tuning += measurements().tuningText(d);
    if (!tuning.empty())
        io::writeWholeFile(folder + "/tuning.txt",
                           std::string(pel::tuningHeader) +
                               "\n# method, target error, ns per pixel of the materials and of the "
                               "frame, RMS error against light\n" +
                               tuning);
    const std::string page = folder + "/bench.html";
    Json shown = report;
    for (size_t i = 0; i < pictures.size(); ++i) shown["devices"][i]["pictures"] = pictures[i];
    writePage(page, Json::array({shown}));
    const std::chrono::duration<double, std::milli> total = std::chrono::steady_clock::now() - start;
    const Json said = {{"device", names},
                       {"report", jsonPath},
                       {"page", page},
                       {"device_ms", deviceMilliseconds},
                       {"total_ms", total.count()},
                       {"warnings", Json::array()}};
    if (a.json) {
        printJson(said);
    } else {
        for (const Json& d : report["devices"]) a.request.firstGpu ? printFirst(d) : printOperations(d);
        std::printf("%s\n%s\n", jsonPath.c_str(), page.c_str());
    }
    if (out.empty()) return;
    std::fprintf(stderr, "pellucid: out of tolerance, or not done:%s\n", out.c_str());
    throw ExitWith(exitWorse);
}

// A report, or the folder that `pellucid bench -o` wrote it into.
Json readReport(std::string path) {
    if (std::filesystem::is_directory(path)) path += "/bench.json";
    Json report = measurements().parseReport(io::readWholeFile(path, io::textLimit));
    if (report.is_discarded()) throw InputError(path + ": not a report of `pellucid bench` (its bench.json)");
    return report;
}

void compare(const BenchArguments& a) {
    const auto limit = [](const std::string& text, const char* option) {
        return text.empty() ? INFINITY : 1 + numberOf(text, "%", option) / 100;
    };
    const double slower = limit(a.slower, "--fail-if-slower"),
                 lessAccurate = limit(a.lessAccurate, "--fail-if-less-accurate");
    if (a.reports.size() < 2)
        throw UsageError("two or more reports are needed: the first is what others are compared with");
    if (!a.output.empty()) checkOutput(a.output, {"html"});
    Json reports = Json::array(), results = Json::array();
    for (const std::string& path : a.reports) reports.push_back(readReport(path));
    bool worse = false;
    for (size_t i = 1; i < reports.size(); ++i) {
        Json result;
        try {
            result = measurements().compareReports(reports[0], reports[i]);
        } catch (const nlohmann::json::exception& e) {
            throw InputError(a.reports[0] + " or " + a.reports[i] + ": incomplete report: " + e.what());
        }
        int compared = 0;
        for (const char* key : {"same", "faster", "slower", "less_accurate", "fails"})
            compared += count(result, key);
        if (compared == 0)
            throw InputError("nothing to compare in " + a.reports[0] + " and " + a.reports[i] +
                             (result.at("other_size") > 0 ? ": all operations have other sizes"
                                                          : ": no operation was measured in both"));
        for (const Json& device : result.at("devices"))
            for (const Json& e : device.at("operations")) {
                const std::string verdict = e.at("verdict");
                worse |= verdict == "slower" && number(e, "ratio") > slower;
                worse |= verdict == "less accurate" && std::isfinite(lessAccurate) &&
                         !(e.at("new_error").is_number() &&
                           number(e, "new_error") <= lessAccurate * number(e, "old_error"));
                worse |= verdict == "fails" && (std::isfinite(slower) || std::isfinite(lessAccurate));
            }
        results.push_back(result);
        if (!a.json)
            std::cout << a.reports[i] << " against " << a.reports[0] << "\n"
                      << measurements().describeComparison(result) << std::flush;
    }
    if (a.json) printJson(results.size() == 1 ? results[0] : Json{{"comparisons", results}});
    if (!a.output.empty()) writePage(a.output, reports);
    if (worse) throw ExitWith(exitWorse);
}

}  // namespace

void addBench(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("bench", "Measure every operation: time, share of the device's limits, error");
    auto a = std::make_shared<BenchArguments>();
    option(*command, "-o,--output", a->output, "folder for bench.json and the page bench.html");
    option(*command, "--device", a->devices,
           "number, name or type; may be given several times (default: all but simulators)", Word{deviceWord},
           oneEach);
    option(*command, "--only", a->request.only,
           "part of an operation's name; may be given several times (default: all)", Word{"NAME"}, oneEach);
    option(*command, "--quick", a->request.quick,
           "fewer scenes and settings, smaller tables: below 90 seconds");
    option(*command, "--stability", a->stability,
           "also search inputs of every operation for the worst error (docs/stability.md): minutes more");
    option(*command, "--stability-share", a->stabilityShare,
           "the same, with this share of the whole search's points (0.05; with --quick 0.002)",
           inRange(1e-6, 1.0));
    option(*command, "--budget", a->budgets,
           "milliseconds at 1080p, such as 1ms, for which the report names the nearest method; several times",
           Word{"TIME"}, oneEach);
    option(*command, "--error", a->errors,
           "share of white, for which the report names the fastest method; several times", Word{"ERROR"},
           oneEach, isPositive());
    option(*command, "--limit", a->request.limitSeconds,
           "seconds that an operation may take to be prepared, and again to be measured, before it is given "
           "up (120; with --quick 60)",
           inRange(1.0, 86400.0));
    option(*command, "--events", a->events, "", hidden);
    option(*command, "--make-truth", a->truth, "", hidden);
    option(*command, "--powercap", a->request.powercap, "", hidden);
    option(*command, "--without", a->request.without, "", oneEach, hidden);
    jsonOption(*command, a->json);
    option(
        *command, "--first-gpu", a->request.firstGpu,
        "the first time on a GPU: pictures of every method against those of a CPU, and the time of each pass "
        "beside a prediction; -o: pellucid-first-gpu. Below 8 minutes");
    option(*command, "--first-use", a->firstUse,
           "time from nothing to the first table and frame, in this process alone");
    CLI::App* two =
        command->add_subcommand("compare",
                                "Reports against the first of them: what became slower, less accurate "
                                "or fails, what faster");
    option(*two, "reports", a->reports,
           "two or more: bench.json, or the folder that -o wrote it into; of any devices and extents",
           required);
    option(*two, "-o,--output", a->output, "page (HTML) that shows all of them");
    option(*two, "--fail-if-slower", a->slower,
           "such as 10%: exit code 1 if a case is slower by more than that, and beyond its noise",
           Word{"PERCENT"});
    option(*two, "--fail-if-less-accurate", a->lessAccurate,
           "such as 50%: exit code 1 if an error grew by more than that", Word{"PERCENT"});
    jsonOption(*two, a->json);
    two->callback([a] { compare(*a); });
    command->callback([a, two] {
        if (!two->parsed()) measure(*a);
    });
}

}  // namespace pellucid::cli
