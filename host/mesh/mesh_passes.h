// What all passes over a topology's slots share.
#pragma once
#include <functional>

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
    launch.arg(topology.slots()).arg(rows.slices).arg(rows.list);
}

inline void ringArguments(const MeshTopology& topology, cl::Launch& launch, const Rows& rows) {
    rowArguments(topology, launch, rows);
    launch.arg(topology.slices()).arg(topology.rings()).arg(topology.runs());
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

}  // namespace pel
