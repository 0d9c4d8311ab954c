// Jobs that build programs, on several threads and with the help of other processes (cl/build_helpers.h).
#pragma once
#include <functional>

#include "cl/build_helpers.h"
#include "core/device.h"

namespace pel {

// They may run at the same time, in any order. Each builds programs and launches their kernels on nothing, or
// on the smallest possible input.
using BuildJobs = std::vector<std::function<void()>>;

// A job for each of these programs, the longest first, so that the others are built in parallel with it.
void addProgramJobs(const Ref<Device>& device, std::vector<cl::ProgramKey> keys, BuildJobs& jobs);

// So many threads or processes; 0: one per core, at most `mostHelpers`.
unsigned buildersFor(const Device& device, uint32_t threads);

// Runs the jobs on `threads` threads, calls report(jobs done) on this one, and throws the first error of
// either. Jobs that have not begun by then are left out.
void runJobs(Device& device, const BuildJobs& jobs, unsigned threads, cl::BuildHelpers& helpers,
             const std::function<void(size_t)>& report);

}  // namespace pel
