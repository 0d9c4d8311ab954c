// What lists of tiles save (docs/guide/shading.md, "Tiles"): 1920 x 1080 pixels of which a part has a material, and frames of two
// materials, skin with everything and one that is plain, by PelShaderOptions.tileLists.
#include <benchmark/benchmark.h>

#include <pellucid/pellucid.hpp>

#include <cmath>
#include <map>

using namespace pellucid;

namespace {

constexpr uint32_t width = 1920, height = 1080;

const Device& device() {
    static const Device device("");
    return device;
}

struct Images {
    std::vector<float> position, geometric, shading, blurred, curvature, albedo, wide, map;
    Images() {
        const auto unit = [](std::vector<float>& to, float x, float y, float z) {
            const float length = std::sqrt(x * x + y * y + z * z);
            to.insert(to.end(), {x / length, y / length, z / length});
        };
        for (int y = 0; y < int(height); ++y)
            for (int x = 0; x < int(width); ++x) {
                const float a = 1.6f * std::sin(float(x) / 110), b = 1.2f * std::cos(float(y) / 85);
                position.insert(position.end(), {0.1f * float(x - 960), 0.1f * float(540 - y),
                                                 12 * std::sin(float(x + y) / 150)});
                unit(geometric, a, b, 1);
                unit(shading, a + 0.1f * std::sin(float(x) / 3), b + 0.1f * std::sin(float(y) / 4), 1);
                unit(blurred, 0.9f * a, 0.9f * b, 1);
                curvature.push_back(0.05f + 0.2f * float((x / 7 + y / 5) % 10) / 10);
                albedo.insert(albedo.end(), {0.8f, 0.5f, 0.4f});
                wide.push_back(std::clamp(0.5f + 3 * std::sin(float(x - y) / 140), 0.0f, 1.0f));
            }
        for (int y = 0; y < 1024; ++y)
            for (int x = 0; x < 1024; ++x)
                map.push_back(0.42f + 0.05f * std::sin(float(x) / 60) * std::cos(float(y) / 50));
    }
};

const Images& images() {
    static const Images all;
    return all;
}

// Discs on a grid, so that tiles of every kind lie side by side; `share` of the area is `inside`, the rest `outside`.
std::vector<uint8_t> discs(double share, uint8_t inside, uint8_t outside) {
    std::vector<uint8_t> ids;
    const double cell = 540, radius = share >= 1 ? cell : cell * std::sqrt(share / 3.14159265358979323846);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            ids.push_back(std::hypot(std::fmod(x, cell) - cell / 2, std::fmod(y, cell) - cell / 2) < radius
                              ? inside
                              : outside);
    return ids;
}

// All cases read the same memory: its place in pages changes the time, too.
const Buffer& onDevice(const std::vector<float>& image) {
    static std::map<const float*, Buffer> buffers;
    Buffer& buffer = buffers[image.data()];
    if (!buffer) buffer = Buffer(device(), image);
    return buffer;
}

// `skin`, `plain`: which materials there are, 1 and 2; `taps`: of skin.
Shader prepare(const std::vector<uint8_t>& ids, bool skin, bool plain, PelTileLists lists, uint32_t taps = 32) {
    Shader shader(device());
    const Images& all = images();
    const auto set = [&](PelImageSlot slot, const std::vector<float>& image, PelFormat format) {
        shader.set(slot, imageDesc(onDevice(image), format, width, height));
    };
    static const Buffer target(device(), size_t(width) * height * 12);
    shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, width, height));
    shader.set(PEL_SLOT_MATERIAL, imageDesc(Buffer(device(), ids), PEL_FORMAT_R8_UINT, width, height));
    set(PEL_SLOT_POSITION, all.position, PEL_FORMAT_RGB32F);
    set(PEL_SLOT_NORMAL_SHADING, all.shading, PEL_FORMAT_RGB32F);
    set(PEL_SLOT_ALBEDO, all.albedo, PEL_FORMAT_RGB32F);
    set(PEL_SLOT_NORMAL_GEOMETRIC, all.geometric, PEL_FORMAT_RGB32F);
    set(PEL_SLOT_NORMAL_BLURRED, all.blurred, PEL_FORMAT_RGB32F);
    set(PEL_SLOT_CURVATURE, all.curvature, PEL_FORMAT_R32F);
    PelLight light = pelLightDefaults();
    const float toLight[3] = {0.8f, 0.36f, 0.48f};
    const float rows[16] = {0.004f, 0, 0, 0.5f, 0, 0.004f, 0, 0.5f, 0, 0, -0.004f, 0.5f, 0, 0, 0, 1};
    std::copy_n(toLight, 3, light.toLight);
    std::copy_n(rows, 16, light.worldToShadow);
    light.shadowDepthRange = 250;
    shader.set(std::vector{light});
    shader.set(0, PEL_LIGHT_WIDE_SHADOW, imageDesc(onDevice(all.wide), PEL_FORMAT_R32F, width, height));
    shader.set(0, PEL_LIGHT_SHADOW_MAP, imageDesc(onDevice(all.map), PEL_FORMAT_R32F, 1024, 1024));
    PelAmbient ambient = pelAmbientDefaults();
    for (int i = 0; i < 9; ++i)
        for (int c = 0; c < 3; ++c) ambient.sh[i][c] = 0.3f / float(1 + i + c);
    PelCamera camera = pelCameraDefaults();
    camera.position[2] = 600;
    shader.set(ambient).set(camera);
    PelShaderOptions options = pelShaderOptionsDefaults();
    options.tileLists = lists;
    shader.set(options);
    static const Lut curvature(device(), pelCurvatureLutDescFaceWorks()),
        shadow(device(), pelShadowLutDescFaceWorks());
    PelMaterial material = pelMaterialDefaults();
    material.specular = 0.8f;
    if (plain) shader.setMaterial(2, material);
    const float color[3] = {0.9f, 0.4f, 0.3f};
    if (taps) std::copy_n(color, 3, material.deepScatterColor);
    material.thicknessTaps = taps;
    if (skin) shader.setMaterial(1, material, curvature, shadow);
    return std::move(shader.commit());
}

void report(benchmark::State& state, const Shader& shader) {
    const PelShaderStats stats = shader.stats();
    state.counters["tiles"] = double(stats.tilesShaded);
    state.counters["partial"] = double(stats.tilesPartial);
    state.counters["launches"] = double(stats.launches);
}

// Skin on `share` of the area, a plain material on the rest.
void mixed(benchmark::State& state, double share, PelTileLists lists) {
    const Shader shader = prepare(discs(share, 1, 2), true, true, lists);
    shader.execute();
    for (auto _ : state) shader.execute();
    report(state, shader);
}

// Skin on `share` of the area, nothing on the rest.
void coverage(benchmark::State& state, double share, PelTileLists lists) {
    const Shader shader = prepare(discs(share, 1, 0), true, false, lists, 0);
    shader.execute();
    for (auto _ : state) shader.execute();
    report(state, shader);
}

}  // namespace

int main(int argc, char** argv) {
    const auto add = [](const std::string& name, auto function, auto... arguments) {
        benchmark::RegisterBenchmark(name.c_str(), function, arguments...)
            ->Unit(benchmark::kMillisecond)
            ->MeasureProcessCPUTime()
            ->UseRealTime();
    };
    for (const int percent : {0, 10, 50, 90, 100}) {
        const std::string share = "/" + std::to_string(percent) + "_percent_skin";
        add("mixed/per_variant" + share, mixed, percent / 100.0, PEL_TILES_PER_VARIANT);
        add("mixed/one_list" + share, mixed, percent / 100.0, PEL_TILES_ONE_LIST);
    }
    for (const int percent : {0, 10, 50, 100}) {
        const std::string share = "/" + std::to_string(percent) + "_percent";
        add("coverage/compacted_list" + share, coverage, percent / 100.0, PEL_TILES_ONE_LIST);
        add("coverage/early_out" + share, coverage, percent / 100.0, PEL_TILES_NO_LIST);
    }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
