// pellucid warm-up: builds programs before they are needed. The driver's cache on disk keeps them.
#include <set>

#include "command.h"
#include "io/file_error.h"
#include "io/scene/scene_frame.h"

namespace pellucid::cli {
namespace {

struct Arguments {
    Run::Options run;
    std::vector<std::string> scenes;
    bool luts = false, tableLuts = false, curvature = false;
    uint32_t threads = 0;
};

// A black image of the smallest size that is read as a frame's is, with these channels.
io::Image blank(const std::set<std::string>& channels, int height = 2) {
    io::Image image;
    image.width = 16;
    image.height = height;
    for (const std::string& name : channels)
        if (!name.empty()) image.addInterleaved(std::vector{name}, std::vector<float>(image.pixelCount()));
    return image;
}

// Shades such a frame. Files beside the scene are read, except shadow maps.
void warmUpScene(const Device& device, const std::string& path) {
    const io::SceneFile scene = io::readScene(path);
    std::set<std::string> channels;
    for (size_t slot = 0; slot < scene.channels.size(); ++slot)
        if (slot != PEL_SLOT_CURVATURE || scene.channels[slot] != std::vector<std::string>{"screen"})
            channels.insert(scene.channels[slot].begin(), scene.channels[slot].end());
    io::ShadowMaps maps;
    for (const io::SceneLight& light : scene.lights) {
        channels.insert(light.wideShadow);
        if (light.shadowMapFile.empty()) continue;
        const bool cube = light.light.shadowProjection >= PEL_SHADOW_CUBE;
        std::map<std::string, std::set<std::string>> files;  // channels of each
        const auto add = [&](const std::string& file, const std::string& channel, const std::string& second) {
            files[file.empty() ? light.shadowMapFile : file].insert({channel.empty() ? "Z" : channel, second});
        };
        add(light.shadowMapFile, light.shadowMapChannel, light.secondChannel);
        for (uint32_t k = 0; k + 1 < light.light.shadowCascades; ++k)
            add(light.cascades[k].file, light.cascades[k].channel, light.cascades[k].secondChannel);
        for (const auto& [file, names] : files) maps[file] = blank(names, cube ? 6 * 16 : 2);
    }
    io::LutStore luts(device);
    io::SceneFrame frame(device, blank(channels), scene, luts, maps);
    frame.shade();
}

void run(const Arguments& a) {
    Run run(a.run);
    const auto stats = [&] {
        PelDeviceStats s = pelDeviceStatsDefaults();
        check(pelDeviceGetStats(run.device().get(), &s));
        return s;
    };
    uint32_t groups = (a.luts ? PEL_PROGRAMS_LUTS : 0) | (a.tableLuts ? PEL_PROGRAMS_TABULATED_LUTS : 0) |
                      (a.curvature ? PEL_PROGRAMS_CURVATURE : 0);
    if (!groups && a.scenes.empty())
        groups = PEL_PROGRAMS_LUTS | PEL_PROGRAMS_TABULATED_LUTS | PEL_PROGRAMS_CURVATURE;
    const PelDeviceStats before = stats();
    if (groups) warmUpPrograms(run.device(), groups, {}, a.threads);
    for (const std::string& scene : a.scenes) {
        run.note("building what " + scene + " needs");
        try {
            warmUpScene(run.device(), scene);
        } catch (const Error& e) {
            if (e.code() == PEL_ERROR_INVALID_ARGUMENT) throw InputError(scene + ": " + e.what());
            throw;
        }
    }
    const PelDeviceStats after = stats();
    run.report["programs"] = after.programsBuilt - before.programsBuilt;
    run.report["loaded"] = after.programsLoaded - before.programsLoaded;
    run.report["stored"] = after.programsStored - before.programsStored;
    run.report["build_ms"] = after.buildMilliseconds - before.buildMilliseconds;
    run.finish();
}

}  // namespace

void addWarmUp(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("warm-up", "Build OpenCL programs before their first use, for the driver's cache");
    command->alias("prefill");  // its first name
    auto a = std::make_shared<Arguments>();
    command->add_option("scene", a->scenes, "scene files (TOML) that `pellucid shade` will be given");
    command->add_flag("--luts", a->luts, "look-up tables of sums of Gaussians");
    command->add_flag("--table-luts", a->tableLuts, "look-up tables of tabulated profiles");
    command->add_flag("--curvature", a->curvature, "curvature of meshes");
    command
        ->add_option("--threads", a->threads,
                     "number that build at the same time; 0: one per core. PoCL builds one by one")
        ->capture_default_str();
    addRunOptions(*command, a->run);
    command->callback([a] { run(*a); });
    command->footer("Without scenes and flags: everything that does not depend on a scene.");
}

}  // namespace pellucid::cli
