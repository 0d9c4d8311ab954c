// Error against time of a 512x512 table of form arc, skin, all on the same device: this library's kernels
// with several node counts, and plain sampling with 16 to 4096 samples, texel by texel or with the profile's
// samples made once a row. Times are device times; `max` is the largest error of 4000 texels against the
// oracle. `bench/plot lut` draws the figure of docs/guide/luts.md from the JSON. Beside it, what the device can do:
// exponentials and bytes per second.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <random>

#include "lut_kernels.h"
#include "reference/lut.h"
#include "shared/choices.h"

namespace {

constexpr int side = bench::ArcTable::side;
#define FORM(name, number, key) "-DPEL_FORM_" #name "=" #number " "
const std::string kernels = PELLUCID_SOURCE_DIR "/kernels/", own = PELLUCID_SOURCE_DIR "/bench/lut/";

bench::Runner& runner() {
    static bench::Runner runner;
    return runner;
}

struct Texel {
    int x, y;
    reference::Rgb truth;
};

// Half of them near the terminator.
const std::vector<Texel>& texels() {
    static const std::vector<Texel> all = [] {
        std::vector<Texel> result;
        std::mt19937 random(3);
        const auto skin = reference::skinProfile();
        for (int i = 0; i < 4000; ++i) {
            const int x = i % 2 ? int(random() % side) : side / 2 - 40 + int(random() % 80),
                      y = int(random() % side);
            result.push_back({x, y,
                              reference::curvatureD(reference::Form::arc, *skin, bench::ArcTable::u(x),
                                                    bench::ArcTable::radius(y))});
        }
        return result;
    }();
    return all;
}

// `stride` floats to a texel, `row` texels to a row.
double largestError(cl_mem memory, size_t stride, size_t row) {
    std::vector<float> values(stride * row * (side + 1));
    size_t bytes = 0;
    clGetMemObjectInfo(memory, CL_MEM_SIZE, sizeof bytes, &bytes, nullptr);
    bench::check(clEnqueueReadBuffer(runner().queue(), memory, CL_TRUE, 0, std::min(bytes, values.size() * 4),
                                     values.data(), 0, nullptr, nullptr),
                 "clEnqueueReadBuffer");
    double worst = 0;
    for (const Texel& t : texels())
        for (int c = 0; c < 3; ++c)
            worst = std::max(
                worst, std::abs(values[(size_t(t.y) * row + size_t(t.x)) * stride + size_t(c)] - t.truth[c]));
    return worst;
}

// Exponentials that curvature_rows evaluates: for each block of rows, in each interval, the Gaussians in
// reach.
double exponentialsOfRows(const bench::ArcTable& table, int nodes, int points) {
    constexpr int lanes = bench::Runner::width;
    constexpr double reach = 5.8;
    double count = 0;
    for (int block = 0; block < side; block += lanes)
        for (int j = nodes - 1; j >= 0; --j)
            for (const LutGaussian& g : table.gaussians) {
                const double steepest = table.params.rowMin + (block + lanes - 0.5) * table.params.rowStep;
                const double arc = reach * g.sigma * steepest;
                count += lanes * points *
                         ((arc > bench::nodeAngle(j, nodes)) +
                          (arc > std::numbers::pi - bench::nodeAngle(j + 1, nodes) &&
                           table.params.cut * steepest > std::numbers::pi / 2));
            }
    return count;
}

void ours(benchmark::State& state) {
    const int nodes = int(state.range(0)), points = int(state.range(1));
    bench::ArcTable table;
    const std::string defines =
        PEL_EACH_CURVATURE_FORM(FORM) "-DPEL_FORM=0 -DPEL_GROUP=1 -DPEL_COLUMNS=256 -DPEL_NODES=" +
        std::to_string(nodes) + " -DPEL_POINTS=" + std::to_string(points);
    cl_kernel rows = runner().kernel(kernels + "lut/curvature_lut.cl", "curvature_rows", defines);
    cl_kernel fill = runner().kernel(kernels + "lut/curvature_lut.cl", "curvature_texels", defines);
    const cl_mem gaussians = runner().upload(table.gaussians),
                 mesh = runner().upload(bench::meshOfNodes(nodes)),
                 columns = runner().upload(bench::columnsOf(nodes)),
                 records = runner().memory(size_t(2 * nodes + 5) * side * 16),
                 out = runner().memory(size_t(side + 1) * (side + 1) * 16);
    runner().arguments(rows, table.params, gaussians, mesh, records);
    runner().arguments(fill, table.params, records, columns, out);
    double rowSeconds = 0, fillSeconds = 0;
    const auto once = [&] {
        const double a = runner().run(rows, side / bench::Runner::width, 1, 1),
                     b = runner().run(fill, 1, side + 1, 1);
        rowSeconds += a;
        fillSeconds += b;
        return a + b;
    };
    once();
    rowSeconds = fillSeconds = 0;
    for (auto _ : state) state.SetIterationTime(once());
    state.counters["max"] = largestError(out, 4, side + 1);
    state.counters["exp_per_s"] =
        exponentialsOfRows(table, nodes, points) * double(state.iterations()) / rowSeconds;
    state.counters["texel_bytes_per_s"] =
        double(side + 1) * (side + 1) * 16 * double(state.iterations()) / fillSeconds;
    state.counters["row_share"] = rowSeconds / (rowSeconds + fillSeconds);
    for (cl_mem memory : {gaussians, mesh, columns, records, out}) clReleaseMemObject(memory);
}

void sampled(benchmark::State& state) {
    const cl_uint samples = cl_uint(state.range(0));
    const bool perRow = state.range(1) != 0;
    bench::ArcTable table;
    const std::string file = own + "sampled_luts.cl";
    const cl_mem gaussians = runner().upload(table.gaussians), out = runner().memory(size_t(side) * side * 12),
                 spread = runner().memory(size_t(side) * samples * 16);
    cl_kernel first = nullptr, second = runner().kernel(file, perRow ? "sampledFromRow" : "sampledTexels");
    if (perRow) {
        first = runner().kernel(file, "sampledSpread");
        runner().arguments(first, table.params, gaussians, samples, spread);
        runner().arguments(second, table.params, spread, samples, out);
    } else {
        runner().arguments(second, table.params, gaussians, samples, out);
    }
    const auto once = [&] {
        return (perRow ? runner().run(first, samples, side, 0) : 0.0) +
               runner().run(second, side / bench::Runner::width, side, 0);
    };
    if (samples <= 256) once();
    for (auto _ : state) state.SetIterationTime(once());
    state.counters["max"] = largestError(out, 3, side);
    for (cl_mem memory : {gaussians, out, spread}) clReleaseMemObject(memory);
}

void peakExponentials(benchmark::State& state) {
    constexpr size_t items = 1 << 14;
    const cl_mem out = runner().memory(items * bench::Runner::width * 4);
    cl_kernel kernel = runner().kernel(own + "device_limits.cl", "exponentials");
    runner().arguments(kernel, out);
    runner().run(kernel, items, 1, 0);
    double seconds = 0;
    for (auto _ : state) {
        const double time = runner().run(kernel, items, 1, 0);
        seconds += time;
        state.SetIterationTime(time);
    }
    state.counters["exp_per_s"] =
        double(items) * bench::Runner::width * 512 * double(state.iterations()) / seconds;
    clReleaseMemObject(out);
}

// A table's worth of bytes, and more than caches hold.
void copyBandwidth(benchmark::State& state) {
    const size_t bytes = size_t(state.range(0)) << 20;
    const cl_mem from = runner().upload(std::vector<float>(bytes / 4, 1.0f)), to = runner().memory(bytes);
    cl_kernel kernel = runner().kernel(own + "device_limits.cl", "copy");
    runner().arguments(kernel, from, to);
    runner().run(kernel, bytes / 64, 1, 0);
    double seconds = 0;
    for (auto _ : state) {
        const double time = runner().run(kernel, bytes / 64, 1, 0);
        seconds += time;
        state.SetIterationTime(time);
    }
    state.counters["bytes_written_per_s"] = double(bytes) * double(state.iterations()) / seconds;
    clReleaseMemObject(from);
    clReleaseMemObject(to);
}

BENCHMARK(ours)
    ->ArgNames({"nodes", "points"})
    ->ArgsProduct({{8}, {1}})
    ->ArgsProduct({{8, 16, 32, 64, 128}, {2}})
    ->ArgsProduct({{96, 128}, {3}})
    ->UseManualTime()
    ->Iterations(10)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(sampled)
    ->ArgNames({"samples", "per_row"})
    ->ArgsProduct({{16, 32, 64, 128, 256, 512, 1024, 2048, 4096}, {0, 1}})
    ->UseManualTime()
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(peakExponentials)->UseManualTime()->Iterations(5)->Unit(benchmark::kMillisecond);
BENCHMARK(copyBandwidth)->ArgName("MiB")->Arg(4)->Arg(256)->UseManualTime()->Iterations(5)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
