// Builds programs before they are needed (pelPrefillPrograms).
#pragma once
#include <functional>
#include <vector>

#include "shading/shader.h"

namespace pel {

// Pieces of the work that may run at the same time, in any order. Each builds programs and launches their kernels on nothing,
// or on the least there is.
using PrefillJobs = std::vector<std::function<void()>>;

PrefillJobs prefillGroups(const Ref<Device>& device, uint32_t groups);

// Runs them on `threads` threads (0: one per core), tells the device's progress callback, and throws the first error; jobs that
// were not begun by then are left out.
void runPrefill(Device& device, const PrefillJobs& jobs, uint32_t threads);

}  // namespace pel
