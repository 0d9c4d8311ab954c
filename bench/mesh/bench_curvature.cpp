// Curvature: the device against a plain loop, the analysis of a topology, and the copy bandwidth to compare
// with.
#include <benchmark/benchmark.h>

#include <pellucid/pellucid.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <random>

#include "baseline_curvature.h"
#include "mesh/mesh_calls.h"

using namespace pellucid;

namespace {

const Device& device() {
    static const Device device("");
    return device;
}

enum Order { ordered = 0, shuffled = 1, irregular = 2 };  // argument "order" of every case

// A torus with 2:1 rings of about `vertices`; shuffled: neighbours in space are strangers in memory; irregular: each cell is
// cut along either diagonal, so that vertices have four to eight neighbours and no two of them alike.
fixture::Mesh makeMesh(int64_t vertices, Order order) {
    const uint32_t sides = uint32_t(std::lround(std::sqrt(double(vertices) / 2)));
    fixture::Mesh mesh = fixture::torus(2 * sides, sides);
    if (order == ordered) return mesh;
    if (order == irregular) {
        std::mt19937 random(1);
        for (size_t cell = 0; cell < mesh.indices.size(); cell += 6) {
            uint32_t* i = &mesh.indices[cell];
            const uint32_t q = i[1], r = i[2], s = i[5];
            if (random() & 1) i[2] = s, i[3] = q, i[4] = r;
        }
        return mesh;
    }
    fixture::Mesh result = fixture::shuffleVertices(mesh, 1).mesh;
    std::mt19937 random(1);
    for (size_t t = 0; t < result.indices.size() / 3; ++t) {
        const size_t other = t + random() % (result.indices.size() / 3 - t);
        std::swap_ranges(&result.indices[3 * t], &result.indices[3 * t] + 3, &result.indices[3 * other]);
    }
    return result;
}

// A mesh with everything that it needs on the device, made once per size and order.
struct Case {
    fixture::Mesh mesh;
    MeshTopology topology;
    Buffer positions, normals, curvature;
    uint32_t vertices;
};

Case& prepared(const benchmark::State& state) {
    static std::map<std::pair<int64_t, int64_t>, std::unique_ptr<Case>> cases;
    std::unique_ptr<Case>& slot = cases[{state.range(0), state.range(1)}];
    if (!slot) {
        slot = std::make_unique<Case>();
        slot->mesh = makeMesh(state.range(0), Order(state.range(1)));
        slot->topology = MeshTopology(device(), fixture::topologyDesc(slot->mesh));
        slot->positions = Buffer(device(), slot->mesh.positions);
        slot->normals = Buffer(device(), slot->mesh.normals);
        slot->vertices = slot->mesh.vertices();
        slot->curvature = Buffer(device(), slot->vertices * sizeof(float));
    }
    return *slot;
}

void perVertex(benchmark::State& state, uint32_t vertices) {
    state.counters["ns_per_vertex"] = benchmark::Counter(
        double(vertices) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void run(const Case& c, const PelCurvatureParams& params) {
    c.topology.curvature(params, vertexView(c.positions, c.vertices), vertexView(c.normals, c.vertices),
                         vertexView(c.curvature, c.vertices));
}

void edgeDevice(benchmark::State& state) {
    const Case& c = prepared(state);
    const PelCurvatureParams params = fixture::edgeParams(uint32_t(state.range(2)));
    run(c, params);
    for (auto _ : state) run(c, params);
    perVertex(state, c.vertices);
}

void estimatorDevice(benchmark::State& state) {
    const Case& c = prepared(state);
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.estimator = PelCurvatureEstimator(state.range(2));
    params.smoothingPasses = 0;
    run(c, params);
    for (auto _ : state) run(c, params);
    perVertex(state, c.vertices);
}

// A frame of a deforming head: the default estimator and two passes.
void deformingFrame(benchmark::State& state) {
    const Case& c = prepared(state);
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.smoothingPasses = 2;
    run(c, params);
    for (auto _ : state) run(c, params);
    perVertex(state, c.vertices);
}

// The same frame where only some vertices moved, in the middle of the mesh.
void livePart(benchmark::State& state) {
    const Case& c = prepared(state);
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.smoothingPasses = 2;
    const LiveMesh live(c.topology, params);
    const PelVertexView positions = vertexView(c.positions, c.vertices),
                        normals = vertexView(c.normals, c.vertices),
                        curvature = vertexView(c.curvature, c.vertices);
    live.update(positions, &normals, curvature);
    const std::vector<PelVertexRange> moved{{c.vertices / 2, uint32_t(state.range(2))}};
    live.update(positions, &normals, curvature, moved);
    for (auto _ : state) live.update(positions, &normals, curvature, moved);
}

// Smoothing to a radius of three edges, on top of the cheapest estimator.
void smoothedToRadius(benchmark::State& state) {
    const Case& c = prepared(state);
    const double pi = 3.14159265358979;
    PelCurvatureParams params = fixture::edgeParams(0);
    params.smoothingRadius = float(3 * std::sqrt(4 * pi * pi * 3 / double(c.vertices)));
    run(c, params);
    for (auto _ : state) run(c, params);
    perVertex(state, c.vertices);
}

void madeNormals(benchmark::State& state) {
    const Case& c = prepared(state);
    const Buffer normals(device(), c.mesh.normals);
    const auto make = [&] {
        c.topology.normals(vertexView(c.positions, c.vertices), vertexView(normals, c.vertices));
    };
    make();
    for (auto _ : state) make();
    perVertex(state, c.vertices);
}

void edgeBaseline(benchmark::State& state) {
    const Case& c = prepared(state);
    baseline::CurvatureScratch scratch;
    std::vector<float> result;
    for (auto _ : state)
        baseline::edgeCurvature(c.mesh.positions, c.mesh.normals, c.mesh.indices, uint32_t(state.range(2)),
                                scratch, result);
    perVertex(state, c.vertices);
    // The speed of a wrong answer is worth nothing.
    run(c, fixture::edgeParams(uint32_t(state.range(2))));
    const std::vector<float> ours = c.curvature.readAll<float>();
    double difference = 0, largest = 0;
    for (size_t v = 0; v < ours.size(); ++v) {
        difference = std::max(difference, double(std::abs(ours[v] - result[v])));
        largest = std::max(largest, double(result[v]));
    }
    state.counters["difference"] = difference / largest;
}

void topologyAnalysis(benchmark::State& state) {
    const Case& c = prepared(state);
    PelMeshTopologyDesc desc = fixture::topologyDesc(c.mesh);
    desc.weld = PelWeld(state.range(2));
    for (auto _ : state) MeshTopology(device(), desc);
    perVertex(state, c.vertices);
}

// What a pass that only moved its memory would take: reads and writes at the same rate.
void copyBandwidth(benchmark::State& state) {
    const size_t bytes = size_t(state.range(0));
    std::vector<char> a(bytes, 1), b(bytes, 2);
    for (auto _ : state) {
        std::copy(a.begin(), a.end(), b.begin());
        benchmark::DoNotOptimize(b.data());
        benchmark::ClobberMemory();
    }
    state.SetBytesProcessed(int64_t(state.iterations()) * int64_t(2 * bytes));
}

BENCHMARK(edgeDevice)
    ->ArgNames({"vertices", "order", "passes"})
    ->ArgsProduct({{100000, 1000000}, {0, 1, 2}, {0, 2}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(edgeBaseline)
    ->ArgNames({"vertices", "order", "passes"})
    ->ArgsProduct({{100000, 1000000}, {0, 1, 2}, {0, 2}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(estimatorDevice)
    ->ArgNames({"vertices", "order", "estimator"})
    ->ArgsProduct({{100000, 1000000}, {0, 1, 2}, {PEL_CURVATURE_EDGE, PEL_CURVATURE_TENSOR, PEL_CURVATURE_QUADRIC}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
// From what fits into a cache to what fits nowhere: is the cost of a vertex the same?
BENCHMARK(edgeDevice)
    ->ArgNames({"vertices", "order", "passes"})
    ->ArgsProduct({{10000, 10000000}, {0}, {2}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(estimatorDevice)
    ->ArgNames({"vertices", "order", "estimator"})
    ->ArgsProduct({{10000, 10000000}, {0}, {PEL_CURVATURE_QUADRIC}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(deformingFrame)
    ->ArgNames({"vertices", "order"})
    ->Args({100000, 0})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(livePart)
    ->ArgNames({"vertices", "order", "part"})
    ->ArgsProduct({{100000}, {0}, {100, 1000, 10000}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(smoothedToRadius)
    ->ArgNames({"vertices", "order"})
    ->ArgsProduct({{1000000}, {0, 2}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(madeNormals)
    ->ArgNames({"vertices", "order"})
    ->ArgsProduct({{1000000}, {0, 2}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(topologyAnalysis)
    ->ArgNames({"vertices", "order", "weld"})
    ->ArgsProduct({{1000000}, {0, 1}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(copyBandwidth)->Arg(64 << 20)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
