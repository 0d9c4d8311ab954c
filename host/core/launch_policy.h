// Ranges of launches by the sizes of groups that a device has (tuning/launch_sizes.h).
#pragma once
#include <algorithm>

#include "core/device.h"

namespace pel {

inline const LaunchPolicy& launchPolicy(const Device& device) {
    return device.policy();
}
// Work-items of a group that add floats up together on a device of one lane. The order of such a sum affects
// the result, so measured sizes must not change it.
inline size_t summingGroup(const Device& device) {
    return builtInPolicy(device.info().mathWidth).texels;
}

// Groups that share `tiles` among them: just enough to keep every compute unit busy to the end.
inline size_t groupsFor(const Device& device, size_t tiles) {
    return std::min<size_t>(tiles, 64 * size_t(device.info().computeUnits));
}

// Ranges of kernels in groups of PEL_GROUP, for a number of work-items.
inline cl::Range itemRange(const Device& device, size_t items) {
    return cl::folded(items, launchPolicy(device).texels);
}
// The same with a work-item for each vector of pixels or blocks.
inline cl::Range vectorRange(const Device& device, uint32_t width, uint32_t height) {
    const uint32_t lanes = device.info().mathWidth;
    return itemRange(device, size_t((width + lanes - 1) / lanes) * height);
}
// How many of the `left` remaining pyramid levels one launch makes, and its range. With one lane, a group
// makes each block of the last of these levels; with several lanes, each work-item makes PEL_WIDTH blocks.
inline uint32_t levelsPerLaunch(const Device& device, uint32_t left) {
    // A block of the first level per item: with more, the few groups of the coarse levels take longer than
    // another launch.
    constexpr uint32_t most = 4;
    return device.info().mathWidth > 1 ? 1 : std::min(left, most);
}
inline cl::Range groupRange(const Device& device, size_t groups) {
    const size_t group = launchPolicy(device).texels;
    return {{groups * group, 1, 1}, {group, 1, 1}};
}
// One item, or one group with one lane, for each tile of a kernel whose groups add up.
inline cl::Range summingRange(const Device& device, size_t tiles) {
    const size_t group = summingGroup(device);
    if (device.info().mathWidth > 1) return cl::folded(tiles, group);
    return {{tiles * group, 1, 1}, {group, 1, 1}};
}
inline cl::Range blockRange(const Device& device, uint32_t width, uint32_t height, uint32_t levels) {
    if (device.info().mathWidth > 1) return vectorRange(device, width, height);
    const uint32_t last = levels - 1;
    return groupRange(device, size_t(((width - 1) >> last) + 1) * (((height - 1) >> last) + 1));
}

}  // namespace pel
