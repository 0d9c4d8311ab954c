// What scattering "auto" costs on the demo's key view, against the pre-integrated pass of FaceWorks' preset
// that filters its own wide shadow: both from a G-buffer and a plain shadow map, one after the other in one
// run.
//
// sweep_auto_time [REPEATS, 15] [WAY]
//
// Its wide shadow is filtered twice: as the pass does it by default, and at every pixel over all of its
// texels. WAY: only those whose names have this in them. Medians of wall clock and of the kernels' time;
// pixels that were scattered and that were left as they are, and taps for each of the former. `pellucid
// demo -o out/demo` comes first (or PELLUCID_DEMO_DIR).
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "demo_files.h"
#include "shading/shade_frames.h"

using namespace pellucid;
using namespace frames;

namespace {

struct Way {
    const char* name;
    bool faceworks;
    bool exact;  // the wide shadow, at every pixel
    PelScattering scattering;
    Shader shader;
    std::vector<double> wall, device;
};

const Buffer& target(const Device& device, const Scene& s) {
    static const Buffer buffer(device, s.frame.position.size() * sizeof(float));
    return buffer;
}

void prepare(const Device& device, const Scene& s, Way& way) {
    const auto w = uint32_t(s.frame.width), h = uint32_t(s.frame.height);
    way.shader = Shader(device);
    const auto set = [&](PelImageSlot slot, const auto& image, PelFormat format) {
        way.shader.set(slot, imageDesc(Buffer(device, image), format, w, h));
    };
    way.shader.set(PEL_SLOT_RADIANCE, imageDesc(target(device, s), PEL_FORMAT_RGB32F, w, h));
    set(PEL_SLOT_MATERIAL, s.frame.id, PEL_FORMAT_R8_UINT);
    set(PEL_SLOT_NORMAL_SHADING, s.frame.shading, PEL_FORMAT_RGB32F);
    set(PEL_SLOT_NORMAL_GEOMETRIC, s.frame.geometric, PEL_FORMAT_RGB32F);
    set(PEL_SLOT_POSITION, s.frame.position, PEL_FORMAT_RGB32F);
    set(PEL_SLOT_ALBEDO, s.frame.albedo, PEL_FORMAT_RGB32F);
    set(PEL_SLOT_NORMAL_BLURRED, s.frame.blurred, PEL_FORMAT_RGB32F);
    set(PEL_SLOT_CURVATURE, s.frame.curvature, PEL_FORMAT_R32F);
    PelLight light = s.light;
    light.shadowFilterTexels = way.exact ? 256 : 48;
    PelShaderOptions options = pelShaderOptionsDefaults();
    options.everyPixel = way.exact;
    way.shader.set(options);
    way.shader.set(std::vector<PelLight>{light}).set(s.camera).set(s.ambient);
    way.shader.set(0, PEL_LIGHT_SHADOW_MAP,
                   imageDesc(Buffer(device, s.frame.map), PEL_FORMAT_R32F, uint32_t(s.frame.mapSize),
                             uint32_t(s.frame.mapSize)));
    const Profile skin = Profile::skin();
    PelMaterial material = way.faceworks ? fixture::faceworksMaterial() : pelMaterialDefaults();
    material.specular = s.material.specular;
    material.scattering = way.scattering;
    if (!way.faceworks) material.profile = skin.get();
    way.shader.setMaterial(1, material, way.faceworks ? s.curvatureLut : Lut(),
                           way.faceworks ? s.shadowLut : Lut());
    way.shader.commit().execute();
}

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + long(values.size() / 2), values.end());
    return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
    const int repeats = argc > 1 ? std::atoi(argv[1]) : 15;
    const Device device("");
    const auto scene = readDemoView(device, demo::directory(), "key");
    const std::string only = argc > 2 ? argv[2] : "";
    std::vector<Way> ways;
    const auto add = [&](const char* name, bool faceworks, bool exact, PelScattering scattering) {
        if (std::string(name).find(only) != std::string::npos)
            ways.push_back({name, faceworks, exact, scattering, {}, {}, {}});
    };
    add("faceworks, wide shadow", true, false, PEL_SCATTERING_PREINTEGRATED);
    add("faceworks, every pixel", true, true, PEL_SCATTERING_PREINTEGRATED);
    add("pre-integrated", false, false, PEL_SCATTERING_PREINTEGRATED);
    add("none, sharp shadow", false, false, PEL_SCATTERING_NONE);
    add("screen", false, false, PEL_SCATTERING_SCREEN);
    add("auto", false, false, PEL_SCATTERING_AUTO);
    for (Way& way : ways) prepare(device, *scene, way);
    for (int i = 0; i < repeats; ++i)
        for (Way& way : ways) {
            const auto start = std::chrono::steady_clock::now();
            way.shader.execute();
            way.wall.push_back(
                std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
            way.device.push_back(way.shader.stats().deviceMilliseconds);
        }
    std::printf("%-24s %10s %10s %8s %10s %10s %8s\n", "", "wall ms", "kernels ms", "ratio", "scattered",
                "kept", "taps");
    for (const Way& way : ways) {
        const PelShaderStats stats = way.shader.stats();
        std::printf("%-24s %10.2f %10.2f %8.3f %10llu %10llu %8.1f\n", way.name, median(way.wall),
                    median(way.device), median(way.device) / median(ways[0].device),
                    (unsigned long long)stats.pixelsScattered, (unsigned long long)stats.pixelsKept,
                    double(stats.scatterTaps) / double(std::max<uint64_t>(stats.pixelsScattered, 1)));
    }
    return 0;
}
