#include "cl/program_cache.h"

#include <algorithm>
#include <chrono>
#include <set>

#include "cl/build_helpers.h"
#include "cl/kernel_files.h"
#include "cl/machine.h"
#include "cl/platform.h"
#include "cl/pocl_cache.h"

namespace pel::cl {

ProgramCache::ProgramCache(Context context, cl_device_id device, Defines defines)
    : context_(std::move(context)),
      device_(device),
      defines_(std::move(defines)),
      binaries_(context_.get(), device) {}

std::string ProgramCache::optionsOf(const ProgramKey& key) const {
    Defines all = key.defines;
    all.insert(defines_.begin(), defines_.end());
    std::string options = "-cl-std=CL1.2";
    for (const auto& [name, value] : all) options += " -D" + name + "=" + value;
    if (const auto limit = all.find("PEL_REGISTERS"); limit != all.end())
        options += " -cl-nv-maxrregcount=" + std::string(limit->second);
    return options;
}

std::string ProgramCache::name(const ProgramKey& key) const {
    std::string all;
    for (const std::string& file : key.files) all += file + " ";
    return all + optionsOf(key);
}

Program ProgramCache::get(const ProgramKey& wanted) {
    const std::string options = optionsOf(wanted);
    std::unique_lock lock(mutex_);
    std::shared_ptr<Entry>& slot = programs_[name(wanted)];
    if (!slot) slot = std::make_shared<Entry>();
    const std::shared_ptr<Entry> entry = slot;
    lock.unlock();
    // A thread waits here while another one builds the program. After a failure the next thread tries again.
    std::lock_guard building(entry->building);
    if (entry->program) return entry->program;
    const auto start = std::chrono::steady_clock::now();
    Counts now;
    entry->program = build(wanted.files, options, now);
    lock.lock();
    ++counts_.built;
    counts_.loaded += now.loaded;
    counts_.stored += now.stored;
    counts_.milliseconds +=
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return entry->program;
}

ProgramCache::Counts ProgramCache::counts() const {
    std::lock_guard lock(mutex_);
    return counts_;
}

Program ProgramCache::build(const std::vector<std::string>& files, const std::string& options,
                            Counts& counts) const {
    const std::string source = kernelSource(files);
    if (isPocl(device_)) {  // PoCL ends the process if it cannot write
        checkPoclCache();
        requireMemory(0, "compiling a program");
    }
    if (Program program = binaries_.load(source, options)) {
        counts.loaded = 1;
        return program;
    }
    if (readyAlone) throw NotBuilt();
    if (BuildHelpers* const helpers = helpersOfThread)
        if (const std::string binary = helpers->compile(options, source); !binary.empty())
            if (Program program = binaries_.take(binary, source, options, counts.stored)) return program;
    Program program = compile(source, files, options);
    counts.stored = binaries_.store(program, source, options);
    return program;
}

Program ProgramCache::compile(const std::string& source, const std::vector<std::string>& files,
                              const std::string& options) const {
    const char* text = source.c_str();
    cl_int code = CL_SUCCESS;
    Program program(clCreateProgramWithSource(context_.get(), 1, &text, nullptr, &code));
    check(code, "clCreateProgramWithSource");
    code = clBuildProgram(program.get(), 1, &device_, options.c_str(), nullptr, nullptr);
    if (code == CL_SUCCESS) return program;
    size_t size = 0;
    clGetProgramBuildInfo(program.get(), device_, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size);
    std::string log(size, '\0');
    clGetProgramBuildInfo(program.get(), device_, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
    fail(PEL_ERROR_DEVICE, "kernel file ", files[0], " did not build with ", options, ": ", errorName(code),
         "\n", log.c_str());
}

namespace {

constexpr uint64_t defaultLimit = 512;  // MiB: some three hundred shading programs of a CPU

struct Use {
    bool load, store;
};

Use wanted(cl_device_id device) {
    const char* text = std::getenv("PELLUCID_CACHE");
    const std::string value = text ? text : "";
    // PoCL compiles everything again to make a binary, but loads one faster than it searches its cache.
    if (value.empty() || value == "auto")
        return {!keepsPrograms(device) || isPocl(device), !keepsPrograms(device)};
    if (value == "on" || value == "1") return {true, true};
    if (value == "off" || value == "0") return {false, false};
    invalidArgument("PELLUCID_CACHE is \"", value, "\"; it must be on, off or auto");
}

uint64_t limitBytes() {
    const char* text = std::getenv("PELLUCID_CACHE_MB");
    if (!text || !*text) return defaultLimit << 20;
    char* end = nullptr;
    const unsigned long long value = std::strtoull(text, &end, 10);
    if (*end || *text < '0' || *text > '9' || value > (1ull << 40))
        invalidArgument("PELLUCID_CACHE_MB is \"", text, "\"; it must be a number of MiB, such as ",
                        defaultLimit);
    return uint64_t(value) << 20;
}

// Environment variables that affect a driver's compiler, without those that only set a folder.
std::string settings() {
    static constexpr const char* prefixes[] = {"CL_CONFIG_", "POCL_", "RUSTICL_", "LP_", "GALLIVM_", "IGC_"};
    std::vector<std::string> found;
    for (const std::string& text : system::environment()) {
        const std::string name = text.substr(0, text.find('='));
        const bool theirs = std::any_of(std::begin(prefixes), std::end(prefixes),
                                        [&](const char* prefix) { return name.starts_with(prefix); });
        if (theirs && name.find("CACHE") == std::string::npos) found.push_back(text);
    }
    std::sort(found.begin(), found.end());
    std::string all;
    for (const std::string& entry : found) all += entry + "\n";
    return all;
}

std::string describeBuilder(cl_device_id device) {
    Digest all;
    all.addPart("2").addPart(text(pelVersion()));  // the form of the files, and the version
    for (const cl_device_info what :
         {CL_DEVICE_NAME, CL_DEVICE_VENDOR, CL_DEVICE_VERSION, CL_DRIVER_VERSION, CL_DEVICE_EXTENSIONS})
        all.addPart(infoString(device, what));
    all.addPart(platformName(device))
        .addPart(platformVersion(device))
        .addPart(system::instructionSet())
        .addPart(settings());
    return all.text();
}

}  // namespace

BinaryCache::BinaryCache(cl_context context, cl_device_id device) : context_(context), device_(device) {
    const uint64_t limit = limitBytes();
    const Use use = wanted(device);
    if (!use.load) return;
    stores_ = use.store;
    const std::filesystem::path folder = system::cacheFolder();
    if (folder.empty()) return;
    builtBy_ = describeBuilder(device);
    files_.emplace(folder, limit);
}

Program BinaryCache::load(const std::string& source, const std::string& options) const {
    if (!files_) return {};
    const std::optional<std::string> binary = files_->load(name(source, options));
    return binary ? programOf(*binary, options) : Program();
}

Program BinaryCache::take(const std::string& binary, const std::string& source, const std::string& options,
                          uint32_t& stored) const {
    Program program = programOf(binary, options);
    stored = program && files_ && files_->store(name(source, options), binary);
    return program;
}

Program BinaryCache::programOf(const std::string& binary, const std::string& options) const {
    const auto* bytes = reinterpret_cast<const unsigned char*>(binary.data());
    const size_t size = binary.size();
    cl_int status = CL_SUCCESS, code = CL_SUCCESS;
    Program program(clCreateProgramWithBinary(context_, 1, &device_, &size, &bytes, &status, &code));
    if (code != CL_SUCCESS || status != CL_SUCCESS) return {};
    if (clBuildProgram(program.get(), 1, &device_, options.c_str(), nullptr, nullptr) != CL_SUCCESS)
        return {};
    return program;
}

bool BinaryCache::store(const Program& program, const std::string& source, const std::string& options) const {
    if (!files_ || !stores_) return false;
    // A program of a context with several devices has an entry for each.
    const auto got = [&](cl_program_info what, auto* to, size_t values) {
        return clGetProgramInfo(program.get(), what, values * sizeof *to, to, nullptr) == CL_SUCCESS;
    };
    cl_uint count = 0;
    if (!got(CL_PROGRAM_NUM_DEVICES, &count, 1) || !count) return false;
    std::vector<cl_device_id> devices(count);
    std::vector<size_t> sizes(count);
    if (!got(CL_PROGRAM_DEVICES, devices.data(), count) || !got(CL_PROGRAM_BINARY_SIZES, sizes.data(), count))
        return false;
    const size_t mine = size_t(std::find(devices.begin(), devices.end(), device_) - devices.begin());
    if (mine == count || sizes[mine] == 0) return false;
    std::string binary(sizes[mine], '\0');
    std::vector<unsigned char*> places(count);  // NULL: not wanted
    places[mine] = reinterpret_cast<unsigned char*>(binary.data());
    return got(CL_PROGRAM_BINARIES, places.data(), count) && files_->store(name(source, options), binary);
}

static std::string_view find(std::string_view name) {
    for (const KernelFile& file : kernelFiles())
        if (file.name == name) return file.text;
    fail(PEL_ERROR_UNKNOWN, "no kernel file named ", name, " is embedded in this library");
}

static void expand(std::string_view name, std::set<std::string_view>& seen, std::string& out) {
    static constexpr std::string_view directive = "#include \"";
    std::string_view rest = find(name);
    // With #line, compiler messages name the file that a reader can open.
    out += text("#line 1 \"", name, "\"\n");
    for (int line = 1; !rest.empty(); ++line) {
        const size_t end = std::min(rest.find('\n'), rest.size() - 1);
        const std::string_view current = rest.substr(0, end + 1);
        rest.remove_prefix(end + 1);
        if (!current.starts_with(directive)) {
            out += current == "#pragma once\n" ? "\n" : current;  // useless in the main file, with a warning
            continue;
        }
        std::string_view included = current.substr(directive.size());
        included = included.substr(0, included.find('"'));
        for (const KernelFile& file : kernelFiles())
            if (file.name == included && seen.insert(file.name).second) expand(file.name, seen, out);
        find(included);
        out += text("#line ", line + 1, " \"", name, "\"\n");
    }
}

std::string kernelSource(std::span<const std::string> names) {
    // Clang warns of vectors wider than the registers in calls, but every function here is inlined. NVIDIA's
    // compiler warns of this line.
    std::string out = "#ifndef __NV_CL_C_VERSION\n#pragma clang diagnostic ignored \"-Wpsabi\"\n#endif\n";
    std::set<std::string_view> seen;
    for (const std::string& name : names)
        if (seen.insert(name).second) expand(name, seen, out);
    return out;
}

}  // namespace pel::cl
