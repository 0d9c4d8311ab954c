// PelLiveMesh: curvature of a mesh when only a part of it moves.
#pragma once
#include <memory>

#include "mesh/curvature.h"
#include "mesh/mesh_reach.h"

namespace pel {

class LiveMesh final : public Object {
  public:
    static constexpr Kind kind = Kind::liveMesh;
    LiveMesh(Ref<MeshTopology> topology, const PelCurvatureParams& params);

    const Ref<MeshTopology>& topology() const { return topology_; }
    const PelCurvatureParams& params() const { return params_; }
    // `changed` NULL: all vertices. Enqueues everything.
    void update(const VertexView& positions, const VertexView& normals, const VertexView& curvature,
                const PelVertexRange* changed, uint32_t numChanged);
    PelLiveMeshStats stats();

  private:
    ~LiveMesh() override = default;
    struct Memory {
        cl::Memory memory;
        size_t bytes = 0;
    };
    const cl::Memory& keep(Memory& memory, size_t bytes);
    void find(const std::vector<PelVertexRange>& changed);
    Rows rowsUpTo(uint32_t distance, Rows::Work& work) const;

    Ref<MeshTopology> topology_;
    PelCurvatureParams params_;
    std::mutex mutex_;  // guards the rest
    std::unique_ptr<MeshReacher> reacher_;
    // Results of the previous update: values of the estimator, gathered rows, normals, weights.
    Memory scratch_[MeshTopology::scratchCount], estimated_, spare_;
    bool fresh_ = true, madeNormals_ = false;
    VertexView target_;
    // The list of the last change, for a next change of the same vertices.
    std::vector<PelVertexRange> changed_;
    MeshReach reach_;
    bool listed_ = false;
    uint32_t estimateReach_ = 0, storedReach_ = 0, passes_ = 0;
    cl::Memory list_, lanes_;
    PelLiveMeshStats stats_ = pelLiveMeshStatsDefaults();
};

// Checks that the ranges lie within `vertices`.
void checkRanges(const PelVertexRange* changed, uint32_t numChanged, uint32_t vertices);

}  // namespace pel
