// PelLiveMesh: curvature of a mesh when only a part of it moves.
#pragma once
#include "mesh/curvature.h"

namespace pel {

// How far a change of vertices reaches: slots by their distance from the changed ones, in edges.

// The first `upTo[d]` of `slices` are the slices that hold a slot of distance <= d. A level that would cover
// most of the mesh is left out, with all later ones.
struct MeshReach {
    std::vector<uint32_t> slices;
    std::vector<uint32_t> upTo;
    std::vector<uint32_t>
        lanes;  // per slice of the first levels up to `stored`: bit i is set if its slot i is that near
    uint64_t storedSlots = 0;
};

// The neighbour lists of a topology on the host, and the state of a search over them.
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

class LiveMesh final : public Object {
  public:
    static constexpr Kind kind = Kind::liveMesh;
    LiveMesh(Ref<MeshTopology> topology, const PelCurvatureParams& params);

    const Ref<MeshTopology>& topology() const { return topology_; }
    const PelCurvatureParams& params() const { return params_; }
    // `changed` NULL: all vertices. Enqueues everything. `blocks`: the caller waits, so that the mesh may be
    // measured.
    void update(const VertexView& positions, const VertexView& normals, const VertexView& curvature,
                const PelVertexRange* changed, uint32_t numChanged, bool blocks);
    PelLiveMeshStats stats();

  private:
    ~LiveMesh() override = default;
    void find(const std::vector<PelVertexRange>& changed);
    Rows rowsUpTo(uint32_t distance, Rows::Work& work) const;

    Ref<MeshTopology> topology_;
    PelCurvatureParams params_;
    std::mutex mutex_;  // guards the rest
    std::unique_ptr<MeshReacher> reacher_;
    // Results of the previous update: values of the estimator, gathered rows, normals, weights.
    SizedMemory scratch_[MeshTopology::scratchCount], estimated_;
    bool fresh_ = true, madeNormals_ = false;
    VertexView target_;
    // The list of the last change, for a next change of the same vertices.
    std::vector<PelVertexRange> changed_;
    MeshReach reach_;
    bool listed_ = false;
    DiffusionRates rates_;  // of the last update of all vertices
    uint32_t estimateReach_ = 0, storedReach_ = 0, passes_ = 0;
    cl::Memory list_, lanes_;
    PelLiveMeshStats stats_ = pelLiveMeshStatsDefaults();
};

// Checks that the ranges lie within `vertices`.
void checkRanges(const PelVertexRange* changed, uint32_t numChanged, uint32_t vertices);

}  // namespace pel
