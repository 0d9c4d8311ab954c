#include "mesh/mesh_topology.h"

#include "core/three.h"

namespace pel {
namespace {

constexpr uint32_t none = UINT32_MAX;

// Normals, or a volume, are trusted to tell the side from this share of the largest possible sum on. Right
// ones reach 0.5 to 1; sums of random signs reach about 1 / root(triangles).
constexpr double believed = 0.1;

void checkStride(uint32_t stride, const char* name) {
    if (stride % sizeof(float) != 0 || (stride > 0 && stride < 3 * sizeof(float)))
        invalidArgument(name, " is ", stride, "; 0 (12 bytes) or a multiple of 4 of at least 12 is needed");
}

// Across side s (from corner s % 3 to the next corner of triangle s / 3): 2 * the other triangle, plus 1 if
// that triangle runs along the side in the same direction. `none` if there is no other triangle, or more than
// one.
std::vector<uint32_t> findAcross(const std::vector<uint32_t>& slots, uint32_t slotCount) {
    const auto low = [&](uint32_t s) { return std::min(slots[s], slots[s % 3 == 2 ? s - 2 : s + 1]); };
    const auto high = [&](uint32_t s) { return std::max(slots[s], slots[s % 3 == 2 ? s - 2 : s + 1]); };
    const auto repeats = [&](uint32_t s) {
        const uint32_t* t = &slots[s / 3 * 3];
        return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    };
    // Sides sorted by their lower end, then by the higher one.
    std::vector<uint32_t> begins(size_t(slotCount) + 2), sides;
    for (uint32_t s = 0; s < slots.size(); ++s)
        if (!repeats(s)) ++begins[size_t(low(s)) + 2];
    for (size_t i = 2; i < begins.size(); ++i) begins[i] += begins[i - 1];
    sides.resize(begins.back());
    for (uint32_t s = 0; s < slots.size(); ++s)
        if (!repeats(s)) sides[begins[size_t(low(s)) + 1]++] = s;
    std::vector<uint32_t> across(slots.size(), none);
    for (size_t slot = 0; slot < slotCount; ++slot) {
        const auto begin = sides.begin() + begins[slot], end = sides.begin() + begins[slot + 1];
        std::sort(begin, end,
                  [&](uint32_t a, uint32_t b) { return std::pair(high(a), a) < std::pair(high(b), b); });
        for (auto first = begin, last = begin; first != end; first = last) {
            while (last != end && high(*last) == high(*first)) ++last;
            if (last - first != 2) continue;
            const uint32_t a = first[0], b = first[1], same = slots[a] == slots[b];
            across[a] = b / 3 * 2 + same;
            across[b] = a / 3 * 2 + same;
        }
    }
    return across;
}

class Orienter {
  public:
    Orienter(const PelMeshTopologyDesc& desc, const float* normals, uint32_t normalStride)
        : desc_(desc), positions_(desc.positions, desc.positionStride), normals_(normals, normalStride) {
        checkStride(desc.positionStride, "PelMeshTopologyDesc.positionStride");
        checkStride(normalStride, "normalStride");
    }

    std::vector<uint32_t> run(PelMeshOrientation& found) {
        std::vector<uint32_t> indices(desc_.indices, desc_.indices + desc_.numIndices);
        const MeshWeld weld = weldVertices(desc_, [](double) {});
        std::vector<uint32_t> slots = indices;
        if (!weld.slotOf.empty())
            for (uint32_t& slot : slots) slot = weld.slotOf[slot];
        across_ = findAcross(slots, weld.slots);
        const auto count = uint32_t(indices.size() / 3);
        state_.assign(count, open);
        for (uint32_t first = 0; first < count; ++first) {
            if (state_[first] != open) continue;
            const bool agrees = collect(first);
            ++found.parts;
            if (agrees) continue;
            const bool rest = otherSide(found);
            uint32_t turned = 0;
            for (uint32_t t : part_)
                if ((state_[t] == turn) != rest) {
                    std::swap(indices[3 * size_t(t) + 1], indices[3 * size_t(t) + 2]);
                    ++turned;
                }
            found.trianglesTurned += turned;
            found.partsTurned += turned > 0;
        }
        return indices;
    }

    // Edges that no reversal repairs.
    uint32_t left() const { return left_; }

  private:
    enum State : uint8_t { open, keep, turn };

    // The part of a triangle, and which of its triangles run in the other direction. True if none does.
    bool collect(uint32_t first) {
        part_.assign(1, first);
        state_[first] = keep;
        closed_ = true;
        uint32_t turns = 0, clashes = 0;
        for (size_t next = 0; next < part_.size(); ++next)
            for (uint32_t s = part_[next] * 3; s < part_[next] * 3 + 3; ++s) {
                if (across_[s] == none) {
                    closed_ = false;
                    continue;
                }
                const uint32_t other = across_[s] / 2;
                const State wanted = (across_[s] & 1) == (state_[part_[next]] == turn) ? keep : turn;
                if (state_[other] == open) {
                    state_[other] = wanted;
                    turns += wanted == turn;
                    part_.push_back(other);
                } else
                    clashes += state_[other] != wanted;  // seen from both sides of the edge
            }
        left_ += clashes / 2;
        turns_ = turns;
        return turns == 0;
    }

    // Whether the triangles that keep their order are the ones to reverse.
    bool otherSide(PelMeshOrientation& found) const {
        if (const int side = normals_.begin ? sideOfNormals() : 0) {
            ++found.partsByNormals;
            return side < 0;
        }
        if (const int side = positions_.begin && closed_ ? sideOfVolume() : 0) {
            ++found.partsByVolume;
            return side < 0;
        }
        ++found.partsByMajority;
        return turns_ * 2 > part_.size();
    }

    Three position(uint32_t vertex) const { return threeAt(positions_[vertex].data()); }
    Three normalOf(uint32_t t) const {  // of twice the triangle's area
        const uint32_t* v = desc_.indices + 3 * size_t(t);
        const Three p = position(v[0]), n = cross(position(v[1]) - p, position(v[2]) - p);
        return state_[t] == turn ? -1 * n : n;
    }

    // 1: the triangles in the order of state_ face the direction of the summed vector; -1: the opposite
    // direction; 0: undecided.
    template <class Term>
    int sideOf(Term term) const {
        double sum = 0, all = 0;
        for (uint32_t t : part_) {
            const double x = term(t);
            if (!std::isfinite(x)) continue;
            sum += x;
            all += std::abs(x);
        }
        return std::isfinite(all) && std::abs(sum) > believed * all ? (sum > 0 ? 1 : -1) : 0;
    }

    int sideOfNormals() const {
        return sideOf([&](uint32_t t) {
            const Three face = normalOf(t);
            double sum = 0;
            for (int c = 0; c < 3; ++c)
                sum += dot(face, threeAt(normals_[desc_.indices[3 * size_t(t) + c]].data()));
            return sum;
        });
    }

    int sideOfVolume() const {
        Three middle{};
        for (uint32_t t : part_) {
            const Three p = position(desc_.indices[3 * size_t(t)]);
            if (!std::isfinite(p[0] + p[1] + p[2])) return 0;
            middle += p;
        }
        for (double& x : middle) x /= double(part_.size());
        return sideOf(
            [&](uint32_t t) { return dot(normalOf(t), position(desc_.indices[3 * size_t(t)]) - middle); });
    }

    const PelMeshTopologyDesc& desc_;
    const VertexFloats positions_, normals_;
    std::vector<uint32_t> across_, part_;
    std::vector<State> state_;
    uint32_t turns_ = 0, left_ = 0;
    bool closed_ = false;
};

}  // namespace

std::vector<uint32_t> orientTriangles(const PelMeshTopologyDesc& desc, const float* normals,
                                      uint32_t normalStride, PelMeshOrientation& found) {
    checkTopologyDesc(desc);
    if (desc.numIndices > UINT32_MAX / 2)
        fail(PEL_ERROR_UNSUPPORTED, desc.numIndices / 3,
             " triangles are more than a topology holds (715827882): split the mesh");
    if (normals && !desc.positions)
        invalidArgument("normals can be used only with PelMeshTopologyDesc.positions, which is NULL");
    Orienter orienter(desc, normals, normalStride);
    std::vector<uint32_t> indices = orienter.run(found);
    found.inconsistentEdges = orienter.left();
    return indices;
}

}  // namespace pel
