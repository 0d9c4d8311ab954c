#include "mesh/mesh_adjacency.h"

#include <algorithm>
#include <bit>
#include <tuple>

#include "shared/mesh.h"

namespace pel {
namespace {

// Up to this size, one triangle is compared with all others at once.
constexpr uint32_t smallFan = RingBuilder::readAhead;

}  // namespace

bool RingBuilder::End::operator<(const End& b) const {
    // Forward first: a walk follows the order of the triangles as long as possible.
    return std::tie(node, backward, other, triangle) < std::tie(b.node, b.backward, b.other, b.triangle);
}

RingBuilder::Edges RingBuilder::build(uint32_t slot, const Corner* corners, uint32_t count,
                                      LargeVector<uint32_t>& out) {
    const size_t begin = out.size();
    Edges edges;
    if (count > 0 && !(count <= smallFan && buildFan(corners, count, out))) {
        buildTrails(corners, count, out);
        // A list of this kind can hold a neighbour several times.
        for (const Node& node : nodes_) {
            if (node.slot < slot) continue;
            const uint32_t triangles = node.end - node.next;
            ++edges.all;
            edges.border += triangles == 1;
            edges.nonManifold += triangles > 2;
            edges.inconsistent +=
                triangles == 2 && ends_[node.next].backward == ends_[node.next + 1].backward;
        }
        return edges;
    }
    for (size_t e = begin; e < out.size(); ++e) {
        const uint32_t own = (out[e] & PEL_MESH_SLOT) >= slot;  // no branch: slots are in any order
        edges.all += own;
        edges.border += own & uint32_t((out[e] & PEL_MESH_SINGLE) != 0);
    }
    return edges;
}

// The usual vertex: one fan of triangles, all in the same order. For any other vertex returns false and
// appends nothing.
bool RingBuilder::buildFan(const Corner* corners, uint32_t count, LargeVector<uint32_t>& out) {
    // The corners whose `end` is `slot`, as bits. A loop over all eight becomes vector instructions.
    constexpr uint32_t bits[smallFan] = {1, 2, 4, 8, 16, 32, 64, 128};
    const uint32_t valid = (1u << count) - 1;
    const auto with = [&](uint32_t Corner::*end, uint32_t slot) {
        uint32_t found = 0;
        for (uint32_t a = 0; a < smallFan; ++a) found |= corners[a].*end == slot ? bits[a] : 0;
        return found & valid;
    };
    // Forwards from any corner until there is no next one, then backwards from it. A walk that takes each
    // corner once has no two with the same `from` or `to`: one of them would be taken twice, or never.
    const auto isOne = [](uint32_t found) { return (found & (found - 1)) == 0; };
    uint32_t walk[2 * smallFan], begin = smallFan, end = smallFan, taken = 1;
    walk[end++] = 0;
    bool closed = false;
    while (const uint32_t found = with(&Corner::from, corners[walk[end - 1]].to)) {
        closed = found == 1;
        if (closed) break;
        if (!isOne(found) || (found & taken)) return false;
        taken |= found;
        walk[end++] = uint32_t(std::countr_zero(found));
    }
    while (const uint32_t found = closed ? 0 : with(&Corner::to, corners[walk[begin]].from)) {
        if (!isOne(found) || (found & taken)) return false;
        taken |= found;
        walk[--begin] = uint32_t(std::countr_zero(found));
    }
    if (end - begin != count) return false;
    const size_t at = out.size();
    out.resize(at + count + (closed ? 0 : 1));
    uint32_t* list = out.data() + at;
    // A closed fan starts at the smallest neighbour: the list must not depend on the order of the triangles.
    uint32_t first = begin;
    for (uint32_t i = begin + 1; closed && i < end; ++i)
        first = corners[walk[i]].from < corners[walk[first]].from ? i : first;
    for (uint32_t i = first; i < end; ++i) *list++ = corners[walk[i]].from;
    for (uint32_t i = begin; i < first; ++i) *list++ = corners[walk[i]].from;
    out[at] |= closed ? PEL_MESH_START : PEL_MESH_START | PEL_MESH_SINGLE;
    if (!closed) *list = corners[walk[end - 1]].to | PEL_MESH_SINGLE;
    return true;
}

RingBuilder::Node& RingBuilder::node(uint32_t slot) {
    return *std::lower_bound(nodes_.begin(), nodes_.end(), slot,
                             [](const Node& n, uint32_t s) { return n.slot < s; });
}

// Any set of triangles. A walk that starts at a corner with an odd number of triangles ends at another such
// corner. When there are none, every walk returns to its start.
void RingBuilder::buildTrails(const Corner* corners, uint32_t count, LargeVector<uint32_t>& out) {
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
    for (uint32_t backward : {0u, 1u})  // an open fan is walked forwards
        for (Node& n : nodes_)
            if (n.free % 2 && ends_[n.next].backward == backward) walk(n, out);
    for (Node& n : nodes_)
        while (n.free) walk(n, out);
    for (size_t n = 0; n < nodes_.size(); ++n) nodes_[n].next = firsts[n];
}

void RingBuilder::walk(Node& start, LargeVector<uint32_t>& out) {
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
