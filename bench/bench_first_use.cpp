// What the first frame of a new process costs beside the frame: from pelDeviceCreate until the demo's key view is shaded, with
// the driver's cache of compiled kernels warm, and with an empty one when it is PoCL's (POCL_CACHE_DIR). Each measurement is a
// process of its own. Needs the demo's views (`./run demo`; out/demo or PELLUCID_DEMO_DIR).
#include <benchmark/benchmark.h>

#include <pellucid/pellucid.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "io/image_file.h"
#include "io/scene_file.h"

using namespace pellucid;

namespace {

std::string demoDirectory() {
    const char* named = std::getenv("PELLUCID_DEMO_DIR");
    return named && *named ? named : PELLUCID_SOURCE_DIR "/out/demo";
}

std::string self, scratch;

// Milliseconds of each stage of a first frame.
struct Stages {
    double device = 0, upload = 0, commit = 0, execute = 0, frame = 0;
    double start() const { return device + upload + commit + execute - frame; }
};

std::vector<float> readFloats(const std::string& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    std::vector<float> values(size_t(file.tellg()) / sizeof(float));
    file.seekg(0);
    file.read(reinterpret_cast<char*>(values.data()), std::streamsize(values.size() * sizeof(float)));
    return values;
}

// The host's memory as it lies.
Buffer shared(const Device& device, std::vector<float>& values) {
    return Buffer::fromHost(device, values.data(), values.size() * sizeof(float));
}

// In a process of its own: everything that a host has is in memory before the clock starts, tables included.
Stages measure() {
    const io::SceneFile scene = io::readScene(demoDirectory() + "/key.toml");
    const io::Image g = io::readImage(demoDirectory() + "/key_gbuffer.exr");
    std::array<std::vector<float>, PEL_SLOT_COUNT> images;
    for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot)
        if (!scene.channels[slot].empty()) images[slot] = g.interleaved(scene.channels[slot]);
    auto wide = g.interleaved(std::vector{scene.lights.at(0).wideShadow});
    const io::Image mapImage = io::readImage(scene.lights[0].shadowMapFile);
    auto map = mapImage.interleaved(std::vector{scene.lights[0].shadowMapChannel});
    PelLutInfo curvatureInfo = pelLutInfoDefaults(), shadowInfo = curvatureInfo;
    shadowInfo.kind = PEL_LUT_SHADOW;
    const auto curvature = readFloats(scratch + "/curvature"), shadow = readFloats(scratch + "/shadow");

    Stages s;
    auto last = std::chrono::steady_clock::now();
    const auto lap = [&] {
        const auto now = std::chrono::steady_clock::now();
        return std::chrono::duration<double, std::milli>(now - std::exchange(last, now)).count();
    };
    const Device device("");
    s.device = lap();
    const auto w = uint32_t(g.width), h = uint32_t(g.height), mapWidth = uint32_t(mapImage.width);
    const Lut curvatureLut(device, curvatureInfo, curvature),
        shadowLut(device, shadowInfo, shadow);
    Shader shader(device);
    std::vector<float> result(size_t(w) * h * 3, 0.0f);
    const Buffer target = shared(device, result);
    shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, w, h));
    for (int slot = 1; slot < PEL_SLOT_COUNT; ++slot)
        if (auto& image = images[slot]; !image.empty())
            shader.set(PelImageSlot(slot), imageDesc(shared(device, image), image.size() > size_t(w) * h ? PEL_FORMAT_RGB32F : PEL_FORMAT_R32F, w, h));
    shader.set(std::vector{scene.lights[0].light}).set(scene.camera).set(scene.ambient);
    shader.setMaterial(1, scene.materials.at(0).material, curvatureLut, shadowLut);
    shader.set(0, PEL_LIGHT_WIDE_SHADOW, imageDesc(shared(device, wide), PEL_FORMAT_R32F, w, h));
    shader.set(0, PEL_LIGHT_SHADOW_MAP, imageDesc(shared(device, map), PEL_FORMAT_R32F, mapWidth, mapWidth));
    s.upload = lap();
    shader.commit();
    s.commit = lap();
    shader.execute();
    s.execute = lap();
    shader.execute();
    shader.execute();
    lap();
    shader.execute();
    s.frame = lap();
    return s;
}

Stages inNewProcess() {
    FILE* pipe = popen(("'" + self + "' --once '" + scratch + "'").c_str(), "r");
    Stages s;
    const bool read = pipe && std::fscanf(pipe, "%lf %lf %lf %lf %lf", &s.device, &s.upload, &s.commit, &s.execute, &s.frame) == 5;
    if (!pipe || pclose(pipe) != 0 || !read) throw std::runtime_error("the process that measures a first frame failed");
    return s;
}

void firstFrame(benchmark::State& state, bool emptyCache) {
    inNewProcess();
    const char* before = std::getenv("POCL_CACHE_DIR");
    const std::string old = before ? before : "";
    Stages sum;
    int run = 0;
    for (auto _ : state) {
        const std::string cache = scratch + "/cache" + std::to_string(run++);
        if (emptyCache) {
            [[maybe_unused]] const int made = std::system(("mkdir '" + cache + "'").c_str());
            setenv("POCL_CACHE_DIR", cache.c_str(), 1);
        }
        const Stages s = inNewProcess();
        state.SetIterationTime(s.start() * 1e-3);
        sum.device += s.device, sum.upload += s.upload, sum.commit += s.commit, sum.execute += s.execute, sum.frame += s.frame;
    }
    before ? setenv("POCL_CACHE_DIR", old.c_str(), 1) : unsetenv("POCL_CACHE_DIR");
    using benchmark::Counter;
    for (auto [name, value] : {std::pair{"device_ms", sum.device}, {"upload_ms", sum.upload}, {"commit_ms", sum.commit},
                               {"execute_ms", sum.execute}, {"frame_ms", sum.frame}})
        state.counters[name] = Counter(value, Counter::kAvgIterations);
}

BENCHMARK_CAPTURE(firstFrame, warm, false)->Unit(benchmark::kMillisecond)->UseManualTime()->Iterations(9);
BENCHMARK_CAPTURE(firstFrame, emptyCache, true)->Unit(benchmark::kMillisecond)->UseManualTime()->Iterations(1);

void writeTable(const std::string& name, const Lut& lut) {
    const auto texels = lut.read<float>(PEL_LUT_FLOAT);
    std::ofstream(scratch + "/" + name, std::ios::binary)
        .write(reinterpret_cast<const char*>(texels.data()), std::streamsize(texels.size() * sizeof(float)));
}

}  // namespace

int main(int argc, char** argv) {
    self = argv[0];
    if (argc == 3 && std::strcmp(argv[1], "--once") == 0) {
        scratch = argv[2];
        const Stages s = measure();
        std::printf("%f %f %f %f %f\n", s.device, s.upload, s.commit, s.execute, s.frame);
        return 0;
    }
    if (!std::ifstream(demoDirectory() + "/key.toml")) {
        std::fprintf(stderr, "no demo views in %s: run ./run demo first\n", demoDirectory().c_str());
        return 0;
    }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    char folder[] = "/tmp/first_use_XXXXXX";
    scratch = mkdtemp(folder);
    {
        const Device device("");
        writeTable("curvature", Lut(device, pelCurvatureLutDescDefaults()));
        writeTable("shadow", Lut(device, pelShadowLutDescDefaults()));
    }
    benchmark::RunSpecifiedBenchmarks();
    return std::system(("rm -r '" + scratch + "'").c_str());
}
