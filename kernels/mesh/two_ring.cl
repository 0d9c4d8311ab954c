// The points of each slot as a list (shared/mesh.h): its two-ring, and for some slots its three-ring. The
// quadric estimator reads this list instead of walking the rings of a ring. The lists depend on the
// topology only and are made once, in three stages of one kernel, because each kernel takes a CPU's
// compiler a tenth of a second.
//
// PEL_TWO_RING_LINK finds the place of each slot in its neighbours' rings. Inputs: one-rings. Outputs:
// links, parallel to the entries of the rings: the row, counted from the first of its slice, of this slot
// in the ring of that neighbour (the last one if there are several; 0 for fillers); rounds (shared/mesh.h).
// Each edge is looked up in the shorter one of its two rings, by the slot that has the longer one: the hub
// of a fan has as many neighbours as the fan has triangles.
//
// PEL_TWO_RING_COUNT writes the number of points of each slot, PEL_TWO_RING_LIST the points.
//
// One work-item: one slot. Variants: none.

#include "shared/mesh.h"

// Of a ring of more than 2 NEAR_STEPS + 4 neighbours only the nearest NEAR_STEPS to either side are points.
#define NEAR_STEPS 16
// A closed ring of at most SMALL_RING neighbours whose two-ring has fewer than FEW_POINTS gets the three-ring
// as well. Splitting triangles leaves such vertices inside large triangles and slivers, where few points
// amplify rounding and terms of higher order (docs/design-notes.md).
#define SMALL_RING 4
#define FEW_POINTS 15

static inline size_t entryAt(__global const uint* slices, uint slot, uint row) {
    return (size_t)(slices[slot / PEL_MESH_LANES] + row) * PEL_MESH_LANES + slot % PEL_MESH_LANES;
}

// Neighbours in a slot's list: it ends with its slice, or with the slot itself.
static inline uint listLength(__global const uint* slices, __global const uint* rings, uint slot, uint most) {
    const uint rows = min(slices[slot / PEL_MESH_LANES + 1] - slices[slot / PEL_MESH_LANES], most);
    uint length = 0;
    while (length < rows && (rings[entryAt(slices, slot, length)] & PEL_MESH_SLOT) != slot) ++length;
    return length;
}

// The part of a neighbour's ring that is listed: `count` steps from row `from` on. Three rows before step
// `middle` are skipped.
typedef struct Steps {
    uint length, from, middle, count;
} Steps;

static inline Steps stepsRound(uint round, uint here) {
    Steps s;
    s.length = round & PEL_MESH_LENGTH;
    const int closed = (round & PEL_MESH_ROUND) != 0;
    // Closed: all but this slot, its two neighbours and the last one; with four in the ring just one is left.
    s.count = !closed ? s.length : s.length > 4 ? s.length - 4 : s.length == 4;
    s.from = closed ? here + 2 : 0;
    s.middle = s.count;
    if (s.length > 2 * NEAR_STEPS + 4) {
        // In a long ring, skip the middle part: this slot and its two neighbours.
        const uint before = here - min(here, (uint)NEAR_STEPS);
        s.from = closed ? here + (here < NEAR_STEPS + 1 ? s.length : 0) - 1 - NEAR_STEPS : before;
        s.count = closed ? 2 * NEAR_STEPS : min((uint)(2 * NEAR_STEPS + 1), s.length - before);
        s.middle = closed ? NEAR_STEPS : s.count;
    }
    return s;
}

// The row of a step.
static inline uint rowOf(Steps s, uint step) {
    const uint row = s.from + step + (step < s.middle ? 0 : 3);
    return row < s.length ? row : row - s.length;
}

static inline void linkSlot(uint slot, uint slots, __global const uint* slices, __global const uint* rings,
                            __global uint* links, __global uint* rounds) {
    if (slot >= slots) {
        rounds[slot] = 0;
        return;
    }
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
            // In both directions. If the slot occurs several times, the last row stays, because rows ascend.
            links[at] = row;
            links[entryAt(slices, slot, row)] = other;
        }
    }
    for (uint row = length; row < slices[slot / PEL_MESH_LANES + 1] - slices[slot / PEL_MESH_LANES]; ++row)
        links[entryAt(slices, slot, row)] = 0;
    rounds[slot] =
        length | (walks == 1 && !open && length > 2 ? PEL_MESH_ROUND : 0) | (open ? PEL_MESH_BORDER : 0);
}

// The list of a slot, or only its length where `points` is NULL.
typedef struct PointList {
    __global uint* points;
    size_t to;
    uint slot, count;
} PointList;

static inline void appendPoint(PointList* list, uint point) {
    if (point == list->slot) return;
    ++list->count;
    if (!list->points) return;
    list->points[list->to] = point;
    list->to += PEL_POINT_LANES;
}

// Adds the neighbours of `slot` and of its neighbours; if `further`, the neighbours of the latter as well.
static inline void appendRings(PointList* list, uint slot, int further, __global const uint* slices,
                               __global const uint* rings, __global const uint* links,
                               __global const uint* rounds) {
    const uint length = rounds[slot] & PEL_MESH_LENGTH;
    for (uint row = 0; row < length; ++row)
        appendPoint(list, rings[entryAt(slices, slot, row)] & PEL_MESH_SLOT);
    for (uint row = 0; row < length; ++row) {
        const size_t at = entryAt(slices, slot, row);
        const uint near_ = rings[at] & PEL_MESH_SLOT;
        const Steps s = stepsRound(rounds[near_], links[at]);
        for (uint step = 0; step < s.count; ++step) {
            const size_t beyond = entryAt(slices, near_, rowOf(s, step));
            const uint far_ = rings[beyond] & PEL_MESH_SLOT;
            appendPoint(list, far_);
            if (!further || far_ == slot) continue;
            const Steps t = stepsRound(rounds[far_], links[beyond]);
            for (uint last = 0; last < t.count; ++last) {
                const uint point = rings[entryAt(slices, far_, rowOf(t, last))] & PEL_MESH_SLOT;
                if (point != near_) appendPoint(list, point);
            }
        }
    }
}

// Without starts the points are only counted.
static inline void listPoints(uint slot, uint slots, __global const uint* slices, __global const uint* rings,
                              __global const uint* links, __global const uint* rounds, __global uint* counts,
                              __global const uint* starts, __global uint* points) {
    const uint length = rounds[slot] & PEL_MESH_LENGTH;
    PointList counted = {0, 0, slot, 0};
    appendRings(&counted, slot, 0, slices, rings, links, rounds);
    const int further = length <= SMALL_RING && (rounds[slot] & PEL_MESH_ROUND) && counted.count < FEW_POINTS;
    PointList list = {starts ? points : 0, 0, slot, 0};
    if (starts) list.to = (size_t)starts[slot / PEL_POINT_LANES] * PEL_POINT_LANES + slot % PEL_POINT_LANES;
    appendRings(&list, slot, further, slices, rings, links, rounds);
    if (!starts) {
        counts[slot] = list.count;
        return;
    }
    const uint rows = starts[slot / PEL_POINT_LANES + 1] - starts[slot / PEL_POINT_LANES];
    while (list.count < rows) {
        points[list.to] = min(slot, slots - 1);
        list.to += PEL_POINT_LANES;
        ++list.count;
    }
}

__kernel __attribute__((reqd_work_group_size(PEL_MESH_GROUP, 1, 1))) void two_ring(
    uint stage, uint slots, __global const uint* restrict slices, __global const uint* restrict rings,
    __global uint* links, __global uint* rounds, __global uint* counts, __global const uint* restrict starts,
    __global uint* points) {
    const uint slot = get_global_id(0);
    if (slot >= (slots + PEL_POINT_LANES - 1) / PEL_POINT_LANES * PEL_POINT_LANES) return;
    if (stage == PEL_TWO_RING_LINK)
        linkSlot(slot, slots, slices, rings, links, rounds);
    else
        listPoints(slot, slots, slices, rings, links, rounds, counts, stage == PEL_TWO_RING_LIST ? starts : 0,
                   points);
}
