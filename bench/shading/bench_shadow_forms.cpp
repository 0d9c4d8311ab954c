// What each form of shadow map costs, and how far its picture is from that of a plain depth map: the demo's key view, its
// wide shadow filtered here (24 texels across) and 32 thickness taps. Cases are wall clock of the whole frame.
//     bench_shadow_forms [--picture OUT.png] [--benchmark_...]
// Needs the views and the mesh of ./run demo (PELLUCID_DEMO_DIR, PELLUCID_DEMO_MESH).
#include <benchmark/benchmark.h>

#include <pellucid/pellucid.hpp>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <optional>

#include "demo_files.h"
#include "io/image/image_file.h"
#include "io/image/picture.h"
#include "io/image/tone_map.h"
#include "io/scene/scene_file.h"
#include "sample/shadow_forms.h"

using namespace pellucid;

namespace {

// Of the filter: half as many texels cost 4e-4 of radiance (docs/performance.md, "Passes before the shading kernel").
constexpr uint32_t texelsAcross = 24;

struct Map {
    PelLightSlot slot;
    uint32_t width, height, components;
    std::vector<float> texels;
};
struct Form {
    std::string name;
    PelLight light;
    std::vector<Map> maps;
    int reference;          // index of the form that it is compared with
    float radiusScale = 1;  // of the disk of taps in UV of its first map, against the reference's
};

struct View {
    Device device{""};
    io::SceneFile scene;
    io::Image gbuffer;
    Lut curvatureLut{device, pelCurvatureLutDescFaceWorks()}, shadowLut{device, pelShadowLutDescFaceWorks()};
    std::vector<Form> forms;
    uint32_t width = 0, height = 0;
};

struct Prepared {
    Shader shader;
    Buffer radiance, thickness;
    std::vector<Buffer> buffers;
};

Prepared prepare(const View& v, const Form& form, bool outputs, bool everyPixel = true) {
    const size_t pixels = size_t(v.width) * v.height;
    Prepared p{Shader(v.device), Buffer(v.device, pixels * 12), Buffer(v.device, pixels * 4), {}};
    p.shader.set(PEL_SLOT_RADIANCE, imageDesc(p.radiance, PEL_FORMAT_RGB32F, v.width, v.height));
    if (outputs)
        p.shader.set(PEL_SLOT_OUT_THICKNESS, imageDesc(p.thickness, PEL_FORMAT_R32F, v.width, v.height));
    const PelFormat formats[] = {PEL_FORMAT_UNDEFINED, PEL_FORMAT_R32F, PEL_FORMAT_RG32F, PEL_FORMAT_RGB32F};
    for (size_t slot = 0; slot < v.scene.channels.size(); ++slot) {
        const auto& names = v.scene.channels[slot];
        if (names.empty()) continue;
        p.buffers.emplace_back(v.device, v.gbuffer.interleaved(names));
        p.shader.set(PelImageSlot(slot), imageDesc(p.buffers.back(), formats[names.size()], v.width, v.height));
    }
    PelMaterial material = demo::withDeepScatter(v.scene.materials.at(0).material);
    material.thicknessFilterRadius *= form.radiusScale;
    p.shader.setMaterial(1, material, v.curvatureLut, v.shadowLut);
    p.shader.set(v.scene.ambient).set(v.scene.camera).set({form.light});
    for (const Map& map : form.maps) {
        p.buffers.emplace_back(v.device, map.texels);
        p.shader.set(0, map.slot, imageDesc(p.buffers.back(), formats[map.components], map.width, map.height));
    }
    PelShaderOptions options = pelShaderOptionsDefaults();
    options.everyPixel = everyPixel;
    p.shader.set(options).commit().execute();
    return p;
}

// Means of `step` x `step` texels of f(z), `components` of them.
template <class Function>
Map reduced(const Map& from, uint32_t step, uint32_t components, Function f) {
    Map to{from.slot, from.width / step, from.height / step, components, {}};
    for (uint32_t y = 0; y < to.height; ++y)
        for (uint32_t x = 0; x < to.width; ++x)
            for (uint32_t c = 0; c < components; ++c) {
                double sum = 0;
                for (uint32_t k = 0; k < step * step; ++k)
                    sum += f(double(from.texels[(y * step + k / step) * from.width + x * step + k % step]), c);
                to.texels.push_back(float(sum / (step * step)));
            }
    return to;
}

void addParallelForms(View& v, const io::Image& image, const std::string& channel) {
    PelLight light = v.scene.lights.at(0).light;
    light.shadowFilterTexels = texelsAcross;
    const auto size = uint32_t(image.width);
    const Map depth{PEL_LIGHT_SHADOW_MAP, size, size, 1, image.interleaved(std::vector{channel})};
    v.forms.push_back({"depth", light, {depth}, 0});

    // The middle of the map at full resolution, all of it at half.
    PelLight cascades = light;
    cascades.shadowCascades = 2;
    Map middle{PEL_LIGHT_SHADOW_MAP, size / 2, size / 2, 1, {}};
    for (uint32_t y = 0; y < size / 2; ++y)
        for (uint32_t x = 0; x < size / 2; ++x)
            middle.texels.push_back(depth.texels[(y + size / 4) * size + x + size / 4]);
    Map all = reduced(depth, 1, 1, [](double z, uint32_t) { return z; });
    all.slot = PEL_LIGHT_CASCADE_1;
    all.texels.clear();
    all.width = all.height = size / 2;
    for (uint32_t y = 0; y < size; y += 2)
        for (uint32_t x = 0; x < size; x += 2) all.texels.push_back(depth.texels[y * size + x]);
    std::memcpy(cascades.cascadeToShadow[0], light.worldToShadow, sizeof light.worldToShadow);
    // Texel 2 x of the map is texel x of the half: its centre lies half a texel of the map further left.
    cascades.cascadeToShadow[0][3] += 0.5f / float(size);
    cascades.cascadeToShadow[0][7] += 0.5f / float(size);
    cascades.cascadeDepthRange[0] = light.shadowDepthRange;
    for (int r = 0; r < 2; ++r)
        for (int c = 0; c < 4; ++c)
            cascades.worldToShadow[4 * r + c] = 2 * light.worldToShadow[4 * r + c] - (c == 3 ? 0.5f : 0.0f);
    v.forms.push_back({"2 cascades", cascades, {middle, all}, 0, 2});

    PelLight moments = light;
    moments.shadowContent = PEL_SHADOW_CONTENT_MOMENTS;
    v.forms.push_back(
        {"moments", moments, {reduced(depth, 1, 2, [](double z, uint32_t c) { return c ? z * z : z; })}, 0});
    v.forms.push_back({"moments of 2 x 2",
                       moments,
                       {reduced(depth, 2, 2, [](double z, uint32_t c) { return c ? z * z : z; })},
                       0});
    PelLight exponential = light;
    exponential.shadowContent = PEL_SHADOW_CONTENT_EXPONENTIAL;
    exponential.shadowExponent = 80;
    const auto e = [](double z, uint32_t) { return std::exp(80 * z); };
    v.forms.push_back({"exponential", exponential, {reduced(depth, 1, 1, e)}, 0});
    v.forms.push_back({"exponential of 2 x 2", exponential, {reduced(depth, 2, 1, e)}, 0});
}

void addLampForms(View& v, const sample::Scene& scene) {
    const sample::Vec3 centre = scene.bounds().centre();
    const float* to = v.scene.lights.at(0).light.toLight;
    const sample::Vec3 away = {to[0], to[1], to[2]}, lamp = centre + away * 320;
    PelLight light = v.scene.lights.at(0).light;
    light.type = PEL_LIGHT_POINT;
    light.shadowFilterTexels = texelsAcross;
    const double position[3] = {lamp.x, lamp.y, lamp.z};
    for (int c = 0; c < 3; ++c) light.position[c] = float(position[c]), light.color[c] *= 320.0f * 320;

    const sample::ShadowMap map = sample::renderShadowMap(scene, sample::SpotLight{lamp, -away, 45}, 1024);
    PelLight perspective = light;
    perspective.shadowProjection = PEL_SHADOW_PERSPECTIVE;
    const auto matrix = map.worldToUvz.toFloats();
    std::copy(matrix.begin(), matrix.end(), perspective.worldToShadow);
    perspective.shadowDepthA = float(map.depthA), perspective.shadowDepthB = float(map.depthB);
    const int reference = int(v.forms.size());
    v.forms.push_back(
        {"lamp, perspective", perspective, {{PEL_LIGHT_SHADOW_MAP, 1024, 1024, 1, map.depth}}, reference});

    const sample::CubeShadowMap cube = sample::renderCubeShadowMap(scene, lamp, 1024);
    PelLight faces = light;
    faces.shadowProjection = PEL_SHADOW_CUBE;
    const auto turn = cube.worldToCube.toFloats();
    std::copy(turn.begin(), turn.end(), faces.worldToShadow);
    faces.shadowDepthA = float(cube.depthA), faces.shadowDepthB = float(cube.depthB);
    v.forms.push_back({"lamp, cube", faces, {{PEL_LIGHT_SHADOW_MAP, 1024, 6 * 1024, 1, cube.depth}}, reference});
}

std::optional<View> readView() {
    const std::string folder = demo::directory(), mesh = demo::meshFile();
    if (!std::ifstream(folder + "/key.toml") || !std::ifstream(mesh)) return {};
    View v;
    v.scene = io::readScene(folder + "/key.toml");
    v.gbuffer = io::readImage(folder + "/key_gbuffer.exr");
    v.width = uint32_t(v.gbuffer.width), v.height = uint32_t(v.gbuffer.height);
    const io::Image depth = io::readImage(v.scene.lights.at(0).shadowMapFile);
    addParallelForms(v, depth, v.scene.lights[0].shadowMapChannel);
    const io::MeshData data = demo::head(mesh);
    const std::vector<float> curvature(data.positions.size() / 3);
    addLampForms(v, sample::Scene({data.positions, data.normals, data.uvs, curvature, data.triangles, {}}));
    return v;
}

// Differences from the form of reference at every pixel, over pixels of skin; `between`: of radiance from the same form at every pixel.
void measure(benchmark::State& state, const View& v, const Form& form, bool everyPixel) {
    const Prepared p = prepare(v, form, false, everyPixel), seen = prepare(v, form, true, everyPixel),
                   truth = prepare(v, v.forms[size_t(form.reference)], true);
    for (auto _ : state) p.shader.execute();
    const auto a = seen.radiance.readAll<float>(), b = truth.radiance.readAll<float>();
    const auto ta = seen.thickness.readAll<float>(), tb = truth.thickness.readAll<float>();
    const auto id = v.gbuffer.interleaved(v.scene.channels[PEL_SLOT_MATERIAL]);
    const auto every = prepare(v, form, false).radiance.readAll<float>();
    double mean = 0, worst = 0, square = 0, between = 0;
    size_t count = 0, thin = 0;
    for (size_t i = 0; i < id.size(); ++i) {
        if (id[i] != 1) continue;
        double d = 0;
        for (size_t c = 0; c < 3; ++c) {
            d = std::max(d, std::fabs(double(a[3 * i + c]) - b[3 * i + c]));
            between += std::pow(double(a[3 * i + c]) - every[3 * i + c], 2);
        }
        mean += d, worst = std::max(worst, d), ++count;
        if (tb[i] < 20) square += std::pow(double(ta[i]) - tb[i], 2), ++thin;
    }
    state.counters["between_rms"] = std::sqrt(between / double(3 * count));
    state.counters["radiance_mean"] = mean / double(count);
    state.counters["radiance_max"] = worst;
    state.counters["thickness_rms_mm"] = std::sqrt(square / double(std::max<size_t>(thin, 1)));
}

void writePicture(const View& v, const std::string& path) {
    std::vector<io::Tile> tiles;
    for (const char* name : {"depth", "2 cascades", "moments of 2 x 2", "exponential of 2 x 2",
                             "lamp, perspective", "lamp, cube"})
        for (const Form& form : v.forms) {
            if (form.name != name) continue;
            const auto bytes = io::toSrgb8(prepare(v, form, false).radiance.readAll<float>());
            const int left = int(v.width) / 4, width = int(v.width) / 2, height = int(v.height);
            io::Picture part(width, height);
            for (int y = 0; y < height; ++y)
                std::copy_n(&bytes[3 * (size_t(y) * v.width + size_t(left))], 3 * width,
                            &part.rgb[3 * size_t(y) * size_t(width)]);
            tiles.push_back({form.name, io::shrunk(part, 2)});
        }
    const io::Picture sheet = io::contactSheet(tiles, 3);
    io::writeImage8(path, sheet.width, sheet.height, 3, sheet.rgb);
}

}  // namespace

int main(int argc, char** argv) {
    std::string picture;
    for (int i = 1; i + 1 < argc; ++i)
        if (!std::strcmp(argv[i], "--picture")) {
            picture = argv[i + 1];
            for (int k = i; k + 2 <= argc; ++k) argv[k] = argv[k + 2];
            argc -= 2;
            break;
        }
    std::optional<View> view = readView();
    if (!view) {
        std::fprintf(
            stderr,
            "no demo views or mesh: run ./run demo first, or set PELLUCID_DEMO_DIR and PELLUCID_DEMO_MESH\n");
        return 0;
    }
    if (!picture.empty()) writePicture(*view, picture);
    for (const Form& form : view->forms)
        for (const bool everyPixel : {true, false})
            benchmark::RegisterBenchmark(
                ("forms/" + form.name + (everyPixel ? "/every pixel" : "")).c_str(),
                [&, everyPixel](benchmark::State& state) { measure(state, *view, form, everyPixel); })
                ->Unit(benchmark::kMillisecond)
                ->MeasureProcessCPUTime()
                ->UseRealTime();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
