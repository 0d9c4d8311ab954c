// Devices that compute 1, 8 and 16 lanes at a time, as other hardware does.
#pragma once
#include "variable.h"

namespace lanes {

inline pellucid::Device deviceOf(int count) {
    const Variable width("PELLUCID_MATH_WIDTH", std::to_string(count).c_str());
    return pellucid::Device("");
}

}  // namespace lanes
