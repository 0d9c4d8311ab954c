#include "core/build_jobs.h"

#include <algorithm>
#include <exception>
#include <thread>

#include "cl/kernel_files.h"

namespace pel {
namespace {

constexpr unsigned mostHelpers = 4;  // each takes about 200 MB

// The exception that `call` throws.
template <class Call>
std::exception_ptr thrownBy(const Call& call) {
    try {
        call();
    } catch (...) {
        return std::current_exception();
    }
    return {};
}

}  // namespace

unsigned buildersFor(const Device& device, uint32_t threads) {
    const std::string_view platform = device.info().platform;
    if (platform == "Oclgrind") return 1;  // it stops where kernels overlap
    if (threads) return threads;
    const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
    return platform == "Portable Computing Language" ? std::min(cores, mostHelpers) : cores;
}

void addProgramJobs(const Ref<Device>& device, std::vector<cl::ProgramKey> keys, BuildJobs& jobs) {
    std::ranges::stable_sort(keys, std::ranges::greater(),
                             [](const cl::ProgramKey& key) { return cl::kernelSource(key.files).size(); });
    for (auto key = keys.begin(); key != keys.end(); ++key)
        if (std::find(keys.begin(), key, *key) == key)
            jobs.push_back([device, key = *key] { device->programs().get(key); });
}

void runJobs(Device& device, const BuildJobs& jobs, unsigned threads, cl::BuildHelpers& helpers,
             const std::function<void(size_t)>& report) {
    std::mutex mutex;  // of these
    std::condition_variable changed;
    size_t next = 0, done = 0;
    std::exception_ptr failure;
    const auto work = [&] {
        const cl::HelpScope scope(helpers);
        std::unique_lock lock(mutex);
        while (!failure && next < jobs.size()) {
            const auto& job = jobs[next++];
            lock.unlock();
            const std::exception_ptr thrown = thrownBy(job);
            lock.lock();
            ++done;
            if (!failure) failure = thrown;
            changed.notify_one();
        }
    };
    failure = thrownBy([&] { report(0); });
    std::vector<std::jthread> workers;
    while (workers.size() < std::min<size_t>(threads, jobs.size())) {
        const std::exception_ptr none = thrownBy([&] { workers.emplace_back(work); });
        if (none && workers.empty()) failure = none;
        if (none) break;  // fewer threads are enough
    }
    // The callback is called on this thread only, and never while the lock is held.
    std::unique_lock lock(mutex);
    for (size_t reported = 0; reported < jobs.size();) {
        changed.wait(lock, [&] { return failure || done > reported; });
        if (failure) break;
        reported = done;
        lock.unlock();
        const std::exception_ptr cancelled = thrownBy([&] { report(reported); });
        lock.lock();
        if (!failure) failure = cancelled;
    }
    lock.unlock();
    if (failure) helpers.cancel();
    workers.clear();
    device.finish();
    if (failure) std::rethrow_exception(failure);
}

}  // namespace pel
