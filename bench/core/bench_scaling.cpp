// How time grows with the size of the work: pixels, lights, vertices, tables. For threads, run it with POCL_MAX_PTHREAD_COUNT.
// `copies`: the rate at which a pass moves its bytes once (float32 images in and out), over that of a plain copy on this machine.
#include <benchmark/benchmark.h>

#include <pellucid/pellucid.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "mesh/mesh_calls.h"
#include "shading/shade_frames.h"

using namespace pellucid;
using namespace frames;

namespace {

const Device& device() {
    static const Device device("");
    return device;
}

// Bytes read and written in a second by a copy on every processor's behalf: the device's own.
double copyRate() {
    static const double rate = [] {
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
        return 2 * double(bytes) / best;
    }();
    return rate;
}

void countCopies(benchmark::State& state, double bytes) {
    state.counters["copies"] =
        benchmark::Counter(bytes / copyRate(), benchmark::Counter::kIsIterationInvariantRate);
}

// A screen of folded skin without taps.
void pixels(benchmark::State& state) {
    const int width = int(state.range(0)), height = width * 9 / 16;
    const auto lights = size_t(state.range(1));
    const auto scene = makeScene(device(), foldedSkin(width, height, 1), 0);
    const auto w = uint32_t(width), h = uint32_t(height);
    Shader shader(device());
    size_t bytes = 0;
    std::vector<Buffer> buffers;
    const auto image = [&](const std::vector<float>& values, PelFormat format) {
        bytes += values.size() * sizeof(float);
        return imageDesc(buffers.emplace_back(device(), values), format, w, h);
    };
    const ShadeFrame& f = scene->frame;
    const Buffer target(device(), size_t(w) * h * 12), ids(device(), f.id), wide(device(), f.wide);
    bytes += target.bytes() + ids.bytes() + lights * wide.bytes();
    shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, w, h));
    shader.set(PEL_SLOT_MATERIAL, imageDesc(ids, PEL_FORMAT_R8_UINT, w, h));
    shader.set(PEL_SLOT_POSITION, image(f.position, PEL_FORMAT_RGB32F));
    shader.set(PEL_SLOT_NORMAL_GEOMETRIC, image(f.geometric, PEL_FORMAT_RGB32F));
    shader.set(PEL_SLOT_NORMAL_SHADING, image(f.shading, PEL_FORMAT_RGB32F));
    shader.set(PEL_SLOT_NORMAL_BLURRED, image(f.blurred, PEL_FORMAT_RGB32F));
    shader.set(PEL_SLOT_CURVATURE, image(f.curvature, PEL_FORMAT_R32F));
    shader.set(PEL_SLOT_ALBEDO, image(f.albedo, PEL_FORMAT_RGB32F));
    shader.setMaterial(1, scene->material, scene->curvatureLut, scene->shadowLut);
    shader.set(std::vector<PelLight>(lights, scene->light)).set(scene->camera).set(scene->ambient);
    for (uint32_t i = 0; i < lights; ++i)
        shader.set(i, PEL_LIGHT_WIDE_SHADOW, imageDesc(wide, PEL_FORMAT_R32F, w, h));
    shader.commit().execute();
    for (auto _ : state) shader.execute();
    countCopies(state, double(bytes));
}

void vertices(benchmark::State& state) {
    const auto sides = uint32_t(std::lround(std::sqrt(double(state.range(0)) / 2)));
    const fixture::Mesh mesh = fixture::torus(2 * sides, sides);
    const MeshTopology topology(device(), fixture::topologyDesc(mesh));
    const auto count = uint32_t(mesh.positions.size() / 3);
    const Buffer positions(device(), mesh.positions), normals(device(), mesh.normals),
        out(device(), count * sizeof(float));
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.estimator = state.range(1) ? PEL_CURVATURE_QUADRIC : PEL_CURVATURE_EDGE;
    params.smoothingPasses = state.range(1) ? 0 : 2;
    const auto run = [&] {
        topology.curvature(params, vertexView(positions, count), vertexView(normals, count),
                           vertexView(out, count));
    };
    run();
    for (auto _ : state) run();
    countCopies(state, double(positions.bytes() + normals.bytes() + out.bytes()));
}

// Different profiles, a curvature and a shadow table of each, one after another.
void tables(benchmark::State& state) {
    for (auto _ : state)
        for (int64_t i = 0; i < state.range(0); ++i) {
            PelCurvatureLutDesc curvature = pelCurvatureLutDescFaceWorks();
            PelShadowLutDesc shadow = pelShadowLutDescFaceWorks();
            curvature.width = curvature.height = shadow.width = shadow.height = 64;
            curvature.diffusionRadius = shadow.diffusionRadius = 2 + 0.001f * float(i);
            const Lut one(device(), curvature), two(device(), shadow);
        }
    state.counters["pairs_per_second"] =
        benchmark::Counter(double(state.range(0)), benchmark::Counter::kIsIterationInvariantRate);
}

#define TIMED ->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime()
BENCHMARK(pixels)->ArgNames({"width", "lights"})->ArgsProduct({{1280, 1920, 3840, 7680}, {1}}) TIMED;
BENCHMARK(pixels)->ArgNames({"width", "lights"})->ArgsProduct({{1280}, {2, 4, 16, 64}}) TIMED;
BENCHMARK(vertices)
    ->ArgNames({"vertices", "quadric"})
    ->ArgsProduct({{1000, 10000, 100000, 1000000, 20000000}, {0, 1}}) TIMED;
BENCHMARK(tables)->ArgName("pairs")->RangeMultiplier(10)->Range(10, 100000) TIMED;

}  // namespace

BENCHMARK_MAIN();
