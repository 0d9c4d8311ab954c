#include "mesh/mesh_adjacency.h"

#include <algorithm>

#include "cl/error.h"
#include "mesh/mesh_threads.h"
#include "shared/mesh.h"

namespace pel {
namespace {

// With fewer, a thread costs more than it saves.
constexpr size_t leastSlots = 16384;

MeshAdjacency buildAdjacency(const CornerTable& table, const Written& ready) {
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
        uint32_t there = 0;
        for (size_t slot = begin; slot < end; ++slot) {
            if (slot >= there) there = ready.waitFor(uint32_t(slot) + 1);
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

}  // namespace

MeshAdjacency buildAdjacency(const CornerTable& table) {
    return buildAdjacency(table, Written(uint32_t(table.begins.size() - 1)));
}

MeshAdjacency buildRenumbered(const CornerTable& table, std::vector<uint32_t>& numbers) {
    Renumbering renumbering(table);
    MeshAdjacency mesh;
    {
        // One thread gives numbers, the others make lists of what it has moved.
        std::jthread mover;
        try {
            mover = std::jthread([&] { renumbering.run(); });
        } catch (const std::system_error&) {  // no more threads for this process
            renumbering.run();
        }
        mesh = buildAdjacency(renumbering.moved, renumbering.ready);
    }
    numbers = std::move(renumbering.numbers);
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

Renumbering::Renumbering(const CornerTable& table)
    : numbers(table.begins.size() - 1, none),
      table_(table),
      slots_(uint32_t(table.begins.size() - 1)),
      queue_(table.begins.size()) {  // one more than slots, for one that turns out to have a number
    moved.corners.resize(table.corners.size());
    moved.begins.resize(table.begins.size());
}

void Renumbering::move(uint32_t next) {
    // Lists lie anywhere in memory: those of the next slots are asked for before their turn.
    if (next + 24 < known_) __builtin_prefetch(table_.begins.data() + queue_[next + 24]);
    if (next + 12 < known_) {
        const Corner* list = table_.corners.data() + table_.begins[queue_[next + 12]];
        __builtin_prefetch(list);
        __builtin_prefetch(list + 6);
    }
    if (next + 6 < known_) {  // this list has come meanwhile
        const uint32_t slot = queue_[next + 6];
        for (uint32_t i = table_.begins[slot]; i < table_.begins[slot + 1]; ++i)
            __builtin_prefetch(numbers.data() + table_.corners[i].from);
    }
    const uint32_t begin = table_.begins[queue_[next]], end = table_.begins[queue_[next] + 1];
    moved.begins[next] = written_;
    Corner* const to = moved.corners.data() + written_;
    for (uint32_t i = begin; i < end; ++i) to[i - begin].from = number(table_.corners[i].from);
    for (uint32_t i = begin; i < end; ++i) to[i - begin].to = number(table_.corners[i].to);
    written_ += end - begin;
}

void Renumbering::run() noexcept {
    uint32_t next = 0, told = 0;
    for (uint32_t first = 0; first < slots_; ++first) {
        if (numbers[first] != none) continue;
        number(first);
        for (; next < known_; ++next) {
            move(next);
            // RingBuilder reads a few corners past a slot's own. So a block is ready only when enough
            // corners follow it.
            if (next - told < block || next % block != 0) continue;
            const uint32_t whole = next - block;
            if (written_ - moved.begins[whole] < RingBuilder::readAhead) continue;
            ready.tell(told = whole);
        }
    }
    moved.begins[slots_] = written_;
    std::ranges::fill(moved.corners.begin() + written_, moved.corners.end(), Corner{0, 0});
    ready.tell(slots_);
}

}  // namespace pel
