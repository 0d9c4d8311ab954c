#include "mesh/mesh_adjacency.h"

#include "cl/error.h"
#include "shared/mesh.h"
#include "system/threads.h"

namespace pel {
// With fewer, a thread costs more than it saves.
constexpr size_t leastSlots = 16384;

MeshAdjacency buildAdjacency(const CornerTable& table) {
    MeshAdjacency mesh;
    const LargeVector<uint32_t>& begins = table.begins;
    const auto slots = uint32_t(begins.size() - 1);
    struct Part {
        LargeVector<uint32_t> neighbours;
        RingBuilder::Edges edges;
    };
    std::vector<Part> parts(partsOf(slots, leastSlots));
    mesh.offsets.resize(size_t(slots) + 1);
    inParts(slots, parts.size(), [&](size_t index, size_t begin, size_t end) {
        Part& part = parts[index];
        const size_t count = table.corners.size() / parts.size();
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

std::vector<uint32_t> findRuns(std::span<const uint32_t> rows) {
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

CornerTable renumbered(const CornerTable& table, std::vector<uint32_t>& numbers) {
    constexpr uint32_t none = UINT32_MAX;
    const auto slots = uint32_t(table.begins.size() - 1);
    CornerTable moved;
    moved.corners.resize(table.corners.size());
    moved.begins.resize(table.begins.size());
    numbers.assign(slots, none);
    LargeVector<uint32_t> queue(table.begins.size());  // one more than slots, for one that has a number
    uint32_t known = 0, written = 0, next = 0;
    const auto number = [&](uint32_t slot) {
        const bool isNew = numbers[slot] == none;
        queue[known] = slot;
        const uint32_t n = isNew ? known : numbers[slot];
        numbers[slot] = n;
        known += isNew;
        return n;
    };
    for (uint32_t first = 0; first < slots; ++first) {
        if (numbers[first] != none) continue;
        number(first);
        for (; next < known; ++next) {
            // Lists are scattered in memory, so those of the next slots are prefetched.
            if (next + 24 < known) __builtin_prefetch(table.begins.data() + queue[next + 24]);
            if (next + 12 < known) {
                const Corner* list = table.corners.data() + table.begins[queue[next + 12]];
                __builtin_prefetch(list);
                __builtin_prefetch(list + 6);
            }
            if (next + 6 < known) {  // this list has been fetched by now
                const uint32_t slot = queue[next + 6];
                for (uint32_t i = table.begins[slot]; i < table.begins[slot + 1]; ++i)
                    __builtin_prefetch(numbers.data() + table.corners[i].from);
            }
            const uint32_t begin = table.begins[queue[next]], end = table.begins[queue[next] + 1];
            moved.begins[next] = written;
            Corner* const to = moved.corners.data() + written;
            for (uint32_t i = begin; i < end; ++i) to[i - begin].from = number(table.corners[i].from);
            for (uint32_t i = begin; i < end; ++i) to[i - begin].to = number(table.corners[i].to);
            written += end - begin;
        }
    }
    moved.begins[slots] = written;
    std::ranges::fill(moved.corners.begin() + written, moved.corners.end(), Corner{0, 0});
    return moved;
}

}  // namespace pel
