// Searches the inputs of every operation for the worst error against the double-precision oracle of the
// tests, on one device, and writes what it found as JSON; bench/stability/write_page makes docs/stability.md of
// such records. Ends with 1 where an error is beyond its limit.
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "stability.h"

using namespace stability;

namespace {

constexpr const char* usage =
    "usage: stability [--json FILE] [--share S] [--seconds N] [--only NAME] [--list]\n"
    "  PELLUCID_DEVICE and PELLUCID_MATH_WIDTH choose the device and its lanes.\n"
    "  --json FILE   where the record goes\n"
    "  --share S     of the full search's points; 1 (0.001: a few seconds, for a test)\n"
    "  --seconds N   stop an operation after this time; the record then says so. 600\n"
    "  --only NAME   operations that have it in their names\n"
    "  --list        names only\n";

const char* unitName(Unit unit) {
    constexpr const char* names[] = {"absolute, relative above 1", "of the largest", "mm", "beyond rounding",
                                     "of a step, beyond rounding"};
    return names[int(unit)];
}

std::string quoted(const std::string& s) {
    std::string out = "\"";
    for (char c : s) {
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + '"';
}
// NaN, which JSON has not, as null.
std::string number(double v) {
    return std::isfinite(v) ? text("%.3g", v) : "null";
}

std::string record(const Operation& o, const Found& f) {
    std::string json =
        "    {\"name\": " + quoted(o.header.name) + ", \"range\": " + quoted(o.header.range) +
        ", \"unit\": " + quoted(unitName(o.header.unit)) + ",\n     \"limit\": " + number(o.header.limit) +
        ", \"limitName\": " + quoted(o.header.limit.name) + ", \"points\": " + std::to_string(f.points) +
        ", \"stopped\": " + (f.stopped ? "true" : "false") + ",\n     \"drawn\": " + number(f.drawn) +
        ", \"worst\": " + number(f.worst) + ", \"inherent\": " + number(f.inherent) +
        ", \"where\": " + quoted(f.where);
    if (o.axis) {
        json += ",\n     \"axis\": {\"label\": " + quoted(o.axis->label) +
                ", \"low\": " + number(o.axis->low) + ", \"high\": " + number(o.axis->high) + ", \"worst\": [";
        for (size_t i = 0; i < f.alongAxis.size(); ++i) json += (i ? ", " : "") + number(f.alongAxis[i]);
        json += "]}";
    }
    return json + "}";
}

void write(const char* path, double share, const std::string& records) {
    const PelDeviceInfo info = device().info();
    const std::string whole =
        "{\"device\": " + quoted(info.name) + ", \"platform\": " + quoted(info.platform) +
        ", \"driver\": " + quoted(info.driver) + ", \"width\": " + std::to_string(info.mathWidth) +
        ", \"share\": " + number(share) + ",\n  \"operations\": [\n" + records + "\n]}\n";
    FILE* file = std::fopen(path, "w");
    if (!file || std::fputs(whole.c_str(), file) < 0 || std::fclose(file) != 0)
        throw std::runtime_error(std::string(path) + ": " + std::strerror(errno));
}

}  // namespace

int main(int argc, char** argv) try {
    const char *json = nullptr, *only = "";
    double share = 1, seconds = 600;
    bool list = false;
    for (int i = 1; i < argc; ++i) {
        const bool more = i + 1 < argc;
        if (!std::strcmp(argv[i], "--list"))
            list = true;
        else if (!std::strcmp(argv[i], "--json") && more)
            json = argv[++i];
        else if (!std::strcmp(argv[i], "--share") && more)
            share = std::atof(argv[++i]);
        else if (!std::strcmp(argv[i], "--seconds") && more)
            seconds = std::atof(argv[++i]);
        else if (!std::strcmp(argv[i], "--only") && more)
            only = argv[++i];
        else
            return std::fputs(usage, stderr), 2;
    }
    std::string records;
    bool within = true;
    for (const auto& some : {tableOperations(), profileOperations(), encodingOperations(), meshOperations(),
                             smoothingOperations(), screenOperations(), normalOperations(),
                             shadingOperations(), formOperations(), formatOperations()})
        for (const Operation& o : some) {
            if (o.header.name.find(only) == std::string::npos) continue;
            if (list) {
                std::puts(o.header.name.c_str());
                continue;
            }
            const auto start = std::chrono::steady_clock::now();
            const Found f = search(o, share, seconds);
            const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            const bool fine = f.worst <= o.header.limit;
            within &= fine;
            std::printf(
                "%-55s %9.2g  drawn %9.2g  inherent %9.2g  limit %9.2g  %zu points in %.1f s%s%s\n    %s\n",
                o.header.name.c_str(), f.worst, f.drawn, f.inherent, o.header.limit.value, f.points, took,
                f.stopped ? ", stopped" : "", fine ? "" : "  BEYOND THE LIMIT", f.where.c_str());
            std::fflush(stdout);
            records += (records.empty() ? "" : ",\n") + record(o, f);
            if (json) write(json, share, records);  // as far as it is: searches are long
        }
    return within ? 0 : 1;
} catch (const std::exception& e) {
    return std::fprintf(stderr, "stability: %s\n", e.what()), 2;
}
