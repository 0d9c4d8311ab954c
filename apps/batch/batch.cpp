// pellucid batch: makes the look-up tables of a manifest that do not exist yet. The name of a file is a hash
// of its parameters; a file contains a check sum and is written atomically.
#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>

#include "batch/batch_index.h"
#include "batch/batch_run.h"
#include "cli/command.h"
#include "io/atomic_file.h"
#include "io/file_error.h"
#include "system/process.h"

namespace pellucid::cli {
namespace {

struct Arguments {
    std::string manifest, folder;
    std::vector<std::string> devices;
    unsigned jobs = 0;
    bool json = false;
};

std::atomic<bool> interrupted{false};

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Standard error: a bar on a terminal, elsewhere a line every ten seconds; messages in between.
class Display {
  public:
    explicit Display(size_t all) : all_(all) {}

    void message(const std::string& text) {
        std::lock_guard lock(mutex_);
        std::fprintf(stderr, "%s%s\n", shown_ ? "\r\033[K" : "", text.c_str());
        shown_ = false;
    }

    void show(size_t done, bool last) {
        const double now = seconds();
        if (now - start_ < 0.25 || (!last && now - spoken_ < (terminal_ ? 0.1 : 10)) || all_ == 0) return;
        spoken_ = now;
        // The rate of the last ten seconds, because existing files are skipped quickly.
        past_.emplace_back(now, done);
        while (past_.size() > 2 && now - past_[1].first > 10) past_.pop_front();
        const double rate =
            last ? double(done) / (now - start_)
                 : double(done - past_.front().second) / std::max(now - past_.front().first, 1e-3);
        char left[64] = "";
        if (rate > 0 && !last) std::snprintf(left, sizeof left, ", %.0f s left", double(all_ - done) / rate);
        std::lock_guard lock(mutex_);
        if (terminal_) {
            const size_t filled = 30 * done / all_;
            std::string bar(30, '.');
            bar.replace(0, filled, std::string(filled, '#'));
            std::fprintf(stderr, "\r\033[K[%s] %zu/%zu, %.1f/s%s%s", bar.c_str(), done, all_, rate, left,
                         last ? "\n" : "");
            shown_ = !last;
        } else {
            std::fprintf(stderr, "%zu of %zu, %.1f per second%s\n", done, all_, rate, left);
        }
    }

  private:
    const size_t all_;
    const bool terminal_ = pel::system::errorsAreSeen();
    const double start_ = seconds();
    double spoken_ = start_;
    std::deque<std::pair<double, size_t>> past_{{start_, 0}};
    std::mutex mutex_;  // guards shown_ and the stream
    bool shown_ = false;
};

nlohmann::ordered_json reportOf(const io::BatchManifest& manifest, const io::BatchRun& run,
                                const std::vector<Device>& devices, double elapsed,
                                const std::vector<std::string>& failures) {
    nlohmann::ordered_json out, each = nlohmann::ordered_json::array();
    std::string names;
    double deviceMilliseconds = 0;
    const std::vector<size_t> made = run.madeByDevice();
    for (size_t i = 0; i < devices.size(); ++i) {
        names += (names.empty() ? "" : ", ") + std::string(devices[i].info().name);
        const double milliseconds = devices[i].stats().kernelMilliseconds;
        deviceMilliseconds += milliseconds;
        each.push_back({{"name", devices[i].info().name}, {"made", made[i]}, {"device_ms", milliseconds}});
    }
    const io::BatchCounts counts = run.counts();
    out["device"] = names;
    out["device_ms"] = deviceMilliseconds;
    out["total_ms"] = elapsed * 1e3;
    out["entries"] = manifest.entries.size();
    out["made"] = counts.made;
    out["kept"] = counts.kept;
    out["redone"] = counts.redone;
    out["duplicates"] = manifest.duplicates;
    out["failed"] = failures.size();
    out["per_second"] = double(counts.made) / std::max(elapsed, 1e-9);
    out["devices"] = each;
    out["warnings"] = failures;
    return out;
}

void runBatch(const Arguments& arguments) {
    const double start = seconds();
    const io::BatchManifest manifest = io::readManifest(arguments.manifest);
    std::error_code error;
    std::filesystem::create_directories(arguments.folder, error);
    if (error || !std::filesystem::is_directory(arguments.folder))
        throw io::FileError(arguments.folder, "is not a folder and cannot be made one");
    std::signal(SIGINT, [](int signal) {
        interrupted = true;  // the entries in flight are finished; a second Ctrl-C kills
        std::signal(signal, SIG_DFL);
    });

    Display display(manifest.entries.size());
    std::vector<std::string> failures;
    const auto failed = [&](const std::string& message) {
        failures.push_back(message);
        display.message(message);
    };
    for (const io::BatchError& e : manifest.errors) failed(e.message);
    io::BatchOptions options;
    options.folder = arguments.folder;
    options.jobs = arguments.jobs;
    for (const std::string& name : arguments.devices) options.devices.emplace_back(name);
    if (options.devices.empty()) options.devices.emplace_back("");
    options.failed = [&](const io::BatchEntry& entry, const std::string& message) {
        failed(arguments.manifest + ":" + std::to_string(entry.line) + ": " + message);
    };
    io::BatchRun run(manifest, options);
    while (run.running()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        if (interrupted) run.stop();
        display.show(run.counts().done, false);
    }
    std::exception_ptr fatal;
    try {
        run.finish();
    } catch (...) {
        fatal = std::current_exception();
    }
    display.show(run.counts().done, true);
    const std::string index = io::batchIndexName(arguments.manifest);
    const std::vector<bool> there = run.there();
    const bool anyTable = std::ranges::find(there, true) != there.end();
    try {
        // An index without a table would replace that of an earlier run for nothing.
        if (anyTable)
            io::writeWholeFile((std::filesystem::path(arguments.folder) / index).string(),
                               io::batchIndex(manifest, arguments.manifest, there));
    } catch (const io::FileError&) {
        if (!fatal) throw;
    }
    nlohmann::ordered_json report = reportOf(manifest, run, options.devices, seconds() - start, failures);
    report["index"] = anyTable ? nlohmann::ordered_json(index) : nlohmann::ordered_json();
    if (arguments.json)
        printJson(report);
    else
        std::printf("%zu tables: %zu made (%zu of them anew), %zu were there, %zu failed\n",
                    manifest.entries.size(), report["made"].get<size_t>(), report["redone"].get<size_t>(),
                    report["kept"].get<size_t>(), failures.size());
    std::fflush(stdout);
    if (fatal) std::rethrow_exception(fatal);
    if (interrupted && run.counts().done < manifest.entries.size())
        throw Error(PEL_ERROR_CANCELLED, "interrupted; the same command goes on from here");
    if (!failures.empty())
        throw io::FileError(arguments.manifest, std::to_string(failures.size()) +
                                                    " of its entries failed; they are listed above");
}

}  // namespace

void addBatch(Command& app) {
    Command* batch = app.addCommand("batch", "Make the look-up tables of a manifest that are not there yet");
    auto a = std::make_shared<Arguments>();
    batch->addOption("manifest", a->manifest, "TOML: [[lut]] and [[grid]] (docs/guide/batch.md)")->required();
    batch->addOption("-o,--output", a->folder, "folder for the files; made if need be")->required();
    batch->addOption("--device", a->devices, "device; several share the work")
        ->typeName(deviceWord)
        ->oneEach();
    batch->addOption("-j,--jobs", a->jobs, "tables in flight (default: four per core and device)")
        ->check(inRange(1, 256));
    batch->addFlag("--json", a->json, "one JSON object on stdout");
    batch->callback([a] { runBatch(*a); });
}

}  // namespace pellucid::cli
