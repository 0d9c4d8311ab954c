// What the first frame of a new process costs beside the frame: from pelDeviceCreate until the demo's key view is shaded, with
// the driver's cache of compiled kernels warm, and with an empty one where it is PoCL's (POCL_CACHE_DIR). Each measurement is a
// process of its own (first_frame.cpp). Needs the demo's views (`./run demo`; out/demo or PELLUCID_DEMO_DIR).
#include <benchmark/benchmark.h>

#include <pellucid/pellucid.hpp>

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "demo_files.h"
#include "io/image/image_file.h"
#include "io/scene/scene_file.h"

using namespace pellucid;

namespace {

std::string program, scratch;

// Milliseconds of each stage.
struct Stages {
    double device = 0, tables = 0, commit = 0, execute = 0, frame = 0;
    double start() const { return device + tables + commit + execute - frame; }
};

Stages inNewProcess() {
    FILE* pipe = popen(("'" + program + "' '" + scratch + "'").c_str(), "r");
    Stages s;
    const bool read = pipe && std::fscanf(pipe, "%lf %lf %lf %lf %lf", &s.device, &s.tables, &s.commit,
                                          &s.execute, &s.frame) == 5;
    if (!pipe || pclose(pipe) != 0 || !read)
        throw std::runtime_error("the process that measures a first frame failed");
    return s;
}

void firstFrame(benchmark::State& state, bool emptyCache) {
    const char* before = std::getenv("POCL_CACHE_DIR");
    const std::string old = before ? before : "";
    if (!emptyCache) inNewProcess();
    Stages sum;
    static int run = 0;  // repetitions have folders of their own
    for (auto _ : state) {
        if (emptyCache) {
            const std::string cache = scratch + "/cache" + std::to_string(run++);
            if (std::system(("mkdir '" + cache + "'").c_str()) != 0)
                return state.SkipWithError("no room for a cache");
            setenv("POCL_CACHE_DIR", cache.c_str(), 1);
        }
        const Stages s = inNewProcess();
        state.SetIterationTime(s.start() * 1e-3);
        sum.device += s.device, sum.tables += s.tables, sum.commit += s.commit, sum.execute += s.execute,
            sum.frame += s.frame;
    }
    before ? setenv("POCL_CACHE_DIR", old.c_str(), 1) : unsetenv("POCL_CACHE_DIR");
    for (auto [name, value] : {std::pair{"device_ms", sum.device},
                               {"tables_ms", sum.tables},
                               {"commit_ms", sum.commit},
                               {"execute_ms", sum.execute},
                               {"frame_ms", sum.frame}})
        state.counters[name] = benchmark::Counter(value, benchmark::Counter::kAvgIterations);
}

BENCHMARK_CAPTURE(firstFrame, warm, false)->Unit(benchmark::kMillisecond)->UseManualTime()->Iterations(1);
BENCHMARK_CAPTURE(firstFrame, emptyCache, true)->Unit(benchmark::kMillisecond)->UseManualTime()->Iterations(1);

template <class T>
void write(const std::string& name, const T* values, size_t count) {
    std::ofstream(scratch + "/" + name, std::ios::binary)
        .write(reinterpret_cast<const char*>(values), std::streamsize(count * sizeof(T)));
}
void write(const std::string& name, const std::vector<float>& values) {
    write(name, values.data(), values.size());
}

// The demo's key view and its tables as plain memory.
void writeFrame() {
    const io::SceneFile scene = io::readScene(demo::directory() + "/key.toml");
    const io::Image g = io::readImage(demo::directory() + "/key_gbuffer.exr");
    for (int slot = 1; slot < PEL_SLOT_COUNT; ++slot)
        if (!scene.channels[slot].empty())
            write("slot" + std::to_string(slot), g.interleaved(scene.channels[slot]));
    const io::SceneLight& light = scene.lights.at(0);
    write("wide", g.interleaved(std::vector{light.wideShadow}));
    const io::Image map = io::readImage(light.shadowMapFile);
    write("map", map.interleaved(std::vector{light.shadowMapChannel}));
    const uint32_t size[3] = {uint32_t(g.width), uint32_t(g.height), uint32_t(map.width)};
    write("size", size, 3);
    write("light", &light.light, 1);
    write("material", &scene.materials.at(0).material, 1);
    write("ambient", &scene.ambient, 1);
    write("camera", &scene.camera, 1);
    const Device device("");
    write("curvature", Lut(device, pelCurvatureLutDescFaceWorks()).read<float>(PEL_LUT_FLOAT));
    write("shadow", Lut(device, pelShadowLutDescFaceWorks()).read<float>(PEL_LUT_FLOAT));
}

}  // namespace

int main(int argc, char** argv) {
    if (!std::ifstream(demo::directory() + "/key.toml")) {
        std::fprintf(stderr, "no demo views in %s: run ./run demo first\n", demo::directory().c_str());
        return 0;
    }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    const std::string self = argv[0];
    program = self.substr(0, self.rfind('/') + 1) + "first_frame";
    char folder[] = "/tmp/first_use_XXXXXX";
    scratch = mkdtemp(folder);
    writeFrame();
    benchmark::RunSpecifiedBenchmarks();
    return std::system(("rm -r '" + scratch + "'").c_str());
}
