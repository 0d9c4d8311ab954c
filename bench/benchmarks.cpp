// Times of the library against other implementations, by size, by feature and by thread.
// bench/performance_page runs this program and keeps the results; `pellucid bench` measures a device with
// less.
//     benchmarks [--benchmark_filter=REGEX] [--benchmark_...]
//
// Frames of shading: `full` is a screen of folded skin, `demo_key` and `demo_backlit` are the views that
// `pellucid demo` left in out/demo or PELLUCID_DEMO_DIR. `lit` is what a renderer without scattering shades
// there: Lambert with a plain shadow, ambient and specular light; `plain` leaves out the shadow and the
// ambient light too.
#include <benchmark/benchmark.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <pellucid/pellucid.hpp>
#include <random>
#include <string>

#include "baselines.h"
#include "io/image/image_file.h"
#include "io/scene/scene_file.h"
#include "mesh/mesh_calls.h"

using namespace pellucid;
using namespace pellucid::bench;

namespace {

using Run = std::function<void(benchmark::State&)>;

const Device& device() {
    static const Device device("");
    return device;
}

// A case that is timed by the wall clock, in milliseconds, with the processor time of all threads beside it.
void add(const std::string& name, const Run& run) {
    benchmark::RegisterBenchmark(name.c_str(), run)
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime()
        ->UseRealTime();
}

// Runs `work` once, which builds its programs, and then times it.
template <class Work>
void time(benchmark::State& state, Work&& work) {
    work();
    for (auto _ : state) work();
}

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

// Counts the share of the device's copy rate at which a pass moves `bytes` in each iteration.
void countCopies(benchmark::State& state, double bytes) {
    static const double rate = copyRate();
    state.counters["copies"] =
        benchmark::Counter(bytes / rate, benchmark::Counter::kIsIterationInvariantRate);
}

// Curvature and shadow tables of as many profiles, one after another.
void addPairs(int pairs) {
    add("tables/pairs:" + std::to_string(pairs), [=](benchmark::State& state) {
        PelCurvatureLutDesc curvature = pelCurvatureLutDescFaceWorks();
        PelShadowLutDesc shadow = pelShadowLutDescFaceWorks();
        curvature.width = curvature.height = shadow.width = shadow.height = 64;
        for (auto _ : state)
            for (int i = 0; i < pairs; ++i) {
                curvature.diffusionRadius = shadow.diffusionRadius = 2 + 0.001f * float(i);
                const Lut one(device(), curvature), two(device(), shadow);
            }
        state.counters["pairs_per_second"] =
            benchmark::Counter(pairs, benchmark::Counter::kIsIterationInvariantRate);
    });
}

// --- curvature of tori with 2:1 rings, and the analysis of a topology ---

// shuffled: neighbours in space lie far apart in memory. irregular: each cell is cut along either diagonal,
// so that vertices have four to eight neighbours.
enum Order { ordered = 0, shuffled = 1, irregular = 2 };

fixture::Mesh makeMesh(uint32_t vertices, Order order) {
    const uint32_t sides = uint32_t(std::lround(std::sqrt(double(vertices) / 2)));
    fixture::Mesh mesh = fixture::torus(2 * sides, sides);
    std::mt19937 random(1);
    if (order == irregular)
        for (size_t cell = 0; cell < mesh.indices.size(); cell += 6) {
            uint32_t* i = &mesh.indices[cell];
            const uint32_t q = i[1], r = i[2], s = i[5];
            if (random() & 1) i[2] = s, i[3] = q, i[4] = r;
        }
    if (order != shuffled) return mesh;
    mesh = fixture::shuffleVertices(mesh, 1).mesh;
    for (size_t t = 0; t < mesh.indices.size() / 3; ++t) {
        const size_t other = t + random() % (mesh.indices.size() / 3 - t);
        std::swap_ranges(&mesh.indices[3 * t], &mesh.indices[3 * t] + 3, &mesh.indices[3 * other]);
    }
    return mesh;
}

struct Torus {
    fixture::Mesh mesh;
    MeshTopology topology;
    Buffer positions, normals, curvature;
    uint32_t vertices;

    Torus(uint32_t count, Order order)
        : mesh(makeMesh(count, order)),
          topology(device(), fixture::topologyDesc(mesh)),
          positions(device(), mesh.positions),
          normals(device(), mesh.normals),
          curvature(device(), mesh.vertices() * sizeof(float)),
          vertices(mesh.vertices()) {}
    PelVertexView view(const Buffer& buffer) const { return vertexView(buffer, vertices); }
    void run(const PelCurvatureParams& params) const {
        topology.curvature(params, view(positions), view(normals), view(curvature));
    }
};

const Torus& torus(uint32_t vertices, Order order = ordered) {
    static std::map<std::pair<uint32_t, Order>, std::unique_ptr<Torus>> made;
    auto& slot = made[{vertices, order}];
    if (!slot) slot = std::make_unique<Torus>(vertices, order);
    return *slot;
}

PelCurvatureParams estimated(PelCurvatureEstimator estimator, uint32_t passes) {
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.estimator = estimator;
    params.smoothingPasses = passes;
    return params;
}

// Adds a case of a torus: `work(torus)` is timed.
template <class Work>
void addCase(const std::string& name, uint32_t vertices, Order order, const std::string& more,
             const Work& work) {
    add(name + "/vertices:" + std::to_string(vertices) + "/order:" + std::to_string(order) + more,
        [=](benchmark::State& state) {
            const Torus& t = torus(vertices, order);
            time(state, [&] { work(t); });
        });
}

void addBaseline(uint32_t vertices, Order order, uint32_t passes) {
    add("edgeBaseline/vertices:" + std::to_string(vertices) + "/order:" + std::to_string(order) +
            "/passes:" + std::to_string(passes),
        [=](benchmark::State& state) {
            const Torus& t = torus(vertices, order);
            baseline::CurvatureScratch scratch;
            std::vector<float> result;
            for (auto _ : state)
                baseline::edgeCurvature(t.mesh.positions, t.mesh.normals, t.mesh.indices, passes, scratch,
                                        result);
            t.run(fixture::edgeParams(passes));
            const std::vector<float> ours = t.curvature.readAll<float>();
            double difference = 0;
            for (size_t v = 0; v < ours.size(); ++v)
                difference = std::max(difference, double(std::abs(ours[v] - result[v])));
            state.counters["difference"] = difference / *std::ranges::max_element(result);
        });
}

void addByOrder(uint32_t vertices, Order order) {
    for (const uint32_t passes : {0, 2}) {
        addCase("edgeDevice", vertices, order, "/passes:" + std::to_string(passes),
                [=](const Torus& t) { t.run(fixture::edgeParams(passes)); });
        addBaseline(vertices, order, passes);
    }
    for (const auto estimator : {PEL_CURVATURE_EDGE, PEL_CURVATURE_TENSOR, PEL_CURVATURE_QUADRIC})
        addCase("estimatorDevice", vertices, order, "/estimator:" + std::to_string(estimator),
                [=](const Torus& t) { t.run(estimated(estimator, 0)); });
    // To a radius of three edges, on top of the cheapest estimator.
    addCase("smoothedToRadius", vertices, order, "", [](const Torus& t) {
        PelCurvatureParams params = fixture::edgeParams(0);
        params.smoothingRadius = float(3 * std::sqrt(4 * M_PI * M_PI * 3 / double(t.vertices)));
        t.run(params);
    });
    addCase("madeNormals", vertices, order, "", [](const Torus& t) {
        const Buffer normals(device(), t.mesh.normals);
        t.topology.normals(t.view(t.positions), t.view(normals));
    });
    for (const auto weld : {PEL_WELD_NONE, PEL_WELD_EXACT})
        addCase("topologyAnalysis", vertices, order, "/weld:" + std::to_string(weld), [=](const Torus& t) {
            PelMeshTopologyDesc desc = fixture::topologyDesc(t.mesh);
            desc.weld = weld;
            MeshTopology(device(), desc);
        });
}

// The default estimator and two passes, as in a frame of a deforming head: of all vertices, and of a part
// that moved.
void addMoving() {
    constexpr uint32_t vertices = 100000;
    addCase("deformingFrame", vertices, ordered, "",
            [](const Torus& t) { t.run(estimated(pelCurvatureParamsDefaults().estimator, 2)); });
    for (const uint32_t part : {100u, 1000u, 10000u})
        add("livePart/vertices:100000/order:0/part:" + std::to_string(part), [=](benchmark::State& state) {
            const Torus& t = torus(vertices);
            const LiveMesh live(t.topology, estimated(pelCurvatureParamsDefaults().estimator, 2));
            const PelVertexView normals = t.view(t.normals);
            live.update(t.view(t.positions), &normals, t.view(t.curvature));
            const std::vector<PelVertexRange> moved{{vertices / 2, part}};
            time(state, [&] { live.update(t.view(t.positions), &normals, t.view(t.curvature), moved); });
        });
}

void addMeshes() {
    for (const Order order : {ordered, shuffled, irregular}) addByOrder(1000000, order);
    addMoving();
    for (const uint32_t vertices : {1000u, 10000u, 100000u, 1000000u, 20000000u})
        for (const bool quadric : {false, true})
            add("vertices/vertices:" + std::to_string(vertices) + "/quadric:" + std::to_string(quadric),
                [=](benchmark::State& state) {
                    const Torus t(vertices, ordered);
                    const PelCurvatureParams params =
                        quadric ? estimated(PEL_CURVATURE_QUADRIC, 0) : estimated(PEL_CURVATURE_EDGE, 2);
                    time(state, [&] { t.run(params); });
                    countCopies(state, double(t.positions.bytes() + t.normals.bytes() + t.curvature.bytes()));
                });
}

// --- shading ---

const std::string demoViews[] = {"key", "backlit"};

// Where `pellucid demo` left its views.
std::string demoFolder() {
    const char* named = std::getenv("PELLUCID_DEMO_DIR");
    return named && *named ? named : PELLUCID_SOURCE_DIR "/out/demo";
}

// A view as `pellucid demo` wrote it. The demo's skin takes transmission from its profile; taps need deep
// scatter by a colour, which FrameSettings gives.
FrameImages demoView(const std::string& view) {
    const io::SceneFile file = io::readScene(demoFolder() + "/" + view + ".toml");
    const io::Image g = io::readImage(demoFolder() + "/" + view + "_gbuffer.exr");
    const auto take = [&](PelImageSlot slot) { return g.interleaved(file.channels[slot]); };
    FrameImages f;
    f.width = uint32_t(g.width), f.height = uint32_t(g.height);
    f.position = take(PEL_SLOT_POSITION), f.geometric = take(PEL_SLOT_NORMAL_GEOMETRIC);
    f.shading = take(PEL_SLOT_NORMAL_SHADING), f.blurred = take(PEL_SLOT_NORMAL_BLURRED);
    f.curvature = take(PEL_SLOT_CURVATURE), f.albedo = take(PEL_SLOT_ALBEDO);
    for (const float id : take(PEL_SLOT_MATERIAL)) f.id.push_back(id == 1.0f);
    f.wideShadow = g.interleaved(std::vector{file.lights.at(0).wideShadow});
    const io::Image map = io::readImage(file.lights[0].shadowMapFile);
    f.map = map.interleaved(std::vector{file.lights[0].shadowMapChannel});
    f.mapSize = uint32_t(map.width);
    f.light = file.lights[0].light;
    f.material = file.materials.at(0).material;
    f.ambient = file.ambient;
    f.camera = file.camera;
    return f;
}

// `name`: a view of the demo, or the width of a screen of folded skin.
const Frame& frame(const std::string& name) {
    static std::map<std::string, std::unique_ptr<Frame>> frames;
    std::unique_ptr<Frame>& slot = frames[name];
    if (!slot) {
        const auto width = uint32_t(std::atoi(name.c_str()));
        slot = std::make_unique<Frame>(device(), width ? foldedSkin(width, width * 9 / 16) : demoView(name));
    }
    return *slot;
}

Run library(const std::string& name, const FrameSettings& settings) {
    return [=](benchmark::State& state) {
        const Shader shader = frame(name).shader(settings);
        time(state, [&] { shader.execute(); });
    };
}

// x and y of the library's disk of taps.
std::vector<float> readDisk(uint32_t taps) {
    std::ifstream file(PELLUCID_SOURCE_DIR "/kernels/lib/shading/poisson_disk.clh");
    const std::string start = "pelDisk" + std::to_string(taps) + "[";
    std::vector<float> disk;
    for (std::string line; std::getline(file, line);)
        if (line.find(start) != std::string::npos)
            while (std::getline(file, line) && line[0] != '}') {
                for (size_t at = 0; (at = line.find("(float2)(", at)) != std::string::npos; ++at) {
                    float x = 0, y = 0;
                    std::sscanf(line.c_str() + at, "(float2)(%ff, %ff)", &x, &y);
                    disk.insert(disk.end(), {x, y});
                }
            }
    if (disk.size() != 2 * size_t(taps))
        throw std::runtime_error("no disk of this many taps in poisson_disk.clh");
    return disk;
}

// The scalar loop, and its largest difference from the library with taps of each pixel's own.
Run openMp(const std::string& name, uint32_t taps, baseline::Effort effort) {
    return [=](benchmark::State& state) {
        const Frame& f = frame(name);
        const FrameSettings settings{.taps = taps, .everyPixel = true};
        const std::vector<float> curvature = f.curvatureLut().read<float>(PEL_LUT_FLOAT),
                                 shadow = f.shadowLut().read<float>(PEL_LUT_FLOAT);
        const baseline::ShadeInput input{f.images(), f.material(settings), curvature, shadow,
                                         taps ? readDisk(taps) : std::vector<float>()};
        std::vector<float> radiance(f.images().position.size());
        for (auto _ : state) baseline::shadeOpenMp(input, effort, radiance);
        f.shader(settings).execute();
        const std::vector<float> ours = f.target().readAll<float>();
        float worst = 0;
        for (size_t i = 0; i < ours.size(); ++i) worst = std::max(worst, std::abs(ours[i] - radiance[i]));
        state.counters["max_difference"] = worst;
    };
}

void addOpenMp(const std::string& title, const std::string& name, uint32_t taps) {
    add("openMp/" + title, openMp(name, taps, baseline::Effort::Straight));
    add("openMp/" + title + "_skipping", openMp(name, taps, baseline::Effort::Skipping));
}

// Surface terms of a screen, by its width and its lights.
Run pixels(uint32_t width, uint32_t lights) {
    return [=](benchmark::State& state) {
        const Frame f(device(), foldedSkin(width, width * 9 / 16));
        const Shader shader = f.shader({.lights = lights});
        time(state, [&] { shader.execute(); });
        // Per pixel: four vectors and the result, albedo, an id, curvature, a wide shadow of each light.
        countCopies(state, double(width) * (width * 9 / 16) * (6 * 12 + 1 + 4 + 4 * lights));
    };
}

// Discs on a grid cover `share` of the area.
std::vector<uint8_t> discs(double share) {
    std::vector<uint8_t> ids;
    const double cell = 540, radius = cell * std::sqrt(share / M_PI);
    for (uint32_t y = 0; y < 1080; ++y)
        for (uint32_t x = 0; x < 1920; ++x)
            ids.push_back(std::hypot(std::fmod(x, cell) - cell / 2, std::fmod(y, cell) - cell / 2) < radius);
    return ids;
}

void addDemoViews() {
    for (const std::string& view : demoViews) {
        const std::string name = "demo_" + view;
        add("library/" + name, library(view, {.taps = 32}));
        add("library/" + name + "_lit", library(view, {.terms = Terms::lit}));
        add("library/" + name + "_plain", library(view, {.terms = Terms::plain}));
        addOpenMp(name, view, 32);
    }
}

void addShading() {
    const struct {
        const char* name;
        FrameSettings settings;
    } features[] = {{"full_surface", {}},
                    {"full_32taps", {.taps = 32}},
                    {"full_lit", {.terms = Terms::lit}},
                    {"full_plain", {.terms = Terms::plain}},
                    {"full_coverage10", {.taps = 32, .ids = discs(0.1)}},
                    {"full_coverage0", {.taps = 32, .ids = discs(0)}},
                    {"full_32taps_4lights", {.taps = 32, .lights = 4}},
                    {"full_surface_4lights", {.lights = 4}}};
    for (const auto& [name, settings] : features)
        add(std::string("library/") + name, library("1920", settings));
    addOpenMp("full_surface", "1920", 0);
    addOpenMp("full_32taps", "1920", 32);
    for (const uint32_t width : {1280, 1920, 3840, 7680})
        add("pixels/width:" + std::to_string(width) + "/lights:1", pixels(width, 1));
    for (const uint32_t lights : {2, 4, 16, 64})
        add("pixels/width:1280/lights:" + std::to_string(lights), pixels(1280, lights));
    if (std::ifstream(demoFolder() + "/key.toml"))
        addDemoViews();
    else
        std::fprintf(stderr, "no demo views in %s: ./run demo makes them\n", demoFolder().c_str());
}

}  // namespace

int main(int argc, char** argv) {
    addShading();
    addMeshes();
    for (const int pairs : {10, 100, 1000, 10000, 100000}) addPairs(pairs);
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
