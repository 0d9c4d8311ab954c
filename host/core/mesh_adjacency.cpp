#include "core/mesh_adjacency.h"

#include <algorithm>

#include "cl/error.h"
#include "shared/mesh.h"

namespace pel {
namespace {

// Lists are short (12 entries around an ordinary vertex) but for the hub of a fan.
void sortList(uint32_t* begin, uint32_t* end) {
    if (end - begin > 32) {
        std::sort(begin, end);
        return;
    }
    for (uint32_t* i = begin + (begin < end); i < end; ++i) {
        const uint32_t value = *i;
        uint32_t* j = i;
        for (; j > begin && j[-1] > value; --j) *j = j[-1];
        *j = value;
    }
}

}  // namespace

MeshAdjacency buildAdjacency(const std::vector<uint32_t>& triangles, uint32_t slots,
                             const std::function<void(double)>& progress) {
    if (triangles.size() * 2 > UINT32_MAX)
        fail(PEL_ERROR_UNSUPPORTED, triangles.size() / 3,
             " triangles are more than a topology holds (715827882): split the mesh");
    MeshAdjacency mesh;
    // Counting sort of every corner's two opposite slots by corner. Offsets are shifted by one while they
    // count.
    mesh.offsets.assign(size_t(slots) + 2, 0);
    for (uint32_t corner : triangles) mesh.offsets[size_t(corner) + 2] += 2;
    for (size_t s = 2; s < mesh.offsets.size(); ++s) mesh.offsets[s] += mesh.offsets[s - 1];
    progress(0.2);
    std::vector<uint32_t> opposite(triangles.size() * 2);
    for (size_t t = 0; t < triangles.size(); t += 3) {
        const uint32_t v[3] = {triangles[t], triangles[t + 1], triangles[t + 2]};
        for (int c = 0; c < 3; ++c) {
            uint32_t& next = mesh.offsets[size_t(v[c]) + 1];
            opposite[next++] = v[(c + 1) % 3];
            opposite[next++] = v[(c + 2) % 3];
        }
    }
    mesh.offsets.pop_back();
    progress(0.6);

    // Sorted, m equal entries are an edge of m triangles; they shrink to half, in place.
    uint32_t written = 0, begin = 0;
    for (uint32_t slot = 0; slot < slots; ++slot) {
        const uint32_t end = mesh.offsets[slot + 1];
        mesh.offsets[slot] = written;
        if (begin == end) ++mesh.unreferencedSlots;
        sortList(opposite.data() + begin, opposite.data() + end);
        while (begin < end) {
            const uint32_t other = opposite[begin];
            uint32_t count = 0;
            for (; begin < end && opposite[begin] == other; ++begin) ++count;
            for (uint32_t pair = 0; pair < count / 2; ++pair) opposite[written++] = other;
            if (count % 2) opposite[written++] = other | MESH_SINGLE;
            if (other < slot) continue;
            ++mesh.edges;
            mesh.borderEdges += count == 1;
            mesh.nonManifoldEdges += count > 2;
        }
    }
    mesh.offsets[slots] = written;
    opposite.resize(written);
    opposite.shrink_to_fit();
    mesh.neighbours = std::move(opposite);
    progress(1.0);
    return mesh;
}

MeshSlices sliceAdjacency(const MeshAdjacency& adjacency) {
    MeshSlices result;
    const uint32_t slots = uint32_t(adjacency.offsets.size() - 1);
    const auto degree = [&](uint32_t slot) { return adjacency.offsets[slot + 1] - adjacency.offsets[slot]; };
    result.slices.push_back(0);
    for (uint32_t first = 0; first < slots; first += MESH_LANES) {
        uint32_t longest = 0;
        for (uint32_t slot = first; slot < std::min(first + MESH_LANES, slots); ++slot)
            longest = std::max(longest, degree(slot));
        if (result.slices.back() > UINT32_MAX - longest)
            fail(PEL_ERROR_UNSUPPORTED, "the neighbour lists of this mesh exceed ", UINT32_MAX,
                 " rows: split it");
        result.slices.push_back(result.slices.back() + longest);
    }
    result.rows.resize(size_t(result.slices.back()) * MESH_LANES);
    for (uint32_t first = 0, slice = 0; first < slots; first += MESH_LANES, ++slice)
        for (uint32_t lane = 0; lane < MESH_LANES; ++lane) {
            const uint32_t slot = std::min(first + lane, slots - 1);
            const uint32_t entries = first + lane < slots ? degree(slot) : 0;
            const uint32_t* list = adjacency.neighbours.data() + adjacency.offsets[slot];
            uint32_t* out = result.rows.data() + size_t(result.slices[slice]) * MESH_LANES + lane;
            const uint32_t rows = result.slices[slice + 1] - result.slices[slice];
            for (uint32_t row = 0; row < rows; ++row)
                out[size_t(row) * MESH_LANES] = row < entries ? list[row] : slot;
        }
    return result;
}

}  // namespace pel
