#include "mesh/mesh_adjacency.h"

#include <algorithm>
#include <cmath>

#include "cl/error.h"
#include "mesh/mesh_ring.h"
#include "shared/mesh.h"

namespace pel {

MeshAdjacency buildAdjacency(const std::vector<uint32_t>& triangles, uint32_t slots,
                             const std::function<void(double)>& progress) {
    if (triangles.size() > UINT32_MAX / 2)
        fail(PEL_ERROR_UNSUPPORTED, triangles.size() / 3,
             " triangles are more than a topology holds (715827882): split the mesh");
    // Counting sort of all corners by slot. Offsets are shifted by one while they count.
    std::vector<uint32_t> begins(size_t(slots) + 2);
    for (uint32_t slot : triangles) ++begins[size_t(slot) + 2];
    for (size_t s = 2; s < begins.size(); ++s) begins[s] += begins[s - 1];
    progress(0.2);
    std::vector<Corner> corners(triangles.size());
    for (size_t t = 0; t < triangles.size(); t += 3)
        for (int c = 0; c < 3; ++c)
            corners[begins[size_t(triangles[t + c]) + 1]++] = {triangles[t + (c + 1) % 3],
                                                               triangles[t + (c + 2) % 3]};
    progress(0.6);

    MeshAdjacency mesh;
    mesh.offsets.reserve(size_t(slots) + 1);
    mesh.neighbours.reserve(triangles.size() + triangles.size() / 8);
    RingBuilder builder;
    for (uint32_t slot = 0; slot < slots; ++slot) {
        mesh.offsets.push_back(uint32_t(mesh.neighbours.size()));
        const RingBuilder::Edges edges = builder.build(slot, corners.data() + begins[slot],
                                                       begins[slot + 1] - begins[slot], mesh.neighbours);
        mesh.edges += edges.all;
        mesh.borderEdges += edges.border;
        mesh.nonManifoldEdges += edges.nonManifold;
        mesh.inconsistentEdges += edges.inconsistent;
    }
    mesh.offsets.push_back(uint32_t(mesh.neighbours.size()));
    progress(1.0);
    return mesh;
}

bool isScattered(const std::vector<uint32_t>& triangles, uint32_t slots) {
    // With fewer slots than this everything stays in the second-level cache.
    constexpr uint32_t fewSlots = 16384;
    if (slots < fewSlots || triangles.empty()) return false;
    double distance = 0;
    for (size_t t = 0; t < triangles.size(); t += 3)
        distance += std::abs(double(triangles[t]) - double(triangles[t + 1]));
    // Random numbers are slots / 3 apart on average, those of a grid root(slots).
    return distance / double(triangles.size() / 3) > slots / 16.0;
}

std::vector<uint32_t> breadthFirstNumbers(const MeshAdjacency& adjacency) {
    const uint32_t slots = uint32_t(adjacency.offsets.size() - 1), none = UINT32_MAX;
    std::vector<uint32_t> numbers(slots, none), queue;
    queue.reserve(slots);
    for (uint32_t first = 0; first < slots; ++first) {
        if (numbers[first] != none) continue;
        size_t next = queue.size();
        numbers[first] = uint32_t(next);
        queue.push_back(first);
        for (; next < queue.size(); ++next)
            for (uint32_t e = adjacency.offsets[queue[next]]; e < adjacency.offsets[queue[next] + 1]; ++e) {
                const uint32_t neighbour = adjacency.neighbours[e] & PEL_MESH_SLOT;
                if (numbers[neighbour] != none) continue;
                numbers[neighbour] = uint32_t(queue.size());
                queue.push_back(neighbour);
            }
    }
    return numbers;
}

MeshSlices sliceAdjacency(const MeshAdjacency& adjacency) {
    MeshSlices result;
    const uint32_t slots = uint32_t(adjacency.offsets.size() - 1);
    const auto degree = [&](uint32_t slot) { return adjacency.offsets[slot + 1] - adjacency.offsets[slot]; };
    result.slices.push_back(0);
    for (uint32_t first = 0; first < slots; first += PEL_MESH_LANES) {
        uint32_t longest = 0;
        for (uint32_t slot = first; slot < std::min(first + PEL_MESH_LANES, slots); ++slot)
            longest = std::max(longest, degree(slot));
        if (result.slices.back() > UINT32_MAX - longest)
            fail(PEL_ERROR_UNSUPPORTED, "the neighbour lists of this mesh exceed ", UINT32_MAX,
                 " rows: split it");
        result.slices.push_back(result.slices.back() + longest);
    }
    result.rows.resize(size_t(result.slices.back()) * PEL_MESH_LANES);
    for (uint32_t first = 0, slice = 0; first < slots; first += PEL_MESH_LANES, ++slice)
        for (uint32_t lane = 0; lane < PEL_MESH_LANES; ++lane) {
            const uint32_t slot = std::min(first + lane, slots - 1);
            const uint32_t entries = first + lane < slots ? degree(slot) : 0;
            const uint32_t* list = adjacency.neighbours.data() + adjacency.offsets[slot];
            uint32_t* out = result.rows.data() + size_t(result.slices[slice]) * PEL_MESH_LANES + lane;
            const uint32_t rows = result.slices[slice + 1] - result.slices[slice];
            for (uint32_t row = 0; row < rows; ++row)
                out[size_t(row) * PEL_MESH_LANES] = row < entries ? list[row] : slot;
        }
    return result;
}

std::vector<uint32_t> findRuns(const std::vector<uint32_t>& rows) {
    std::vector<uint32_t> runs(rows.size() / PEL_MESH_LANES, PEL_MESH_NO_RUN);
    size_t found = 0;
    for (size_t r = 0; r < runs.size(); ++r) {
        const uint32_t* row = rows.data() + r * PEL_MESH_LANES;
        uint32_t lane = 1;
        // Flags are above the slot's bits, and the last slot is below PEL_MESH_SLOT, so a sum never reaches
        // the flags.
        while (lane < PEL_MESH_LANES && row[lane] == row[0] + lane) ++lane;
        if (lane == PEL_MESH_LANES) runs[r] = row[0], ++found;
    }
    if (found * 2 < runs.size()) runs.clear();
    return runs;
}

}  // namespace pel
