#include "cl/program_cache.h"

#include <chrono>

#include "cl/kernel_files.h"

namespace pel::cl {

ProgramCache::ProgramCache(Context context, cl_device_id device, uint32_t mathWidth)
    : context_(std::move(context)), device_(device), mathWidth_(mathWidth) {}

Program ProgramCache::get(const std::string& file, const Defines& defines) {
    Defines all = defines;
    all.emplace("PEL_WIDTH", std::to_string(mathWidth_));
    std::string options = "-cl-std=CL1.2";
    for (const auto& [name, value] : all) options += " -D" + name + "=" + value;
    const std::string key = file + " " + options;

    std::lock_guard lock(mutex_);
    if (auto found = programs_.find(key); found != programs_.end()) return found->second;
    const auto start = std::chrono::steady_clock::now();
    Program program = build(file, options);
    buildMilliseconds_ +=
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return programs_.emplace(key, std::move(program)).first->second;
}

uint32_t ProgramCache::built() const {
    std::lock_guard lock(mutex_);
    return uint32_t(programs_.size());
}

double ProgramCache::buildMilliseconds() const {
    std::lock_guard lock(mutex_);
    return buildMilliseconds_;
}

Program ProgramCache::build(const std::string& file, const std::string& options) const {
    const std::string source = kernelSource(file);
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
    fail(PEL_ERROR_DEVICE, "kernel file ", file, " did not build with ", options, ": ", errorName(code), "\n",
         log.c_str());
}

}  // namespace pel::cl
