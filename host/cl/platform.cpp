#include "cl/platform.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <mutex>
#include <optional>

#include "cl/machine.h"
#include "cl/opencl_loader.h"
#include "cl/pocl_cache.h"

namespace pel::cl {
namespace {

constexpr const char* pocl = "Portable Computing Language";
constexpr const char* missingPackage =
    "no OpenCL device was found: install a driver, for example PoCL for the CPU (Debian: apt-get install "
    "pocl-opencl-icd), or the one of your GPU's vendor";

// PoCL reports no device at all if it cannot write to the folder that POCL_CACHE_DIR names. Returns what is
// wrong with that folder, "" for nothing.
std::string poclFolderTrouble() {
    namespace fs = std::filesystem;
    const char* folder = std::getenv("POCL_CACHE_DIR");
    if (!folder || !*folder) return {};
    std::error_code error;
    fs::create_directories(folder, error);
    const std::string why = error ? error.message() : whyNotWritable(folder);
    if (why.empty()) return {};
    return text("; PoCL also reports no device if it cannot write to POCL_CACHE_DIR, ", folder, " (", why,
                "): set it to another folder, or unset it");
}

template <class T>
T info(cl_device_id device, cl_device_info what) {
    T value{};
    check(clGetDeviceInfo(device, what, sizeof value, &value, nullptr), "clGetDeviceInfo");
    return value;
}

template <size_t N>
void copyText(char (&to)[N], const std::string& from) {
    std::strncpy(to, from.c_str(), N - 1);
    to[N - 1] = '\0';
}

std::string lower(std::string s) {
    std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return std::tolower(c); });
    return s;
}

std::string list(const std::vector<PelDeviceInfo>& devices) {
    std::string out;
    for (const PelDeviceInfo& d : devices) out += text("\n  ", d.index, ": ", d.name, " (", d.platform, ")");
    return out;
}

// Better devices have more peak arithmetic. OpenCL reports only the clock and the number of units.
uint64_t strength(const PelDeviceInfo& d) {
    const uint64_t kind = d.type == PEL_DEVICE_GPU ? 2 : d.type == PEL_DEVICE_CPU ? 1 : 0;
    return kind << 48 | uint64_t(d.computeUnits) * std::max(1u, d.clockMhz);
}

// PELLUCID_MATH_WIDTH, so that a CPU can test and time the kernels of other devices.
std::optional<uint32_t> requestedMathWidth() {
    const char* text = std::getenv("PELLUCID_MATH_WIDTH");
    if (!text || !*text) return {};
    for (const uint32_t width : {1u, 8u, 16u})
        if (text == std::to_string(width)) return width;
    invalidArgument("PELLUCID_MATH_WIDTH is \"", text, "\"; it must be 1, 8 or 16");
}

}  // namespace

static std::string platformString(cl_device_id device, cl_platform_info what) {
    const auto platform = info<cl_platform_id>(device, CL_DEVICE_PLATFORM);
    return queryString("clGetPlatformInfo", [&](size_t room, void* to, size_t* size) {
        return clGetPlatformInfo(platform, what, room, to, size);
    });
}

std::string platformName(cl_device_id device) {
    return platformString(device, CL_PLATFORM_NAME);
}

std::string platformVersion(cl_device_id device) {
    return platformString(device, CL_PLATFORM_VERSION);
}

bool isPocl(cl_device_id device) {
    return platformName(device) == pocl;
}

bool keepsPrograms(cl_device_id device) {
    const std::string platform = platformName(device);
    // Drivers whose programs this library does not keep by itself. PoCL would compile everything once more to
    // make binaries, NVIDIA has ~/.nv/ComputeCache, Oclgrind compiles next to nothing.
    return platform == pocl || platform == "NVIDIA CUDA" || platform == "Oclgrind";
}

std::string infoString(cl_device_id device, cl_device_info what) {
    return queryString("clGetDeviceInfo", [&](size_t room, void* to, size_t* size) {
        return clGetDeviceInfo(device, what, room, to, size);
    });
}

std::vector<cl_device_id> allDevices() {
    claimProcess();
    // Loaders load their drivers at the first call. If a second call comes meanwhile, ocl-icd reports no
    // platforms, or crashes. The lock is never destroyed: devices may be made while the process ends.
    static std::mutex& loading = *new std::mutex;
    std::lock_guard lock(loading);
    choosePoclCache();
    cl_uint count = 0;
    // A loader without platforms returns an error. Here it means an empty list.
    if (clGetPlatformIDs(0, nullptr, &count) != CL_SUCCESS || count == 0) return {};
    std::vector<cl_platform_id> platforms(count);
    check(clGetPlatformIDs(count, platforms.data(), nullptr), "clGetPlatformIDs");
    std::vector<cl_device_id> all;
    for (cl_platform_id platform : platforms) {
        cl_uint devices = 0;
        if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &devices) != CL_SUCCESS) continue;
        const size_t first = all.size();
        all.resize(first + devices);
        check(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, devices, all.data() + first, nullptr),
              "clGetDeviceIDs");
    }
    poclCacheIsChosen();
    return all;
}

PelDeviceInfo describe(cl_device_id device, uint32_t index) {
    PelDeviceInfo d = pelDeviceInfoDefaults();
    d.index = index;
    const auto type = info<cl_device_type>(device, CL_DEVICE_TYPE);
    d.type = type & CL_DEVICE_TYPE_GPU   ? PEL_DEVICE_GPU
             : type & CL_DEVICE_TYPE_CPU ? PEL_DEVICE_CPU
                                         : PEL_DEVICE_ACCELERATOR;
    d.computeUnits = info<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS);
    d.clockMhz = info<cl_uint>(device, CL_DEVICE_MAX_CLOCK_FREQUENCY);
    d.preferredFloatWidth = info<cl_uint>(device, CL_DEVICE_PREFERRED_VECTOR_WIDTH_FLOAT);
    d.sharedMemory = info<cl_bool>(device, CL_DEVICE_HOST_UNIFIED_MEMORY);
    d.globalMemoryBytes = info<cl_ulong>(device, CL_DEVICE_GLOBAL_MEM_SIZE);
    d.maxAllocationBytes = info<cl_ulong>(device, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
    d.localMemoryBytes = info<cl_ulong>(device, CL_DEVICE_LOCAL_MEM_SIZE);
    d.maxWorkGroupSize = info<size_t>(device, CL_DEVICE_MAX_WORK_GROUP_SIZE);
    copyText(d.name, infoString(device, CL_DEVICE_NAME));
    copyText(d.vendor, infoString(device, CL_DEVICE_VENDOR));
    copyText(d.version, infoString(device, CL_DEVICE_VERSION));
    copyText(d.driver, infoString(device, CL_DRIVER_VERSION));
    const std::string platform = platformName(device);
    copyText(d.platform, platform);

    // CPUs vectorise explicit vector types, GPUs vectorise across work-items (docs/dataflow.md, "Widths"). A
    // driver without vectors on a CPU (rusticl on llvmpipe) gets one lane, since it would make eight of each.
    // Intel's driver prefers 1 and has 16, but its compiler crashes on 16-wide kernels of the default method.
    const uint32_t lanes =
        std::max(d.preferredFloatWidth, info<cl_uint>(device, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT));
    const bool intel = platform.starts_with("Intel");
    d.mathWidth = d.type != PEL_DEVICE_CPU || lanes <= 1 ? 1 : lanes >= 16 && !intel ? 16 : 8;
    d.mathWidth = requestedMathWidth().value_or(d.mathWidth);
    std::string quirks;
    if (d.mathWidth > 1) quirks += text("explicit ", d.mathWidth, "-wide arithmetic; ");
    if (platform == pocl)
        quirks +=
            "fixed work-group sizes, short ranges and no global offsets (each is compiled anew); program "
            "binaries by a warm-up alone (own cache); ";
    if (platform == "rusticl" && std::string(d.driver).starts_with("22."))
        quirks += "its compiler crashes on kernels of auto, screen and light scattering; ";
    if (!quirks.empty()) quirks.resize(quirks.size() - 2);
    copyText(d.quirks, quirks);
    return d;
}

uint32_t selectDevice(const char* selector) {
    const char* source = "the device selector";
    if (!selector || !*selector) {
        selector = std::getenv("PELLUCID_DEVICE");
        source = "PELLUCID_DEVICE";
    }
    const std::vector<cl_device_id> ids = allDevices();
    if (ids.empty()) {
        if (const std::string why = whyNoLoader(); !why.empty()) fail(PEL_ERROR_NO_DEVICE, why);
        const std::string trouble = poclFolderTrouble();
        if (!trouble.empty()) fail(PEL_ERROR_NO_DEVICE, "no OpenCL device was found", trouble);
        fail(PEL_ERROR_NO_DEVICE, missingPackage);
    }
    std::vector<PelDeviceInfo> devices;
    for (size_t i = 0; i < ids.size(); ++i) devices.push_back(describe(ids[i], uint32_t(i)));

    std::vector<PelDeviceInfo> matches;
    const std::string wanted = lower(selector ? selector : "");
    const bool number = !wanted.empty() && std::all_of(wanted.begin(), wanted.end(),
                                                       [](unsigned char c) { return std::isdigit(c); });
    for (const PelDeviceInfo& d : devices) {
        const char* type = d.type == PEL_DEVICE_GPU   ? "gpu"
                           : d.type == PEL_DEVICE_CPU ? "cpu"
                                                      : "accelerator";
        if (wanted.empty() || (number && wanted == std::to_string(d.index)) || (!number && wanted == type))
            matches.push_back(d);
    }
    if (matches.empty() && !number)
        for (const PelDeviceInfo& d : devices)
            if (lower(text(d.name, " ", d.platform)).find(wanted) != std::string::npos) matches.push_back(d);
    if (matches.empty())
        fail(PEL_ERROR_NO_DEVICE, source, " \"", selector,
             "\" matches no OpenCL device; there are:", list(devices));
    return std::max_element(matches.begin(), matches.end(),
                            [](const auto& a, const auto& b) { return strength(a) < strength(b); })
        ->index;
}

}  // namespace pel::cl
