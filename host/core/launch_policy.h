// The sizes of work-groups and work-items by kind of device: the one place for what was measured.
#pragma once
#include <algorithm>

#include "cl/launch.h"
#include "core/device.h"

namespace pel {

// Kernels for devices of several lanes (lib/width.clh) have vectors of their own: few long work-items. Other
// devices run many short ones.
struct LaunchPolicy {
    size_t group;         // work-items of kernels that loop over tiles or columns
    size_t columns;       // of a table's row per work-item, where a texel is cheap
    size_t tableColumns;  // where each texel of it walks a tabulated profile
    size_t texels;        // PEL_GROUP: work-items of a group where each is short: a texel, a block of a map
};

constexpr LaunchPolicy launchPolicy(uint32_t lanes) {
    return lanes > 1 ? LaunchPolicy{1, 256, 64, 16} : LaunchPolicy{64, 1, 1, 64};
}
inline LaunchPolicy launchPolicy(const Device& device) {
    return launchPolicy(device.info().mathWidth);
}

// Groups that share `tiles` among them: enough of them to keep every compute unit busy to the end, and no
// more.
inline size_t groupsFor(const Device& device, size_t tiles) {
    return std::min<size_t>(tiles, 64 * size_t(device.info().computeUnits));
}

// Ranges of kernels in groups of PEL_GROUP: an item each; one group each, or as many as groupsFor() has.
inline cl::Range itemRange(const Device& device, size_t items) {
    return cl::folded(items, launchPolicy(device).texels);
}
inline cl::Range groupRange(const Device& device, size_t groups) {
    const size_t group = launchPolicy(device).texels;
    return {{groups * group, 1, 1}, {group, 1, 1}};
}

}  // namespace pel
