// What the files of the program `benchmarks` share. Each bench_*.cpp registers the cases of one subject.
#pragma once
#include <benchmark/benchmark.h>

#include <functional>
#include <pellucid/pellucid.hpp>
#include <string>

namespace benchmarks {

using Run = std::function<void(benchmark::State&)>;

const pellucid::Device& device();

// A case that is timed by the wall clock, in milliseconds, with the processor time of all threads beside it.
void add(const std::string& name, const Run& run);

// Runs `work` once, which builds its programs, and then times it.
template <class Work>
void time(benchmark::State& state, Work&& work) {
    work();
    for (auto _ : state) work();
}

// Counts the share of the device's copy rate at which a pass moves `bytes` in each iteration.
void countCopies(benchmark::State& state, double bytes);

void addShading();
void addMeshes();
void addTables();

}  // namespace benchmarks
