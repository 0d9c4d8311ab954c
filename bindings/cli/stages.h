// The table of stages that a long command prints on stderr, one line at the end of each: time, bytes and
// items.
#pragma once
#include <chrono>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "command.h"

namespace pellucid::cli {

class Stages {
  public:
    explicit Stages(const Run& run) : run_(run) {}

    // Runs `work` as a stage and measures wall and device time. The caller counts the work: `count` items of
    // kind `unit`, and `bytes` read and written.
    template <class Work>
    void measure(const std::string& name, uint64_t count, const char* unit, uint64_t bytes, Work&& work) {
        begin(name);
        const double device = run_.deviceMilliseconds();
        const auto start = std::chrono::steady_clock::now();
        work();
        const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;
        add(name, wall.count(), run_.deviceMilliseconds() - device, count, unit, bytes);
    }
    // Says on a terminal what is being done, until its line comes.
    static void begin(const std::string& name);
    // The same for work whose kernels may have to be compiled: it is done twice, the second time is the
    // stage's, and what the first took longer belongs to the time of preparation.
    template <class Work>
    void measureWarm(const std::string& name, uint64_t count, const char* unit, uint64_t bytes, Work&& work) {
        const double first = milliseconds(work);
        measure(name, count, unit, bytes, work);
        preparation_ += std::max(0.0, first - stages_.back().wall);
    }
    // Work that makes ready for a stage: uploads, tables, kernels.
    template <class Work>
    void prepare(Work&& work) {
        preparation_ += milliseconds(work);
    }
    // A line for what prepared the others.
    void addPreparation() { add("uploads, compiling kernels", preparation_, 0, 0, "", 0); }
    // A stage that was measured elsewhere; deviceMilliseconds is 0 for work of the host.
    void add(const std::string& name, double wallMilliseconds, double deviceMilliseconds, uint64_t count,
             const char* unit, uint64_t bytes);

    nlohmann::ordered_json json() const;

  private:
    template <class Work>
    static double milliseconds(Work&& work) {
        const auto start = std::chrono::steady_clock::now();
        work();
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    }
    struct Stage {
        std::string name, unit;
        double wall, device;  // ms
        uint64_t count, bytes;
        // Items per second of device time if there is any, otherwise of wall time. NaN where the clock is too
        // coarse.
        double perSecond() const {
            constexpr double shortest = 1e-3;  // ms
            const double time = device > 0 ? device : wall;
            return time >= shortest ? double(count) * 1000 / time : NAN;
        }
    };
    const Run& run_;
    std::vector<Stage> stages_;
    double preparation_ = 0;  // ms
};

}  // namespace pellucid::cli
