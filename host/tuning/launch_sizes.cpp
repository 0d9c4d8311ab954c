#include "tuning/launch_sizes.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <locale>
#include <sstream>

#include "system/process.h"

namespace pel {
namespace {

// Sizes that were measured with another driver or version may be slow.
std::string madeWith(const PelDeviceInfo& device) {
    return std::to_string(PEL_VERSION_MAJOR) + '.' + std::to_string(PEL_VERSION_MINOR) + '.' +
           std::to_string(PEL_VERSION_PATCH) + ' ' + device.driver;
}

// The sizes in a line "launch GROUP COLUMNS TABLE_COLUMNS TEXELS VERSION DRIVER"; returns an error message,
// or "".
std::string readSizes(const std::string& line, const PelDeviceInfo& device, LaunchPolicy& policy) {
    std::istringstream words(line.substr(7));
    words.imbue(std::locale::classic());
    int64_t sizes[4];
    for (int64_t& size : sizes)
        if (!(words >> size) || size < 1 || size > 1 << 20) return "four numbers from 1 on are needed";
    std::string made;
    std::getline(words >> std::ws, made);
    if (made != madeWith(device)) return "measured with " + made + ", but this is " + madeWith(device);
    policy = {size_t(sizes[0]), size_t(sizes[1]), size_t(sizes[2]), size_t(sizes[3])};
    return {};
}

}  // namespace

std::string deviceLine(const PelDeviceInfo& device) {
    return std::string("device ") + device.name + ", " + device.platform;
}

LaunchPolicy allowedPolicy(LaunchPolicy policy, const PelDeviceInfo& device) {
    const size_t lanes = std::max(device.mathWidth, 1u),
                 most = std::clamp<size_t>(size_t(device.maxWorkGroupSize), 16, 256);
    const auto within = [](size_t v, size_t low, size_t high) {
        return std::bit_floor(std::clamp(v, low, std::bit_floor(high)));
    };
    return {within(policy.group, 1, most), within(policy.columns, lanes, 4096),
            within(policy.tableColumns, lanes, 4096), within(policy.texels, 16, most)};
}

std::filesystem::path launchFile(const PelDeviceInfo& device) {
    const std::filesystem::path folder = system::cacheFolder();
    if (folder.empty()) return {};
    const std::string key = deviceLine(device) + '\n' + madeWith(device) + char(device.mathWidth);
    std::ostringstream name;
    name.imbue(std::locale::classic());
    name << "tuning-" << std::hex << XXH3_64bits(key.data(), key.size()) << ".txt";
    return folder / name.str();
}

std::string launchText(const PelDeviceInfo& device, const LaunchPolicy& p) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << tuningHeader << '\n'
         << deviceLine(device) << "\nlaunch " << p.group << ' ' << p.columns << ' ' << p.tableColumns << ' '
         << p.texels << ' ' << madeWith(device) << '\n';
    return text.str();
}

LaunchRule launchRule(const PelDeviceInfo& device) {
    LaunchRule rule{builtInPolicy(device.mathWidth), {}, {}};
    const char* const named = std::getenv("PELLUCID_TUNING");
    const bool own = !named || !*named;
    if (!own && std::string(named) == "off") return rule;
    const std::filesystem::path path = own ? launchFile(device) : std::filesystem::path(named);
    std::error_code error;
    if (path.empty() || (own && !std::filesystem::exists(path, error))) return rule;
    const auto ignored = [&](const std::string& why) {
        rule.warning = path.string() + " does not set launch sizes: " + why;
        return rule;
    };
    if (!std::filesystem::is_regular_file(path, error) ||
        std::filesystem::file_size(path, error) > mostTuningBytes || error)
        return ignored("it is not a readable file of at most 1 MiB");
    std::ifstream file(path, std::ios::binary);
    bool here = false, known = false;
    size_t number = 0;
    for (std::string line; std::getline(file, line);) {
        if (line.ends_with('\r')) line.pop_back();
        if (++number == 1 && line != tuningHeader)
            return ignored(std::string("it does not begin with ") + tuningHeader);
        if (line.starts_with("device ")) known |= here = line == deviceLine(device);
        if (!here || !line.starts_with("launch ")) continue;
        const std::string wrong = readSizes(line, device, rule.policy);
        if (!wrong.empty()) return ignored("line " + std::to_string(number) + ": " + wrong);
        rule.policy = allowedPolicy(rule.policy, device);
        rule.file = path.string();
        return rule;
    }
    if (number == 0) return ignored("it is empty or cannot be read");
    if (own || !known) return ignored("it has no sizes for this device");
    return rule;  // the record is only for time budgets
}

}  // namespace pel
