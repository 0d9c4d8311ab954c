#include "mesh/mesh_adjacency.h"

#include <algorithm>
#include <cmath>

#include "cl/error.h"
#include "mesh/mesh_ring.h"
#include "mesh/mesh_threads.h"
#include "shared/mesh.h"

namespace pel {

namespace {

// With fewer, a thread costs more than it saves.
constexpr size_t leastTriangles = 32768, leastSlots = 16384;

}  // namespace

CornerTable sortCorners(const std::vector<uint32_t>& triangles, uint32_t slots) {
    if (triangles.size() > UINT32_MAX / 2)
        fail(PEL_ERROR_UNSUPPORTED, triangles.size() / 3,
             " triangles are more than a topology holds (715827882): split the mesh");
    // Counting sort. Offsets are shifted by one while they count. Every thread reads all triangles, and writes the corners of its own
    // slots: they come in the same order whatever the number of threads.
    CornerTable table;
    std::vector<uint32_t>& begins = table.begins;
    begins.resize(size_t(slots) + 2);
    for (uint32_t slot : triangles) ++begins[size_t(slot) + 2];
    for (size_t s = 2; s < begins.size(); ++s) begins[s] += begins[s - 1];
    table.corners.resize(triangles.size());
    inParts(slots, partsOf(triangles.size() / 3, leastTriangles), [&](size_t, size_t begin, size_t end) {
        for (size_t t = 0; t < triangles.size(); t += 3)
            for (size_t c = 0; c < 3; ++c)
                if (const uint32_t slot = triangles[t + c]; slot - begin < end - begin)
                    table.corners[begins[size_t(slot) + 1]++] = {triangles[t + (c + 1) % 3],
                                                                 triangles[t + (c + 2) % 3]};
    });
    begins.pop_back();
    return table;
}

MeshAdjacency buildAdjacency(CornerTable& table) {
    MeshAdjacency mesh;
    const std::vector<uint32_t>& begins = table.begins;
    const auto slots = uint32_t(begins.size() - 1);
    struct Part {
        std::vector<uint32_t> neighbours;
        RingBuilder::Edges edges;
    };
    std::vector<Part> parts(partsOf(slots, leastSlots));
    mesh.offsets.resize(size_t(slots) + 1);
    inParts(slots, parts.size(), [&](size_t index, size_t begin, size_t end) {
        Part& part = parts[index];
        const size_t count = begins[end] - begins[begin];
        part.neighbours.reserve(count + count / 8);
        RingBuilder builder;
        for (size_t slot = begin; slot < end; ++slot) {
            mesh.offsets[slot] = uint32_t(part.neighbours.size());
            part.edges += builder.build(uint32_t(slot), table.corners.data() + begins[slot],
                                        begins[slot + 1] - begins[slot], part.neighbours);
        }
    });
    std::vector<uint32_t> starts{0};
    for (const Part& part : parts) {
        starts.push_back(starts.back() + uint32_t(part.neighbours.size()));
        mesh.edges += part.edges.all;
        mesh.borderEdges += part.edges.border;
        mesh.nonManifoldEdges += part.edges.nonManifold;
        mesh.inconsistentEdges += part.edges.inconsistent;
    }
    mesh.offsets[slots] = starts.back();
    if (parts.size() == 1) {
        mesh.neighbours = std::move(parts[0].neighbours);
        return mesh;
    }
    mesh.neighbours.resize(starts.back());
    inParts(slots, parts.size(), [&](size_t index, size_t begin, size_t end) {
        for (size_t slot = begin; slot < end; ++slot) mesh.offsets[slot] += starts[index];
        std::ranges::copy(parts[index].neighbours, mesh.neighbours.begin() + starts[index]);
    });
    return mesh;
}

CornerTable renumberCorners(const CornerTable& table, const std::vector<uint32_t>& numbers) {
    CornerTable result;
    const size_t slots = numbers.size();
    result.begins.resize(slots + 1);
    for (size_t slot = 0; slot < slots; ++slot)
        result.begins[size_t(numbers[slot]) + 1] = table.begins[slot + 1] - table.begins[slot];
    for (size_t slot = 0; slot < slots; ++slot) result.begins[slot + 1] += result.begins[slot];
    result.corners.resize(table.corners.size());
    inParts(slots, partsOf(slots, leastSlots), [&](size_t, size_t begin, size_t end) {
        for (size_t slot = begin; slot < end; ++slot) {
            Corner* to = result.corners.data() + result.begins[numbers[slot]];
            for (size_t i = table.begins[slot]; i < table.begins[slot + 1]; ++i)
                *to++ = {numbers[table.corners[i].from], numbers[table.corners[i].to]};
        }
    });
    return result;
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
        for (; next < queue.size(); ++next) {
            // Lists lie anywhere in memory: those of the next slots are asked for before their turn.
            if (next + 16 < queue.size()) __builtin_prefetch(adjacency.offsets.data() + queue[next + 16]);
            if (next + 8 < queue.size())
                __builtin_prefetch(adjacency.neighbours.data() + adjacency.offsets[queue[next + 8]]);
            for (uint32_t e = adjacency.offsets[queue[next]]; e < adjacency.offsets[queue[next] + 1]; ++e) {
                const uint32_t neighbour = adjacency.neighbours[e] & PEL_MESH_SLOT;
                if (numbers[neighbour] != none) continue;
                numbers[neighbour] = uint32_t(queue.size());
                queue.push_back(neighbour);
            }
        }
    }
    return numbers;
}

namespace {

void fillSlice(const MeshAdjacency& adjacency, MeshSlices& result, uint32_t slice) {
    const uint32_t slots = uint32_t(adjacency.offsets.size() - 1), first = slice * PEL_MESH_LANES;
    for (uint32_t lane = 0; lane < PEL_MESH_LANES; ++lane) {
        const uint32_t slot = std::min(first + lane, slots - 1);
        const uint32_t* list = adjacency.neighbours.data() + adjacency.offsets[slot];
        const uint32_t entries =
            first + lane < slots ? adjacency.offsets[slot + 1] - adjacency.offsets[slot] : 0;
        uint32_t* out = result.rows.data() + size_t(result.slices[slice]) * PEL_MESH_LANES + lane;
        const uint32_t rows = result.slices[slice + 1] - result.slices[slice];
        for (uint32_t row = 0; row < rows; ++row)
            out[size_t(row) * PEL_MESH_LANES] = row < entries ? list[row] : slot;
    }
}

}  // namespace

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
    const size_t slices = result.slices.size() - 1;
    inParts(slices, partsOf(slots, leastSlots), [&](size_t, size_t begin, size_t end) {
        for (size_t slice = begin; slice < end; ++slice) fillSlice(adjacency, result, uint32_t(slice));
    });
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
