// Services of the operating system for host/cl: memory, private folders, and whether this process is a fork.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>

namespace pel::cl {

// Whole pages of zeros, all committed: systems overcommit memory, and end the process that touches the last
// page. nullptr if there is not enough.
void* mapPages(size_t bytes);
// Zeros whose pages are allocated when a thread first touches them.
void* mapZeros(size_t bytes);
// Frees memory of either function.
void unmapPages(void* at, size_t bytes);

// nullptr if there is not enough. `bytes` is a multiple of `alignment`, a power of two.
void* allocateAligned(size_t alignment, size_t bytes);
void freeAligned(void* at);

// Throws PEL_ERROR_OUT_OF_MEMORY if so many more bytes would not leave enough of the machine, the control
// group or the address space (ulimit -v) for drivers and others: without this check, processes end without an
// error.
void requireMemory(uint64_t bytes, const char* what);
// Seconds since the machine started; 0 where that is not known.
double uptime();

// Private folders: they hold machine code that this process will run, so nobody else may write there.

// Makes the folder and its missing parents, for this user alone. False if that is not possible.
bool makePrivateFolder(const std::filesystem::path& folder);

// The reason why others could change files in the folder or replace the folder; "" if they cannot. The folder
// and all its parents must belong to this user or root. Others may write to a parent only if they cannot
// rename files of other users there (as in /tmp).
std::string whyNotPrivate(const std::filesystem::path& folder);

// The system's reason why this process cannot make files in the folder; "" if it can.
std::string whyNotWritable(const std::filesystem::path& folder);

// Bytes that can still be written there; 0 if none.
uint64_t roomIn(const std::filesystem::path& folder);

// Forked processes. A fork has none of the threads of OpenCL's drivers: it would wait for them for ever.

// Before the first use of OpenCL: from now on this process may use it. Throws as checkProcess does.
void claimProcess();
// Whether this process is a fork of the owner.
bool isFork();
// Throws PEL_ERROR_INVALID_STATE in a fork.
void checkProcess();

}  // namespace pel::cl
