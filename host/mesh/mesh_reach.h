// How far a change of vertices reaches: slots by their distance from the changed ones, in edges.
#pragma once
#include "mesh/mesh_topology.h"

namespace pel {

// The first `upTo[d]` of `slices` are the slices that hold a slot of distance <= d. A level that would be
// most of the mesh is left out, with all later ones.
struct MeshReach {
    std::vector<uint32_t> slices;
    std::vector<uint32_t> upTo;
    std::vector<uint32_t>
        lanes;  // per slice of the first levels up to `stored`: bit i is set if its slot i is that near
    uint64_t storedSlots = 0;
};

// The neighbour lists of a topology on the host, and what a search over them needs.
class MeshReacher {
  public:
    explicit MeshReacher(const MeshTopology& topology);
    // `changed`: vertices of the caller. Distances up to `farthest`; lanes for those up to `stored`.
    MeshReach reach(const std::vector<PelVertexRange>& changed, uint32_t farthest, uint32_t stored);
    size_t bytes() const;

  private:
    bool take(std::vector<uint32_t>& marks, uint32_t index) {
        return std::exchange(marks[index], round_) != round_;
    }
    uint32_t slots_, round_ = 0;
    std::vector<uint32_t> slices_, rings_, slotOf_;
    std::vector<uint32_t> slotMarks_, sliceMarks_;  // the round that visited it last
};

}  // namespace pel
