// Warm-up: builds programs before they are needed (pelWarmUpPrograms).
#pragma once
#include <functional>
#include <vector>

#include "shading/shader.h"

namespace pel {

// Jobs that may run at the same time, in any order. Each builds programs and launches their kernels on
// nothing, or on the smallest possible input.
using WarmUpJobs = std::vector<std::function<void()>>;

WarmUpJobs jobsOfGroups(const Ref<Device>& device, uint32_t groups);

// Runs them on `threads` threads (0: one per core), reports progress to the device's callback, and throws the
// first error. Jobs that have not begun by then are left out.
void runJobs(Device& device, const WarmUpJobs& jobs, uint32_t threads);

}  // namespace pel
