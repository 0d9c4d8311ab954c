// pellucid batch: makes the look-up tables of a manifest that are not there yet. A file is named by what was
// asked for, holds a check sum of its texels, and appears complete or not at all.
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <mutex>
#include <thread>

#include "command.h"
#include "io/batch_manifest.h"
#include "io/file_error.h"
#include "io/lut_file.h"

namespace pellucid::cli {
namespace {

struct Arguments {
    std::string manifest, folder;
    std::vector<std::string> devices;
    unsigned jobs = 0;
    bool json = false;
};

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Shared by the workers, each of which takes one entry at a time from integration to the renamed file: with
// more workers than cores, one computes while another waits for its disk.
class Batch {
  public:
    Batch(const Arguments& arguments, io::BatchManifest manifest)
        : arguments_(arguments), manifest_(std::move(manifest)), start_(seconds()) {
        for (const std::string& name : arguments.devices) devices_.emplace_back(name);
        if (devices_.empty()) devices_.emplace_back("");
    }

    void run() {
        unsigned jobs =
            arguments_.jobs ? arguments_.jobs : 2 * std::max(1u, std::thread::hardware_concurrency());
        jobs = unsigned(std::min<size_t>(jobs, std::max<size_t>(1, manifest_.entries.size())));
        std::vector<std::thread> workers;
        for (unsigned i = 0; i < jobs; ++i)
            workers.emplace_back([this, i] { work(devices_[i % devices_.size()]); });
        while (done_ < manifest_.entries.size() && !stopped_) {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            showProgress(false);
        }
        for (std::thread& worker : workers) worker.join();
        showProgress(true);
        if (fatal_) std::rethrow_exception(fatal_);
    }

    nlohmann::ordered_json report() {
        nlohmann::ordered_json out;
        std::string names;
        double deviceMilliseconds = 0;
        for (const Device& device : devices_) {
            names += (names.empty() ? "" : ", ") + std::string(device.info().name);
            deviceMilliseconds += device.stats().kernelMilliseconds;
        }
        const double elapsed = seconds() - start_;
        out["device"] = names;
        out["device_ms"] = deviceMilliseconds;
        out["total_ms"] = elapsed * 1e3;
        out["entries"] = manifest_.entries.size();
        out["made"] = made_.load();
        out["kept"] = kept_.load();
        out["redone"] = redone_.load();
        out["duplicates"] = manifest_.duplicates;
        out["failed"] = failures_.size();
        out["per_second"] = double(made_) / std::max(elapsed, 1e-9);
        out["warnings"] = failures_;
        return out;
    }
    bool failed() const { return !failures_.empty(); }

    void fail(const std::string& message) {
        std::lock_guard lock(mutex_);
        std::fprintf(stderr, "%s%s\n", shown_ ? "\r\033[K" : "", message.c_str());
        failures_.push_back(message);
    }
    void failManifest() {
        for (const io::BatchError& error : manifest_.errors) fail(error.message);
    }

  private:
    void work(const Device& device) {
        for (size_t i; !stopped_ && (i = next_++) < manifest_.entries.size();) {
            const io::BatchEntry& entry = manifest_.entries[i];
            try {
                make(device, entry);
            } catch (const Error& e) {
                // Something about this entry; all others may be fine.
                fail(arguments_.manifest + ":" + std::to_string(entry.line) + ": " + e.what());
            } catch (...) {  // the folder is full or gone: no entry will fare better
                std::lock_guard lock(mutex_);
                if (!fatal_) fatal_ = std::current_exception();
                stopped_ = true;
            }
            ++done_;
        }
    }

    void make(const Device& device, const io::BatchEntry& entry) {
        const std::string path = (std::filesystem::path(arguments_.folder) / entry.file).string();
        const bool exists = std::filesystem::exists(path);
        if (exists && io::verifyLut(path, entry.key)) {
            ++kept_;
            return;
        }
        io::writeCheckedLut(path, integrated(device, entry), entry.encoding, entry.key);
        ++made_;
        if (exists) ++redone_;
    }

    static Lut integrated(const Device& device, const io::BatchEntry& entry) {
        if (entry.info.kind == PEL_LUT_CURVATURE) return Lut(device, entry.info.curvature);
        if (entry.info.kind == PEL_LUT_SHADOW) return Lut(device, entry.info.shadow);
        return Lut(device, entry.info.specular);
    }

    // A bar on a terminal; elsewhere a line every ten seconds.
    void showProgress(bool last) {
        const size_t done = done_, all = manifest_.entries.size();
        const double now = seconds(), elapsed = now - start_;
        const bool terminal = isatty(2);
        if (elapsed < 1 || (!last && now - spoken_ < (terminal ? 0.1 : 10)) || all == 0) return;
        spoken_ = now;
        const double rate = double(done) / elapsed;
        std::lock_guard lock(mutex_);
        if (terminal) {
            std::string bar(30, '.');
            bar.replace(0, 30 * done / all, std::string(30 * done / all, '#'));
            std::fprintf(stderr, "\r\033[K[%s] %zu/%zu  %.1f/s  %.0f s left%s", bar.c_str(), done, all, rate,
                         double(all - done) / std::max(rate, 1e-9), last ? "\n" : "");
            shown_ = !last;
        } else {
            std::fprintf(stderr, "%zu of %zu, %.1f per second, %.0f s left\n", done, all, rate,
                         double(all - done) / std::max(rate, 1e-9));
        }
    }

    const Arguments& arguments_;
    const io::BatchManifest manifest_;
    std::vector<Device> devices_;
    const double start_;
    double spoken_ = 0;
    std::atomic<size_t> next_{0}, done_{0}, made_{0}, kept_{0}, redone_{0};
    std::atomic<bool> stopped_{false};
    std::mutex mutex_;  // guards the rest
    std::exception_ptr fatal_;
    std::vector<std::string> failures_;
    bool shown_ = false;
};

void runBatch(const Arguments& arguments) {
    io::BatchManifest manifest = io::readManifest(arguments.manifest);
    std::error_code error;
    std::filesystem::create_directories(arguments.folder, error);
    if (error || !std::filesystem::is_directory(arguments.folder))
        throw io::FileError(arguments.folder, "is no folder and cannot be made one");
    Batch batch(arguments, std::move(manifest));
    batch.failManifest();
    batch.run();
    const nlohmann::ordered_json report = batch.report();
    if (arguments.json)
        std::printf("%s\n", report.dump(2).c_str());
    else
        std::printf("%zu tables: %zu made (%zu of them anew), %zu were there, %zu failed\n",
                    report["entries"].get<size_t>(), report["made"].get<size_t>(),
                    report["redone"].get<size_t>(), report["kept"].get<size_t>(),
                    report["failed"].get<size_t>());
    if (batch.failed())
        throw io::FileError(arguments.manifest, std::to_string(report["failed"].get<size_t>()) +
                                                    " of its entries failed; they are listed above");
}

}  // namespace

void addBatch(CLI::App& app) {
    CLI::App* batch =
        app.add_subcommand("batch", "Make the look-up tables of a manifest that are not there yet");
    auto a = std::make_shared<Arguments>();
    batch->add_option("manifest", a->manifest, "TOML: [[lut]] and [[grid]] (docs/batch.md)")->required();
    batch->add_option("-o,--output", a->folder, "folder for the files; made if need be")->required();
    batch->add_option("--device", a->devices, "device; several share the work");
    batch->add_option("-j,--jobs", a->jobs, "tables in flight (default: two per core)")
        ->check(CLI::Range(1, 256));
    batch->add_flag("--json", a->json, "one JSON object on stdout");
    batch->callback([a] { runBatch(*a); });
}

}  // namespace pellucid::cli
