// Run time against error of whole methods: every way to scatter, over its settings, on one scene, against the
// surface integral.
//
//   sweep_error_time SCENE SCALE [PIXELS] [REPEATS] [PICTURES] [METHOD] [HEAD.obj]
//
// prints JSON lines of all methods, or of one. SCENE is side, ear or sphere; SCALE multiplies the profile's
// radius; a picture has PIXELS a side, 512. Into the folder PICTURES, if given, go pictures of one setting of
// each method, raw floats. Times are of all kernels that a frame has beyond those of plain lighting
// (irradiance given, nothing scattered), medians. Errors are RMSE of radiance with an albedo of 0.8 over the
// pixels of skin. bench/diffusion/methods runs all of it.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "diffusion/lit_scenes.h"

using namespace lit_scenes;

namespace {

constexpr float albedo = 0.8f;

struct Setting {
    std::string method, setting;
    ShadeRequest request;
    bool shown = false;  // its picture is written
};

// The methods: name, what is swept, and how to shade. New ones are added here.
std::vector<Setting> settings() {
    std::vector<Setting> all;
    const auto add = [&](const char* method, const std::string& setting, PelScattering scattering,
                         bool traced) -> Setting& {
        all.push_back({method, setting, {}});
        all.back().request.scattering = scattering;
        all.back().request.traced = traced;
        return all.back();
    };
    for (uint32_t size : {16u, 64u, 256u, 512u}) {
        Setting& s =
            add("pre-integrated", std::to_string(size) + " texels", PEL_SCATTERING_PREINTEGRATED, false);
        s.request.tableSize = size;
        s.shown = size == 64;
    }
    for (uint32_t size : {128u, 512u}) {
        Setting& s = add("FaceWorks", std::to_string(size) + " texels", PEL_SCATTERING_PREINTEGRATED, false);
        s.request.tableSize = size;
        s.request.faceworks = true;
        s.shown = size == 512;
    }
    // With visibility given, as an image; what the camera does not see is in the map.
    for (uint32_t taps : {9u, 17u, 25u, 51u, 101u}) {
        Setting& s =
            add("separable", "2 x " + std::to_string(taps) + " taps", PEL_SCATTERING_SEPARABLE, true);
        s.request.scatterTaps = taps;
        s.shown = taps == 25;
    }
    for (uint32_t taps : {8u, 16u, 32u, 64u, 128u, 256u}) {
        Setting& s = add("disk", std::to_string(taps) + " taps", PEL_SCATTERING_SCREEN, true);
        s.request.scatterTaps = taps;
        s.shown = taps == 32;
    }
    for (float target : {0.0f, 5e-4f, 2e-3f, 5e-3f, 1e-2f, 2e-2f}) {
        char setting[32];
        std::snprintf(setting, sizeof setting, "error %g", double(target));
        Setting& s = add("auto", setting, PEL_SCATTERING_AUTO, true);
        s.request.targetError = target;
        s.shown = target == pelShaderOptionsDefaults().targetError;
    }
    add("auto, own shadows", "default", PEL_SCATTERING_AUTO, false);
    add("light", "default", PEL_SCATTERING_LIGHT, true).shown = true;
    return all;
}

// Christensen-Burley with the radii of a usual Blender material: d = 0.292, 0.109, 0.054 mm.
Profile usualProfile() {
    const float path[3] = {1.05f * 0.29205f, 1.05f * 0.10902f, 1.05f * 0.05411f},
                albedos[3] = {0.8f, 0.8f, 0.8f};
    return Profile::burley(path, albedos, PEL_BURLEY_SEARCHLIGHT);
}

LitScene sceneOf(const Device& device, const std::string& scene, double scale, int size,
                 const std::string& headFile) {
    SceneRequest request;
    request.size = size;
    request.mapSize = 2048;
    request.profileScale = scale;
    if (scene == "ear") request.azimuth = 70, request.lightAzimuth = 200, request.lightElevation = 10;
    if (scene == "sphere") request.azimuth = 0;
    const Body body = scene == "sphere" ? ball(10, 320) : head(headFile, "head", 3);
    return make(device, body, request, usualProfile());
}

void print(const LitScene& s, const std::string& scene, double scale, const Setting& setting, double seconds,
           const std::vector<float>& picture) {
    const char* name = scene == "side"  ? "head, light from the side"
                       : scene == "ear" ? "head and ear, light from behind"
                                        : "sphere of 10 mm";
    std::vector<float> shown = picture, truth = s.truth;
    for (std::vector<float>* values : {&shown, &truth})
        for (float& v : *values) v *= albedo;
    size_t pixels = 0;
    std::vector<uint8_t> dark(s.covered.size());
    for (size_t i = 0; i < dark.size(); ++i) {
        pixels += s.covered[i];
        dark[i] = s.covered[i] && (s.subsets[i] & io::SUBSET_UNLIT);
    }
    const io::ImageDifference all = io::compareImages(shown, truth, s.covered),
                              unlit = io::compareImages(shown, truth, dark);
    std::printf(
        "{\"scene\": \"%s\", \"scale\": %g, \"method\": \"%s\", \"setting\": \"%s\", \"pixels\": %zu, "
        "\"ms\": %.4g, \"rmse\": [%.4g, %.4g, %.4g], \"unlit\": [%.4g, %.4g, %.4g]}\n",
        name, scale, setting.method.c_str(), setting.setting.c_str(), pixels, seconds * 1e3, all.rmse[0],
        all.rmse[1], all.rmse[2], unlit.rmse[0], unlit.rmse[1], unlit.rmse[2]);
    std::fflush(stdout);
}

void write(const std::string& folder, const std::string& name, const std::vector<float>& values) {
    if (folder.empty()) return;
    std::ofstream out(folder + "/" + name + ".f32", std::ios::binary);
    out.write(reinterpret_cast<const char*>(values.data()), std::streamsize(values.size() * sizeof(float)));
    if (!out.flush()) throw std::runtime_error("cannot write into " + folder);
}

void measure(const std::string& scene, double scale, int pixels, int repeats, const std::string& pictures,
             const std::string& only, const std::string& headFile) {
    const Device device("");
    const Profile profile = usualProfile();
    const LitScene s = sceneOf(device, scene, scale, pixels, headFile);
    Setting plain{"Lambert", "", {}};
    plain.request.scattering = PEL_SCATTERING_NONE;
    plain.request.traced = true;
    plain.request.repeats = repeats;
    double plainSeconds = 0;
    shade(device, s, profile, scale, &plainSeconds, plain.request);
    print(s, scene, scale, plain, 0, s.irradiance);
    write(pictures, "Lambert", s.irradiance);
    write(pictures, "surface integral", s.truth);
    for (Setting& setting : settings()) {
        if (!only.empty() && setting.method != only) continue;
        setting.request.repeats = repeats;
        double seconds = 0;
        const std::vector<float> picture = shade(device, s, profile, scale, &seconds, setting.request);
        print(s, scene, scale, setting, std::max(seconds - plainSeconds, 0.0), picture);
        if (setting.shown) write(pictures, setting.method, picture);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> a(argv + 1, argv + argc);
    const auto text = [&](size_t i, const std::string& otherwise) { return i < a.size() ? a[i] : otherwise; };
    const double scale = std::atof(text(1, "").c_str());
    const int pixels = std::atoi(text(2, "512").c_str()), repeats = std::atoi(text(3, "7").c_str());
    if (!(scale > 0) || pixels < 1 || repeats < 1 || (a[0] != "side" && a[0] != "ear" && a[0] != "sphere")) {
        std::cerr
            << "sweep_error_time side|ear|sphere SCALE [PIXELS] [REPEATS] [PICTURES] [METHOD] [HEAD.obj]\n";
        return 2;
    }
    try {
        measure(a[0], scale, pixels, repeats, text(4, ""), text(5, ""),
                text(6, PELLUCID_SOURCE_DIR "/data/heads/head_female.obj"));
    } catch (const std::exception& e) {
        std::cerr << "sweep_error_time: " << e.what() << "\n";
        return 1;
    }
}
