// The operations of docs/stability.md: from a point of the unit cube, which stands for the inputs, the error
// there.
#pragma once
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "pass_scene.h"

namespace stability {

using namespace pellucid;
using Point = std::vector<double>;  // of the unit cube

struct Operation {
    std::string name, range, unit;
    size_t dimensions;
    std::function<double(const Point&, std::string& where)> error;
};

inline double logBetween(double t, double low, double high) {
    return low * std::pow(high / low, t);
}

inline std::string text(const char* format, double a, double b = 0, double c = 0, double d = 0) {
    char buffer[256];
    std::snprintf(buffer, sizeof buffer, format, a, b, c, d);
    return buffer;
}

// A NaN is the worst of all errors, and stays it.
inline void keepWorst(double& worst, double e) {
    if (std::isnan(e) || e > worst) worst = e;
}

inline const Device& device() {
    return shade_test::device();
}

std::vector<Operation> tableOperations();
std::vector<Operation> meshOperations();
std::vector<Operation> imageOperations();  // passes over pixels

}  // namespace stability
