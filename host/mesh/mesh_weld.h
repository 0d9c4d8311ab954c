// Welding: which of the caller's vertices are at one place, and become one vertex of the topology.
#pragma once
#include <pellucid/pellucid.h>

#include <cstdint>
#include <functional>
#include <vector>

namespace pel {

struct MeshWeld {
    std::vector<uint32_t> slotOf;  // per vertex; empty when slots are the vertices in their order
    // Vertices of each slot, ascending; empty in the same case.
    std::vector<uint32_t> memberOffsets;  // slots + 1
    std::vector<uint32_t> members;        // vertices
    uint32_t slots = 0;
};

// Gives slot s the number numbers[s].
void renumberSlots(MeshWeld& weld, std::vector<uint32_t> numbers);

// Exact: equal coordinates (-0 equals 0). Tolerance: a vertex joins the first earlier vertex within the
// tolerance that did not itself join another; chains do not grow. NaN and Inf join nothing. `progress` gets a
// fraction in [0, 1] and may throw.
MeshWeld weldVertices(const PelMeshTopologyDesc& desc, const std::function<void(double)>& progress);

}  // namespace pel
