// Measures a device in processes of its own, so that a failure there cannot stop the rest.
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <set>

#include "io/shortest.h"
#include "measure.h"
#include "temporary_folder.h"
#include "timing.h"

namespace pellucid::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double startSeconds = 120;

// The command `bench` of pellucid in a child process, read line by line. It ends with this process.
class Again {
  public:
    // `environment`: "NAME=VALUE" added to this process's own. Without `loud`, standard error is discarded.
    Again(const Request& request, const std::vector<std::string>& words,
          const std::vector<std::string>& environment, bool loud)
        : request_(request) {
        std::vector<std::string> all{"/usr/bin/env"};
        all.insert(all.end(), environment.begin(), environment.end());
        all.insert(all.end(), {request.command, "bench", "--device", request.device});
        all.insert(all.end(), words.begin(), words.end());
        std::vector<char*> pointers;
        for (std::string& word : all) pointers.push_back(word.data());
        pointers.push_back(nullptr);
        int ends[2];
        if (::pipe2(ends, O_CLOEXEC) != 0)
            throw std::runtime_error(std::string("no pipe: ") + std::strerror(errno));
        posix_spawn_file_actions_t streams;
        ::posix_spawn_file_actions_init(&streams);
        ::posix_spawn_file_actions_adddup2(&streams, ends[1], STDOUT_FILENO);
        if (!loud) ::posix_spawn_file_actions_addopen(&streams, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
        const int error =
            ::posix_spawn(&process_, all[0].c_str(), &streams, nullptr, pointers.data(), environ);
        ::posix_spawn_file_actions_destroy(&streams);
        ::close(ends[1]);
        pipe_ = ends[0];
        if (error) process_ = -1, why_ = std::string("cannot be started: ") + std::strerror(error);
    }
    ~Again() {
        if (process_ > 0) {
            ::kill(process_, SIGKILL);
            ::waitpid(process_, nullptr, 0);
        }
        ::close(pipe_);
    }
    Again(const Again&) = delete;

    // The next line of its output as JSON; empty if there is none, for the reason that why() returns.
    std::optional<Json> next(double seconds) {
        for (const double end = milliseconds() + 1e3 * seconds;;) {
            if (const size_t at = heard_.find('\n'); at != std::string::npos) {
                const Json line = Json::parse(heard_.substr(0, at), nullptr, false);
                heard_.erase(0, at + 1);
                return line;
            }
            if (request_.cancelled())
                throw pellucid::Error(PEL_ERROR_CANCELLED, "the benchmark was cancelled");
            const double left = end - milliseconds();
            why_ = io::printed("no result within %g s", request_.limitSeconds);
            if (left <= 0) return {};
            pollfd waits{pipe_, POLLIN, 0};
            if (::poll(&waits, 1, int(std::clamp(left, 1.0, 200.0))) <= 0) continue;
            char part[4096];
            const ssize_t got = ::read(pipe_, part, sizeof part);
            if (got > 0) heard_.append(part, size_t(got));
            if (got == 0 || (got < 0 && errno != EINTR)) break;
        }
        int status = 0;
        if (process_ > 0) ::waitpid(process_, &status, 0);
        process_ = -1;
        why_ = "its process ended";
        if (WIFSIGNALED(status))
            why_ = "its process was ended by signal " + std::to_string(WTERMSIG(status)) + " (" +
                   ::strsignal(WTERMSIG(status)) + ")";
        else if (WEXITSTATUS(status))
            why_ += " with exit code " + std::to_string(WEXITSTATUS(status));
        return {};
    }
    const std::string& why() const { return why_; }

  private:
    const Request& request_;
    pid_t process_ = -1;
    int pipe_ = -1;
    std::string heard_, why_;  // heard_: beyond the last line
};

// The report of one process; null if it did not finish. `part`: its task. `at`: its last case. `done`: gets
// what it measured before.
Json runApart(const Request& request, const char* part, const std::set<std::string>& without, Json& at,
              Json& done, std::string& why) {
    std::vector<std::string> words{
        "--events", part, "--limit", std::to_string(request.limitSeconds), "--powercap", request.powercap};
    if (request.quick) words.push_back("--quick");
    for (const std::string& name : request.only) words.insert(words.end(), {"--only", name});
    for (const std::string& name : without) words.insert(words.end(), {"--without", name});
    if (request.stability > 0)
        words.insert(words.end(), {"--stability-share", std::to_string(request.stability)});
    Again child(request, words, {"PELLUCID_DEVICE=" + request.device}, true);
    Json report;
    // Starting and opening the device is not a case.
    while (const auto event = child.next(at.is_null() ? std::max(request.limitSeconds, startSeconds)
                                                      : request.limitSeconds)) {
        if (!event->is_object()) continue;
        if (event->contains("begin")) at = *event;
        if (event->contains("say")) request.progress((*event)["say"]);
        if (event->contains("row")) done.push_back((*event)["row"]);
        if (event->contains("report")) report = (*event)["report"];
    }
    why = child.why();
    return report;
}

// measureCases() or measureMethods() by the command `request.command`. A case that does not answer within
// request.limitSeconds, or ends its process, is among the operations as {"name", "group", "failed": why}; the
// others are measured without it.
Json measureApart(const Request& request, const char* part) {
    std::set<std::string> without;
    Json done = Json::array();
    // After a failure, all unfinished operations are measured again.
    for (;;) {
        Json at;
        std::string why;
        Json report = runApart(request, part, without, at, done, why);
        if (!report.is_null()) {
            for (const Json& e : done) report["operations"].push_back(e);
            return report;
        }
        for (const Json& e : done) without.insert(e.at("name").get<std::string>());
        if (at.is_null()) at = {{"begin", "start"}, {"group", "device"}};
        const std::string name = at.at("begin");
        request.progress(name + ": " + why);
        done.push_back({{"name", name}, {"group", at.at("group")}, {"failed", why}});
        // The process did not reach any case, or reached one that was left out.
        if (name == "start" || !without.insert(name).second) return {{"operations", done}};
    }
}

// "first_use" and "warm_start" of a report: runs the command with an empty cache of every known driver, then
// with the cache that this run has filled.
void measureFirstUse(const Request& request, Json& report) {
    const TemporaryFolder cache("pellucid-bench-");
    std::vector<std::string> environment;
    for (const char* variable :
         {"POCL_CACHE_DIR", "CUDA_CACHE_PATH", "MESA_SHADER_CACHE_DIR", "NEO_CACHE_DIR", "cl_cache_dir",
          "AMD_COMGR_CACHE_DIR", "PELLUCID_CACHE_DIR"})
        environment.push_back(variable + ("=" + cache.path()));
    for (const char* key : {"first_use", "warm_start"}) {
        Again child(request, {"--first-use"}, environment, false);
        const auto said = child.next(request.limitSeconds);
        if (said && said->is_object()) {
            report[key] = *said;
            child.next(request.limitSeconds);  // until it is gone: drivers may write their caches at the end
        } else {
            report[key] = {{"failed", child.why()}};
        }
    }
}

}  // namespace

Json measureDevice(const Request& request) {
    const PelDeviceInfo info = Device(request.device).info();
    Json report = {{"name", info.name},
                   {"platform", info.platform},
                   {"version", info.version},
                   {"driver", info.driver},
                   {"type", info.type == PEL_DEVICE_GPU   ? "gpu"
                            : info.type == PEL_DEVICE_CPU ? "cpu"
                                                          : "accelerator"},
                   {"compute_units", info.computeUnits},
                   {"clock_mhz", info.clockMhz},
                   {"math_width", info.mathWidth}};
    request.progress("first use and warm start");
    measureFirstUse(request, report);
    report.update({{"copy_bytes_per_second", Json()}, {"operations_per_second", Json()}});
    report["operations"] = Json::array();
    for (const char* part : {"cases", "methods", "first", "stability"}) {
        if (part == std::string("stability") && request.stability == 0) continue;
        if (part == std::string(request.firstGpu ? "methods" : "first")) continue;
        Request own = request;
        if (request.firstGpu && part == std::string("cases")) {
            own.quick = true;
            if (own.only.empty()) own.only = judgedCases();
        }
        Json measured = measureApart(own, part);
        for (Json& e : measured["operations"]) report["operations"].push_back(std::move(e));
        measured.erase("operations");
        report.update(measured);
    }
    // Of methods; those of operations were measured in their own rounds.
    const Json& copies = report["copy_bytes_per_second"];
    for (Json& e : report["operations"])
        if (e.contains("passes") && copies.is_number()) {
            const double part =
                e["bytes"].get<double>() / e["median_ms"].get<double>() * 1e3 / copies.get<double>();
            e["bandwidth_share"] = part < 1.001 ? Json(std::min(part, 1.0)) : Json();
        }
    return report;
}

}  // namespace pellucid::bench
