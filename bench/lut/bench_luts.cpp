// Look-up tables: the device against the sampled loop on one thread, and many tables one after another. The
// time of a table is the device's, from OpenCL's profiling.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "baselines.h"
#include "benchmarks.h"

using namespace pellucid;

namespace benchmarks {
namespace {

constexpr uint32_t side = 512;

const std::vector<baseline::LutGaussian> skin = {
    {0.080f, {0.233f, 0.455f, 0.649f}}, {0.220f, {0.100f, 0.336f, 0.344f}}, {0.432f, {0.118f, 0.198f, 0}},
    {0.753f, {0.113f, 0.007f, 0.007f}}, {1.411f, {0.358f, 0.004f, 0}},      {2.722f, {0.078f, 0, 0}}};

template <class Desc>
Desc squareOf(Desc desc, uint32_t texels) {
    desc.width = desc.height = texels;
    return desc;
}

PelCurvatureLutDesc curvatureDesc(PelCurvatureForm form = PEL_FORM_ARC) {
    PelCurvatureLutDesc desc = squareOf(pelCurvatureLutDescFaceWorks(), side);
    desc.form = form;
    return desc;
}

template <class Desc>
void addTable(const std::string& name, Desc desc, const Profile& profile = {}) {
    if (profile.get()) desc.profile = profile.get(), desc.diffusionRadius = 0;
    benchmark::RegisterBenchmark(
        name.c_str(),
        [=](benchmark::State& state) {
            (void)profile;  // keeps it alive
            Lut(device(), desc);
            for (auto _ : state) {
                const double before = device().stats().kernelMilliseconds;
                const Lut lut(device(), desc);
                state.SetIterationTime((device().stats().kernelMilliseconds - before) * 1e-3);
            }
        })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
}

// The loop, with its largest difference from the device's table.
template <class Desc, class Loop>
void addSampled(const std::string& name, const Desc& desc, const Loop& loop) {
    benchmark::RegisterBenchmark(name.c_str(),
                                 [=](benchmark::State& state) {
                                     std::vector<float> texels;
                                     for (auto _ : state) loop(texels);
                                     const auto exact =
                                         Lut(device(), desc).template read<float>(PEL_LUT_FLOAT);
                                     double worst = 0;
                                     for (size_t i = 0; i < exact.size(); ++i)
                                         worst = std::max(worst, double(std::abs(exact[i] - texels[i])));
                                     state.counters["difference"] = worst;
                                 })
        ->Iterations(1)
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
}

// A tabulated profile of 32 distances.
Profile measuredProfile() {
    std::vector<float> distances, values;
    for (int i = 0; i < 32; ++i) {
        distances.push_back(0.4f * float(i));
        for (float decay : {2.0f, 1.0f, 0.5f}) values.push_back(std::exp(-0.4f * float(i) / decay));
    }
    return Profile::table(distances, values);
}

// Curvature and shadow tables of as many profiles, one after another.
void addPairs(int pairs) {
    add("tables/pairs:" + std::to_string(pairs), [=](benchmark::State& state) {
        PelCurvatureLutDesc curvature = squareOf(pelCurvatureLutDescFaceWorks(), 64);
        PelShadowLutDesc shadow = squareOf(pelShadowLutDescFaceWorks(), 64);
        for (auto _ : state)
            for (int i = 0; i < pairs; ++i) {
                curvature.diffusionRadius = shadow.diffusionRadius = 2 + 0.001f * float(i);
                const Lut one(device(), curvature), two(device(), shadow);
            }
        state.counters["pairs_per_second"] =
            benchmark::Counter(pairs, benchmark::Counter::kIsIterationInvariantRate);
    });
}

}  // namespace

void addTables() {
    const PelCurvatureLutDesc arc = curvatureDesc();
    const PelShadowLutDesc shadow = squareOf(pelShadowLutDescFaceWorks(), side);
    addTable("curvatureArc/side:512", arc);
    addTable("curvatureSphere/side:512", curvatureDesc(PEL_FORM_SPHERE));
    addTable("shadow/side:512", shadow);
    const Profile measured = measuredProfile();
    for (int form = 0; form < 4; ++form)
        addTable("measured/side:512/form:" + std::to_string(form), curvatureDesc(PelCurvatureForm(form)),
                 measured);
    addTable("measured/side:512/form:4", shadow, measured);
    addSampled("curvatureSampled/side:512", arc, [=](std::vector<float>& texels) {
        baseline::sampledCurvatureLut(skin, side, side, arc.radiusMin, arc.radiusMax, 200, texels);
    });
    addSampled("shadowSampled/side:512", shadow, [=](std::vector<float>& texels) {
        baseline::sampledShadowLut(skin, side, side, shadow.widthMin, shadow.widthMax, shadow.sharpening, 200,
                                   texels);
    });
    for (const int pairs : {10, 100, 1000, 10000, 100000}) addPairs(pairs);
}

}  // namespace benchmarks
