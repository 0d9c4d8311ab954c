// Programs built for one device, each once, by kernel file and options.
#pragma once
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "cl/handle.h"

namespace pel::cl {

// Compile-time choices of a program, NAME=VALUE. Structure only (features, formats, counts); numbers are
// kernel arguments.
using Defines = std::map<std::string, std::string>;

// What makes a program: kernel files, one after the other, each file that they include once; and choices. Two requests of
// one meaning are equal.
struct ProgramKey {
    std::vector<std::string> files;
    Defines defines;
    bool operator==(const ProgramKey&) const = default;
};

class ProgramCache {
  public:
    ProgramCache(Context context, cl_device_id device, uint32_t mathWidth);

    // Thread-safe; different programs are built at the same time by threads that ask for them, where the driver can do that.
    // PEL_WIDTH (the device's math width) is defined unless `defines` says otherwise.
    Program get(const ProgramKey& key);
    Program get(const std::string& file, const Defines& defines) { return get(ProgramKey{{file}, defines}); }

    uint32_t built() const;
    double buildMilliseconds() const;

  private:
    struct Entry {
        std::mutex building;
        Program program;
    };
    Program build(const std::vector<std::string>& files, const std::string& options) const;

    Context context_;
    cl_device_id device_;
    uint32_t mathWidth_;
    mutable std::mutex mutex_;  // of the rest
    std::map<std::string, std::shared_ptr<Entry>> programs_;
    uint32_t built_ = 0;
    double buildMilliseconds_ = 0;
};

}  // namespace pel::cl
