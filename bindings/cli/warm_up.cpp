// pellucid warm-up: builds programs before they are needed. The driver's cache on disk keeps them.

#include "command.h"
#include "scene/scene_frame.h"
#include "system/process.h"

namespace pellucid::cli {
namespace {

struct WarmUpArguments {
    Run::Options run;
    std::vector<std::string> scenes;
    bool luts = false, tableLuts = false, curvature = false;
    uint32_t threads = 0;
};

void runWarmUp(const WarmUpArguments& a) {
    // Also keep binaries: they load in a fraction of the time that PoCL needs to find its own.
    if (!std::getenv("PELLUCID_CACHE")) pel::system::setVariable("PELLUCID_CACHE", "on");
    Run run(a.run);
    uint32_t groups = (a.luts ? PEL_PROGRAMS_LUTS : 0) | (a.tableLuts ? PEL_PROGRAMS_TABULATED_LUTS : 0) |
                      (a.curvature ? PEL_PROGRAMS_CURVATURE : 0);
    if (!groups && a.scenes.empty())
        groups = PEL_PROGRAMS_LUTS | PEL_PROGRAMS_TABULATED_LUTS | PEL_PROGRAMS_CURVATURE;
    const PelDeviceStats before = run.device().stats();
    warmUpPrograms(run.device(), groups, {}, a.threads);
    for (const std::string& scene : a.scenes) {
        run.note("building what " + scene + " needs");
        withInput(scene, [&] {
            io::LutStore luts(run.device());
            io::buildPrograms(run.device(), io::readScene(scene), luts);
        });
    }
    const PelDeviceStats after = run.device().stats();
    run.report["programs"] = after.programsBuilt - before.programsBuilt;
    run.report["loaded"] = after.programsLoaded - before.programsLoaded;
    run.report["stored"] = after.programsStored - before.programsStored;
    run.report["build_ms"] = after.buildMilliseconds - before.buildMilliseconds;
    run.finish();
}

}  // namespace

void addWarmUp(CLI::App& app) {
    auto [command, a] = subcommand<WarmUpArguments>(
        app, "warm-up",
        "Build OpenCL programs before their first use, for the driver's cache and as binaries", runWarmUp);
    command.alias("prefill");  // its first name
    option(command, "scene", a.scenes, "scene files (TOML) that `pellucid shade` will be given");
    option(command, "--luts", a.luts, "look-up tables of sums of Gaussians");
    option(command, "--table-luts", a.tableLuts, "look-up tables of tabulated profiles");
    option(command, "--curvature", a.curvature, "curvature of meshes");
    option(command, "--threads", a.threads,
           "number that build at the same time; 0: one per core. PoCL builds one by one", shown);
    addRunOptions(command, a.run);
    command.footer("Without scenes and flags: everything that does not depend on a scene.");
}

}  // namespace pellucid::cli
