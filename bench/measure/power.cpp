#include "power.h"

#include <CL/cl.h>

#include <fstream>

#include "io/shortest.h"
#include "system/process.h"

namespace pellucid::bench {
namespace {

// A counter of microjoules that begins again at 0 beyond `range`.
struct Package {
    std::string file;
    double range = 0, last = 0, sum = 0;

    bool read() {
        double now = 0;
        if (!(std::ifstream(file) >> now)) return false;
        sum += now >= last ? now - last : now + range - last;
        last = now;
        return true;
    }
};

// nvml.h: every function returns 0 for success, and devices are pointers.
struct Nvml {
    void* library = nullptr;
    template <class... Parameters>
    bool call(const char* name, Parameters... parameters) const {
        void* const found = pel::system::symbolIn(library, name);
        return found && reinterpret_cast<int (*)(Parameters...)>(found)(parameters...) == 0;
    }
};

std::string pciPlaceOf(const Device& device) {
    // cl_nv_device_attribute_query: bus, slot (five bits of the device, three of the function) and domain.
    constexpr cl_device_info names[] = {0x4008, 0x4009, 0x400A};
    void *context = nullptr, *id = nullptr, *queue = nullptr;
    check(pelDeviceGetCl(device.get(), &context, &id, &queue));
    cl_uint values[3] = {};
    for (int i = 0; i < 3; ++i)
        if (clGetDeviceInfo(static_cast<cl_device_id>(id), names[i], sizeof values[i], &values[i], nullptr) !=
            CL_SUCCESS)
            return "";
    return io::printed("%08X:%02X:%02X.%u", values[2], values[0], values[1] >> 3, values[1] & 7);
}

}  // namespace

EnergyMeter packageEnergy(const std::string& folder) {
    std::vector<Package> packages;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
        // Parts of packages (intel-rapl:0:0) and the whole machine ("psys") overlap with other counters.
        std::string name;
        if (!entry.path().filename().string().starts_with("intel-rapl:") ||
            !(std::ifstream(entry.path() / "name") >> name) || !name.starts_with("package"))
            continue;
        Package package{(entry.path() / "energy_uj").string()};
        // Only administrators may read the counters of most systems.
        if (!(std::ifstream(entry.path() / "max_energy_range_uj") >> package.range) || !package.read())
            return {};
        packages.push_back(package);
    }
    if (packages.empty()) return {};
    return [packages]() mutable {
        double sum = 0;
        for (Package& package : packages) sum += package.read() ? package.sum : NAN;
        return 1e-6 * sum;
    };
}

EnergyMeter nvidiaEnergy(const std::string& busId, const std::string& library, const Clock& now) {
    std::string why;
    const Nvml nvml{pel::system::openLibrary(library, why)};
    void* device = nullptr;
    unsigned count = 0;
    if (!nvml.library || !nvml.call("nvmlInit_v2")) return {};
    if (!nvml.call("nvmlDeviceGetHandleByPciBusId_v2", busId.c_str(), &device) &&
        !(nvml.call("nvmlDeviceGetCount_v2", &count) && count == 1 &&
          nvml.call("nvmlDeviceGetHandleByIndex_v2", 0u, &device)))
        return {};
    unsigned long long millijoules = 0;
    if (nvml.call("nvmlDeviceGetTotalEnergyConsumption", device, &millijoules))
        return [nvml, device]() {
            unsigned long long energy = 0;
            return nvml.call("nvmlDeviceGetTotalEnergyConsumption", device, &energy) ? 1e-3 * double(energy)
                                                                                     : NAN;
        };
    unsigned milliwatts = 0;
    if (!nvml.call("nvmlDeviceGetPowerUsage", device, &milliwatts)) return {};
    // GPUs before Volta count no energy.
    return [nvml, device, now, last = now(), joules = 0.0]() mutable {
        unsigned power = 0;
        if (!nvml.call("nvmlDeviceGetPowerUsage", device, &power)) return double(NAN);
        const double time = now();
        joules += 1e-6 * power * (time - last);
        last = time;
        return joules;
    };
}

EnergyMeter energyOf(const Device& device, const std::string& powercap) {
    const PelDeviceInfo info = device.info();
    if (info.type == PEL_DEVICE_CPU) return packageEnergy(powercap);
    if (std::string(info.vendor).find("NVIDIA") != std::string::npos) return nvidiaEnergy(pciPlaceOf(device));
    return {};
}

std::optional<double> meanWatts(const EnergyMeter& joules, const std::function<void()>& work,
                                const Clock& now) {
    if (!joules) return {};
    constexpr double atLeast = 400, atMost = 4000, between = 5;  // ms; reading takes time, too
    const double start = now();
    double last = joules(), from = NAN, first = 0;
    while (now() - start < atMost) {
        const double begin = now();
        do work();
        while (now() - begin < between);
        const double energy = joules(), time = now();
        if (!std::isfinite(energy)) return {};
        if (energy == last) continue;
        last = energy;
        // From one step of the counter to another.
        if (std::isnan(from))
            from = time, first = energy;
        else if (time - from >= atLeast)
            return 1e3 * (energy - first) / (time - from);
    }
    return {};
}

}  // namespace pellucid::bench
