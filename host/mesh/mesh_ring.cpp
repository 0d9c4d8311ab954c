#include "mesh/mesh_ring.h"

#include <algorithm>
#include <tuple>

#include "shared/mesh.h"

namespace pel {
namespace {

// With more triangles than this, sorting costs less than a search per step.
constexpr uint32_t largestFan = 24;

}  // namespace

bool RingBuilder::End::operator<(const End& b) const {
    // Forward first: a walk follows the order of the triangles as long as possible.
    return std::tie(node, backward, other, triangle) < std::tie(b.node, b.backward, b.other, b.triangle);
}

RingBuilder::Edges RingBuilder::build(uint32_t slot, Corner* corners, uint32_t count, std::vector<uint32_t>& out) {
    const size_t begin = out.size();
    Edges edges;
    if (count > 0 && !(count <= largestFan && buildFan(corners, count, out))) {
        buildTrails(corners, count, out);
        // A list of this kind can hold a neighbour several times.
        for (const Node& node : nodes_) {
            if (node.slot < slot) continue;
            const uint32_t triangles = node.end - node.next;
            ++edges.all;
            edges.border += triangles == 1;
            edges.nonManifold += triangles > 2;
            edges.inconsistent += triangles == 2 && ends_[node.next].backward == ends_[node.next + 1].backward;
        }
        return edges;
    }
    for (size_t e = begin; e < out.size(); ++e) {
        if ((out[e] & PEL_MESH_SLOT) < slot) continue;
        ++edges.all;
        edges.border += (out[e] & PEL_MESH_SINGLE) != 0;
    }
    return edges;
}

// The usual vertex: one fan of triangles, all in the same order. For any other vertex returns false and
// appends nothing.
bool RingBuilder::buildFan(Corner* corners, uint32_t count, std::vector<uint32_t>& out) {
    // Start at the corner that no triangle leads to, or at the smallest neighbour if there is none: the list
    // must not depend on the order of the triangles.
    uint32_t first = UINT32_MAX, entrances = 0;
    for (uint32_t a = 0; a < count; ++a) {
        bool reached = false;
        for (uint32_t b = 0; b < count; ++b) {
            if (a != b && (corners[a].from == corners[b].from || corners[a].to == corners[b].to))
                return false;
            reached |= corners[a].from == corners[b].to;
        }
        if (!reached) {
            ++entrances;
            first = a;
        } else if (entrances == 0 && (first == UINT32_MAX || corners[a].from < corners[first].from))
            first = a;
    }
    if (entrances > 1) return false;
    std::swap(corners[0], corners[first]);
    for (uint32_t a = 1; a < count; ++a) {
        uint32_t next = a;
        while (next < count && corners[next].from != corners[a - 1].to) ++next;
        if (next == count) return false;  // two closed fans
        std::swap(corners[a], corners[next]);
    }
    const uint32_t open = entrances ? PEL_MESH_SINGLE : 0;
    for (uint32_t a = 0; a < count; ++a)
        out.push_back(corners[a].from | (a == 0 ? PEL_MESH_START | open : 0));
    if (open) out.push_back(corners[count - 1].to | PEL_MESH_SINGLE);
    return true;
}

RingBuilder::Node& RingBuilder::node(uint32_t slot) {
    return *std::lower_bound(nodes_.begin(), nodes_.end(), slot,
                             [](const Node& n, uint32_t s) { return n.slot < s; });
}

// Any set of triangles. A walk that starts at a corner with an odd number of triangles ends at another such
// corner. When there are none, every walk returns to its start.
void RingBuilder::buildTrails(const Corner* corners, uint32_t count, std::vector<uint32_t>& out) {
    ends_.clear();
    nodes_.clear();
    used_.assign(count, 0);
    std::vector<uint32_t> order(count);  // sorted triangles, so that their order in the mesh does not matter
    for (uint32_t t = 0; t < count; ++t) order[t] = t;
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return std::tie(corners[a].from, corners[a].to) < std::tie(corners[b].from, corners[b].to);
    });
    for (uint32_t t = 0; t < count; ++t) {
        const Corner& c = corners[order[t]];
        ends_.push_back({c.from, 0, c.to, t});
        ends_.push_back({c.to, 1, c.from, t});
    }
    std::sort(ends_.begin(), ends_.end());
    for (uint32_t e = 0; e < ends_.size(); ++e) {
        if (e == 0 || ends_[e].node != ends_[e - 1].node) nodes_.push_back({ends_[e].node, e, e, 0, false});
        nodes_.back().end = e + 1;
        ++nodes_.back().free;
    }
    std::vector<uint32_t> firsts;
    for (const Node& n : nodes_) firsts.push_back(n.next);
    for (Node& n : nodes_)
        if (n.free % 2) walk(n, out);
    for (Node& n : nodes_)
        while (n.free) walk(n, out);
    for (size_t n = 0; n < nodes_.size(); ++n) nodes_[n].next = firsts[n];
}

void RingBuilder::walk(Node& start, std::vector<uint32_t>& out) {
    const bool open = start.free % 2;
    const auto emit = [&](Node& n, uint32_t flags) {
        out.push_back(n.slot | flags | (n.visited ? PEL_MESH_REPEAT : 0));
        n.visited = true;
    };
    emit(start, PEL_MESH_START | (open ? PEL_MESH_SINGLE : 0));
    for (Node* current = &start; current->free > 0;) {
        while (used_[ends_[current->next].triangle]) ++current->next;
        const End& taken = ends_[current->next];
        used_[taken.triangle] = 1;
        if (taken.backward) out.back() |= PEL_MESH_FLIPPED;
        --current->free;
        current = &node(taken.other);
        --current->free;
        if (current->free > 0)
            emit(*current, 0);
        else if (open)
            emit(*current, PEL_MESH_SINGLE);
    }
}

}  // namespace pel
