// Makes the tables of a manifest that are not in a folder yet, several at a time on one or more devices.
#pragma once
#include <atomic>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "batch/batch_manifest.h"

namespace pellucid::io {

struct BatchOptions {
    std::string folder;           // exists
    std::vector<Device> devices;  // at least one; the same one may be listed several times
    unsigned jobs = 0;            // entries in flight; 0: four per core and device
    // Called by the workers, one at a time, with the fault of an entry. The others continue.
    std::function<void(const BatchEntry&, const std::string&)> failed;
};

struct BatchCounts {
    size_t done = 0;  // the sum of all that follow
    size_t made = 0, kept = 0, failed = 0;
    size_t redone = 0;  // of `made`: in place of a file that was damaged
};

// Each worker takes an entry from integration to the renamed file. So with more workers than cores one
// computes while another waits for its device or its disk. If its device fails, an entry is tried on the
// others.
class BatchRun {
  public:
    // Starts. The manifest must outlive this.
    BatchRun(const BatchManifest& manifest, BatchOptions options);
    ~BatchRun();  // stops, and waits for the entries in flight

    void stop() { stopped_ = true; }  // takes no more entries
    bool running() const { return active_ > 0; }
    // Waits for the workers. Throws the error that stopped them: FileError if the folder is full or gone.
    void finish();

    BatchCounts counts() const;
    std::vector<size_t> madeByDevice() const;
    // For each entry of the manifest: whether its file exists, is undamaged and matches the entry.
    std::vector<bool> there() const;

  private:
    void work(size_t device);
    void handle(const BatchEntry& entry, size_t device);
    std::string make(const BatchEntry& entry, size_t& device) const;

    const BatchManifest& manifest_;
    const BatchOptions options_;
    std::atomic<size_t> next_{0}, made_{0}, kept_{0}, failed_{0}, redone_{0}, active_{0};
    std::vector<std::atomic<size_t>> madeBy_;
    std::vector<std::atomic<bool>> there_;
    std::atomic<bool> stopped_{false};
    std::mutex mutex_;
    std::exception_ptr fatal_;           // guarded, as are the calls of options_.failed
    std::vector<std::jthread> workers_;  // the last member: the threads use all others
};

}  // namespace pellucid::io
