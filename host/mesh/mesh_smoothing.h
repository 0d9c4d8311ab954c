// Smoothing of values on a mesh: kernels/mesh/curvature.cl (uniform passes) and
// kernels/mesh/curvature_diffuse.cl (to a radius).
#pragma once
#include "mesh/mesh_passes.h"

namespace pel {

// Planes of one value per slot, planeStride apart, in two memories that are used in turn; `from` holds the
// values. With a `spare` the first values are kept, and the spare takes the place of their memory.
struct SlotPlanes {
    uint32_t planes, planeStride;
    cl::Memory from, to, spare, before;
    void advance() {
        before = from;
        std::swap(from, to);
        if (spare) to = std::exchange(spare, {});
    }
};

// Which rows pass i of a smoothing works on; none given: all.
using RowsOfPass = std::function<Rows(uint32_t pass)>;

void smoothUniform(MeshTopology& topology, const cl::Defines& defines, uint32_t count, SlotPlanes& values,
                   const RowsOfPass& rows = {});

// The passes of a smoothing to a radius. Waits for the device the first time, if params do not give the
// number of stages.
struct Diffusion {
    float limit = 0, turn2 = 0;       // of rates, 1/length^2; square of the change of the normal at a crease
    std::vector<float> coefficients;  // of the Chebyshev polynomials from degree 0 on; empty: nothing to do
    PelSmoothingWeights weights = PEL_SMOOTHING_COTANGENT;
    uint32_t passes() const { return coefficients.empty() ? 0 : uint32_t(coefficients.size()) - 1; }
    // By how many edges changed positions change weights beyond the changed vertices.
    uint32_t weightReach(bool madeNormals) const {
        // By areas a weight depends on factors of both ends, and its limit on the rates of both.
        return (madeNormals && turn2 > 0 ? 2 : 1) + (weights == PEL_SMOOTHING_AREA ? 2 : 0);
    }
};
Diffusion planDiffusion(MeshTopology& topology, const SlotData& data, const PelCurvatureParams& params,
                        const Scratch& scratch);

// `weighed`: rows whose weights are computed.
void smoothToRadius(MeshTopology& topology, const SlotData& data, const Diffusion& diffusion,
                    SlotPlanes& values, const Scratch& scratch, const Rows& weighed = {},
                    const RowsOfPass& rows = {});

}  // namespace pel
