// pellucid devices [--json]: lists the OpenCL devices.

#include "command.h"

namespace pellucid::cli {
namespace {

const char* typeName(PelDeviceType type) {
    return type == PEL_DEVICE_GPU ? "gpu" : type == PEL_DEVICE_CPU ? "cpu" : "accelerator";
}

nlohmann::ordered_json toJson(const PelDeviceInfo& d) {
    return {{"index", d.index},
            {"name", d.name},
            {"type", typeName(d.type)},
            {"platform", d.platform},
            {"vendor", d.vendor},
            {"version", d.version},
            {"driver", d.driver},
            {"compute_units", d.computeUnits},
            {"clock_mhz", d.clockMhz},
            {"global_memory_bytes", d.globalMemoryBytes},
            {"max_allocation_bytes", d.maxAllocationBytes},
            {"local_memory_bytes", d.localMemoryBytes},
            {"max_work_group_size", d.maxWorkGroupSize},
            {"preferred_float_width", d.preferredFloatWidth},
            {"math_width", d.mathWidth},
            {"shared_memory", d.sharedMemory != 0},
            {"quirks", d.quirks}};
}

void print(const PelDeviceInfo& d, bool standard) {
    std::printf("%u: %s (%s)%s\n", d.index, d.name, typeName(d.type), standard ? ", the default" : "");
    std::printf("   %s; %s; driver %s\n", d.platform, d.version, d.driver);
    std::printf(
        "   %u units at %u MHz, %.1f GiB (%.1f GiB at once), %llu KiB local, %s memory\n", d.computeUnits,
        d.clockMhz, double(d.globalMemoryBytes) / (1 << 30), double(d.maxAllocationBytes) / (1 << 30),
        static_cast<unsigned long long>(d.localMemoryBytes / 1024), d.sharedMemory ? "shared" : "own");
    std::printf("   preferred float width %u, used %u\n", d.preferredFloatWidth, d.mathWidth);
    if (*d.quirks) std::printf("   quirks: %s\n", d.quirks);
}

}  // namespace

void addDevices(CLI::App& app) {
    CLI::App* command = app.add_subcommand("devices", "List the OpenCL devices and what matters about them");
    auto options = std::make_shared<Run::Options>();
    addRunOptions(*command, *options);
    command->callback([options] {
        // Creates the default device to check that it works; without any device this is an error.
        Run run(*options);
        const uint32_t standard = run.device().info().index;
        run.report["default"] = standard;
        for (const PelDeviceInfo& info : Device::all()) {
            run.report["devices"].push_back(toJson(info));
            if (!options->json) print(info, info.index == standard);
        }
        if (options->json) run.finish();
    });
}

}  // namespace pellucid::cli
