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

    // The binary of a program, once a process has compiled it; waits for one that is free. Empty if none can:
    // this process has to. Any thread may call it.
    std::string compile(const std::string& options, const std::string& source);
    // Ends the processes; from now on calls throw PEL_ERROR_CANCELLED.
    void cancel();
    void checkCancelled();

    // Those whom this thread asks for programs (HelpScope), or nullptr.
    static BuildHelpers* ofThread();

  private:
    void throwIfCancelled() const;

    std::mutex mutex_;  // of the rest
    std::condition_variable freed_;
    std::vector<std::string> words_;  // that start one; none: there are no helpers
    std::vector<std::unique_ptr<system::Child>> idle_, busy_;
    unsigned most_;
    bool cancelled_ = false;
};

// During its lifetime this thread has programs compiled by `helpers`.
class HelpScope {
  public:
    explicit HelpScope(BuildHelpers& helpers);
    ~HelpScope();
    HelpScope(const HelpScope&) = delete;

  private:
    BuildHelpers* outer_;
};

// During its lifetime this thread gets programs that are in memory or on disk; for others ProgramCache throws
// NotBuilt.
class ReadyScope {
  public:
    ReadyScope();
    ~ReadyScope();
    ReadyScope(const ReadyScope&) = delete;
    static bool active();

  private:
    bool outer_;
};
struct NotBuilt {};

}  // namespace pel::cl
