// How many work-items a group has, and how much one of them does: built in by kind of device, or as
// `pellucid tune` measured (docs/guide/devices.md, "Launch sizes"). Results have the same bits with all.
#pragma once
#include <pellucid/pellucid.h>

#include <filesystem>
#include <string>

namespace pel {

// The format of such files, which PelShaderOptions.timeBudget reads as well: a first line, and lines for one
// device after another, each of which begins with deviceLine().
inline constexpr const char* tuningHeader = "pellucid tuning 1";
inline constexpr size_t mostTuningBytes = 1 << 20;
std::string deviceLine(const PelDeviceInfo& device);

// Devices of several lanes (lib/width.clh) run few long work-items with vectors, others many short ones.
struct LaunchPolicy {
    size_t group;         // work-items of kernels that loop over tiles or columns
    size_t columns;       // of a table's row per work-item, where a texel is cheap
    size_t tableColumns;  // where each texel of it walks a tabulated profile
    size_t texels;        // PEL_GROUP: work-items of a group where each is short: a texel, a block of a map

    bool operator==(const LaunchPolicy&) const = default;
};

constexpr LaunchPolicy builtInPolicy(uint32_t lanes) {
    return lanes > 1 ? LaunchPolicy{1, 256, 64, 16} : LaunchPolicy{64, 1, 1, 64};
}
// Registers of a work-item by NVIDIA's compiler at most, of kernels with PEL_WORK_GROUP. More of them leave
// too few work-items on a unit to hide the latency of memory (docs/design-notes.md, "Registers").
constexpr uint32_t nvidiaRegisters = 96;
// The nearest sizes that kernels can have on this device: powers of two.
LaunchPolicy allowedPolicy(LaunchPolicy policy, const PelDeviceInfo& device);

struct LaunchRule {
    LaunchPolicy policy;
    std::string file;     // the source of these sizes; "": built in
    std::string warning;  // why the file is ignored; "": it is not
};
// Sizes of the file that PELLUCID_TUNING names, or of launchFile(); "off": built in. Faulty files do not
// throw.
LaunchRule launchRule(const PelDeviceInfo& device);

// This user's file for the device with its driver and this version of the library; empty: there is no folder.
std::filesystem::path launchFile(const PelDeviceInfo& device);
// The content of such a file.
std::string launchText(const PelDeviceInfo& device, const LaunchPolicy& policy);

}  // namespace pel
