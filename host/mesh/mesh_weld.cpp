#include "mesh/mesh_topology.h"

#include <bit>
#include <numeric>

#include "core/three.h"

namespace pel {
namespace {

using Point = std::array<float, 3>;
using Cell = std::array<int64_t, 3>;

// Chains of the vertices of each cell of space, in a hash table twice as long as there are vertices.
class CellTable {
  public:
    explicit CellTable(uint32_t vertices) : next_(vertices, none) {
        size_t size = 16;
        while (size < size_t(vertices) * 2) size *= 2;
        heads_.assign(size, none);
    }
    void insert(const Cell& cell, uint32_t vertex) {
        uint32_t& head = heads_[bucket(cell)];
        next_[vertex] = head;
        head = vertex;
    }
    // The smallest vertex of the cell's chain that `matches`. Other cells may share the chain.
    template <class Matches>
    uint32_t find(const Cell& cell, Matches&& matches) const {
        uint32_t found = none;
        for (uint32_t v = heads_[bucket(cell)]; v != none; v = next_[v])
            if (v < found && matches(v)) found = v;
        return found;
    }
    static constexpr uint32_t none = UINT32_MAX;

  private:
    size_t bucket(const Cell& cell) const {
        // Multiplicative hashing (Knuth, TAOCP 6.4), once per coordinate, with the golden ratio of 2^64.
        uint64_t h = 0;
        for (int64_t c : cell) h = (h ^ uint64_t(c)) * 0x9E3779B97F4A7C15u, h ^= h >> 32;
        return h & (heads_.size() - 1);
    }
    std::vector<uint32_t> heads_, next_;
};

bool finite(const Point& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

// Every distinct coordinate is a cell of its own.
Cell exactCell(const Point& p) {
    Cell cell;
    for (int c = 0; c < 3; ++c) cell[c] = std::bit_cast<uint32_t>(p[c] + 0.0f);  // -0 becomes 0
    return cell;
}

Cell gridCell(const Point& p, double size) {
    Cell cell;
    for (int c = 0; c < 3; ++c) cell[c] = int64_t(std::floor(std::min(std::max(p[c] / size, -4e18), 4e18)));
    return cell;
}

uint32_t findExact(const CellTable& table, const VertexFloats& positions, const Point& p) {
    return table.find(exactCell(p), [&](uint32_t v) { return positions[v] == p; });
}

uint32_t findNear(const CellTable& table, const VertexFloats& positions, const Point& p, double tolerance) {
    const Cell centre = gridCell(p, tolerance);
    uint32_t found = CellTable::none;
    for (int n = 0; n < 27; ++n) {
        const Cell cell{centre[0] + n % 3 - 1, centre[1] + n / 3 % 3 - 1, centre[2] + n / 9 - 1};
        found = std::min(found, table.find(cell, [&](uint32_t v) {
            const Three way = threeAt(p.data()) - threeAt(positions[v].data());
            return dot(way, way) <= tolerance * tolerance;
        }));
    }
    return found;
}

void listMembers(MeshWeld& weld) {
    weld.memberOffsets.assign(size_t(weld.slots) + 2, 0);
    for (uint32_t slot : weld.slotOf) ++weld.memberOffsets[size_t(slot) + 2];
    for (size_t s = 2; s < weld.memberOffsets.size(); ++s) weld.memberOffsets[s] += weld.memberOffsets[s - 1];
    weld.members.resize(weld.slotOf.size());
    for (uint32_t v = 0; v < weld.slotOf.size(); ++v)
        weld.members[weld.memberOffsets[size_t(weld.slotOf[v]) + 1]++] = v;
    weld.memberOffsets.pop_back();
}

}  // namespace

void renumberSlots(MeshWeld& weld, std::vector<uint32_t> numbers) {
    if (!weld.slotOf.empty()) {
        for (uint32_t& slot : weld.slotOf) slot = numbers[slot];
        listMembers(weld);
        return;
    }
    // Each slot has one member.
    weld.members.resize(numbers.size());
    for (uint32_t v = 0; v < numbers.size(); ++v) weld.members[numbers[v]] = v;
    weld.memberOffsets.resize(numbers.size() + 1);
    std::iota(weld.memberOffsets.begin(), weld.memberOffsets.end(), 0u);
    weld.slotOf = std::move(numbers);
}

MeshWeld weldVertices(const PelMeshTopologyDesc& desc, const std::function<void(double)>& progress) {
    MeshWeld weld;
    weld.slots = desc.numVertices;
    if (desc.weld == PEL_WELD_NONE || desc.numVertices == 0) return weld;
    if (!desc.positions) invalidArgument("welding needs PelMeshTopologyDesc.positions, not NULL");
    if (desc.positionStride != 0 && desc.positionStride < 12)
        invalidArgument("PelMeshTopologyDesc.positionStride is ", desc.positionStride,
                        " bytes; a position of three floats needs at least 12 (or 0: tightly packed)");
    const bool exact = desc.weld == PEL_WELD_EXACT;
    if (!exact && !(std::isfinite(desc.weldTolerance) && desc.weldTolerance > 0))
        invalidArgument("PelMeshTopologyDesc.weldTolerance is ", desc.weldTolerance,
                        "; a length above 0 is needed (PEL_WELD_EXACT welds equal positions)");

    const VertexFloats positions(desc.positions, desc.positionStride);
    CellTable table(desc.numVertices);
    weld.slotOf.resize(desc.numVertices);
    uint32_t slots = 0;
    for (uint32_t v = 0; v < desc.numVertices; ++v) {
        if (v % (1u << 16) == 0) progress(double(v) / desc.numVertices);
        const Point p = positions[v];
        uint32_t first = CellTable::none;
        if (finite(p)) {
            first =
                exact ? findExact(table, positions, p) : findNear(table, positions, p, desc.weldTolerance);
            if (first == CellTable::none)
                table.insert(exact ? exactCell(p) : gridCell(p, desc.weldTolerance), v);
        }
        weld.slotOf[v] = first == CellTable::none ? slots++ : weld.slotOf[first];
    }
    weld.slots = slots;
    if (slots == desc.numVertices) {
        weld.slotOf.clear();
        return weld;
    }
    listMembers(weld);
    return weld;
}

}  // namespace pel
