#include "supervise.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "case.h"
#include "child_process.h"
#include "page.h"

namespace pellucid::bench {
namespace {

using Json = nlohmann::ordered_json;
using Answer = ChildProcess::Answer;

constexpr double startSeconds = 120;

bool cancelled(const Request& request) {
    return request.cancelled && request.cancelled();
}

std::string noResult(const Request& request) {
    return "no result within " + shortNumber(request.limitSeconds) + " s";
}

// The result of one process.
struct Outcome {
    Json report;      // null: it did not get there
    Json at;          // {"begin", "group"} of the case that it was at
    std::string why;  // it did not get there
};

Outcome runApart(const Request& request, const std::set<std::string>& without) {
    std::vector<std::string> command{request.command,
                                     "bench",
                                     "--events",
                                     "--device",
                                     request.device,
                                     "--limit",
                                     std::to_string(request.limitSeconds)};
    if (request.quick) command.push_back("--quick");
    for (const std::string& name : request.only) command.insert(command.end(), {"--only", name});
    for (const std::string& name : without) command.insert(command.end(), {"--without", name});
    ChildProcess child(command, {}, true);
    Outcome outcome;
    std::string line;
    for (;;) {
        // Starting and opening the device is not a case.
        const double limit =
            outcome.at.is_null() ? std::max(request.limitSeconds, startSeconds) : request.limitSeconds;
        const Answer answer = child.next(line, limit, request.cancelled);
        if (cancelled(request)) throw pellucid::Error(PEL_ERROR_CANCELLED, "the benchmark was cancelled");
        if (answer == Answer::silent) {
            outcome.why = noResult(request);
            return outcome;
        }
        if (answer == Answer::ended) break;
        const Json event = Json::parse(line, nullptr, false);
        if (!event.is_object()) continue;
        if (event.contains("begin")) outcome.at = event;
        if (event.contains("say") && request.progress) request.progress(event["say"]);
        if (event.contains("report")) outcome.report = event["report"];
    }
    const std::string ending = child.ending();
    if (outcome.report.is_null()) outcome.why = "its process " + (ending.empty() ? "ended" : ending);
    return outcome;
}

}  // namespace

Json measureCasesApart(const Request& request) {
    std::set<std::string> without;
    Json lost = Json::array();
    // After a loss all others are measured again.
    for (;;) {
        Outcome outcome = runApart(request, without);
        if (!outcome.report.is_null()) {
            for (const Json& e : lost) outcome.report["operations"].push_back(e);
            return outcome.report;
        }
        if (outcome.at.is_null()) outcome.at = {{"begin", "start"}, {"group", "device"}};
        const std::string name = outcome.at.at("begin");
        if (request.progress) request.progress(name + ": " + outcome.why);
        lost.push_back({{"name", name}, {"group", outcome.at.at("group")}, {"failed", outcome.why}});
        // The process did not reach any case, or reached one that was left out.
        if (name == "start" || !without.insert(name).second)
            return {
                {"copy_bytes_per_second", Json()}, {"operations_per_second", Json()}, {"operations", lost}};
    }
}

void measureFirstUse(const Request& request, Json& report) {
    const std::filesystem::path cache =
        std::filesystem::temp_directory_path() / ("pellucid-bench-" + std::to_string(::getpid()));
    std::vector<std::pair<std::string, std::string>> environment;
    for (const char* variable :
         {"POCL_CACHE_DIR", "CUDA_CACHE_PATH", "MESA_SHADER_CACHE_DIR", "NEO_CACHE_DIR", "cl_cache_dir",
          "AMD_COMGR_CACHE_DIR", "PELLUCID_CACHE_DIR"})
        environment.emplace_back(variable, cache.string());
    for (const char* key : {"first_use", "warm_start"}) {
        std::filesystem::create_directories(cache);
        ChildProcess child({request.command, "bench", "--first-use", "--device", request.device}, environment,
                           false);
        std::string line;
        const Answer answer = child.next(line, request.limitSeconds, request.cancelled);
        const Json parsed = answer == Answer::heard ? Json::parse(line, nullptr, false) : Json();
        // Until it is gone: drivers may write their caches at the end.
        if (answer == Answer::heard) child.next(line, request.limitSeconds, request.cancelled);
        if (parsed.is_object())
            report[key] = parsed;
        else
            report[key] = {
                {"failed", answer == Answer::silent ? noResult(request) : "its process " + child.ending()}};
        if (cancelled(request)) break;
    }
    std::error_code ignored;
    std::filesystem::remove_all(cache, ignored);
    if (cancelled(request)) throw pellucid::Error(PEL_ERROR_CANCELLED, "the benchmark was cancelled");
}

}  // namespace pellucid::bench
