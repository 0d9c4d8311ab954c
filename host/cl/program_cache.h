// Programs built for one device, each once, by kernel file and options.
#pragma once
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "cl/handle.h"

namespace pel::cl {

// Compile-time choices of a program, NAME=VALUE. Structure only (features, formats, counts); numbers are
// kernel arguments.
using Defines = std::map<std::string, std::string>;

class ProgramCache {
  public:
    ProgramCache(Context context, cl_device_id device, uint32_t mathWidth);

    // Thread-safe. PEL_WIDTH (the device's math width) is defined unless `defines` says otherwise.
    Program get(const std::string& file, const Defines& defines);

    uint32_t built() const;
    double buildMilliseconds() const;

  private:
    Program build(const std::string& file, const std::string& options) const;

    Context context_;
    cl_device_id device_;
    uint32_t mathWidth_;
    mutable std::mutex mutex_;
    std::map<std::string, Program> programs_;
    double buildMilliseconds_ = 0;
};

}  // namespace pel::cl
