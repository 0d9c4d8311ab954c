// What every pass over a topology's slots shares.
#pragma once
#include "core/mesh_topology.h"
#include "core/vertex_view.h"

namespace pel {

inline cl::Range over(size_t items) {
    return {{items, 1, 1}, {MESH_GROUP, 1, 1}};
}

// Mesh passes take a slice of slots at a time where wide arithmetic pays, else one slot.
inline uint32_t width(const Device& device) {
    return device.info().mathWidth > 1 ? MESH_LANES : 1;
}

inline cl::Range overSlots(const MeshTopology& topology, uint32_t planes = 1) {
    const uint32_t lanes = width(topology.device());
    return {{(topology.slots() + lanes - 1) / lanes, planes, 1}, {MESH_GROUP, 1, 1}};
}

inline cl::Defines mapping(const MeshTopology& topology) {
    return {{"MESH_MAPPED", topology.mapped() ? "1" : "0"}};
}

// Positions and normals by slot, both `stride` words apart: the caller's own memory, or rows gathered from
// it.
struct SlotData {
    VertexView positions, normals;
    uint32_t stride;
};

}  // namespace pel
