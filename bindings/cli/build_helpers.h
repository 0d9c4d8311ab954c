// Processes that compile kernels beside this one. PoCL compiles one kernel at a time in a process, and keeps
// kernels on disk.
#pragma once
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "pellucid/pellucid.hpp"
#include "system/process.h"

namespace pellucid::cli {

// Make it before the programs of a scene are built, and call finish() afterwards. Where building takes longer
// than a moment, other cores run `pellucid warm-up` for the same scene; each process builds what no other has
// begun. After a second, a line on standard error says what takes the time.
class BuildHelpers {
  public:
    // Without a scene no other process helps.
    BuildHelpers(const Device& device, const std::string& selector, const std::string& scene);
    ~BuildHelpers();
    // Waits for what the others have begun.
    void finish();

  private:
    void start(const std::string& selector, const std::string& scene);

    std::string folder_;  // of what each process has begun; "": nothing is shared
    std::vector<pel::system::Child> helpers_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool done_ = false;
    std::thread starter_;
};

}  // namespace pellucid::cli
