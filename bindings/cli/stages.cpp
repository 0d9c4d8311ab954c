#include "stages.h"

#include <cstdio>

namespace pellucid::cli {

void Stages::add(const std::string& name, double wallMilliseconds, double deviceMilliseconds, uint64_t count,
                 const char* unit, uint64_t bytes) {
    stages_.push_back({name, unit, wallMilliseconds, deviceMilliseconds, count, bytes});
}

nlohmann::ordered_json Stages::json() const {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Stage& s : stages_)
        list.push_back({{"stage", s.name},
                        {"wall_ms", s.wall},
                        {"device_ms", s.device},
                        {"unit", s.unit},
                        {"count", s.count},
                        {"bytes", s.bytes},
                        {"per_second", s.perSecond(double(s.count))}});
    return list;
}

void Stages::print() const {
    std::fprintf(stderr, "%-34s %10s %10s %10s %10s %-9s %12s\n", "stage", "wall ms", "device ms", "MB",
                 "count", "of", "M/s");
    for (const Stage& s : stages_)
        std::fprintf(stderr, "%-34s %10.1f %10.2f %10.2f %10llu %-9s %12.2f\n", s.name.c_str(), s.wall,
                     s.device, double(s.bytes) * 1e-6, static_cast<unsigned long long>(s.count),
                     s.unit.c_str(), s.perSecond(double(s.count)) * 1e-6);
}

}  // namespace pellucid::cli
