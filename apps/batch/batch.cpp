// pellucid batch: makes the look-up tables of a manifest that do not exist yet. The name of a file is a hash
// of its parameters; a file contains a check sum and is written atomically.
#include <atomic>
#include <csignal>
#include <deque>
#include <mutex>
#include <thread>

#include "batch/batch_manifest.h"
#include "cli/command.h"
#include "io/atomic_file.h"
#include "io/input_file.h"
#include "io/lut/lut_exr.h"
#include "system/process.h"

namespace pellucid::cli {
namespace {

struct BatchArguments {
    std::string manifest, folder;
    std::vector<std::string> devices;
    unsigned jobs = 0;
    bool json = false;
};

std::atomic<bool> batchStopped{false};  // no more entries are begun

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Standard error: rate and time left, in place on a terminal, elsewhere a line every ten seconds; messages in
// between.
class Display {
  public:
    explicit Display(size_t all) : all_(all) {}

    void message(const std::string& text) {
        std::lock_guard lock(mutex_);
        std::fprintf(stderr, "%s%s\n", terminal_ ? "\r\033[K" : "", text.c_str());
    }

    void show(size_t done, bool last) {
        const double now = seconds();
        if (now - start_ < 0.25 || (!last && now - spoken_ < (terminal_ ? 0.1 : 10)) || all_ == 0) return;
        spoken_ = now;
        // The rate of the last ten seconds, because existing files are skipped quickly.
        past_.emplace_back(now, done);
        while (past_.size() > 2 && now - past_[1].first > 10) past_.pop_front();
        const auto [then, before] = last ? std::pair(start_, size_t{0}) : past_.front();
        const double rate = double(done - before) / std::max(now - then, 1e-3);
        char left[64] = "";
        if (rate > 0 && !last) std::snprintf(left, sizeof left, ", %.0f s left", double(all_ - done) / rate);
        std::lock_guard lock(mutex_);
        std::fprintf(stderr, "%s%zu of %zu, %.1f per second%s%s", terminal_ ? "\r\033[K" : "", done, all_,
                     rate, left, terminal_ && !last ? "" : "\n");
    }

  private:
    const size_t all_;
    const bool terminal_ = pel::system::errorsAreSeen();
    const double start_ = seconds();
    double spoken_ = start_;
    std::deque<std::pair<double, size_t>> past_{{start_, 0}};
    std::mutex mutex_;  // guards the stream
};

enum State : uint8_t { open, failed, kept, made, redone };  // of an entry; from `kept` on its file is there

// How many entries can be in flight. Each needs file handles for its folder, its file and its lock, and the
// driver needs some for its programs.
size_t jobsFor(const BatchArguments& a, size_t devices, size_t entries) {
    constexpr size_t perJob = 3, others = 32;
    const size_t handles = pel::system::filesLeft(),
                 wanted = a.jobs ? a.jobs : 4 * devices * std::max(1u, std::thread::hardware_concurrency());
    return std::max<size_t>(
        1, std::min({wanted, entries, size_t(256), handles > others ? (handles - others) / perJob : 0}));
}

// Each thread takes an entry from integration to the renamed file. So with more threads than cores one
// computes while another waits for its device or its disk.
class Batch {
  public:
    explicit Batch(const BatchArguments& a)
        : a_(a),
          manifest_(io::readManifest(a.manifest)),
          display_(manifest_.entries.size()),
          states_(manifest_.entries.size()) {
        std::error_code error;
        std::filesystem::create_directories(a.folder, error);
        if (error || !std::filesystem::is_directory(a.folder))
            throw io::FileError(a.folder, "is not a folder and cannot be created");
        for (const std::string& name : a.devices) devices_.emplace_back(name);
        if (devices_.empty()) devices_.emplace_back("");
        madeBy_ = std::vector<std::atomic<size_t>>(devices_.size());
        for (const io::BatchError& e : manifest_.errors) fault(e.message);
    }

    void run() {
        io::removeAbandonedFiles(a_.folder);
        {
            std::vector<std::jthread> workers;
            for (size_t i = 0, jobs = jobsFor(a_, devices_.size(), states_.size()); i < jobs; ++i) {
                ++active_;
                try {
                    workers.emplace_back([this, device = i % devices_.size()] { work(device); });
                } catch (const std::system_error&) {  // fewer threads are enough
                    --active_;
                    if (i == 0) throw;
                    break;
                }
            }
            for (; active_ > 0; std::this_thread::sleep_for(std::chrono::milliseconds(20)))
                display_.show(count(failed), false);
        }
        display_.show(count(failed), true);
        if (!fatal_ && count(made) > 0) io::flushFolder(a_.folder);
    }

    // The report and the index, and the error that ends the command.
    void finish() {
        std::vector<bool> there;
        for (const auto& state : states_) there.push_back(state >= kept);
        const std::string index = io::batchIndexName(a_.manifest);
        const bool anyTable = count(kept) > 0;
        try {
            // An index without a table would replace that of an earlier run for nothing.
            if (anyTable)
                io::writeWholeFile((std::filesystem::path(a_.folder) / index).string(),
                                   io::batchIndex(manifest_, a_.manifest, there));
        } catch (const io::FileError&) {
            if (!fatal_) throw;
        }
        const size_t entries = states_.size();
        if (a_.json)
            printJson(report(anyTable ? nlohmann::ordered_json(index) : nlohmann::ordered_json()));
        else
            std::printf("%zu %s: %zu made (%zu of them anew), %zu were there, %zu failed\n", entries,
                        tables() > entries
                            ? io::concat(entries == 1 ? "file" : "files", " of ", tables(), " tables").c_str()
                            : "tables",
                        count(made), count(redone), count(kept) - count(made), faults_.size());
        std::fflush(stdout);
        if (fatal_) std::rethrow_exception(fatal_);
        if (count(failed) < entries)
            throw Error(PEL_ERROR_CANCELLED, "interrupted; the same command goes on from here");
        if (!faults_.empty())
            throw io::FileError(a_.manifest,
                                io::concat(faults_.size(), " of its entries failed; they are listed above"));
    }

  private:
    // Entries of this state and of those behind it.
    size_t count(State from) const {
        return size_t(std::ranges::count_if(states_, [from](const auto& state) { return state >= from; }));
    }

    size_t tables() const {
        size_t all = 0;
        for (const io::BatchEntry& entry : manifest_.entries) all += entry.tables.size();
        return all;
    }

    void fault(const std::string& message) {
        faults_.push_back(message);
        display_.message(message);
    }

    void work(size_t device) {
        for (size_t i; !batchStopped && (i = next_++) < states_.size();) {
            const io::BatchEntry& entry = manifest_.entries[i];
            try {
                states_[i] = handle(entry, device);
            } catch (const Error& e) {  // of this entry; others may be fine
                std::lock_guard lock(mutex_);
                fault(io::concat(a_.manifest, ":", entry.line, ": ", e.what()));
                states_[i] = failed;
            } catch (...) {  // the folder is full or gone: no entry can succeed
                std::lock_guard lock(mutex_);
                if (!fatal_) fatal_ = std::current_exception();
                batchStopped = true;
            }
        }
        --active_;
    }

    State handle(const io::BatchEntry& entry, size_t device) {
        const std::string path = (std::filesystem::path(a_.folder) / entry.file).string();
        std::error_code error;
        const auto status = std::filesystem::status(path, error);
        const bool exists = std::filesystem::is_regular_file(status);
        if (!exists && status.type() != std::filesystem::file_type::not_found)
            throw Error(PEL_ERROR_INVALID_ARGUMENT, path + " is in the way: it is not a file");
        if (exists && io::verifyLutExr(io::readWholeFile(path), entry.key)) {
            for (const io::BatchTable& table : entry.tables)  // the index will describe them
                if (table.profile.valid()) table.profile.wait();
            return kept;
        }
        const std::string bytes = make(entry, device);
        io::AtomicFile file(path);
        file.write(bytes.data(), bytes.size());
        // run() flushes the folder once. A name that is lost in a power cut is an entry to make again.
        file.commit(false);
        ++madeBy_[device];
        return exists ? redone : made;
    }

    // If its device fails, an entry is tried on the others.
    std::string make(const io::BatchEntry& entry, size_t& device) const {
        for (size_t tried = 0;; device = (device + 1) % devices_.size()) {
            try {
                return io::makeEntryFile(devices_[device], entry);
            } catch (const Error& e) {
                const bool failing = e.code() == PEL_ERROR_DEVICE || e.code() == PEL_ERROR_OUT_OF_MEMORY;
                if (!failing || ++tried >= devices_.size()) throw;
            }
        }
    }

    nlohmann::ordered_json report(const nlohmann::ordered_json& index) const {
        nlohmann::ordered_json each = nlohmann::ordered_json::array();
        std::string names;
        double deviceMilliseconds = 0;
        for (size_t i = 0; i < devices_.size(); ++i) {
            const double milliseconds = devices_[i].stats().kernelMilliseconds;
            names += (names.empty() ? "" : ", ") + std::string(devices_[i].info().name);
            deviceMilliseconds += milliseconds;
            each.push_back({{"name", devices_[i].info().name},
                            {"made", madeBy_[i].load()},
                            {"device_ms", milliseconds}});
        }
        const double elapsed = seconds() - start_;
        return {{"device", names},
                {"device_ms", deviceMilliseconds},
                {"total_ms", elapsed * 1e3},
                {"entries", states_.size()},
                {"tables", tables()},
                {"made", count(made)},
                {"kept", count(kept) - count(made)},
                {"redone", count(redone)},
                {"duplicates", manifest_.duplicates},
                {"failed", faults_.size()},
                {"per_second", double(count(made)) / std::max(elapsed, 1e-9)},
                {"devices", each},
                {"warnings", faults_},
                {"index", index}};
    }

    const BatchArguments a_;
    const double start_ = seconds();
    const io::BatchManifest manifest_;
    Display display_;
    std::vector<Device> devices_;
    std::vector<std::atomic<size_t>> madeBy_;  // by device
    std::vector<std::atomic<State>> states_;   // by entry
    std::atomic<size_t> next_{0}, active_{0};
    std::mutex mutex_;  // guards the two that follow
    std::vector<std::string> faults_;
    std::exception_ptr fatal_;
};

void runBatch(const BatchArguments& a) {
    Batch batch(a);
    std::signal(SIGINT, [](int signal) {
        batchStopped = true;  // the entries in flight are finished; a second Ctrl-C kills
        std::signal(signal, SIG_DFL);
    });
    batch.run();
    batch.finish();
}

}  // namespace

void addBatch(CLI::App& app) {
    auto [batch, a] = subcommand<BatchArguments>(
        app, "batch", "Make the look-up tables of a manifest that are not there yet", runBatch);
    option(batch, "manifest", a.manifest, "TOML: [[lut]] and [[grid]] (docs/guide/batch.md)", required);
    option(batch, "-o,--output", a.folder, "folder for the files; created if missing", required);
    option(batch, "--device", a.devices, "device; several share the work", Word{deviceWord}, oneEach);
    option(batch, "-j,--jobs", a.jobs, "tables in flight (default: four per core and device)",
           inRange(1, 256));
    option(batch, "--json", a.json, "one JSON object on stdout");
}

}  // namespace pellucid::cli
