// One measurement of `pellucid bench`, and the lists of all of them.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <pellucid/pellucid.hpp>
#include <string>
#include <vector>

namespace pellucid::bench {

struct Error {
    double max = 0, rms = 0;
};

struct Case {
    std::string what;  // for people: size, settings
    double items = 0;  // worked on per run
    std::string unit;  // of the items: "vertices"
    // Least work by the definition, for shares of the device's own limits; 0: not counted. Bytes: each input
    // read and each output written once. Operations: +, *, comparison, square root, exponential each 1, fused
    // multiply-add 2.
    double bytes = 0, operations = 0;
    std::function<void()> run;     // returns when the result is there
    std::function<Error()> error;  // of the last run's result; empty: nothing to compare
    std::string truth;             // what the result is compared with, and in which unit
};

// Making a case may need memory and time, and may fail on a device that lacks something.
struct Factory {
    std::string name, group;
    std::function<Case()> make;
};

struct Size {
    bool quick;
};

std::vector<Factory> deviceCases(const Device& device, Size size);   // copy bandwidth, arithmetic peak
std::vector<Factory> meshCases(const Device& device, Size size);     // curvature, normals, UV scale
std::vector<Factory> tableCases(const Device& device, Size size);    // look-up tables
std::vector<Factory> shadingCases(const Device& device, Size size);  // the pass over a G-buffer
std::vector<Factory> eyeCases(const Device& device, Size size);      // a cornea's table, a frame with an eye

constexpr const char* copyName = "copy";  // the case whose bytes per second are the device's bandwidth
constexpr const char* arithmeticName = "arithmetic";  // and whose operations per second are its peak

// Gathers differences into an Error.
class ErrorSum {
  public:
    void add(double difference) {
        max_ = difference == difference && max_ == max_ ? std::max(max_, std::abs(difference)) : NAN;
        squares_ += difference * difference;
        ++count_;
    }
    Error result(double scale = 1) const {
        return {max_ / scale, std::sqrt(squares_ / double(std::max<size_t>(count_, 1))) / scale};
    }

  private:
    double max_ = 0, squares_ = 0;
    size_t count_ = 0;
};

}  // namespace pellucid::bench
