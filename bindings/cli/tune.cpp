// pellucid tune: which launch sizes are fastest on a device, kept in a file that is read when it is opened.

#include "command.h"
#include "io/atomic_file.h"
#include "measurements.h"

namespace pellucid::cli {
namespace {

struct TuneArguments {
    Run::Options run;
    std::string output;
    bool show = false, quick = false;
};

nlohmann::ordered_json toJson(const pel::LaunchPolicy& p) {
    return {
        {"group", p.group}, {"columns", p.columns}, {"table_columns", p.tableColumns}, {"texels", p.texels}};
}

void show(Run& run) {
    const pel::LaunchRule rule = pel::launchRule(run.device().info());
    run.report["sizes"] = toJson(rule.policy);
    run.report["from"] = rule.file.empty() ? "built in" : rule.file;
    run.finish();
}

void tune(const TuneArguments& a) {
    Run run(a.run);
    const PelDeviceInfo info = run.device().info();
    if (a.show) return show(run);
    const std::string path = a.output.empty() ? pel::launchFile(info).string() : a.output;
    if (path.empty()) throw UsageError("PELLUCID_CACHE_DIR leaves no folder for the file: name one with -o");
    std::error_code error;
    if (!a.output.empty()) {
        checkOutput(path, {"txt"});
    } else {
        std::filesystem::create_directories(std::filesystem::path(path).parent_path(), error);
        io::checkWritable(path);
    }
    const bench::Tuned tuned =
        measurements().tuneLaunches(run.device(), a.run.device, a.quick,
                                    [&](double fraction, const char* what) { run.progress(fraction, what); });
    const pel::LaunchPolicy builtIn = pel::builtInPolicy(info.mathWidth);
    run.report["built_in"] = toJson(builtIn);
    run.report["sizes"] = toJson(tuned.sizes);
    run.report["time_ratio"] = tuned.ratio;
    if (a.run.json) run.report["measured"] = tuned.measured;
    if (tuned.sizes == builtIn) {
        // An older file would still be used.
        if (a.output.empty()) std::filesystem::remove(path, error);
        run.report["file"] = "none: no other sizes are faster by more than 5 % and the noise";
    } else {
        io::writeWholeFile(path, pel::launchText(info, tuned.sizes));
        run.report["file"] = path;
    }
    run.finish();
}

}  // namespace

void addTune(CLI::App& app) {
    auto [command, a] = subcommand<TuneArguments>(
        app, "tune", "Measure which sizes of work-groups are fastest on a device, and keep them in a file",
        tune);
    CLI::Option* show = option(command, "--show", a.show, "only say which sizes are in force, and why");
    option(command, "-o,--output", a.output,
           "file, for PELLUCID_TUNING; without it, this user's for the device, its driver and this version")
        ->excludes(show);
    option(command, "--quick", a.quick, "fewer sizes and rounds, smaller tables and frames")->excludes(show);
    addRunOptions(command, a.run);
}

}  // namespace pellucid::cli
