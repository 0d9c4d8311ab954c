// Devices that compute 1, 8 and 16 lanes at a time, as other hardware does.
#pragma once
#include "test.h"

namespace lanes {

inline pellucid::Device deviceOf(int count) {
    const char* before = std::getenv("PELLUCID_MATH_WIDTH");
    const std::string saved = before ? before : "";
    setenv("PELLUCID_MATH_WIDTH", std::to_string(count).c_str(), 1);
    pellucid::Device device("");
    before ? setenv("PELLUCID_MATH_WIDTH", saved.c_str(), 1) : unsetenv("PELLUCID_MATH_WIDTH");
    return device;
}

}  // namespace lanes
