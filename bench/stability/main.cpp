// Searches the inputs of every operation for the worst error against the double-precision oracle of the
// tests, on one device, and writes what it found as JSON; bench/stability/write_page makes docs/stability.md
// of such records. Ends with 1 where an error is beyond its limit.
#include <CLI/CLI.hpp>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>

#include "stability.h"

using namespace stability;
using Json = nlohmann::ordered_json;

namespace {

const char* unitName(Unit unit) {
    constexpr const char* names[] = {"absolute, relative above 1", "of the largest", "mm"};
    return names[int(unit)];
}

// Three digits; NaN, which JSON has not, as null.
Json number(double v) {
    return std::isfinite(v) ? Json::parse(text("%.3g", v)) : Json();
}

Json record(const Operation& o, const Found& f) {
    Json json = {{"name", o.header.name},
                 {"range", o.header.range},
                 {"unit", unitName(o.header.unit)},
                 {"limit", number(o.header.limit)},
                 {"limitName", o.header.limit.name},
                 {"points", f.points},
                 {"stopped", f.stopped},
                 {"drawn", number(f.drawn)},
                 {"worst", number(f.worst)},
                 {"inherent", number(f.inherent)},
                 {"where", f.where}};
    if (o.axis) {
        json["axis"] = {{"label", o.axis->label},
                        {"low", number(o.axis->low)},
                        {"high", number(o.axis->high)},
                        {"worst", Json::array()}};
        for (const double worst : f.alongAxis) json["axis"]["worst"].push_back(number(worst));
    }
    return json;
}

void write(const std::string& path, double share, const Json& records) {
    const PelDeviceInfo info = device().info();
    const Json whole = {{"device", info.name},     {"platform", info.platform}, {"driver", info.driver},
                        {"width", info.mathWidth}, {"share", number(share)},    {"operations", records}};
    std::ofstream file(path);
    if (!(file << whole.dump(1) << '\n' << std::flush))
        throw std::runtime_error(path + ": cannot be written");
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app(
        "Worst errors of every operation; PELLUCID_DEVICE and PELLUCID_MATH_WIDTH choose the device and its "
        "lanes.");
    std::string json, only;
    double share = 1, seconds = 600;
    bool list = false;
    app.add_option("--json", json, "where the record goes");
    app.add_option("--share", share, "of the full search's points; 0.001: a few seconds, for a test")
        ->capture_default_str();
    app.add_option("--seconds", seconds, "stop an operation after this time; the record then says so")
        ->capture_default_str();
    app.add_option("--only", only, "operations that have it in their names");
    app.add_flag("--list", list, "names only");
    CLI11_PARSE(app, argc, argv);
    Json records = Json::array();
    bool within = true;
    for (const auto& some : {tableOperations(), profileOperations(), meshOperations(), smoothingOperations(),
                             screenOperations(), shadingOperations()})
        for (const Operation& o : some) {
            if (o.header.name.find(only) == std::string::npos) continue;
            if (list) {
                std::puts(o.header.name.c_str());
                continue;
            }
            const auto start = std::chrono::steady_clock::now();
            const Found f = search(o, share, seconds);
            const double took =
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            const bool fine = f.worst <= o.header.limit;
            within &= fine;
            std::printf(
                "%-55s %9.2g  drawn %9.2g  inherent %9.2g  limit %9.2g  %zu points in %.1f s%s%s\n    %s\n",
                o.header.name.c_str(), f.worst, f.drawn, f.inherent, o.header.limit.value, f.points, took,
                f.stopped ? ", stopped" : "", fine ? "" : "  BEYOND THE LIMIT", f.where.c_str());
            std::fflush(stdout);
            records.push_back(record(o, f));
            if (!json.empty()) write(json, share, records);  // as far as it is: searches are long
        }
    return within ? 0 : 1;
} catch (const std::exception& e) {
    return std::fprintf(stderr, "stability: %s\n", e.what()), 2;
}
