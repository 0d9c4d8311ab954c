#include "cl/program_cache.h"

#include <chrono>

#include "cl/host_memory.h"
#include "cl/kernel_files.h"
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
    // A thread that asks for a program which another thread is building waits here. After a failure the next
    // one tries again.
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

}  // namespace pel::cl
