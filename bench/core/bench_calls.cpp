// What a call costs beside its work: looking up a handle, counting it, making and releasing one; alone and
// from several threads.
#include <benchmark/benchmark.h>

#include <pellucid/pellucid.hpp>

namespace {

const pellucid::Buffer& buffer() {
    static const pellucid::Device device("");
    static const pellucid::Buffer buffer(device, 16);
    return buffer;
}

void LookUp(benchmark::State& state) {
    const PelBuffer handle = buffer().get();
    size_t bytes = 0;
    for (auto _ : state) benchmark::DoNotOptimize(pelBufferGetSize(handle, &bytes));
}
void RetainAndRelease(benchmark::State& state) {
    const PelBuffer handle = buffer().get();
    for (auto _ : state) {
        pelBufferRetain(handle);
        pelBufferRelease(handle);
    }
}
void MakeAndRelease(benchmark::State& state) {
    for (auto _ : state) {
        PelProfile profile = nullptr;
        pelProfileCreateSkin(&profile);
        pelProfileRelease(profile);
    }
}
void Refuse(benchmark::State& state) {
    size_t bytes = 0;
    const auto forged = reinterpret_cast<PelBuffer>(reinterpret_cast<uintptr_t>(buffer().get()) + 2);
    for (auto _ : state) benchmark::DoNotOptimize(pelBufferGetSize(forged, &bytes));
}

BENCHMARK(LookUp)->ThreadRange(1, 4)->UseRealTime();
BENCHMARK(RetainAndRelease)->ThreadRange(1, 4)->UseRealTime();
BENCHMARK(MakeAndRelease)->ThreadRange(1, 4)->UseRealTime();
BENCHMARK(Refuse);

}  // namespace

BENCHMARK_MAIN();
