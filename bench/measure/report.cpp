#include "report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <vector>

namespace pellucid::bench {
namespace {

using Json = nlohmann::ordered_json;

double value(const Json& e, const char* key) {
    const auto found = e.find(key);
    return found != e.end() && found->is_number() ? found->get<double>() : NAN;
}

// Of the logarithm of a case's median.
double relativeError(const Json& e) {
    const double time = e.value("median_ms", 0.0), samples = std::max(1.0, e.value("samples", 1.0));
    return time > 0 ? 1.2533 * 1.4826 * e.value("mad_ms", 0.0) / time / std::sqrt(samples) : 0;
}

// The verdict on one operation; times and errors go to `out`.
std::string compareOne(Json& out, const Json& before, const Json& after, double machine) {
    constexpr double minChange = 0.05, standardErrors = 4, errorGrowth = 1.5, errorStep = 1e-7;
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
        pairs.push_back({nullptr, &device});
        const auto same = std::ranges::find_if(left, [&](const Json* old) {
            return DevicePair{old, &device}.sameDevice();
        });
        if (same == left.end()) continue;
        pairs.back().before = *same;
        left.erase(same);
    }
    const auto isNew = [](const DevicePair& pair) { return !pair.before; };
    if (left.size() == 1 && std::ranges::count_if(pairs, isNew) == 1) {
        std::ranges::find_if(pairs, isNew)->before = left[0];
        return pairs;
    }
    for (const Json* old : left) pairs.push_back({old, nullptr});
    return pairs;
}

Json compareDevice(const DevicePair& pair, const std::function<void(std::string)>& count) {
    Json entry = {{"name", (pair.after ? pair.after : pair.before)->at("name")},
                  {"operations", Json::array()}};
    if (!pair.before || !pair.after) {
        entry["only"] = pair.after ? "new" : "old";
        return entry;
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
    const auto add = [&](Json one, const std::string& verdict) {
        one["verdict"] = verdict;
        count(verdict);
        entry["operations"].push_back(one);
    };
    for (const Json& e : pair.after->at("operations")) {
        if (e.at("group") == "device") continue;
        Json one = {{"name", e.at("name")}};
        const auto found = byName.find(e.at("name"));
        add(one, found == byName.end() ? "only new" : compareOne(one, *found->second, e, machine));
        if (found != byName.end()) byName.erase(found);
    }
    for (const auto& [name, e] : byName)
        if (e->at("group") != "device") add({{"name", name}}, "only old");
    return entry;
}

}  // namespace

Json parseReport(const std::string& text) {
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
    for (const DevicePair& pair : pairDevices(before, after))
        result["devices"].push_back(compareDevice(pair, count));
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

std::string shortNumber(double value) {
    if (!std::isfinite(value)) return "–";
    const double size = std::abs(value);
    const char* pattern = size == 0                    ? "%.0f"
                          : size < 1e-3 || size >= 1e5 ? "%.2e"
                          : size < 1                   ? "%.3f"
                          : size < 10                  ? "%.2f"
                          : size < 100                 ? "%.1f"
                                                       : "%.0f";
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, pattern, value);
    return buffer;
}

namespace {

constexpr const char* head = R"(<!DOCTYPE html>
<html lang='en'><head><meta charset='utf-8'><title>pellucid bench</title><style>
body { font: 15px/1.45 system-ui, sans-serif; max-width: 1280px; margin: 2em auto; padding: 0 1em; }
body { color: #222; background: #fff; } h1 { font-size: 1.5em; } h2 { font-size: 1.2em; margin-top: 2em; }
table { border-collapse: collapse; font-size: 13px; width: 100%; font-variant-numeric: tabular-nums; }
th, td { padding: 3px 4px; border-bottom: 1px solid #ddd; text-align: right; white-space: nowrap; }
th:first-child, td:first-child, .words tr :nth-child(2) { text-align: left; } .words { overflow-x: auto; }
.first td { font-size: 16px; } .note { color: #555; font-size: 13px; }
</style></head><body><h1>pellucid bench</h1>)";

std::string words(const Json& e, const char* key) {
    const auto found = e.find(key);
    std::string out;
    if (found == e.end() || !found->is_string()) return out;
    for (const char c : found->get<std::string>()) {
        const char* name = c == '&'    ? "&amp;"
                           : c == '<'  ? "&lt;"
                           : c == '>'  ? "&gt;"
                           : c == '\'' ? "&#39;"
                           : c == '"'  ? "&quot;"
                                       : nullptr;
        name ? void(out += name) : void(out += c);
    }
    return out;
}
std::string number(const Json& e, const char* key, double scale = 1) {
    return shortNumber(scale * value(e, key));
}
std::string percent(const Json& e, const char* key) {
    return number(e, key, 100) + (std::isfinite(value(e, key)) ? " %" : "");
}

std::string row(const std::vector<std::string>& cells, const std::string& tag = "td") {
    std::string html = "<tr>";
    for (const std::string& cell : cells) html += "<" + tag + ">" + cell + "</" + tag + ">";
    return html + "</tr>";
}
std::string table(const char* kind, const std::vector<std::string>& titles, const std::string& rows) {
    return std::string("<div class='") + kind + "'><table>" + row(titles, "th") + rows + "</table></div>";
}
std::string note(const std::string& text) {
    return "<p class='note'>" + text + "</p>";
}

std::string operationsTable(const Json& device) {
    std::string rows, truths;
    std::set<std::string> said;
    for (const Json& e : device.at("operations")) {
        if (e.contains("failed")) {
            rows += row({words(e, "name"), "could not be done: " + words(e, "failed")});
            continue;
        }
        const double rate = value(e, "per_second"), unit = rate >= 1e9 ? 1e9 : rate >= 1e6 ? 1e6 : 1;
        const std::string truth = words(e, "truth");
        rows += row({words(e, "name"), words(e, "what"), number(e, "median_ms"), number(e, "mad_ms"),
                     value(e, "device_ms") > 0 ? number(e, "device_ms") : "–",
                     shortNumber(rate / unit) +
                         (unit == 1e9   ? " G"
                          : unit == 1e6 ? " M"
                                        : " ") +
                         words(e, "unit"),
                     percent(e, "bandwidth_share"), percent(e, "arithmetic_share"),
                     "<span title='" + truth + "'>" + number(e, "error_max") + "</span>",
                     number(e, "error_rms")});
        if (!truth.empty() && said.insert(truth).second)
            truths += (truths.empty() ? "<b>" : "; <b>") + words(e, "name") + "</b> " + truth;
    }
    return table("words",
                 {"operation", "size", "median ms", "± MAD", "device ms", "per second", "of copies",
                  "of arithmetic", "largest error", "RMS error"},
                 rows) +
           note("Errors are against: " + truths + ".");
}

// Which device, how many frames a second, at what error: the question that the page is opened with.
std::string framesTable(const Json& devices) {
    static constexpr const char* operations[] = {"shade-10-percent", "shade-surface", "shade-32-taps"};
    std::string rows, size;
    for (const Json& d : devices) {
        std::vector<std::string> cells{words(d, "name")};
        double error = NAN;
        for (const char* operation : operations) {
            double frames = NAN;
            for (const Json& e : d.at("operations")) {
                if (words(e, "name") != operation || e.contains("failed")) continue;
                frames = 1e3 / value(e, "median_ms");
                error = std::fmax(error, value(e, "error_max"));
                if (size.empty()) size = words(e, "what").substr(0, words(e, "what").find(','));
            }
            cells.push_back(shortNumber(frames));
        }
        cells.push_back(shortNumber(error));
        rows += row(cells);
    }
    if (size.empty()) return "";  // --only
    return table("first",
                 {"frames a second", "skin on a tenth of the frame, 32 taps", "skin everywhere",
                  "skin everywhere, 32 taps", "largest error"},
                 rows) +
           note("Frames of " + size +
                " pixels with one light, nothing else running. Error of linear radiance, against double "
                "precision.");
}

}  // namespace

std::string htmlPage(const Json& report) {
    const Json &host = report.at("host"), &devices = report.at("devices");
    std::string rows, html = head;
    html +=
        "<p>Version " + words(host, "pellucid") + ", " + words(host, "date") + ", " + words(host, "cpu") +
        " with " + std::to_string(host.value("cores", 0)) + " threads" +
        (report.value("quick", false) ? ", <b>quick: small sizes, few repetitions</b>" : "") + ".</p>" +
        framesTable(devices) +
        note(
            "Times are medians of blocking calls, cases interleaved in rounds; MAD is the median absolute "
            "deviation. Bandwidth and arithmetic are shares of what the same device reached in the same "
            "run with a copy and with multiply-adds alone, counting only what the operation's definition "
            "needs.");
    for (const Json& d : devices)
        rows += row({words(d, "name"), words(d, "platform") + ", " + words(d, "driver"),
                     number(d, "copy_bytes_per_second", 1e-9), number(d, "operations_per_second", 1e-9),
                     number(d.value("first_use", Json::object()), "total_ms"),
                     number(d.value("warm_start", Json::object()), "total_ms")});
    html +=
        table("words",
              {"device", "platform, driver", "copy GB/s", "arithmetic GFLOP/s", "first use ms",
               "warm start ms"},
              rows) +
        note(
            "First use: a new process with empty caches, from nothing to the first small table and frame; "
            "warm start: the same again.");
    for (const Json& d : devices) html += "<h2>" + words(d, "name") + "</h2>" + operationsTable(d);
    return html + "</body></html>\n";
}

}  // namespace pellucid::bench
