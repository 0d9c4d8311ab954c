// With PELLUCID_CHECK_LEFT set, a process that leaves handles unreleased reports them and ends with 1.
#include <cstdio>
#include <cstdlib>

#include "cl/process.h"
#include "core/handle_table.h"

namespace pel {
namespace {

// After all static objects of whoever uses the library. A fork holds what its parent does.
[[gnu::destructor]] void tellWhatIsLeft() {
    const uint64_t handles = liveHandles(), objects = Object::alive();
    if ((handles == 0 && objects == 0) || !std::getenv("PELLUCID_CHECK_LEFT") || cl::isFork()) return;
    std::fprintf(stderr, "\npellucid: %llu handles were never released; %llu objects are left\n",
                 static_cast<unsigned long long>(handles), static_cast<unsigned long long>(objects));
    std::fflush(nullptr);
    std::_Exit(1);
}

}  // namespace
}  // namespace pel
