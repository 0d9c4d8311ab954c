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

#include "baseline_shade.h"
#include "demo_files.h"
#include "io/image_file.h"
#include "io/scene_file.h"
#include "pack_images.h"

using namespace pellucid;
using baseline::Effort;
using baseline::ShadeFrame;
using baseline::ShadeSettings;
using baseline::ShadeTable;

namespace {

const Device& device() {
    static const Device device("");
    return device;
}

void append3(std::vector<float>& to, float x, float y, float z) {
    to.insert(to.end(), {x, y, z});
}

void appendUnit(std::vector<float>& to, float x, float y, float z) {
    const float length = std::sqrt(x * x + y * y + z * z);
    append3(to, x / length, y / length, z / length);
}

// Coverage: share of the rows, from the top, that are skin.
ShadeFrame foldedSkin(int width, int height, double coverage) {
    ShadeFrame f;
    f.width = width;
    f.height = height;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float a = 1.6f * std::sin(float(x) / 110), b = 1.2f * std::cos(float(y) / 85);
            f.id.push_back(y < int(std::lround(coverage * height)));
            append3(f.position, 0.1f * float(x - width / 2), 0.1f * float(height / 2 - y),
                    12 * std::sin(float(x + y) / 150));
            appendUnit(f.geometric, a, b, 1);
            appendUnit(f.shading, a + 0.1f * std::sin(float(x) / 3), b + 0.1f * std::sin(float(y) / 4), 1);
            appendUnit(f.blurred, 0.9f * a, 0.9f * b, 1);
            f.curvature.push_back(0.05f + 0.2f * float((x / 7 + y / 5) % 10) / 10);
            append3(f.albedo, 0.8f, 0.5f, 0.4f);
            f.wide.push_back(std::clamp(0.5f + 3 * std::sin(float(x - y) / 140), 0.0f, 1.0f));
        }
    return f;
}

ShadeFrame ball(int width, int height) {
    ShadeFrame f;
    f.width = width;
    f.height = height;
    const float radius = 0.45f * float(height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float px = (float(x) - 0.5f * float(width)) / radius,
                        py = (0.5f * float(height) - float(y)) / radius;
            const float r2 = px * px + py * py;
            const bool inside = r2 < 1;
            const float pz = inside ? std::sqrt(1 - r2) : 0;
            f.id.push_back(inside);
            append3(f.position, 110 * px, 110 * py, 110 * pz);
            appendUnit(f.geometric, px, py, pz + 1e-3f);
            appendUnit(f.shading, px + 0.05f * std::sin(float(x) / 3), py + 0.05f * std::sin(float(y) / 4),
                       pz + 1e-3f);
            appendUnit(f.blurred, px, py, pz + 1e-3f);
            f.curvature.push_back(1.0f / 110 + 0.1f * std::fabs(std::sin(float(x + y) / 40)));
            append3(f.albedo, 0.8f, 0.5f, 0.4f);
            f.wide.push_back(std::clamp(0.5f + 4 * (0.7f * px + 0.3f * py + 0.6f * pz), 0.0f, 1.0f));
        }
    return f;
}

void addShadowMap(ShadeFrame& f) {
    f.mapSize = 1024;
    for (int y = 0; y < 1024; ++y)
        for (int x = 0; x < 1024; ++x)
            f.map.push_back(0.42f + 0.05f * std::sin(float(x) / 60) * std::cos(float(y) / 50));
}

struct Scene {
    ShadeFrame frame;
    ShadeSettings settings{};
    ShadeTable curvature, shadow;
    Lut curvatureLut, shadowLut;
    PelLight light = pelLightDefaults();
    PelMaterial material = pelMaterialDefaults();
    PelAmbient ambient = pelAmbientDefaults();
    PelCamera camera = pelCameraDefaults();
    std::vector<float> out;
};

std::vector<float> readDisk(int taps) {
    std::ifstream file(PELLUCID_SOURCE_DIR "/kernels/lib/poisson_disk.clh");
    const std::string start = "pelDisk" + std::to_string(taps) + "[";
    std::vector<float> disk;
    for (std::string line; std::getline(file, line);)
        if (line.find(start) != std::string::npos)
            while (std::getline(file, line) && line[0] != '}') {
                float x = 0, y = 0;
                std::sscanf(line.c_str(), " (float2)(%ff, %ff)", &x, &y);
                disk.insert(disk.end(), {x, y});
            }
    return disk;
}

void describeScene(Scene& s, int taps) {
    const float toLight[3] = {0.8f, 0.36f, 0.48f}, camera[3] = {0, 0, 600};
    std::copy_n(toLight, 3, s.light.toLight);
    std::copy_n(camera, 3, s.camera.position);
    const float rows[16] = {0.004f, 0, 0, 0.5f, 0, 0.004f, 0, 0.5f, 0, 0, -0.004f, 0.5f, 0, 0, 0, 1};
    std::copy_n(rows, 16, s.light.worldToShadow);
    s.light.shadowDepthRange = 250;
    const float color[3] = {0.9f, 0.4f, 0.3f};
    if (taps) std::copy_n(color, 3, s.material.deepScatterColor);
    s.material.thicknessTaps = uint32_t(taps);
    s.material.specular = 0.8f;
    for (int i = 0; i < 9; ++i)
        for (int c = 0; c < 3; ++c) s.ambient.sh[i][c] = 0.3f / float(1 + i + c);
}

// A parallel camera along -z that sees `scale` of length a pixel, to the depth of `reach` on either side of the origin.
void describeCamera(Scene& s, float scale, float reach) {
    const float w = float(s.frame.width), h = float(s.frame.height);
    const float rows[16] = {0.5f * scale * w, 0, 0, -0.5f * scale, 0, 0.5f * scale * h, 0, 0.5f * scale,
                            0, 0, 2 * reach, -reach, 0, 0, 0, 1};
    std::copy_n(rows, 16, s.camera.inverseViewProjection);
}

// The baselines take their numbers from what the library is given.
void fillSettings(Scene& s) {
    ShadeSettings& b = s.settings;
    const int taps = int(s.material.thicknessTaps);
    std::copy_n(s.light.toLight, 3, b.toLight);
    std::copy_n(s.camera.position, 3, b.camera);
    std::copy_n(s.light.color, 3, b.light);
    std::copy_n(s.material.deepScatterColor, 3, b.deepScatter);
    std::copy_n(s.light.worldToShadow, 16, b.worldToShadow);
    const float one = 0.48860251f, two = 1.09254843f;
    const float factors[9] = {0.28209479f, one, one, one, two, two, 0.31539157f, two, 0.5f * two};
    for (int i = 0; i < 9; ++i)
        for (int c = 0; c < 3; ++c)
            b.ambient[i][c] = factors[i] * s.ambient.sh[i][c] + (i ? 0 : s.ambient.constant[c]);
    b.depthRange = s.light.shadowDepthRange;
    b.rowsCurvature[0] = 1 / (1 - 0.01f);
    b.rowsCurvature[1] = -0.01f / (1 - 0.01f);
    b.rowsShadow[0] = 1 / (1 / 8.0f - 0.01f);
    b.rowsShadow[1] = -0.01f / (1 / 8.0f - 0.01f);
    b.penumbraPerCosine = 1 / s.material.shadowFilterWidth;
    b.sharpening = 9;
    b.deepScatterRadius = s.material.deepScatterRadius;
    b.normalOffset = s.material.deepScatterNormalOffset;
    b.filterRadius = s.material.thicknessFilterRadius;
    b.taps = taps;
    b.specular = s.material.specular;
    b.roughness = s.material.roughness;
    b.f0 = s.material.f0;
    if (taps) b.disk = readDisk(taps);
}

void makeTables(Scene& s) {
    s.curvatureLut = Lut(device(), pelCurvatureLutDescDefaults());
    s.shadowLut = Lut(device(), pelShadowLutDescDefaults());
    s.curvature = {s.curvatureLut.read<float>(PEL_LUT_FLOAT), 512, 512};
    s.shadow = {s.shadowLut.read<float>(PEL_LUT_FLOAT), 512, 512};
    s.out.resize(s.frame.position.size());
}

std::unique_ptr<Scene> makeScene(ShadeFrame frame, int taps) {
    auto s = std::make_unique<Scene>();
    s->frame = std::move(frame);
    addShadowMap(s->frame);
    describeScene(*s, taps);
    fillSettings(*s);
    makeTables(*s);
    return s;
}

// A view as `pellucid demo` wrote it.
std::unique_ptr<Scene> readDemoView(const std::string& directory, const std::string& view) {
    const io::SceneFile file = io::readScene(directory + "/" + view + ".toml");
    const io::Image g = io::readImage(directory + "/" + view + "_gbuffer.exr");
    auto s = std::make_unique<Scene>();
    ShadeFrame& f = s->frame;
    f.width = g.width;
    f.height = g.height;
    const auto take = [&](PelImageSlot slot) { return g.interleaved(file.channels[slot]); };
    f.position = take(PEL_SLOT_POSITION);
    f.geometric = take(PEL_SLOT_NORMAL_GEOMETRIC);
    f.shading = take(PEL_SLOT_NORMAL_SHADING);
    f.blurred = take(PEL_SLOT_NORMAL_BLURRED);
    f.curvature = take(PEL_SLOT_CURVATURE);
    f.albedo = take(PEL_SLOT_ALBEDO);
    for (const float id : take(PEL_SLOT_MATERIAL)) f.id.push_back(id == 1.0f);
    f.wide = g.interleaved(std::vector{file.lights.at(0).wideShadow});
    const io::Image map = io::readImage(file.lights[0].shadowMapFile);
    f.map = map.interleaved(std::vector{file.lights[0].shadowMapChannel});
    f.mapSize = map.width;
    s->light = file.lights[0].light;
    s->material = file.materials.at(0).material;
    s->ambient = file.ambient;
    s->camera = file.camera;
    fillSettings(*s);
    makeTables(*s);
    return s;
}

enum View { full, head, key, backlit };

// view, taps, coverage in percent; taps and coverage of the demo's views are as they are.
Scene& scene(View view, int taps, int coverage = 100) {
    static std::map<std::tuple<int, int, int>, std::unique_ptr<Scene>> scenes;
    auto& slot = scenes[{view, taps, coverage}];
    if (slot) return *slot;
    if (view == full) {
        slot = makeScene(foldedSkin(1920, 1080, coverage / 100.0), taps);
        describeCamera(*slot, 0.1f, 12);
    } else if (view == head) {
        slot = makeScene(ball(1280, 720), taps);
        describeCamera(*slot, 110 / (0.45f * 720), 110);
    } else
        slot = readDemoView(demo::directory(), view == key ? "key" : "backlit");
    return *slot;
}

struct Prepared {
    Shader shader;
    Buffer target;
};

enum class Terms { scattering, lit, plain };
enum class Storage { float32, packed };
enum class Given { all, noBlurredNormal, noWideShadow };  // what the host does not give, the library makes

Prepared prepare(const Scene& s, uint32_t lights, Terms terms, Storage storage = Storage::float32, Given given = Given::all) {
    const auto w = uint32_t(s.frame.width), h = uint32_t(s.frame.height);
    const bool packed = storage == Storage::packed;
    Prepared p{Shader(device()), Buffer(device(), size_t(w) * h * 12)};
    const auto set = [&](PelImageSlot slot, const auto& image, PelFormat format) {
        p.shader.set(slot, imageDesc(Buffer(device(), image), format, w, h));
    };
    const auto setNormal = [&](PelImageSlot slot, const std::vector<float>& image) {
        packed ? set(slot, packing::octahedral(image), PEL_FORMAT_OCT16X2_SNORM) : set(slot, image, PEL_FORMAT_RGB32F);
    };
    p.shader.set(PEL_SLOT_RADIANCE, imageDesc(p.target, packed ? PEL_FORMAT_RGBA16F : PEL_FORMAT_RGB32F, w, h));
    set(PEL_SLOT_MATERIAL, s.frame.id, PEL_FORMAT_R8_UINT);
    setNormal(PEL_SLOT_NORMAL_SHADING, s.frame.shading);
    if (packed) {
        set(PEL_SLOT_DEPTH, packing::depths(s.frame.position, s.camera, s.frame.width, s.frame.height), PEL_FORMAT_R32F);
        set(PEL_SLOT_ALBEDO, packing::srgb8(s.frame.albedo), PEL_FORMAT_RGBA8_SRGB);
    } else {
        set(PEL_SLOT_POSITION, s.frame.position, PEL_FORMAT_RGB32F);
        set(PEL_SLOT_ALBEDO, s.frame.albedo, PEL_FORMAT_RGB32F);
    }
    std::vector<PelLight> all(lights, s.light);
    for (uint32_t i = 1; i < lights; ++i) std::swap(all[i].toLight[i % 3], all[i].toLight[(i + 1) % 3]);
    if (given == Given::noWideShadow) all[0].shadowFilterTexels = 48;
    p.shader.set(all).set(s.camera);
    if (terms != Terms::plain) {
        p.shader.set(s.ambient);
        const Buffer wide = packed ? Buffer(device(), packing::unorm8(s.frame.wide)) : Buffer(device(), s.frame.wide);
        for (uint32_t i = 0; i < lights; ++i)
            p.shader.set(i, PEL_LIGHT_WIDE_SHADOW, imageDesc(wide, packed ? PEL_FORMAT_R8_UNORM : PEL_FORMAT_R32F, w, h));
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
        PelShaderOptions options = pelShaderOptionsDefaults();
        options.blurNormals = 1;
        p.shader.set(options).clear(PEL_SLOT_NORMAL_BLURRED);
    }
    if (given == Given::noWideShadow) check(pelShaderSetLightImage(p.shader.get(), 0, PEL_LIGHT_WIDE_SHADOW, nullptr));
    p.shader.commit().execute();
    return p;
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
    compare(state, prepare(s, 1, Terms::scattering), s.out);
    perPixel(state, s.frame);
}

void port(benchmark::State& state, View view, int taps) {
    const Scene& s = scene(view, taps);
    void *context, *id, *queue;
    check(pelDeviceGetCl(device().get(), &context, &id, &queue));
    baseline::ShadePort naive(context, id, queue, s.frame, s.settings, s.curvature, s.shadow);
    naive.run();
    for (auto _ : state) naive.run();
    compare(state, prepare(s, 1, Terms::scattering), naive.result());
    perPixel(state, s.frame);
}

#define CASE(function, name, ...) \
    BENCHMARK_CAPTURE(function, name, __VA_ARGS__)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime()

#define OPEN_MP(name, ...)                                   \
    CASE(openMp, name, __VA_ARGS__, Effort::Straight);        \
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
            benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) { function(state, arguments...); })
                ->Unit(benchmark::kMillisecond)
                ->MeasureProcessCPUTime()
                ->UseRealTime();
        };
        const auto shadeLibrary = [](benchmark::State& state, auto... arguments) { library(state, arguments...); };
        for (const View view : {key, backlit}) {
            const std::string name = view == key ? "demo_key" : "demo_backlit";
            add("library/" + name, shadeLibrary, view, 32, 100, 1u, Terms::scattering);
            add("library/" + name + "_lit", shadeLibrary, view, 32, 100, 1u, Terms::lit);
            add("library/" + name + "_plain", shadeLibrary, view, 32, 100, 1u, Terms::plain);
            add("library/" + name + "_packed", shadeLibrary, view, 32, 100, 1u, Terms::scattering, Storage::packed);
            add("library/" + name + "_lit_packed", shadeLibrary, view, 32, 100, 1u, Terms::lit, Storage::packed);
            add("library/" + name + "_blur", shadeLibrary, view, 32, 100, 1u, Terms::scattering, Storage::float32, Given::noBlurredNormal);
            add("library/" + name + "_filter", shadeLibrary, view, 32, 100, 1u, Terms::scattering, Storage::float32, Given::noWideShadow);
            add("openMp/" + name, openMp, view, 32, Effort::Straight);
            add("openMp/" + name + "_skipping", openMp, view, 32, Effort::Skipping);
            add("port/" + name, port, view, 32);
        }
    } else {
        std::fprintf(stderr, "no demo views in %s: run ./run demo first to have them measured\n", demo::directory().c_str());
    }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
