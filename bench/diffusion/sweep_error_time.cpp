// Run time against error of whole methods: every way to scatter, over its settings, on three scenes at the
// usual radius and at four times that, against the surface integral. Writes one line of CSV per measurement;
// bench/plot methods draws them.
//
//   sweep_error_time OUT.csv [PIXELS] [HEAD.obj]
//
// Times are of all that a frame has beyond plain lighting, medians of seven. Errors are RMSE of radiance with
// an albedo of 0.8 over the pixels of skin.
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "diffusion/lit_scenes.h"

using namespace lit_scenes;

namespace {

constexpr float albedo = 0.8f;

struct Setting {
    std::string method, setting;
    Method shade;
};

// The methods: name, what is swept, and how to shade. New ones are added here.
std::vector<Setting> settings() {
    std::vector<Setting> all;
    all.push_back({"Lambert", "", shadeLambert});
    for (uint32_t size : {16u, 64u, 256u, 512u})
        all.push_back({"pre-integrated", std::to_string(size) + " texels",
                       [size](const Device& d, const LitScene& s, const Profile& p, double k, double* t) {
                           return shadePreintegrated(d, s, p, k, t, size);
                       }});
    // With visibility given, as an image; what the camera does not see is in the map.
    const auto add = [&](const char* method, const std::string& setting, const ShadeRequest& request) {
        all.push_back({method, setting,
                       [request](const Device& d, const LitScene& s, const Profile& p, double k, double* t) {
                           return shade(d, s, p, k, t, request);
                       }});
    };
    for (uint32_t taps : {9u, 17u, 25u, 51u, 101u}) {
        ShadeRequest request;
        request.scattering = PEL_SCATTERING_SEPARABLE;
        request.scatterTaps = taps;
        request.traced = true;
        add("separable", "2 x " + std::to_string(taps) + " taps", request);
    }
    for (uint32_t taps : {8u, 16u, 32u, 64u, 128u, 256u}) {
        ShadeRequest request;
        request.scattering = PEL_SCATTERING_SCREEN;
        request.scatterTaps = taps;
        request.traced = true;
        add("disk", std::to_string(taps) + " taps", request);
    }
    for (float target : {5e-4f, 2e-3f, 5e-3f, 1e-2f, 2e-2f}) {
        ShadeRequest request;
        request.targetError = target;
        request.traced = true;
        char setting[32];
        std::snprintf(setting, sizeof setting, "error %g", double(target));
        add("auto", setting, request);
    }
    ShadeRequest light;
    light.scattering = PEL_SCATTERING_LIGHT;
    light.traced = true;
    add("light", "", light);
    ShadeRequest faceworks;
    faceworks.scattering = PEL_SCATTERING_PREINTEGRATED;
    faceworks.faceworks = true;
    faceworks.tableSize = 512;
    add("FaceWorks", "", faceworks);
    return all;
}

void measure(std::ofstream& out, const Device& device, const LitScene& s, const std::string& name,
             const Profile& profile, double scale) {
    std::vector<float> truth = s.truth;
    for (float& v : truth) v *= albedo;
    size_t covered = 0;
    for (uint8_t c : s.covered) covered += c;
    for (const Setting& setting : settings()) {
        double seconds = 0;
        std::vector<float> picture = setting.shade(device, s, profile, scale, &seconds);
        for (float& v : picture) v *= albedo;
        const io::ImageDifference d = io::compareImages(picture, truth, s.covered);
        std::vector<uint8_t> dark(s.covered.size());
        for (size_t i = 0; i < dark.size(); ++i) dark[i] = s.covered[i] && (s.subsets[i] & io::SUBSET_UNLIT);
        const io::ImageDifference unlit = io::compareImages(picture, truth, dark);
        out << name << "," << scale << "," << setting.method << "," << setting.setting << "," << covered
            << "," << seconds * 1e3;
        for (const auto* e : {&d, &unlit})
            for (double rmse : e->rmse) out << "," << rmse;
        out << "\n";
        std::printf(
            "%-10s x%g  %-16s %-12s %8.3f ms   RMSE 1e-4 %5.0f %5.0f %5.0f   unlit %5.0f %5.0f %5.0f\n",
            name.c_str(), scale, setting.method.c_str(), setting.setting.c_str(), seconds * 1e3, 1e4 * d.rmse[0],
            1e4 * d.rmse[1], 1e4 * d.rmse[2], 1e4 * unlit.rmse[0], 1e4 * unlit.rmse[1], 1e4 * unlit.rmse[2]);
        std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "sweep_error_time OUT.csv [PIXELS a side, 512] [HEAD.obj]\n");
        return 2;
    }
    const int size = argc > 2 ? std::atoi(argv[2]) : 512;
    const std::string file = argc > 3 ? argv[3] : PELLUCID_SOURCE_DIR "/data/heads/head_female.obj";
    const Device device("");
    // Christensen-Burley with the radii of a usual Blender material: d = 0.292, 0.109, 0.054 mm.
    const float path[3] = {1.05f * 0.29205f, 1.05f * 0.10902f, 1.05f * 0.05411f},
                albedos[3] = {0.8f, 0.8f, 0.8f};
    const Profile profile = Profile::burley(path, albedos, PEL_BURLEY_SEARCHLIGHT);
    std::ofstream out(argv[1]);
    out << "scene,scale,method,setting,pixels,ms,r,g,b,unlit_r,unlit_g,unlit_b\n";
    const Body skull = head(file, "head", 3), sphere = ball(10, 320);
    for (double scale : {1.0, 4.0}) {
        SceneRequest side, ear, round;
        side.size = ear.size = round.size = size;
        side.mapSize = ear.mapSize = round.mapSize = 2048;
        side.profileScale = ear.profileScale = round.profileScale = scale;
        ear.azimuth = 70, ear.lightAzimuth = 200, ear.lightElevation = 10;
        round.azimuth = 0;
        measure(out, device, make(device, skull, side, profile), "head side", profile, scale);
        measure(out, device, make(device, skull, ear, profile), "ear behind", profile, scale);
        measure(out, device, make(device, sphere, round, profile), "sphere", profile, scale);
    }
    return out.good() ? 0 : 1;
}
