#include "batch/batch_run.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <system_error>

#include "batch/batch_entry.h"
#include "io/atomic_file.h"
#include "io/input_file.h"
#include "io/lut/lut_exr.h"
#include "system/process.h"

namespace pellucid::io {
namespace {

// How many entries can be in flight with the file handles that are left. Each needs handles for its folder,
// its file and its lock, and the driver needs some for its programs.
size_t jobsForHandles() {
    constexpr size_t perJob = 3, others = 32;
    const size_t left = pel::system::filesLeft();
    return left > others ? (left - others) / perJob : 0;
}

}  // namespace

BatchRun::BatchRun(const BatchManifest& manifest, BatchOptions options)
    : manifest_(manifest),
      options_(std::move(options)),
      madeBy_(options_.devices.size()),
      there_(manifest.entries.size()) {
    removeAbandonedFiles(options_.folder);
    const size_t cores = std::max(1u, std::thread::hardware_concurrency());
    size_t jobs = options_.jobs ? options_.jobs : 4 * cores * options_.devices.size();
    jobs = std::min({jobs, std::max<size_t>(1, manifest_.entries.size()), size_t(256)});
    jobs = std::max<size_t>(1, std::min(jobs, jobsForHandles()));
    for (size_t i = 0; i < jobs; ++i) {
        ++active_;
        try {
            workers_.emplace_back([this, device = i % options_.devices.size()] { work(device); });
        } catch (const std::system_error&) {  // fewer threads are enough
            --active_;
            if (i == 0) throw;
            break;
        }
    }
}

BatchRun::~BatchRun() {
    stop();
}

void BatchRun::finish() {
    workers_.clear();  // waits for them
    if (fatal_) std::rethrow_exception(fatal_);
    if (made_ > 0) flushFolder(options_.folder);
}

BatchCounts BatchRun::counts() const {
    const size_t made = made_, kept = kept_, failed = failed_;
    return {made + kept + failed, made, kept, failed, redone_};
}

std::vector<size_t> BatchRun::madeByDevice() const {
    return {madeBy_.begin(), madeBy_.end()};
}

std::vector<bool> BatchRun::there() const {
    return {there_.begin(), there_.end()};
}

void BatchRun::work(size_t device) {
    for (size_t i; !stopped_ && (i = next_++) < manifest_.entries.size();) {
        const BatchEntry& entry = manifest_.entries[i];
        try {
            handle(entry, device);
            there_[i] = true;
        } catch (const Error& e) {  // an error of this entry; others may be fine
            std::lock_guard lock(mutex_);
            if (options_.failed) options_.failed(entry, e.what());
            ++failed_;
        } catch (...) {  // the folder is full or gone: no entry can succeed
            std::lock_guard lock(mutex_);
            if (!fatal_) fatal_ = std::current_exception();
            stopped_ = true;
        }
    }
    --active_;
}

void BatchRun::handle(const BatchEntry& entry, size_t device) {
    const std::string path = (std::filesystem::path(options_.folder) / entry.file).string();
    const bool exists = std::filesystem::exists(path);
    if (exists && verifyLutExr(readWholeFile(path), entry.key)) {
        ++kept_;
        return;
    }
    const std::string bytes = make(entry, device);
    AtomicFile file(path);
    file.write(bytes.data(), bytes.size());
    // finish() flushes the folder once. A name that is lost in a power cut is an entry to make again.
    file.commit(false);
    if (exists) ++redone_;
    ++made_;
    ++madeBy_[device];
}

std::string BatchRun::make(const BatchEntry& entry, size_t& device) const {
    for (size_t tried = 0;; device = (device + 1) % options_.devices.size()) {
        try {
            return makeEntryFile(options_.devices[device], entry);
        } catch (const Error& e) {
            const bool failing = e.code() == PEL_ERROR_DEVICE || e.code() == PEL_ERROR_OUT_OF_MEMORY;
            if (!failing || ++tried >= options_.devices.size()) throw;
        }
    }
}

}  // namespace pellucid::io
