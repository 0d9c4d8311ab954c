#include "report.h"

#include "io/shortest.h"
#include "timing.h"

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
    constexpr double minChange = 0.05, standardErrors = 4, errorGrowth = 1.5, errorStep = 1e-7,
                     flipGrowth = 0.1;
    if (after.contains("failed")) return before.contains("failed") ? "not compared" : "fails";
    const bool timed = before.contains("median_ms") || after.contains("median_ms");  // clips are not
    const double ratio = value(after, "median_ms") / value(before, "median_ms");
    // The old run failed, or one of the reports has no times.
    if (before.contains("failed") || (timed && (!(ratio > 0) || std::isinf(ratio)))) return "not compared";
    if (timed) out["old_ms"] = value(before, "median_ms"), out["new_ms"] = value(after, "median_ms");
    // Times and errors of different sizes cannot be compared.
    for (const char* key : {"items", "what"})
        if (before.value(key, Json()) != after.value(key, Json())) return "other size";
    const double noise =
        std::max({std::log1p(minChange),
                  standardErrors * std::hypot(relativeError(before), relativeError(after)), machine});
    if (timed) out["ratio"] = ratio, out["noise"] = std::expm1(noise);
    const char* error = before.contains("error_max") ? "error_max" : "error_rms";
    const double oldError = value(before, error), newError = value(after, error);
    if (std::isfinite(oldError)) {
        out["old_error"] = oldError;
        out["new_error"] = after.value(error, Json());
        if (!(newError <= std::max(errorGrowth * oldError, oldError + errorStep))) return "less accurate";
    }
    // Reports of earlier versions have none.
    const double oldFlip = value(before, "flip"), newFlip = value(after, "flip");
    if (newFlip - oldFlip > std::max(flipGrowth * oldFlip, value(after, "flip_noise"))) {
        out["old_error"] = oldFlip, out["new_error"] = newFlip;
        return "less accurate";
    }
    if (!timed) return std::isfinite(oldError) ? "same" : "not compared";
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
    const auto line = [&](auto... parts) { text += io::printed(parts...); };
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

namespace {

// A method with one setting, over all scenes.
struct Summed {
    Json about;
    std::array<double, 3> squares{};
    std::vector<double> nanoseconds, watts;
    double flip = 0;  // sum; NaN where a row has none
};

// The row of `group` with this scene, method and setting; null: there is none.
const Json* rowOf(const Json& device, const char* group, const std::string& scene, const Json& method,
                  const Json& setting) {
    for (const Json& e : device.at("operations"))
        if (e.value("group", "") == group && e.value("scene", "") == scene &&
            std::isfinite(value(e, "added_ms")) && e["method"] == method && e["setting"] == setting)
            return &e;
    return nullptr;
}

// Skin of a frame of this height with the head of the first scene.
double skinOf(const Json& device, const std::string& frame, double height) {
    for (const Json& e : device.at("operations"))
        if (e.value("group", "") == "frames" && e.value("scene", "") == frame && e.contains("items"))
            return e["items"];
    for (const Json& scene : device.value("scenes", Json::array()))
        return scene.at("pixels").get<double>() * std::pow(height / scene.at("height").get<double>(), 2);
    return NAN;
}

double percentile90(std::vector<double> values) {
    std::ranges::sort(values);
    return values[size_t(0.9 * double(values.size() - 1) + 0.5)];
}

// How far the square of a method's error may be from that without the walk's noise: two standard errors of
// the mean product of both halves' noise, which are sqrt(2) times as noisy as their mean.
double uncertaintyOf(const Json& device, const Json& e) {
    double variance = 0, pixels = 0;
    for (const Json& noise : e.value("noise", Json::array()))
        variance += std::pow(noise.get<double>(), 2) / 3;
    for (const Json& scene : device.value("scenes", Json::array()))
        if (scene["name"] == e["scene"]) pixels = value(scene, "compared");
    return pixels > 0 ? 2 * 2 * variance / std::sqrt(3 * pixels) : 0;
}

// Whether frames keep their time budget, and their error relative to the best method that was as fast.
void summarizeBudgets(Json& device) {
    size_t frames = 0, kept = 0, near = 0;
    double worst = 0;
    for (Json& e : device.at("operations")) {
        if (e.value("group", "") != "budgets" || !std::isfinite(value(e, "added_ms"))) continue;
        const double took = value(e, "added_ms"), error = value(e, "error_rms");
        double front = error;
        for (const Json& other : device.at("operations"))
            if (other.value("group", "") == "methods" && value(other, "added_ms") <= took &&
                other["scene"] == e["scene"] && other["setting"] != withThickness)
                front = std::min(front, value(other, "error_rms"));
        e["kept"] = took <= 1.15 * value(e, "budget_ms");
        e["front_ratio"] = error / front;
        constexpr double most = 1.3 * 1.3;
        ++frames, kept += e["kept"].get<bool>();
        near += error * error <= most * front * front + (most - 1) * uncertaintyOf(device, e);
        worst = std::max(worst, error / front);
    }
    if (frames)
        device["budgets"] = {{"frames", frames}, {"kept", kept}, {"near", near}, {"worst_ratio", worst}};
}

}  // namespace

std::string tuningText(const Json& device) {
    struct Tuned {
        std::string tunes;
        double target = 0, perFrame = 0, squares = 0;
        std::vector<double> perPixel;
    };
    std::vector<Tuned> all;
    std::map<std::string, double> empty;  // ns per pixel of a frame without skin
    const auto pixels = [](const Json& e) {
        double width = 0, height = 0;
        std::sscanf(e.value("what", "").c_str(), "%lfx%lf", &width, &height);
        return width * height;
    };
    for (const Json& e : device.at("operations"))
        if (e.value("scene", "") == "0 % of the skin" && e.contains("tunes") &&
            std::isfinite(value(e, "added_ms")))
            empty[e["tunes"]] = std::max(value(e, "added_ms"), 0.0) * 1e6 / pixels(e);
    for (const Json& e : device.at("operations")) {
        if (e.value("group", "") != "methods" || !e.contains("tunes") || !std::isfinite(value(e, "added_ms")))
            continue;
        const double target = value(e, "target_error");
        auto found = std::ranges::find_if(
            all, [&](const Tuned& t) { return t.tunes == e["tunes"] && t.target == target; });
        if (found == all.end()) found = all.insert(all.end(), {e["tunes"], target, empty[e["tunes"]]});
        found->squares += std::pow(value(e, "error_rms"), 2);
        found->perPixel.push_back(
            std::max((value(e, "added_ms") * 1e6 - found->perFrame * pixels(e)) / value(e, "items"), 0.0));
    }
    std::string text;
    if (!all.empty())
        text = "device " + device.at("name").get<std::string>() + ", " +
               device.at("platform").get<std::string>() + "\n";
    for (const Tuned& t : all)
        text += io::printed("%s %.4g %.4g %.4g %.4g\n", t.tunes.c_str(), t.target, percentile90(t.perPixel),
                            t.perFrame, std::sqrt(t.squares / double(t.perPixel.size())));
    return text;
}

void summarize(Json& device, const std::vector<double>& budgets, const std::vector<double>& errors) {
    std::vector<Summed> all;
    for (const Json& e : device.at("operations")) {
        if (e.value("group", "") != "methods" || !std::isfinite(value(e, "added_ms")) || !e.contains("rmse"))
            continue;
        auto found = std::ranges::find_if(all, [&](const Summed& s) {
            return s.about["method"] == e["method"] && s.about["setting"] == e["setting"];
        });
        if (found == all.end())
            found = all.insert(all.end(), {{{"method", e["method"]}, {"setting", e["setting"]}}, {}, {}});
        for (size_t c = 0; c < 3; ++c) found->squares[c] += std::pow(e["rmse"][c].get<double>(), 2);
        found->nanoseconds.push_back(
            std::max(e["added_ms"].get<double>() * 1e6 / e["items"].get<double>(), 0.0));
        found->flip += value(e, "flip");
        if (e.contains("watts")) found->watts.push_back(e["watts"]);
    }
    // Settings that fewer scenes have cannot be compared with the others.
    size_t scenes = 0;
    for (const Summed& s : all) scenes = std::max(scenes, s.nanoseconds.size());
    std::erase_if(all, [&](const Summed& s) { return s.nanoseconds.size() < scenes; });
    Json list = Json::array();
    for (const Summed& s : all) {
        Json e = s.about;
        double whole = 0;
        e["scenes"] = scenes;
        for (const double square : s.squares) {
            e["rmse"].push_back(std::sqrt(square / double(scenes)));
            whole += square / double(3 * scenes);
        }
        e["error"] = std::sqrt(whole);
        if (std::isfinite(s.flip)) e["flip"] = s.flip / double(scenes);
        if (!s.watts.empty()) e["watts"] = median(s.watts);
        e["ns_per_pixel"] = median(s.nanoseconds);
        e["ns_per_pixel_p90"] = percentile90(s.nanoseconds);
        for (const auto& [frame, height] : {std::pair{"1080p", 1080.0}, {"4K", 2160.0}}) {
            const Json* row = rowOf(device, "frames", frame, e["method"], e["setting"]);
            e["ms"][frame] = row ? std::max((*row)["added_ms"].get<double>(), 0.0)
                                 : median(s.nanoseconds) * 1e-6 * skinOf(device, frame, height);
            e["measured"][frame] = row != nullptr;
        }
        list.push_back(e);
    }
    const auto time = [](const Json& e) { return e["ns_per_pixel"].get<double>(); };
    const auto error = [](const Json& e) { return e["error"].get<double>(); };
    for (Json& e : list)
        e["pareto"] = std::ranges::none_of(list, [&](const Json& other) {
            return time(other) <= time(e) && error(other) <= error(e) &&
                   (time(other) < time(e) || error(other) < error(e));
        });
    device["summary"] = list;
    device["answers"] = Json::array();
    const auto answer = [&](const char* key, double limit, const auto& measure, const auto& cost) {
        const Json* best = nullptr;
        for (const Json& e : list)
            if (measure(e) <= limit && (!best || cost(e) < cost(*best))) best = &e;
        Json said = {{key, limit}};
        if (best) said["take"] = *best;
        device["answers"].push_back(said);
    };
    const auto frameTime = [](const Json& e) { return e["ms"]["1080p"].get<double>(); };
    for (const double b : budgets) answer("budget_ms", b, frameTime, error);
    for (const double e : errors) answer("error", e, error, frameTime);
    summarizeBudgets(device);
}

std::string pageOf(std::string page, const Json& reports) {
    std::string text = reports.dump(-1, ' ', false, Json::error_handler_t::replace);
    for (size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3) text.insert(at + 1, "\\");
    const std::string place = "/*reports*/ []";
    const size_t at = page.find(place);
    return at == std::string::npos ? page : page.replace(at, place.size(), text);
}

}  // namespace pellucid::bench
