// A warm-up that several processes share. PoCL compiles one kernel at a time in a process, and keeps kernels
// on disk. PELLUCID_BUILD_SHARE names a folder; each process that sees the variable builds what no other has
// begun.
#pragma once
#include <string>

#include "cl/handle.h"

namespace pel::cl {

// Whether this process is the first to claim `what`; always true without a folder.
bool claimBuild(const std::string& what);
// Whether this process only helps another one: PELLUCID_BUILD_SHARE begins with "helper:".
bool helpsToBuild();

// During its lifetime this thread launches kernels only so that the driver compiles them, on memory of zeros.
class BuildScope {
  public:
    enum Launches { all, claimed, none };
    explicit BuildScope(Launches launches);
    ~BuildScope();
    BuildScope(const BuildScope&) = delete;

    // Whether new memory must be zero, because the kernel that writes to it may be skipped.
    static bool zeroes();
    // Whether this process launches a kernel of the program.
    static bool launches(cl_program program, const char* kernel, cl_command_queue queue);

  private:
    const BuildScope* outer_;
    Launches launches_;
};

}  // namespace pel::cl
