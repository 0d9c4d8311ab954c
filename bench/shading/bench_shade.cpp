// The shading pass: against the scalar C++ loop and the straight OpenCL port, by feature, coverage and number
// of lights.
//
// Frames: `full` is a screen of folded skin, `head` a 1280 x 720 view of a ball that covers as much as the
// demo's head, `key` and `backlit` the two views of the demo, from where `pellucid demo` left them (out/demo, or
// PELLUCID_DEMO_DIR). `lit` is what a renderer without scattering shades there: Lambert with a plain shadow, ambient and
// specular; `plain` leaves out the shadow and the ambient light too. `packed`: the images in compact formats, 24 bytes a
// pixel read and 8 written, instead of float32.
#include <benchmark/benchmark.h>

#include <pellucid/pellucid.hpp>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>

#include "demo_files.h"
#include "pack_images.h"
#include "shade_frames.h"

using namespace pellucid;
using baseline::Effort;
using baseline::ShadeFrame;
using namespace frames;

namespace {

const Device& device() {
    static const Device device("");
    return device;
}

enum View { full, head, key, backlit };

// view, taps, coverage in percent; taps and coverage of the demo's views are as they are.
Scene& scene(View view, int taps, int coverage = 100) {
    static std::map<std::tuple<int, int, int>, std::unique_ptr<Scene>> scenes;
    auto& slot = scenes[{view, taps, coverage}];
    if (slot) return *slot;
    if (view == full) {
        slot = makeScene(device(), foldedSkin(1920, 1080, coverage / 100.0), taps);
        describeCamera(*slot, 0.1f, 12);
    } else if (view == head) {
        slot = makeScene(device(), ball(1280, 720), taps);
        describeCamera(*slot, 110 / (0.45f * 720), 110);
    } else
        slot = readDemoView(device(), demo::directory(), view == key ? "key" : "backlit");
    return *slot;
}

struct Prepared {
    Shader shader;
    Buffer target;
};

enum class Terms { scattering, lit, plain };
enum class Storage { float32, packed };
enum class Given { all, noBlurredNormal, noWideShadow };  // what the host does not give, the library makes

Prepared prepare(const Scene& s, uint32_t lights, Terms terms, Storage storage = Storage::float32,
                 Given given = Given::all, uint32_t filterTexels = 48, uint32_t everyPixel = 0) {
    const auto w = uint32_t(s.frame.width), h = uint32_t(s.frame.height);
    const bool packed = storage == Storage::packed;
    Prepared p{Shader(device()), Buffer(device(), size_t(w) * h * 12)};
    const auto set = [&](PelImageSlot slot, const auto& image, PelFormat format) {
        p.shader.set(slot, imageDesc(Buffer(device(), image), format, w, h));
    };
    const auto setNormal = [&](PelImageSlot slot, const std::vector<float>& image) {
        packed ? set(slot, packing::octahedral(image), PEL_FORMAT_OCT16X2_SNORM)
               : set(slot, image, PEL_FORMAT_RGB32F);
    };
    p.shader.set(PEL_SLOT_RADIANCE, imageDesc(p.target, packed ? PEL_FORMAT_RGBA16F : PEL_FORMAT_RGB32F, w, h));
    set(PEL_SLOT_MATERIAL, s.frame.id, PEL_FORMAT_R8_UINT);
    setNormal(PEL_SLOT_NORMAL_SHADING, s.frame.shading);
    if (packed) {
        set(PEL_SLOT_DEPTH, packing::depths(s.frame.position, s.camera, s.frame.width, s.frame.height),
            PEL_FORMAT_R32F);
        set(PEL_SLOT_ALBEDO, packing::srgb8(s.frame.albedo), PEL_FORMAT_RGBA8_SRGB);
    } else {
        set(PEL_SLOT_POSITION, s.frame.position, PEL_FORMAT_RGB32F);
        set(PEL_SLOT_ALBEDO, s.frame.albedo, PEL_FORMAT_RGB32F);
    }
    std::vector<PelLight> all(lights, s.light);
    for (uint32_t i = 1; i < lights; ++i) std::swap(all[i].toLight[i % 3], all[i].toLight[(i + 1) % 3]);
    if (given == Given::noWideShadow) all[0].shadowFilterTexels = filterTexels;
    p.shader.set(all).set(s.camera);
    if (terms != Terms::plain) {
        p.shader.set(s.ambient);
        const Buffer wide =
            packed ? Buffer(device(), packing::unorm8(s.frame.wide)) : Buffer(device(), s.frame.wide);
        for (uint32_t i = 0; i < lights; ++i)
            p.shader.set(i, PEL_LIGHT_WIDE_SHADOW,
                         imageDesc(wide, packed ? PEL_FORMAT_R8_UNORM : PEL_FORMAT_R32F, w, h));
    }
    PelMaterial material = s.material;
    if (terms != Terms::scattering) {
        std::fill_n(material.deepScatterColor, 3, 0.0f);
        p.shader.setMaterial(1, material);
    } else {
        setNormal(PEL_SLOT_NORMAL_GEOMETRIC, s.frame.geometric);
        setNormal(PEL_SLOT_NORMAL_BLURRED, s.frame.blurred);
        packed ? set(PEL_SLOT_CURVATURE, packing::halves(s.frame.curvature), PEL_FORMAT_R16F)
               : set(PEL_SLOT_CURVATURE, s.frame.curvature, PEL_FORMAT_R32F);
        p.shader.setMaterial(1, material, s.curvatureLut, s.shadowLut);
        const Buffer map(device(), s.frame.map);
        const auto size = uint32_t(s.frame.mapSize);
        for (uint32_t i = 0; i < lights; ++i)
            p.shader.set(i, PEL_LIGHT_SHADOW_MAP, imageDesc(map, PEL_FORMAT_R32F, size, size));
    }
    if (given == Given::noBlurredNormal) {
        p.shader.clear(PEL_SLOT_NORMAL_BLURRED);
    }
    PelShaderOptions options = pelShaderOptionsDefaults();
    options.blurNormals = given == Given::noBlurredNormal;
    options.everyPixel = everyPixel;
    p.shader.set(options);
    if (given == Given::noWideShadow)
        check(pelShaderSetLightImage(p.shader.get(), 0, PEL_LIGHT_WIDE_SHADOW, nullptr));
    p.shader.commit().execute();
    return p;
}

// As the baselines compute it: each pixel by taps of its own.
Prepared prepareExact(const Scene& s) {
    return prepare(s, 1, Terms::scattering, Storage::float32, Given::all, 48, 1);
}

void perPixel(benchmark::State& state, const ShadeFrame& f) {
    const double pixels = double(std::count(f.id.begin(), f.id.end(), 1));
    state.counters["ns_per_skin_pixel"] = benchmark::Counter(
        pixels * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// Largest difference in brightness between the library and a baseline: they must compute the same.
void compare(benchmark::State& state, const Prepared& p, const std::vector<float>& other) {
    const auto ours = p.target.readAll<float>();
    float worst = 0;
    for (size_t i = 0; i < ours.size(); ++i) worst = std::max(worst, std::fabs(ours[i] - other[i]));
    state.counters["max_difference"] = worst;
}

void library(benchmark::State& state, View view, int taps, int coverage, uint32_t lights, Terms terms,
             Storage storage = Storage::float32, Given given = Given::all) {
    const Scene& s = scene(view, taps, coverage);
    const Prepared p = prepare(s, lights, terms, storage, given);
    for (auto _ : state) p.shader.execute();
    perPixel(state, s.frame);
}

// The wide shadow filtered from the shadow map by at most so many texels across, and how far radiance is from that by all texels: root
// mean square over pixels of skin.
void wideShadow(benchmark::State& state, View view, uint32_t filterTexels, uint32_t everyPixel) {
    const Scene& s = scene(view, 32);
    const Prepared p =
        prepare(s, 1, Terms::scattering, Storage::float32, Given::noWideShadow, filterTexels, everyPixel);
    for (auto _ : state) p.shader.execute();
    constexpr uint32_t allTexels = 256;
    const auto exact = prepare(s, 1, Terms::scattering, Storage::float32, Given::noWideShadow, allTexels, 1)
                           .target.readAll<float>();
    const auto shown = p.target.readAll<float>();
    double sum = 0, count = 0;
    for (size_t i = 0; i < shown.size(); ++i)
        if (s.frame.id[i / 3] == 1) sum += std::pow(double(shown[i]) - exact[i], 2), count += 1;
    state.counters["radiance_rms"] = std::sqrt(sum / count);
    perPixel(state, s.frame);
    PelShaderOptions options = pelShaderOptionsDefaults();
    options.everyPixel = everyPixel;
    options.countPixels = 1;
    Shader counting = p.shader;
    counting.set(options).commit().execute();
    const PelShaderStats stats = counting.stats();
    state.counters["filtered"] = double(stats.pixelsWideShadow) / double(stats.pixelsShaded);
    state.counters["read"] = double(stats.pixelsShadowTexels) / double(stats.pixelsShaded);
}

// Ambient light from a cube map of `size` texels along an edge in place of harmonics.
void libraryCube(benchmark::State& state, View view, uint32_t size) {
    const Scene& s = scene(view, 0);
    Prepared p = prepare(s, 1, Terms::scattering);
    std::vector<float> texels(size_t(18) * size * size);
    for (size_t i = 0; i < texels.size(); ++i) texels[i] = 0.5f + 0.3f * std::sin(float(i % 1000));
    p.shader.set(pelAmbientDefaults());
    p.shader.setAmbientCube(imageDesc(Buffer(device(), texels), PEL_FORMAT_RGB32F, size, 6 * size)).commit();
    for (auto _ : state) p.shader.execute();
    perPixel(state, s.frame);
}

void openMp(benchmark::State& state, View view, int taps, Effort effort) {
    Scene& s = scene(view, taps);
    for (auto _ : state) baseline::shadeOpenMp(s.frame, s.settings, s.curvature, s.shadow, effort, s.out);
    compare(state, prepareExact(s), s.out);
    perPixel(state, s.frame);
}

void port(benchmark::State& state, View view, int taps) {
    const Scene& s = scene(view, taps);
    void *context, *id, *queue;
    check(pelDeviceGetCl(device().get(), &context, &id, &queue));
    baseline::ShadePort naive(context, id, queue, s.frame, s.settings, s.curvature, s.shadow);
    naive.run();
    for (auto _ : state) naive.run();
    compare(state, prepareExact(s), naive.result());
    perPixel(state, s.frame);
}

#define CASE(function, name, ...) \
    BENCHMARK_CAPTURE(function, name, __VA_ARGS__)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime()

#define OPEN_MP(name, ...)                             \
    CASE(openMp, name, __VA_ARGS__, Effort::Straight); \
    CASE(openMp, name##_skipping, __VA_ARGS__, Effort::Skipping)

CASE(library, full_surface, full, 0, 100, 1u, Terms::scattering);
CASE(libraryCube, full_surface_32, full, 32u);
CASE(port, full_surface, full, 0);
OPEN_MP(full_surface, full, 0);
CASE(library, full_32taps, full, 32, 100, 1u, Terms::scattering);
CASE(port, full_32taps, full, 32);
OPEN_MP(full_32taps, full, 32);
CASE(library, full_lit, full, 0, 100, 1u, Terms::lit);
CASE(library, full_plain, full, 0, 100, 1u, Terms::plain);
CASE(library, full_surface_packed, full, 0, 100, 1u, Terms::scattering, Storage::packed);
CASE(library, full_32taps_packed, full, 32, 100, 1u, Terms::scattering, Storage::packed);
CASE(library, full_lit_packed, full, 0, 100, 1u, Terms::lit, Storage::packed);
CASE(library, full_coverage10, full, 32, 10, 1u, Terms::scattering);
CASE(library, full_coverage0, full, 32, 0, 1u, Terms::scattering);
CASE(library, full_32taps_4lights, full, 32, 100, 4u, Terms::scattering);
CASE(library, full_surface_4lights, full, 0, 100, 4u, Terms::scattering);
CASE(library, head_plain, head, 0, 100, 1u, Terms::plain);
CASE(library, head_lit, head, 0, 100, 1u, Terms::lit);
CASE(library, head_surface, head, 0, 100, 1u, Terms::scattering);
CASE(library, head_8taps, head, 8, 100, 1u, Terms::scattering);
CASE(library, head_32taps, head, 32, 100, 1u, Terms::scattering);
OPEN_MP(head_32taps, head, 32);
CASE(port, head_32taps, head, 32);

}  // namespace

int main(int argc, char** argv) {
    if (std::ifstream(demo::directory() + "/key.toml")) {
        const auto add = [](const std::string& name, auto function, auto... arguments) {
            benchmark::RegisterBenchmark(name.c_str(),
                                         [=](benchmark::State& state) { function(state, arguments...); })
                ->Unit(benchmark::kMillisecond)
                ->MeasureProcessCPUTime()
                ->UseRealTime();
        };
        const auto shadeLibrary = [](benchmark::State& state, auto... arguments) {
            library(state, arguments...);
        };
        for (const View view : {key, backlit}) {
            const std::string name = view == key ? "demo_key" : "demo_backlit";
            add("library/" + name, shadeLibrary, view, 32, 100, 1u, Terms::scattering);
            add("library/" + name + "_lit", shadeLibrary, view, 32, 100, 1u, Terms::lit);
            add("library/" + name + "_plain", shadeLibrary, view, 32, 100, 1u, Terms::plain);
            add("library/" + name + "_packed", shadeLibrary, view, 32, 100, 1u, Terms::scattering,
                Storage::packed);
            add("library/" + name + "_lit_packed", shadeLibrary, view, 32, 100, 1u, Terms::lit, Storage::packed);
            add("library/" + name + "_blur", shadeLibrary, view, 32, 100, 1u, Terms::scattering,
                Storage::float32, Given::noBlurredNormal);
            for (const uint32_t every : {1, 0})
                for (const uint32_t texels : {256, 48, 24, 16, 12, 8})
                    add("wideShadow/" + name + "/texels:" + std::to_string(texels) + (every ? "/every_pixel" : ""),
                        wideShadow, view, texels, every);
            add("openMp/" + name, openMp, view, 32, Effort::Straight);
            add("openMp/" + name + "_skipping", openMp, view, 32, Effort::Skipping);
            add("port/" + name, port, view, 32);
        }
    } else {
        std::fprintf(stderr, "no demo views in %s: run ./run demo first to have them measured\n",
                     demo::directory().c_str());
    }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
