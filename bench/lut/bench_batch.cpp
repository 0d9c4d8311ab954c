// How fast a batch of tables is made, against how fast this machine can write the same files when they need
// no computing. Both write under a temporary name, flush and rename, with as many threads; the file system is
// that of TMPDIR.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "io/atomic_file.h"
#include "io/lut/batch_entry.h"
#include "io/lut/batch_run.h"

using namespace pellucid;
namespace fs = std::filesystem;

namespace {

constexpr unsigned jobs = 8;

// A folder that is there and empty at each construction.
struct Folder {
    fs::path path = fs::temp_directory_path() / ("pellucid-bench-batch-" + std::to_string(::getpid()));
    Folder() {
        fs::remove_all(path);
        fs::create_directories(path);
    }
    ~Folder() { fs::remove_all(path); }
};

// `count` tables of 64x64 halves: two profiles, forms and axes, and as many radii as that takes.
const io::BatchManifest& manifest(int64_t count) {
    static std::map<int64_t, io::BatchManifest> known;
    auto [at, fresh] = known.try_emplace(count);
    if (fresh) {
        std::ostringstream text;
        text << "[[grid]]\nprofile = [\"skin\", \"marble\"]\nform = [\"arc\", \"sphere\"]\n"
                "axis = [\"linear\", \"root\"]\nsize = 64\nencoding = \"half\"\ndiffusion_radius = [";
        for (int64_t i = 0; i < count / 8; ++i) text << (i ? "," : "") << 0.5 + 0.002 * double(i);
        text << "]\n";
        at->second = io::parseManifest("manifest", text.str(), {});
    }
    return at->second;
}

const Device& device() {
    static const Device d("");
    return d;
}

// The programs of the device are built before anything is timed.
const std::string& sampleFile(const io::BatchManifest& m) {
    static const std::string bytes = [&] {
        for (size_t i = 0; i < std::min<size_t>(m.entries.size(), 4000); i += 37)
            io::makeEntryFile(device(), m.entries[i]);
        return io::makeEntryFile(device(), m.entries[0]);
    }();
    return bytes;
}

void report(benchmark::State& state, size_t count, size_t bytes) {
    state.SetItemsProcessed(state.iterations() * int64_t(count));
    state.SetBytesProcessed(state.iterations() * int64_t(count * bytes));
}

// The baseline: the same number of files of the same size, their bytes known beforehand.
void writeAlone(benchmark::State& state, bool flushed) {
    const io::BatchManifest& m = manifest(state.range(0));
    const std::string& bytes = sampleFile(m);
    for (auto _ : state) {
        state.PauseTiming();
        const Folder folder;
        state.ResumeTiming();
        std::atomic<size_t> next{0};
        std::vector<std::thread> threads;
        for (unsigned t = 0; t < jobs; ++t)
            threads.emplace_back([&] {
                for (size_t i; (i = next++) < m.entries.size();) {
                    const fs::path path = folder.path / m.entries[i].file;
                    if (flushed) {
                        io::writeWholeFile(path.string(), bytes);
                    } else {
                        std::ofstream(path, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
                    }
                }
            });
        for (std::thread& t : threads) t.join();
        state.PauseTiming();
        fs::remove_all(folder.path);
        state.ResumeTiming();
    }
    report(state, m.entries.size(), bytes.size());
}
BENCHMARK_CAPTURE(writeAlone, flushed, true)
    ->Arg(1000)
    ->Arg(10000)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);
BENCHMARK_CAPTURE(writeAlone, unflushed, false)->Arg(1000)->UseRealTime()->Unit(benchmark::kMillisecond)->Iterations(1);

// The whole batch: integration, read-back, encoding, writing.
void makeBatch(benchmark::State& state) {
    const io::BatchManifest& m = manifest(state.range(0));
    const size_t bytes = sampleFile(m).size();
    const size_t copies = size_t(state.range(1));
    const std::vector<Device> devices = [&] {
        std::vector<Device> all{device()};
        while (all.size() < copies) all.emplace_back("");
        return all;
    }();
    for (auto _ : state) {
        state.PauseTiming();
        const Folder folder;
        state.ResumeTiming();
        io::BatchRun run(m, {folder.path.string(), devices, jobs, {}});
        run.finish();
        state.PauseTiming();
        if (run.counts().made != m.entries.size()) state.SkipWithError("not all were made");
        fs::remove_all(folder.path);
        state.ResumeTiming();
    }
    report(state, m.entries.size(), bytes);
}
BENCHMARK(makeBatch)
    ->ArgNames({"", "queues"})
    ->Args({1000, 1})
    ->Args({10000, 1})
    ->Args({1000, 2})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

// Without the disk: what the processor and the device can do.
void makeInMemory(benchmark::State& state) {
    const io::BatchManifest& m = manifest(state.range(0));
    const size_t bytes = sampleFile(m).size();
    for (auto _ : state) {
        std::atomic<size_t> next{0};
        std::vector<std::thread> threads;
        for (unsigned t = 0; t < jobs; ++t)
            threads.emplace_back([&] {
                for (size_t i; (i = next++) < m.entries.size();)
                    benchmark::DoNotOptimize(io::makeEntryFile(device(), m.entries[i]));
            });
        for (std::thread& t : threads) t.join();
    }
    report(state, m.entries.size(), bytes);
}
BENCHMARK(makeInMemory)->Arg(1000)->UseRealTime()->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
