// Counts the library's calls of OpenCL, between it and the loader (cl_spy.cpp is linked before the loader
// into each test program). If OpenCL objects are left at the end of the program, or a kernel compiled with
// warnings, the spy fails the program. With PELLUCID_FENCE=begin or =end a kernel on the CPU that reads
// before or behind a buffer ends the program.
#pragma once
#include <cstdint>

namespace spy {

struct [[gnu::visibility("default")]] Counts {
    // References that the library holds now.
    int64_t contexts, queues, memory, programs, kernels, events;
    // of buffers that live now; parts of buffers and the host's own memory are not counted
    int64_t memoryBytes;
    // Since the program began.
    uint64_t buffersMade;  // clCreateBuffer that succeeded
    // by CL_MEM_COPY_HOST_PTR and the enqueued reads, writes and copies between buffers
    uint64_t bytesCopied;
    uint64_t transfers;    // how many of those
    uint64_t launches;     // clEnqueueNDRangeKernel that succeeded
    uint64_t bytesFilled;  // by clEnqueueFillBuffer
    uint64_t fills;        // how many of those
    uint64_t waits;        // clFinish and clWaitForEvents
    uint64_t builds;       // clBuildProgram

    int64_t left() const {
        return contexts + queues + memory + programs + kernels + events;
    }
};

[[gnu::visibility("default")]] Counts counts();
// Of one kernel, since the program began; and programs that were made from source which has its name.
[[gnu::visibility("default")]] uint64_t launchesOf(const char* kernel);
[[gnu::visibility("default")]] uint64_t programsWith(const char* kernel);

// Calls that fail on demand, before they reach OpenCL. `host` is for programs with other calls to fail.
enum class Call { none, host, createBuffer, createKernel, launch, destructorCallback };
// From now on the nth call of this kind fails, and where that is `lasting` all after it.
[[gnu::visibility("default")]] void failAt(Call call, int nth, bool lasting = false);
// Whether this call has to fail; and the number of calls before the first failure, 0 or less after it.
[[gnu::visibility("default")]] bool strikes(Call call);
[[gnu::visibility("default")]] int callsUntilFailure();

}  // namespace spy
