#include "compare.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <vector>

#include "case.h"

namespace pellucid::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double minChange = 0.05;    // share below which no change counts
constexpr double standardErrors = 4;  // of the difference
constexpr double errorGrowth = 1.5, errorStep = 1e-7;

// Of the logarithm of a case's median.
double relativeError(const Json& e) {
    const double time = e.value("median_ms", 0.0), samples = std::max(1.0, e.value("samples", 1.0));
    return time > 0 ? 1.2533 * 1.4826 * e.value("mad_ms", 0.0) / time / std::sqrt(samples) : 0;
}

double value(const Json& e, const char* key) {
    const auto found = e.find(key);
    return found != e.end() && found->is_number() ? found->get<double>() : NAN;
}

// The verdict on one operation; times and errors go to `out`.
std::string compareOne(Json& out, const Json& before, const Json& after, double machine) {
    if (after.contains("failed")) return before.contains("failed") ? "not compared" : "fails";
    const double ratio = value(after, "median_ms") / value(before, "median_ms");
    // The old run failed, or one of the reports has no times.
    if (before.contains("failed") || !(ratio > 0) || std::isinf(ratio)) return "not compared";
    out["old_ms"] = value(before, "median_ms");
    out["new_ms"] = value(after, "median_ms");
    // Neither the times nor the errors of two sizes can be compared.
    for (const char* key : {"items", "what"})
        if (before.value(key, Json()) != after.value(key, Json())) return "other size";
    const double noise =
        std::max({std::log1p(minChange),
                  standardErrors * std::hypot(relativeError(before), relativeError(after)), machine});
    out["ratio"] = ratio;
    out["noise"] = std::expm1(noise);
    const double oldError = value(before, "error_max"), newError = value(after, "error_max");
    if (std::isfinite(oldError)) {
        out["old_error"] = oldError;
        out["new_error"] = after["error_max"];
        if (!(newError <= std::max(errorGrowth * oldError, oldError + errorStep))) return "less accurate";
    }
    return std::log(ratio) > noise ? "slower" : std::log(ratio) < -noise ? "faster" : "same";
}

// A device of the new report and the device of the old report that it is compared with. One of the two is
// null for a device that only one report has.
struct DevicePair {
    const Json *before, *after;
    bool sameDevice() const {
        return before->at("name") == after->at("name") && before->at("platform") == after->at("platform");
    }
};

// Pairs devices of the same name and platform; of several equal devices the first with the first, and so on.
// If one device is left over in each report, the two are compared although they differ.
std::vector<DevicePair> pairDevices(const Json& before, const Json& after) {
    std::vector<DevicePair> pairs;
    std::vector<const Json*> left;
    for (const Json& device : before.at("devices")) left.push_back(&device);
    for (const Json& device : after.at("devices")) {
        DevicePair pair{nullptr, &device};
        const auto same = std::ranges::find_if(left, [&](const Json* old) {
            return DevicePair{old, &device}.sameDevice();
        });
        if (same != left.end()) {
            pair.before = *same;
            left.erase(same);
        }
        pairs.push_back(pair);
    }
    const auto isNew = [](const DevicePair& pair) { return !pair.before; };
    if (left.size() == 1 && std::ranges::count_if(pairs, isNew) == 1) {
        std::ranges::find_if(pairs, isNew)->before = left[0];
        return pairs;
    }
    for (const Json* old : left) pairs.push_back({old, nullptr});
    return pairs;
}

}  // namespace

nlohmann::ordered_json parseReport(const std::string& text) {
    using Json = nlohmann::ordered_json;
    constexpr int deepest = 16;  // copies and texts of values are made by recursion
    bool deep = false;
    Json report = Json::parse(
        text,
        [&](int depth, Json::parse_event_t, Json&) {
            deep |= depth > deepest;
            return depth <= deepest;  // else it is left out
        },
        false);
    const bool sound = !deep && !report.is_discarded() && report.is_object() && report.contains("devices") &&
                       report["devices"].is_array();
    return sound ? report : Json(Json::value_t::discarded);
}

Json compareReports(const Json& before, const Json& after) {
    Json result = {{"devices", Json::array()}, {"same", 0},  {"faster", 0},     {"slower", 0},
                   {"less_accurate", 0},       {"fails", 0}, {"other_size", 0}, {"not_compared", 0}};
    const auto count = [&result](std::string verdict) {
        std::replace(verdict.begin(), verdict.end(), ' ', '_');
        if (!result.contains(verdict)) verdict = "not_compared";
        result[verdict] = result[verdict].get<int>() + 1;
    };
    for (const DevicePair& pair : pairDevices(before, after)) {
        Json entry = {{"name", (pair.after ? pair.after : pair.before)->at("name")},
                      {"operations", Json::array()}};
        if (!pair.before || !pair.after) {
            entry["only"] = pair.after ? "new" : "old";
            result["devices"].push_back(entry);
            continue;
        }
        if (!pair.sameDevice()) entry["old_name"] = pair.before->at("name");
        std::map<std::string, const Json*> byName;
        for (const Json& e : pair.before->at("operations")) byName[e.at("name")] = &e;
        // A change of the device's own speed between two runs adds to the noise of all its operations.
        double machine = 0;
        for (const char* key : {"copy_bytes_per_second", "operations_per_second"}) {
            const double ratio = value(*pair.after, key) / value(*pair.before, key);
            if (pair.sameDevice() && std::isfinite(ratio) && ratio > 0)
                machine = std::max(machine, std::abs(std::log(ratio)));
            entry[key] = ratio;
        }
        for (const Json& e : pair.after->at("operations")) {
            const std::string name = e.at("name");
            if (e.at("group") == "device") continue;
            Json one = {{"name", name}};
            const auto found = byName.find(name);
            one["verdict"] = found == byName.end() ? "only new" : compareOne(one, *found->second, e, machine);
            if (found != byName.end()) byName.erase(found);
            count(one["verdict"]);
            entry["operations"].push_back(one);
        }
        for (const auto& [name, e] : byName)
            if (e->at("group") != "device") {
                entry["operations"].push_back({{"name", name}, {"verdict", "only old"}});
                count("only old");
            }
        result["devices"].push_back(entry);
    }
    return result;
}

std::string describeComparison(const Json& comparison) {
    std::string text;
    const auto line = [&](const char* format, auto... values) {
        char buffer[256];
        std::snprintf(buffer, sizeof buffer, format, values...);
        text += buffer;
    };
    for (const Json& device : comparison.at("devices")) {
        text += device.at("name").get<std::string>();
        if (device.contains("old_name"))
            text += ", compared with another device: " + device["old_name"].get<std::string>();
        text += "\n";
        if (device.contains("only")) {
            text += "  only in the " + device["only"].get<std::string>() + " report\n";
            continue;
        }
        line("  the device itself: copies x %.2f, arithmetic x %.2f\n",
             value(device, "copy_bytes_per_second"), value(device, "operations_per_second"));
        line("  %-28s %10s %10s %8s %8s  %s\n", "operation", "old ms", "new ms", "new/old", "noise",
             "verdict");
        for (const Json& e : device.at("operations")) {
            line("  %-28s", e.at("name").get<std::string>().c_str());
            if (e.contains("ratio"))
                line(" %10.3f %10.3f %8.3f %7.1f%%", value(e, "old_ms"), value(e, "new_ms"),
                     value(e, "ratio"), 100 * value(e, "noise"));
            else
                line("%40s", "");
            text += "  " + e.at("verdict").get<std::string>() + "\n";
        }
    }
    const auto number = [&](const char* key) { return comparison.at(key).get<int>(); };
    line("%d same, %d faster, %d slower, %d less accurate, %d fail, %d of another size, %d not compared\n",
         number("same"), number("faster"), number("slower"), number("less_accurate"), number("fails"),
         number("other_size"), number("not_compared"));
    return text;
}

}  // namespace pellucid::bench
