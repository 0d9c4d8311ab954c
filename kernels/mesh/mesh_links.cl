// Where each slot stands in its neighbours' rings, so that a pass over the two-ring need not search for it.
//
// Inputs: one-rings (shared/mesh.h). Outputs: links, beside the entries of the rings: the row, counted from its slice's first,
// in which this slot stands in that neighbour's ring (the last one, where there are several; 0 for fillers); rounds, for each
// slot: neighbours in its list, and MESH_ROUND where they are one closed walk of more than two.
// One work-item: one slot.
// Variants: none. It runs once for a topology.

#include "shared/mesh.h"

__kernel __attribute__((reqd_work_group_size(MESH_GROUP, 1, 1))) void mesh_links(
    uint slots, __global const uint* slices, __global const uint* rings, __global uint* links, __global uint* rounds) {
    const uint slot = get_global_id(0);
    if (slot >= slots) return;
    const uint lane = slot % MESH_LANES;
    uint length = 0, walks = 0, open = 0;
    for (uint row = slices[slot / MESH_LANES]; row < slices[slot / MESH_LANES + 1]; ++row) {
        const size_t at = (size_t)row * MESH_LANES + lane;
        const uint entry = rings[at], near_ = entry & MESH_SLOT;
        uint here = 0;
        if (near_ != slot) {
            ++length;
            walks += (entry & MESH_START) != 0;
            open |= entry & MESH_SINGLE;
            const uint begin = slices[near_ / MESH_LANES], end = slices[near_ / MESH_LANES + 1];
            for (uint other = begin; other < end; ++other)
                if ((rings[(size_t)other * MESH_LANES + near_ % MESH_LANES] & MESH_SLOT) == slot) here = other - begin;
        }
        links[at] = here;
    }
    rounds[slot] = length | (walks == 1 && !open && length > 2 ? MESH_ROUND : 0);
}
