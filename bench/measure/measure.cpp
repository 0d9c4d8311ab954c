#include "measure.h"

#include <sys/utsname.h>

#include <ctime>
#include <fstream>
#include <numeric>
#include <random>
#include <thread>

#include "power.h"

namespace pellucid::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Running {
    Json entry;
    Case work;
    int repeats = 1;  // runs per sample, so that a sample is long against the clock
    int rounds = 0;   // that it takes part in: fewer than others where it is slow
    std::vector<double> wall, device;
    std::optional<double> watts{};
};

void sample(const Device& device, Running& r) {
    const double before = device.stats().kernelMilliseconds, start = milliseconds();
    for (int i = 0; i < r.repeats; ++i) r.work.run();
    const double end = milliseconds();
    r.wall.push_back((end - start) / r.repeats);
    r.device.push_back((device.stats().kernelMilliseconds - before) / r.repeats);
}

Json summary(const Running& r) {
    Json e = r.entry;
    const double time = median(r.wall);
    e["runs"] = r.wall.size() * size_t(r.repeats);
    e["samples"] = r.wall.size();
    e["median_ms"] = time;
    e["mad_ms"] = medianDeviation(r.wall);
    e["device_ms"] = median(r.device);
    e["per_second"] = r.work.items / time * 1e3;
    if (r.work.bytes > 0) e["bytes"] = r.work.bytes;
    if (r.work.operations > 0) e["operations"] = r.work.operations;
    if (r.watts) e["watts"] = *r.watts;
    return e;
}

}  // namespace

Json measureCases(const Request& request) {
    findTaps(request);
    const Device device(request.device);
    std::vector<Factory> factories;
    for (const auto& from : {deviceCases, meshCases, tableCases, shadingCases, eyeCases})
        for (Factory& f : from(device, request.quick)) factories.push_back(std::move(f));
    // Every round runs each case once, in an order of its own: machines drift, and all cases drift with them.
    const int rounds = request.quick ? 5 : 15;
    std::vector<Running> running;
    Json failed = Json::array();
    for (const Factory& f : factories) {
        if (!request.wants(f.name) && f.group != "device") continue;
        if (std::ranges::find(request.without, f.name) != request.without.end()) continue;
        Running r;
        r.entry = {{"name", f.name}, {"group", f.group}};
        request.say(f.name + ": prepared, compared with the truth");
        request.begin(f.name, f.group);
        try {
            r.work = f.make();
            r.entry["what"] = r.work.what;
            r.entry["items"] = r.work.items;
            r.entry["unit"] = r.work.unit;
            r.work.run();
            if (r.work.error) {
                const Error e = r.work.error();
                r.entry["error_max"] = finite(e.max);
                r.entry["error_rms"] = finite(e.rms);
                r.entry["truth"] = r.work.truth;
            }
            const double start = milliseconds();
            r.work.run();
            const double once = std::max(milliseconds() - start, 1e-3);
            r.repeats = int(std::clamp((request.quick ? 2.0 : 10.0) / once, 1.0, 100.0));
            r.rounds = int(std::clamp(request.limitSeconds * 1e3 / (once * r.repeats), 1.0, double(rounds)));
            running.push_back(std::move(r));
        } catch (const std::exception& e) {
            r.entry["failed"] = e.what();
            failed.push_back(r.entry);
        }
    }
    std::mt19937 random(1);
    std::vector<size_t> order(running.size());
    std::iota(order.begin(), order.end(), size_t(0));
    for (int round = 0; round < rounds && !running.empty(); ++round) {
        request.say("round " + std::to_string(round + 1) + " of " + std::to_string(rounds));
        std::shuffle(order.begin(), order.end(), random);
        for (const size_t i : order) {
            if (round >= running[i].rounds) continue;
            request.begin(running[i].entry["name"], running[i].entry["group"]);
            sample(device, running[i]);
        }
    }
    const EnergyMeter joules = energyOf(device, request.powercap);
    for (Running& r : running) {
        request.begin(r.entry["name"], r.entry["group"]);
        r.watts = meanWatts(joules, r.work.run);
    }
    double bandwidth = NAN, peak = NAN;
    for (const Running& r : running) {
        if (r.entry["name"] == copyName) bandwidth = r.work.bytes / median(r.wall) * 1e3;
        if (r.entry["name"] == arithmeticName) peak = r.work.operations / median(r.wall) * 1e3;
    }
    Json report = {{"copy_bytes_per_second", finite(bandwidth)}, {"operations_per_second", finite(peak)}};
    Json list = Json::array();
    for (const Running& r : running) {
        Json& e = list.emplace_back(summary(r));
        const double seconds = e["median_ms"].get<double>() * 1e-3;
        // Above 1, the bytes came from a cache, or the device was slower when its limits were measured: then
        // the share is not known.
        const auto share = [&](const char* key, double work, double limit) {
            const double part = work / seconds / limit;
            if (work > 0 && std::isfinite(limit)) e[key] = part < 1.001 ? Json(std::min(part, 1.0)) : Json();
        };
        share("bandwidth_share", r.work.bytes, bandwidth);
        share("arithmetic_share", r.work.operations, peak);
    }
    for (const Json& e : failed) list.push_back(e);
    report["operations"] = list;
    return report;
}

Json firstUse(const std::string& selector) {
    const double start = milliseconds();
    const Device device(selector);
    const double opened = milliseconds();
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = desc.height = 64;
    const Lut lut(device, desc);
    const double table = milliseconds();
    const std::vector<float> normals(64 * 64 * 3, 0.57735027f), curvature(64 * 64, 0.1f);
    const Buffer target(device, normals.size() * sizeof(float));
    Shader shader(device);
    shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, 64, 64));
    shader.set(PEL_SLOT_NORMAL_SHADING, imageDesc(Buffer(device, normals), PEL_FORMAT_RGB32F, 64, 64));
    shader.set(PEL_SLOT_CURVATURE, imageDesc(Buffer(device, curvature), PEL_FORMAT_R32F, 64, 64));
    shader.setMaterial(1, pelMaterialDefaults(), lut).set(std::vector<PelLight>{pelLightDefaults()});
    shader.commit().execute();
    const double shaded = milliseconds();
    return {{"device_ms", opened - start},
            {"table_ms", table - opened},
            {"shade_ms", shaded - table},
            {"total_ms", shaded - start}};
}

Json describeHost() {
    utsname system{};
    ::uname(&system);
    std::string cpu;
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line) && cpu.empty();)
        if (line.starts_with("model name")) cpu = line.substr(line.find(':') + 2);
    char date[32] = "";
    const std::time_t now = std::time(nullptr);
    std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
    const uint32_t v = pelVersion();
    return {{"format", reportFormat},
            {"pellucid",
             std::to_string(v / 10000) + "." + std::to_string(v / 100 % 100) + "." + std::to_string(v % 100)},
            {"date", date},
            {"cpu", cpu},
            {"cores", std::thread::hardware_concurrency()},
            {"system", std::string(system.sysname) + " " + system.machine}};
}

}  // namespace pellucid::bench
