// Clocks and medians.
#pragma once
#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

namespace pellucid::bench {

inline double milliseconds() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

inline double median(std::vector<double> values) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    const size_t half = values.size() / 2;
    return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

// Median absolute deviation from the median.
inline double medianDeviation(const std::vector<double>& values) {
    const double middle = median(values);
    std::vector<double> away;
    for (const double v : values) away.push_back(std::abs(v - middle));
    return median(away);
}

}  // namespace pellucid::bench
