// Other processes that compile programs. PoCL compiles one kernel at a time in a process, and launches none
// meanwhile; several processes use all cores, and leave this one free.
#pragma once
#include <condition_variable>
#include <memory>
#include <mutex>

#include "cl/handle.h"
#include "system/process.h"

namespace pel::cl {

// At most so many processes, each started when all others are busy, and ended with this object.
class BuildHelpers {
  public:
    BuildHelpers(cl_device_id device, unsigned most);
    ~BuildHelpers();

    // The binary of a program; waits for a process that is free, and for its result. Empty if none can
    // compile it: then this process must. Any thread may call it.
    std::string compile(const std::string& options, const std::string& source);
    // Ends the processes; from now on calls throw PEL_ERROR_CANCELLED.
    void cancel();
    void checkCancelled();

  private:
    void throwIfCancelled() const {
        if (cancelled_) fail(PEL_ERROR_CANCELLED, "the building of programs was cancelled");
    }

    std::mutex mutex_;  // of the rest
    std::condition_variable freed_;
    std::vector<std::string> words_;  // that start one; none: there are no helpers
    std::vector<std::unique_ptr<system::Child>> idle_, busy_;
    unsigned most_;
    bool cancelled_ = false;
};

// Per thread: the helpers that compile its programs, or nullptr; and whether it only gets programs in memory
// or on disk, while ProgramCache throws NotBuilt for others.
inline thread_local BuildHelpers* helpersOfThread = nullptr;
inline thread_local bool readyAlone = false;
struct NotBuilt {};

// Sets one of these to another value during its lifetime.
template <class T>
struct ThreadScope {
    ThreadScope(T& variable, T value) : variable(variable), outer(std::exchange(variable, value)) {}
    ~ThreadScope() { variable = outer; }
    ThreadScope(const ThreadScope&) = delete;
    T &variable, outer;
};
struct HelpScope : ThreadScope<BuildHelpers*> {
    explicit HelpScope(BuildHelpers& helpers) : ThreadScope(helpersOfThread, &helpers) {}
};
struct ReadyScope : ThreadScope<bool> {
    ReadyScope() : ThreadScope(readyAlone, true) {}
};

}  // namespace pel::cl
