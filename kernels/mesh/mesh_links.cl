// Finds the place of each slot in its neighbours' rings, so that a pass over the two-ring need not search for
// it.
//
// Inputs: one-rings (shared/mesh.h). Outputs: links, parallel to the entries of the rings: the row, counted
// from the first of its slice, at which this slot is in that neighbour's ring (the last one if there are
// several; 0 for fillers); rounds, for each slot: the number of neighbours in its list, with PEL_MESH_ROUND
// if they are one closed walk of more than two.
// Each edge is looked up in the shorter one of its two rings, by the slot that has the longer one: the hub of
// a fan has as many neighbours as the fan has triangles.
// One work-item: one slot. Variants: none. It runs once for a topology.

#include "shared/mesh.h"

inline size_t entryAt(__global const uint* slices, uint slot, uint row) {
    return (size_t)(slices[slot / PEL_MESH_LANES] + row) * PEL_MESH_LANES + slot % PEL_MESH_LANES;
}

// Neighbours in a slot's list: it ends with its slice, or with the slot itself.
inline uint listLength(__global const uint* slices, __global const uint* rings, uint slot, uint most) {
    const uint rows = min(slices[slot / PEL_MESH_LANES + 1] - slices[slot / PEL_MESH_LANES], most);
    uint length = 0;
    while (length < rows && (rings[entryAt(slices, slot, length)] & PEL_MESH_SLOT) != slot) ++length;
    return length;
}

__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void mesh_links(
    uint slots, __global const uint* slices, __global const uint* rings, __global uint* links,
    __global uint* rounds) {
    const uint slot = get_global_id(0);
    if (slot >= slots) return;
    const uint length = listLength(slices, rings, slot, 0xffffffffu);
    uint walks = 0, open = 0;
    for (uint row = 0; row < length; ++row) {
        const uint entry = rings[entryAt(slices, slot, row)], near_ = entry & PEL_MESH_SLOT;
        walks += (entry & PEL_MESH_START) != 0;
        open |= entry & PEL_MESH_SINGLE;
        const uint others = listLength(slices, rings, near_, length + 1);
        if (others > length || (others == length && near_ > slot)) continue;  // left to the neighbour
        for (uint other = 0; other < others; ++other) {
            const size_t at = entryAt(slices, near_, other);
            if ((rings[at] & PEL_MESH_SLOT) != slot) continue;
            // In both directions. Of several places the last one stays, because rows ascend.
            links[at] = row;
            links[entryAt(slices, slot, row)] = other;
        }
    }
    for (uint row = length; row < slices[slot / PEL_MESH_LANES + 1] - slices[slot / PEL_MESH_LANES]; ++row)
        links[entryAt(slices, slot, row)] = 0;
    rounds[slot] = length | (walks == 1 && !open && length > 2 ? PEL_MESH_ROUND : 0);
}
