#include "stages.h"

#include <cstdio>

#include "system/process.h"

namespace pellucid::cli {

void Stages::begin(const std::string& name) {
    if (pel::system::errorsAreSeen())
        std::fprintf(stderr, "\r\033[K%s ...", name.c_str()), std::fflush(stderr);
}

void Stages::add(const std::string& name, double wallMilliseconds, double deviceMilliseconds, uint64_t count,
                 const char* unit, uint64_t bytes) {
    if (pel::system::errorsAreSeen()) std::fputs("\r\033[K", stderr);
    if (stages_.empty())
        std::fprintf(stderr, "%-38s %9s %10s %8s %8s  %s\n", "stage", "wall ms", "device ms", "MB", "M/s",
                     "of");
    const Stage& s =
        stages_.emplace_back(Stage{name, unit, wallMilliseconds, deviceMilliseconds, count, bytes});
    std::fprintf(stderr, "%-38s %9.1f", name.c_str(), s.wall);
    // Blank instead of 0 if a stage has no such value.
    s.device > 0 ? std::fprintf(stderr, " %10.2f", s.device) : std::fprintf(stderr, " %10s", "");
    s.bytes > 0 ? std::fprintf(stderr, " %8.1f", double(s.bytes) * 1e-6) : std::fprintf(stderr, " %8s", "");
    if (count > 0) {
        const double rate = s.perSecond();
        std::isnan(rate) ? std::fprintf(stderr, " %8s", "") : std::fprintf(stderr, " %8.1f", rate * 1e-6);
        std::fprintf(stderr, "  %llu %s", static_cast<unsigned long long>(count), unit);
    }
    std::fputs("\n", stderr);
}

nlohmann::ordered_json Stages::json() const {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Stage& s : stages_) {
        nlohmann::ordered_json& entry = list.emplace_back(
            nlohmann::ordered_json{{"stage", s.name}, {"wall_ms", s.wall}, {"device_ms", s.device}});
        if (s.bytes > 0) entry["bytes"] = s.bytes;
        if (s.count == 0) continue;
        entry[s.unit] = s.count;
        if (const double rate = s.perSecond(); !std::isnan(rate)) entry[s.unit + "_per_second"] = rate;
    }
    return list;
}

}  // namespace pellucid::cli
