// Helpers shared by all passes over a topology's slots.
#pragma once
#include "mesh/mesh_topology.h"
#include "mesh/vertex_view.h"

namespace pel {

inline cl::Range over(size_t items) {
    return {{items, 1, 1}, {PEL_MESH_GROUP, 1, 1}};
}

// Mesh passes take a slice of slots at a time where wide arithmetic pays, otherwise one slot.
inline uint32_t width(const Device& device) {
    return device.info().mathWidth > 1 ? PEL_MESH_LANES : 1;
}

// The rows (slots) that a pass works on: all of them, or those of the first `slices` slices of a list on the
// device.
struct Rows {
    cl::Memory list;
    uint32_t slices = 0;
    struct Work {
        uint64_t launches = 0, rows = 0;
    };
    Work* work = nullptr;  // where launches over these rows are counted; may be NULL
};

inline std::string listed(const Rows& rows) {
    return rows.list ? "1" : "0";
}

// Launches a pass that takes `lanes` slots per work-item.
inline void launchRows(const MeshTopology& topology, cl::Launch& launch, const Rows& rows, uint32_t lanes,
                       uint32_t planes = 1) {
    const uint32_t slots = rows.list ? rows.slices * PEL_MESH_LANES : topology.slots();
    topology.device().launch(launch, {{(slots + lanes - 1) / lanes, planes, 1}, {PEL_MESH_GROUP, 1, 1}});
    if (rows.work && slots > 0) ++rows.work->launches, rows.work->rows += slots;
}

// The arguments that every pass over slots begins with.
inline void rowArguments(const MeshTopology& topology, cl::Launch& launch, const Rows& rows) {
    launch.args(topology.slots(), rows.slices, rows.list);
}

// Launches a pass that walks rings; `values`: its arguments after those of the rings.
template <class... Values>
void launchRings(const MeshTopology& topology, const cl::Program& program, const char* kernel,
                 const Rows& rows, uint32_t planes, const Values&... values) {
    cl::Launch launch(program, kernel, topology.slots(), rows.slices, rows.list, topology.slices(),
                      topology.rings(), topology.runs(), values...);
    launchRows(topology, launch, rows, width(topology.device()), planes);
}

// Whether a pass may read rows as runs: true where measurements showed a gain.
inline std::string haveRuns(const MeshTopology& topology) {
    return topology.runs() && width(topology.device()) > 1 ? "1" : "0";
}

inline cl::Defines mapping(const MeshTopology& topology) {
    return {{"PEL_MESH_MAPPED", topology.mapped() ? "1" : "0"}};
}

// Positions and normals by slot, both `stride` words apart: the caller's own memory, or rows gathered from
// it.
struct SlotData {
    VertexView positions, normals;
    uint32_t stride;
};

// Device memory by purpose, made when first needed.
using Scratch = std::function<const cl::Memory&(MeshTopology::Scratch, size_t bytes)>;

inline Scratch scratchOf(MeshTopology& topology) {
    return [&](MeshTopology::Scratch which, size_t bytes) -> const cl::Memory& {
        return topology.scratch(which, bytes);
    };
}

// Positions and normals by slot, and normals made from positions: kernels/mesh/mesh_rows.cl,
// kernels/mesh/mesh_normals.cl.

// If `normals` is empty they are made from the positions. `moved`: slots whose vertices are gathered.
// `turned`: slots whose normals are made, including the neighbours of moved ones. Other rows of the scratch
// memory keep their values.
SlotData gatherBySlot(MeshTopology& topology, const VertexView& positions, const VertexView& normals,
                      const Scratch& scratch, const Rows& moved = {}, const Rows& turned = {});

// Unit normals of the caller's vertices from their positions. Enqueues everything.
void meshNormals(MeshTopology& topology, const VertexView& positions, const VertexView& normals);

// Smoothing of values on a mesh: kernels/mesh/curvature.cl (uniform passes) and
// kernels/mesh/curvature_diffuse.cl (to a radius).

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

// The passes of a smoothing to a radius.
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
// `measure`: measures the mesh, which waits for the device, if params do not give the number of stages.
// Otherwise only if `rates` were not measured before.
Diffusion planDiffusion(MeshTopology& topology, const SlotData& data, const PelCurvatureParams& params,
                        const Scratch& scratch, DiffusionRates& rates, bool measure);

// `weighed`: rows whose weights are computed.
void smoothToRadius(MeshTopology& topology, const SlotData& data, const Diffusion& diffusion,
                    SlotPlanes& values, const Scratch& scratch, const Rows& weighed = {},
                    const RowsOfPass& rows = {});

// The heat equation as a sum of Chebyshev polynomials (kernels/mesh/curvature_diffuse.cl).
constexpr uint32_t mostStages = 4000;

// `span`: time times the largest rate, half the largest eigenvalue. The truncation error of a sum of n stages
// is erfc(n / sqrt(2 span)) for large n, about 2e-4 here.
double stagesOfSpan(double span);
double spanOfStages(uint32_t stages);

// Coefficients of degree 0 to `stages` for exp(-span (x + correction x^2)), where x from 0 to 2 is an
// eigenvalue divided by the largest rate. Their sum is 1. correction: waves on vertices h apart have the
// eigenvalues k^2 (1 - k^2 h^2 / 16) instead of k^2 (the mean over directions, on squares and on equilateral
// triangles alike), so their square times h^2 / 16, divided by the largest rate, is added.
std::vector<float> heatCoefficients(uint32_t stages, double span, double correction);

// The lists of the topology, made at the first call, which waits until they are there, on a queue of its
// own. `program` holds two_ring.cl. Call with the topology's lock held.
const MeshTopology::TwoRings& twoRings(MeshTopology& topology, const cl::Program& program);

// UV scale of a mesh: kernels/mesh/uv_scale.cl.
// Length per UV unit. Waits for the result.
float meshUvScale(MeshTopology& topology, const VertexView& positions, const VertexView& uvs);

}  // namespace pel
