// The shading pass against the scalar C++ loop, by feature, coverage, size, lights and tile lists.
//
// Frames: `full` is a screen of folded skin, `demo_key` and `demo_backlit` are the views that `pellucid demo`
// left in out/demo or PELLUCID_DEMO_DIR. `lit` is what a renderer without scattering shades there: Lambert
// with a plain shadow, ambient and specular light; `plain` leaves out the shadow and the ambient light too.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>

#include "baselines.h"
#include "benchmarks.h"
#include "io/image/image_file.h"
#include "io/scene/scene_file.h"

using namespace pellucid;
using namespace pellucid::bench;

namespace benchmarks {
namespace {

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
        state.counters["tiles"] = double(shader.stats().tilesShaded);
    };
}

// The same settings against a filter of all texels at every pixel: root mean square of radiance over pixels
// of skin.
Run wideShadow(const std::string& view, FrameSettings settings) {
    return [=](benchmark::State& state) {
        const Frame& f = frame(view);
        const Shader shader = f.shader(settings);
        time(state, [&] { shader.execute(); });
        const std::vector<float> shown = f.target().readAll<float>();
        FrameSettings exact = settings;
        exact.filterTexels = 256, exact.everyPixel = true;
        f.shader(exact).execute();
        const std::vector<float> wanted = f.target().readAll<float>();
        double sum = 0, count = 0;
        for (size_t i = 0; i < shown.size(); ++i)
            if (f.images().id[i / 3] == 1) sum += std::pow(double(shown[i]) - wanted[i], 2), count += 1;
        state.counters["radiance_rms"] = std::sqrt(sum / count);
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

// Discs on a grid, so that tiles of every kind lie side by side; `share` of the area is `inside`, the rest
// `outside`.
std::vector<uint8_t> discs(double share, uint8_t inside, uint8_t outside) {
    std::vector<uint8_t> ids;
    const double cell = 540, radius = share >= 1 ? cell : cell * std::sqrt(share / M_PI);
    for (uint32_t y = 0; y < 1080; ++y)
        for (uint32_t x = 0; x < 1920; ++x)
            ids.push_back(std::hypot(std::fmod(x, cell) - cell / 2, std::fmod(y, cell) - cell / 2) < radius
                              ? inside
                              : outside);
    return ids;
}

void addTiles() {
    for (const int percent : {0, 10, 50, 90, 100}) {
        const std::string share = "/" + std::to_string(percent) + "_percent";
        const auto settings = [&](uint32_t taps, uint8_t outside, PelTileLists lists) {
            return FrameSettings{.taps = taps, .ids = discs(percent / 100.0, 1, outside), .tileLists = lists};
        };
        add("mixed/per_variant" + share + "_skin", library("1920", settings(32, 2, PEL_TILES_PER_VARIANT)));
        add("mixed/one_list" + share + "_skin", library("1920", settings(32, 2, PEL_TILES_ONE_LIST)));
        add("coverage/compacted_list" + share, library("1920", settings(0, 0, PEL_TILES_ONE_LIST)));
        add("coverage/early_out" + share, library("1920", settings(0, 0, PEL_TILES_NO_LIST)));
    }
}

void addDemoViews() {
    for (const std::string& view : demoViews) {
        const std::string name = "demo_" + view;
        add("library/" + name, library(view, {.taps = 32}));
        add("library/" + name + "_lit", library(view, {.terms = Terms::lit}));
        add("library/" + name + "_plain", library(view, {.terms = Terms::plain}));
        add("library/" + name + "_blur", library(view, {.taps = 32, .blurNormals = true}));
        for (const bool every : {true, false})
            for (const uint32_t texels : {256, 48, 24, 16, 12, 8})
                add("wideShadow/" + name + "/texels:" + std::to_string(texels) +
                        (every ? "/every_pixel" : ""),
                    wideShadow(view, {.taps = 32, .filterTexels = texels, .everyPixel = every}));
        addOpenMp(name, view, 32);
    }
}

}  // namespace

void addShading() {
    const struct {
        const char* name;
        FrameSettings settings;
    } features[] = {{"full_surface", {}},
                    {"full_32taps", {.taps = 32}},
                    {"full_lit", {.terms = Terms::lit}},
                    {"full_plain", {.terms = Terms::plain}},
                    {"full_coverage10", {.taps = 32, .ids = discs(0.1, 1, 0)}},
                    {"full_coverage0", {.taps = 32, .ids = discs(0, 1, 0)}},
                    {"full_32taps_4lights", {.taps = 32, .lights = 4}},
                    {"full_surface_4lights", {.lights = 4}}};
    for (const auto& [name, settings] : features)
        add(std::string("library/") + name, library("1920", settings));
    addOpenMp("full_surface", "1920", 0);
    addOpenMp("full_32taps", "1920", 32);
    addTiles();
    for (const uint32_t width : {1280, 1920, 3840, 7680})
        add("pixels/width:" + std::to_string(width) + "/lights:1", pixels(width, 1));
    for (const uint32_t lights : {2, 4, 16, 64})
        add("pixels/width:1280/lights:" + std::to_string(lights), pixels(1280, lights));
    if (std::ifstream(demoFolder() + "/key.toml"))
        addDemoViews();
    else
        std::fprintf(stderr, "no demo views in %s: ./run demo makes them\n", demoFolder().c_str());
}

}  // namespace benchmarks
