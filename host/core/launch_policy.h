// How work is cut into groups and items, by what a device is: one place for what was measured.
#pragma once
#include <algorithm>

#include "core/device.h"

namespace pel {

// Where arithmetic is wide (lib/width.clh) kernels bring their own vectors: long work-items, one to a group. Elsewhere many short ones.
struct LaunchPolicy {
    size_t group;         // work-items
    size_t columns;       // of a table's row per work-item, where a texel is cheap
    size_t tableColumns;  // where each texel of it walks a tabulated profile
    size_t texels;        // work-items of a group, where each makes one texel or a few cells
};

inline LaunchPolicy launchPolicy(const Device& device) {
    return device.info().mathWidth > 1 ? LaunchPolicy{1, 256, 64, 16} : LaunchPolicy{64, 1, 1, 64};
}

// Groups that share `tiles` among them: enough of them to keep every compute unit busy to the end, and no more.
inline size_t groupsFor(const Device& device, size_t tiles) {
    return std::min<size_t>(tiles, 64 * size_t(device.info().computeUnits));
}

}  // namespace pel
