// Look-up tables: the device against the sampled loop in one thread, and the device's own limits beside it.
//
// Times of the library are device times (kernels, from OpenCL profiling) as iteration time, wall time as a
// counter. Run with
// --benchmark_enable_random_interleaving=true --benchmark_repetitions=5 and compare medians.
#include <benchmark/benchmark.h>

#include <pellucid/pellucid.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "baseline_luts.h"

using namespace pellucid;

namespace {

const Device& device() {
    static const Device device("");
    return device;
}

const std::vector<baseline::LutGaussian> skin = {
    {0.080f, {0.233f, 0.455f, 0.649f}}, {0.220f, {0.100f, 0.336f, 0.344f}}, {0.432f, {0.118f, 0.198f, 0}},
    {0.753f, {0.113f, 0.007f, 0.007f}}, {1.411f, {0.358f, 0.004f, 0}},      {2.722f, {0.078f, 0, 0}}};

double wallSeconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

template <class Desc>
void integrate(benchmark::State& state, const Desc& desc) {
    Lut(device(), desc);  // builds the program
    double wall = 0;
    for (auto _ : state) {
        const double before = device().stats().kernelMilliseconds, start = wallSeconds();
        const Lut lut(device(), desc);
        wall += wallSeconds() - start;
        state.SetIterationTime((device().stats().kernelMilliseconds - before) * 1e-3);
    }
    const double texels = double(desc.width) * desc.height;
    state.counters["wall_ms"] = wall * 1e3 / double(state.iterations());
    state.counters["bytes_written_per_s"] =
        benchmark::Counter(texels * 16, benchmark::Counter::kIsIterationInvariantRate);
}

PelCurvatureLutDesc curvatureDesc(const benchmark::State& state) {
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = desc.height = uint32_t(state.range(0));
    return desc;
}

PelShadowLutDesc shadowDesc(const benchmark::State& state) {
    PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
    desc.width = desc.height = uint32_t(state.range(0));
    return desc;
}

void curvatureArc(benchmark::State& state) {
    integrate(state, curvatureDesc(state));
}

void curvatureSphere(benchmark::State& state) {
    PelCurvatureLutDesc desc = curvatureDesc(state);
    desc.form = PEL_FORM_SPHERE;
    integrate(state, desc);
}

void shadow(benchmark::State& state) {
    integrate(state, shadowDesc(state));
}

// A measured profile of 32 distances, in each form and as a shadow table (form 4).
void measured(benchmark::State& state) {
    std::vector<float> distances, values;
    for (int i = 0; i < 32; ++i) {
        distances.push_back(0.4f * float(i));
        for (float decay : {2.0f, 1.0f, 0.5f}) values.push_back(std::exp(-0.4f * float(i) / decay));
    }
    const Profile profile = Profile::table(distances, values);
    if (state.range(1) == 4) {
        PelShadowLutDesc desc = shadowDesc(state);
        desc.profile = profile.get();
        desc.diffusionRadius = 0;
        integrate(state, desc);
        return;
    }
    PelCurvatureLutDesc desc = curvatureDesc(state);
    desc.profile = profile.get();
    desc.diffusionRadius = 0;
    desc.form = PelCurvatureForm(state.range(1));
    integrate(state, desc);
}

// Largest difference from the device's table: the speed of a wrong answer is worth nothing.
void compare(benchmark::State& state, const Lut& lut, const std::vector<float>& sampled) {
    const std::vector<float> exact = lut.read<float>(PEL_LUT_FLOAT);
    double worst = 0;
    for (size_t i = 0; i < exact.size(); ++i)
        worst = std::max(worst, double(std::abs(exact[i] - sampled[i])));
    state.counters["difference"] = worst;
}

void curvatureSampled(benchmark::State& state) {
    const PelCurvatureLutDesc desc = curvatureDesc(state);
    std::vector<float> texels;
    for (auto _ : state) {
        const double start = wallSeconds();
        baseline::sampledCurvatureLut(skin, int(desc.width), int(desc.height), desc.radiusMin, desc.radiusMax,
                                      200, texels);
        state.SetIterationTime(wallSeconds() - start);
    }
    compare(state, Lut(device(), desc), texels);
}

void shadowSampled(benchmark::State& state) {
    const PelShadowLutDesc desc = shadowDesc(state);
    std::vector<float> texels;
    for (auto _ : state) {
        const double start = wallSeconds();
        baseline::sampledShadowLut(skin, int(desc.width), int(desc.height), desc.widthMin, desc.widthMax,
                                   desc.sharpening, 200, texels);
        state.SetIterationTime(wallSeconds() - start);
    }
    compare(state, Lut(device(), desc), texels);
}

BENCHMARK(curvatureArc)->ArgName("side")->Arg(512)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(curvatureSphere)->ArgName("side")->Arg(512)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(shadow)->ArgName("side")->Arg(512)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(measured)
    ->ArgNames({"side", "form"})
    ->ArgsProduct({{512}, {0, 1, 2, 3, 4}})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(curvatureSampled)->ArgName("side")->Arg(512)->UseManualTime()->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(shadowSampled)->ArgName("side")->Arg(512)->UseManualTime()->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
