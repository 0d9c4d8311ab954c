#include "compare.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "case.h"

namespace pellucid::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double leastChange = 0.05;  // share below which nothing counts
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

std::string compareOne(Json& out, const Json& before, const Json& after, double machine) {
    if (after.contains("failed")) return before.contains("failed") ? "not compared" : "fails";
    const double ratio = value(after, "median_ms") / value(before, "median_ms");
    // A failure before, or a report without times.
    if (before.contains("failed") || !(ratio > 0) || std::isinf(ratio)) return "not compared";
    const double noise =
        std::max({std::log1p(leastChange),
                  standardErrors * std::hypot(relativeError(before), relativeError(after)), machine});
    out["old_ms"] = value(before, "median_ms");
    out["new_ms"] = value(after, "median_ms");
    out["ratio"] = ratio;
    out["noise"] = std::expm1(noise);
    const double oldError = value(before, "error_max"), newError = value(after, "error_max");
    if (std::isfinite(oldError)) {
        out["old_error"] = oldError;
        out["new_error"] = after["error_max"];
        if (!(newError <= std::max(errorGrowth * oldError, oldError + errorStep))) return "less accurate";
    }
    if (before.value("items", 0.0) != after.value("items", 0.0)) return "other size";
    return std::log(ratio) > noise ? "slower" : std::log(ratio) < -noise ? "faster" : "same";
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
    Json result = {{"devices", Json::array()}, {"same", 0},  {"faster", 0},      {"slower", 0},
                   {"less_accurate", 0},       {"fails", 0}, {"not_compared", 0}};
    const auto count = [&result](std::string verdict) {
        std::replace(verdict.begin(), verdict.end(), ' ', '_');
        if (!result.contains(verdict)) verdict = "not_compared";
        result[verdict] = result[verdict].get<int>() + 1;
    };
    for (const Json& device : after.at("devices")) {
        const Json* old = nullptr;
        for (const Json& d : before.at("devices"))
            if (d.at("name") == device.at("name") && d.at("platform") == device.at("platform")) old = &d;
        Json entry = {{"name", device.at("name")}, {"operations", Json::array()}};
        if (!old) {
            entry["only"] = "new";
            result["devices"].push_back(entry);
            continue;
        }
        std::map<std::string, const Json*> byName;
        for (const Json& e : old->at("operations")) byName[e.at("name")] = &e;
        // How much the machine itself changed since then.
        double machine = 0;
        for (const char* key : {"copy_bytes_per_second", "operations_per_second"}) {
            const double ratio = value(device, key) / value(*old, key);
            if (std::isfinite(ratio) && ratio > 0) machine = std::max(machine, std::abs(std::log(ratio)));
            entry[key] = ratio;
        }
        for (const Json& e : device.at("operations")) {
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
        text += device.at("name").get<std::string>() + "\n";
        if (device.contains("only")) {
            text += "  in the new report only\n";
            continue;
        }
        line("  the machine itself: copies x %.2f, arithmetic x %.2f\n",
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
    line("%d same, %d faster, %d slower, %d less accurate, %d fail, %d not compared\n", number("same"),
         number("faster"), number("slower"), number("less_accurate"), number("fails"), number("not_compared"));
    return text;
}

}  // namespace pellucid::bench
