#include "mesh/curvature.h"

#include <algorithm>
#include <cmath>

#include "shared/choices.h"

namespace pel {
namespace {

// The kernel's names of the quantities.
#define QUANTITY_NUMBER(name, number, key) {"PEL_QUANTITY_" #name, #number},

// Faults of the data, in addition to those that estimators have counted in `memory`.
MeshCounts countFaults(MeshTopology& topology, const VertexView& positions, const VertexView& given,
                       const SlotData& data, const cl::Memory& memory) {
    const VertexView& normals = given.memory ? given : positions;
    Device& device = topology.device();
    cl::Launch count(device.programs().get("mesh/mesh_rows.cl", mapping(topology)), "mesh_count",
                     topology.vertices(), positions, normals, topology.slots(), topology.slices(),
                     topology.rings(), data.positions, memory);
    device.launch(count, over(topology.vertices()));
    MeshCounts counts;
    device.read(memory.get(), 0, sizeof counts, &counts, true);
    if (!given.memory)
        counts.nonFiniteNormals = 0;  // normals are made, so their faults are those of the positions
    return counts;
}

}  // namespace

uint32_t quantityFloats(PelCurvatureQuantity quantity) {
    return quantity == PEL_QUANTITY_PRINCIPAL ? 2 : quantity == PEL_QUANTITY_FRAME ? 8 : 1;
}

void checkCurvatureParams(const PelCurvatureParams& params) {
    if (params.estimator < PEL_CURVATURE_EDGE || params.estimator > PEL_CURVATURE_QUADRIC)
        invalidArgument("PelCurvatureParams.estimator is ", int(params.estimator),
                        ", which is not a value of PelCurvatureEstimator");
    if (params.quantity < PEL_QUANTITY_ABSOLUTE || params.quantity > PEL_QUANTITY_FRAME)
        invalidArgument("PelCurvatureParams.quantity is ", int(params.quantity),
                        ", which is not a value of PelCurvatureQuantity");
    if (params.estimator == PEL_CURVATURE_EDGE && params.quantity != PEL_QUANTITY_ABSOLUTE) {
        constexpr std::pair<const char*, const char*> names[] = {
            PEL_EACH_QUANTITY(QUANTITY_NUMBER) PEL_EACH_QUANTITY_OF_SEVERAL(QUANTITY_NUMBER)};
        invalidArgument("the edge estimator measures PEL_QUANTITY_ABSOLUTE only, not ",
                        names[params.quantity].first, ": take the tensor or the quadric estimator");
    }
    if (params.smoothingPasses > 1000)
        invalidArgument("PelCurvatureParams.smoothingPasses is ", params.smoothingPasses,
                        "; 0 to 1000 are allowed, typical is 2");
    if (!std::isfinite(params.smoothingRadius) || params.smoothingRadius < 0)
        invalidArgument("PelCurvatureParams.smoothingRadius is ", params.smoothingRadius,
                        "; a finite length of at least 0 is needed");
    if (!(params.smoothingCrease >= 0 && params.smoothingCrease <= 3.14159265f))
        invalidArgument("PelCurvatureParams.smoothingCrease is ", params.smoothingCrease,
                        "; an angle from 0 to pi is needed");
    if (params.smoothingWeights < PEL_SMOOTHING_COTANGENT || params.smoothingWeights > PEL_SMOOTHING_AREA)
        invalidArgument("PelCurvatureParams.smoothingWeights is ", int(params.smoothingWeights),
                        ", which is not a value of PelSmoothingWeights");
    if (params.smoothingStages > 4000)
        invalidArgument("PelCurvatureParams.smoothingStages is ", params.smoothingStages,
                        "; 0 (chosen from the mesh) to 4000 are allowed");
    if (!std::isfinite(params.scale) || params.scale < 0)
        invalidArgument("PelCurvatureParams.scale is ", params.scale,
                        "; a finite number of at least 0 is needed");
}

uint32_t planesOf(PelCurvatureQuantity quantity) {
    switch (quantity) {
        case PEL_QUANTITY_ABSOLUTE:
        case PEL_QUANTITY_MEAN:
            return 1;
        case PEL_QUANTITY_FRAME:
            return 8;
        default:
            return 2;
    }
}

uint32_t planeStrideOf(const MeshTopology& topology) {
    // Whole slices are written, of either kind.
    return (topology.slots() + PEL_POINT_LANES - 1) / PEL_POINT_LANES * PEL_POINT_LANES;
}

cl::Defines passDefines(const MeshTopology& topology, const PelCurvatureParams& params, uint32_t stride) {
    return {{"PEL_MESH_MAPPED", topology.mapped() ? "1" : "0"},
            {"PEL_MESH_STRIDE", stride},
            {"PEL_MESH_PLANES", planesOf(params.quantity)},
            {"PEL_MESH_QUANTITY", params.quantity},
            PEL_EACH_QUANTITY(QUANTITY_NUMBER)
                PEL_EACH_QUANTITY_OF_SEVERAL(QUANTITY_NUMBER){"PEL_MESH_LISTED", "0"},
            {"PEL_MESH_RUNS", haveRuns(topology)},
            {"PEL_WIDTH", width(topology.device())}};
}

static void estimateQuadric(MeshTopology& topology, const cl::Defines& common, const SlotData& data,
                            const cl::Memory& planes, const Rows& rows, const cl::Memory& counts) {
    cl::Defines defines = common;
    const uint32_t lanes = rows.list ? width(topology.device()) : topology.device().info().mathWidth;
    defines["PEL_WIDTH"] = lanes;
    // In one program, because each one costs a CPU's compiler 0.1 s before its first kernel.
    const cl::Program program =
        topology.device().programs().get({{"mesh/curvature_quadric.cl", "mesh/two_ring.cl"}, defines});
    const MeshTopology::TwoRings& lists = twoRings(topology, program);
    cl::Launch estimate(program, "curvature_quadric");
    rowArguments(topology, estimate, rows);
    estimate.args(data.positions.memory, data.positions.layout.offset, data.normals.memory,
                  data.normals.layout.offset, planeStrideOf(topology), planes, lists.starts, lists.points,
                  lists.rounds, counts);
    launchRows(topology, estimate, rows, lanes);
}

void estimateCurvature(MeshTopology& topology, const PelCurvatureParams& params, const SlotData& data,
                       const cl::Memory& planes, const Rows& rows, const cl::Memory& counts) {
    cl::Defines defines = passDefines(topology, params, data.stride);
    defines["PEL_MESH_LISTED"] = listed(rows);
    const bool edge = params.estimator == PEL_CURVATURE_EDGE;
    if (!edge) {  // stored quantity and mapping do not change these programs
        defines.erase("PEL_MESH_MAPPED");
        defines["PEL_MESH_RUNS"] = "0";  // they compute much more than they read
        defines.erase("PEL_MESH_QUANTITY");
    }
    if (params.estimator == PEL_CURVATURE_QUADRIC)
        return estimateQuadric(topology, defines, data, planes, rows, counts);
    const char* file = edge ? "mesh/curvature.cl" : "mesh/curvature_tensor.cl";
    launchRings(topology, topology.device().programs().get(file, defines),
                edge ? "curvature_edge" : "curvature_tensor", rows, 1, data.positions.memory,
                data.positions.layout.offset, data.normals.memory, data.normals.layout.offset,
                planeStrideOf(topology), planes);
}

void storeQuantity(MeshTopology& topology, const PelCurvatureParams& params, uint32_t stride,
                   const cl::Memory& smoothed, const cl::Memory& estimated, const VertexView& curvature,
                   Rows::Work* work) {
    cl::Launch store(
        topology.device().programs().get("mesh/curvature.cl", passDefines(topology, params, stride)),
        "curvature_store", topology.slotOf(), planeStrideOf(topology), smoothed, estimated, params.scale,
        curvature);
    topology.device().launch(store, over(topology.vertices()));
    if (work) ++work->launches, work->rows += topology.slots();
}

void meshCurvature(MeshTopology& topology, const PelCurvatureParams& params, const VertexView& positions,
                   const VertexView& normals, const VertexView& curvature, MeshCounts* counts, bool blocks) {
    if (counts) *counts = {};
    if (topology.vertices() == 0) return;
    const uint32_t planes = planesOf(params.quantity), planeStride = planeStrideOf(topology);
    const size_t planeBytes = planeStride * sizeof(float);
    const auto lock = topology.lock();
    const Scratch scratch = scratchOf(topology);
    const SlotData data = gatherBySlot(topology, positions, normals, scratch);
    const cl::Memory estimated = scratch(MeshTopology::scratchFrom, planeBytes * planes);
    const MeshCounts none{};
    const cl::Memory counted = counts ? topology.device().allocate(sizeof none, &none) : cl::Memory{};
    estimateCurvature(topology, params, data, estimated, {}, counted);

    SlotPlanes values{std::min(planes, 2u), planeStride, estimated, {}, {}, {}};
    if (params.smoothingPasses > 0 || params.smoothingRadius > 0)
        values.to = scratch(MeshTopology::scratchTo, planeBytes * values.planes);
    // Before the uniform passes, so that none of their work is lost if this throws.
    const Diffusion diffusion = planDiffusion(topology, data, params, scratch,
                                              topology.diffusionRates[params.smoothingWeights], blocks);
    smoothUniform(topology, passDefines(topology, params, data.stride), params.smoothingPasses, values);
    if (diffusion.passes() > 0) smoothToRadius(topology, data, diffusion, values, scratch);
    storeQuantity(topology, params, data.stride, values.from, estimated, curvature, nullptr);
    if (counts) *counts = countFaults(topology, positions, normals, data, counted);
}

// The first row of each slice, from the numbers of points of its slots.
static std::vector<uint32_t> startsOf(const std::vector<uint32_t>& counts) {
    std::vector<uint32_t> starts{0};
    for (auto slice = counts.begin(); slice != counts.end(); slice += PEL_POINT_LANES) {
        const uint32_t rows = *std::max_element(slice, slice + PEL_POINT_LANES);
        if (starts.back() > UINT32_MAX - rows)
            fail(PEL_ERROR_UNSUPPORTED, "the two-rings of this mesh exceed ", UINT32_MAX, " rows: split it");
        starts.push_back(starts.back() + rows);
    }
    return starts;
}

const MeshTopology::TwoRings& twoRings(MeshTopology& topology, const cl::Program& program) {
    MeshTopology::TwoRings& made = topology.twoRings;
    if (made.points) return made;
    Device& device = topology.device();
    const size_t padded =
        (size_t(topology.slots()) + PEL_POINT_LANES - 1) / PEL_POINT_LANES * PEL_POINT_LANES;
    std::vector<uint32_t> counts(padded);
    const cl_command_queue queue = device.sideQueue();
    const cl::Memory links = device.allocate(std::max<size_t>(topology.ringEntries(), 1) * sizeof(uint32_t)),
                     rounds = device.allocate(padded * sizeof(uint32_t)),
                     counted = device.allocate(padded * sizeof(uint32_t));
    const auto run = [&](uint32_t stage, const cl::Memory& starts, const cl::Memory& points) {
        cl::Launch launch(program, "two_ring", stage, topology.slots(), topology.slices(), topology.rings(),
                          links, rounds, counted, starts, points);
        device.launch(launch, over(padded), queue);
    };
    run(PEL_TWO_RING_LINK, {}, {});
    run(PEL_TWO_RING_COUNT, {}, {});
    cl::check(clFinish(queue), "clFinish");
    device.readOnSideQueue(counted.get(), counts.size() * sizeof(uint32_t), counts.data());
    const std::vector<uint32_t> starts = startsOf(counts);
    const size_t entries = std::max<size_t>(size_t(starts.back()) * PEL_POINT_LANES, 1);
    const cl::Memory begin = device.allocate(starts.size() * sizeof(uint32_t)),
                     points = device.allocate(entries * sizeof(uint32_t));
    device.writeAside(begin.get(), starts.size() * sizeof(uint32_t), starts.data());
    run(PEL_TWO_RING_LIST, begin, points);
    cl::check(clFinish(queue), "clFinish");
    made = {begin, points, rounds};
    return made;
}

}  // namespace pel
