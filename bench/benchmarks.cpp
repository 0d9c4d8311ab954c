// Times of the library against other implementations, by size, by feature and by thread.
// bench/performance_page runs this program and keeps the results; `pellucid bench` measures a device with
// less.
//     benchmarks [--benchmark_filter=REGEX] [--benchmark_...]
#include "benchmarks.h"

#include <algorithm>
#include <chrono>

using namespace pellucid;

namespace benchmarks {
namespace {

double copyRate() {
    constexpr size_t bytes = size_t{128} << 20;
    const Buffer from(device(), bytes);
    std::vector<char> to(bytes);
    double best = 1e9;
    for (int i = 0; i < 5; ++i) {
        const auto start = std::chrono::steady_clock::now();
        from.read(to.data(), bytes);
        best =
            std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return 2 * double(bytes) / best;  // read and written
}

const Buffer& someBuffer() {
    static const Buffer buffer(device(), 16);
    return buffer;
}

// The cost of a call beside its work, on an object that several threads use.
void lookUp(benchmark::State& state) {
    const PelBuffer handle = someBuffer().get();
    size_t bytes = 0;
    for (auto _ : state) benchmark::DoNotOptimize(pelBufferGetSize(handle, &bytes));
}
void retainAndRelease(benchmark::State& state) {
    const PelBuffer handle = someBuffer().get();
    for (auto _ : state) pelBufferRetain(handle), pelBufferRelease(handle);
}
void makeAndRelease(benchmark::State& state) {
    for (auto _ : state) {
        PelProfile profile = nullptr;
        pelProfileCreateSkin(&profile);
        pelProfileRelease(profile);
    }
}
void refuse(benchmark::State& state) {
    size_t bytes = 0;
    const auto forged = reinterpret_cast<PelBuffer>(reinterpret_cast<uintptr_t>(someBuffer().get()) + 2);
    for (auto _ : state) benchmark::DoNotOptimize(pelBufferGetSize(forged, &bytes));
}
BENCHMARK(lookUp)->Name("LookUp")->ThreadRange(1, 4)->UseRealTime();
BENCHMARK(retainAndRelease)->Name("RetainAndRelease")->ThreadRange(1, 4)->UseRealTime();
BENCHMARK(makeAndRelease)->Name("MakeAndRelease")->ThreadRange(1, 4)->UseRealTime();
BENCHMARK(refuse)->Name("Refuse");

}  // namespace

const Device& device() {
    static const Device device("");
    return device;
}

void add(const std::string& name, const Run& run) {
    benchmark::RegisterBenchmark(name.c_str(), run)
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime()
        ->UseRealTime();
}

void countCopies(benchmark::State& state, double bytes) {
    static const double rate = copyRate();
    state.counters["copies"] =
        benchmark::Counter(bytes / rate, benchmark::Counter::kIsIterationInvariantRate);
}

}  // namespace benchmarks

int main(int argc, char** argv) {
    benchmarks::addShading();
    benchmarks::addMeshes();
    benchmarks::addTables();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
