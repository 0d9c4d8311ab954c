// Runs cases on a device and reports them as JSON.
#pragma once
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "case.h"

namespace pellucid::bench {

double median(std::vector<double> values);                  // of none: 0
double medianDeviation(const std::vector<double>& values);  // median absolute deviation from the median

struct Request {
    std::string device;                // selector
    bool quick = false;                // small sizes, few repetitions
    std::vector<std::string> only;     // parts of names; empty: every operation
    std::vector<std::string> without;  // names that are left out
    double limitSeconds = 120;         // that a case may take to be prepared, and again for all its runs
    std::string command;               // path of the pellucid command, for processes of their own
    std::function<void(const std::string&)> progress;  // a line now and then
    // What happens, for whoever waits: {"begin": name, "group"}, {"say": text}
    std::function<void(const nlohmann::ordered_json&)> event;
    std::function<bool()> cancelled;
};

// {"name", "platform", "version", "driver", ..., "first_use", "warm_start", and what measureCases() gives}.
// Everything but the description happens in other processes, so that a driver that hangs or crashes costs the
// case that it was at.
nlohmann::ordered_json measureDevice(const Request& request);

// In this process: {"copy_bytes_per_second", "operations_per_second" (null: not known), "operations":
// [{"name", "group", "what", "items", "unit", "runs", "median_ms", "mad_ms", "device_ms", "bytes",
// "bandwidth_share", "operations", "arithmetic_share", "error_max", "error_rms", "truth"} or {..., "failed":
// message}]}
nlohmann::ordered_json measureCases(const Request& request);

// What a process pays once: {"device_ms", "table_ms", "shade_ms", "total_ms"} from nothing to the first table
// and frame.
nlohmann::ordered_json firstUse(const std::string& device);

// This machine and this build.
nlohmann::ordered_json describeHost();

}  // namespace pellucid::bench
