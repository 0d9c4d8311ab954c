// The cases of `pellucid bench`, and their measurement.
#pragma once
#include <nlohmann/json.hpp>
#include <pellucid/pellucid.hpp>

#include "tuning/launch_sizes.h"

namespace pellucid::bench {

struct Error {
    double max = 0, rms = 0;
};

struct Case {
    std::string what{};  // for people: size, settings
    double items = 0;    // worked on per run
    std::string unit{};  // of the items: "vertices"
    // Least work by the definition, for shares of the device's own limits; 0: not counted. Bytes: each input
    // read and each output written once. Operations: +, *, comparison, square root, exponential each 1, fused
    // multiply-add 2.
    double bytes = 0, operations = 0;
    std::function<void()> run{};     // returns when the result is there
    std::function<Error()> error{};  // of the last run's result; empty: nothing to compare
    std::string truth{};             // what the result is compared with, and in which unit
};

// Creating a case may need memory and time, and may fail if the device lacks a feature.
struct Factory {
    std::string name, group;
    std::function<Case()> make;
};

std::vector<Factory> deviceCases(const Device& device, bool quick);   // copy bandwidth, arithmetic peak
std::vector<Factory> meshCases(const Device& device, bool quick);     // curvature, normals, UV scale
std::vector<Factory> tableCases(const Device& device, bool quick);    // look-up tables
std::vector<Factory> shadingCases(const Device& device, bool quick);  // the pass over a G-buffer
std::vector<Factory> eyeCases(const Device& device, bool quick);      // a cornea's table, a frame with an eye

constexpr const char* copyName = "copy";  // the case whose bytes per second are the device's bandwidth
constexpr const char* arithmeticName = "arithmetic";  // and whose operations per second are its peak

// Gathers differences into an Error.
class ErrorSum {
  public:
    void add(double difference) {
        max_ = difference == difference && max_ == max_ ? std::max(max_, std::abs(difference)) : NAN;
        squares_ += difference * difference;
        ++count_;
    }
    Error result(double scale = 1) const {
        return {max_ / scale, std::sqrt(squares_ / double(std::max<size_t>(count_, 1))) / scale};
    }

  private:
    double max_ = 0, squares_ = 0;
    size_t count_ = 0;
};

struct Request {
    std::string device;                // selector
    bool quick = false;                // small sizes, few repetitions
    bool firstGpu = false;             // the checks and predictions of first_gpu.cpp instead of all else
    double stability = 0;              // share of its whole search for the worst errors; 0: none
    std::vector<std::string> only;     // parts of names; empty: every operation
    std::vector<std::string> without;  // names that are left out
    double limitSeconds = 120;         // that a case may take to be prepared, and again for all its runs
    std::string data;  // folder of the library's data: heads, and the truth of scenes in bench
    std::string powercap = "/sys/class/powercap";  // folder of the counters of processors' energy
    std::string command;                           // path of the pellucid command, for processes of their own
    std::function<void(const std::string&)> progress;  // a line now and then
    // Receives events for the waiting process: {"begin": name, "group"}, {"say": text}, {"row": a finished
    // operation, which need not be measured again}
    std::function<void(const nlohmann::ordered_json&)> event;
    std::function<bool()> cancelled;

    void begin(const std::string& name, const std::string& group) const {
        event({{"begin", name}, {"group", group}});
    }
    void say(const std::string& text) const { event({{"say", text}}); }
    bool wants(const std::string& name) const {
        return (only.empty() ||
                std::ranges::any_of(
                    only, [&](const std::string& part) { return name.find(part) != std::string::npos; })) &&
               std::ranges::find(without, name) == without.end();
    }
};

// {"name", "platform", "version", "driver", ..., "first_use", "warm_start", and what measureCases() gives}.
// Measured in other processes, so that a driver that hangs or crashes costs the case that it was at.
nlohmann::ordered_json measureDevice(const Request& request);

// Null where there is none: JSON has no NaN.
inline nlohmann::ordered_json finite(double v) {
    return std::isfinite(v) ? nlohmann::ordered_json(v) : nlohmann::ordered_json();
}

// In this process: {"copy_bytes_per_second", "operations_per_second" (null: not known), "operations":
// [{"name", "group", "what", "items", "unit", "runs", "median_ms", "mad_ms", "device_ms", "bytes",
// "bandwidth_share", "operations", "arithmetic_share", "error_max", "error_rms", "truth"} or {..., "failed":
// message}]}
nlohmann::ordered_json measureCases(const Request& request);

// In this process: {"scenes", "operations", "pictures"} (docs/guide/measuring.md).
nlohmann::ordered_json measureMethods(const Request& request);

// The checks of --first-gpu, in this process: compares each method's picture with the one kept in
// `request.data`, then measures its passes at 1080p and 4K. Operations are sent as events.
void measureFirst(const Request& request);

// Writes the pictures that measureFirst() compares with into `folder`.
void keepPictures(const Request& request, const std::string& folder);

// From now on the oracle of shading reads the kernels' taps from what comes with the command.
void findTaps(const Request& request);

// Judges the results of --first-gpu. Adds to the operations of a report their "tolerance" and "within", to
// passes of frames "predicted_ms" and "limited_by" (null: not predicted) by the counts of `warps`
// (bench/roofline), and "first_gpu": {"checked", "out": [names]}.
void judgeFirst(nlohmann::ordered_json& report, const nlohmann::ordered_json& warps);

// Parts of the names of operations that judgeFirst() judges.
std::vector<std::string> judgedCases();

// In this process: {"stability": {"share", "operations": [{"name", "range", "unit", "limit", "points",
// "stopped", "drawn", "worst", "inherent", "where"}]}}, the worst error of every operation against the tests'
// oracles, on the device that PELLUCID_DEVICE names (docs/stability.md).
nlohmann::ordered_json measureStability(const Request& request);

// Writes the truth of each scene and clip that `folder` does not have into it. Minutes each.
void makeTruth(const Device& device, const std::string& folder, const std::string& headFile,
               const std::function<void(const std::string&)>& say, const std::function<bool()>& cancelled);

// The fastest launch sizes of a device; the built-in sizes unless others are faster by more than the noise.
struct Tuned {
    pel::LaunchPolicy sizes;
    double ratio = 1;  // of its times over those of what is built in
    nlohmann::ordered_json measured = nlohmann::ordered_json::array();
};
using TuneProgress = std::function<void(double fraction, const char* what)>;
// `selector`: that opened `device`.
Tuned tuneLaunches(const Device& device, const std::string& selector, bool quick,
                   const TuneProgress& progress);

// One-time cost of a process's first table and frame: {"device_ms", "table_ms", "shade_ms", "total_ms"}.
nlohmann::ordered_json firstUse(const std::string& device);

// This machine and this build. reportFormat: changes where a reader of reports would have to.
constexpr int reportFormat = 2;
nlohmann::ordered_json describeHost();

}  // namespace pellucid::bench
