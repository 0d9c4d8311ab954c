#include "mesh/mesh_orient.h"

#include <algorithm>
#include <array>
#include <utility>

namespace pel {
namespace {

constexpr uint32_t none = UINT32_MAX;

// Across each edge of each triangle: 2 * the other triangle, plus 1 where it has the opposite order; none where there is no
// other, or more than one.
std::vector<uint32_t> findNeighbours(const std::vector<uint32_t>& triangles) {
    struct Side {
        uint32_t low, high, side;  // side: 3 * triangle + corner
    };
    std::vector<Side> sides;
    sides.reserve(triangles.size());
    const auto end = [&](uint32_t side) { return triangles[side % 3 == 2 ? side - 2 : side + 1]; };
    for (uint32_t s = 0; s < triangles.size(); ++s) {
        sides.push_back({std::min(triangles[s], end(s)), std::max(triangles[s], end(s)), s});
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::array{a.low, a.high, a.side} < std::array{b.low, b.high, b.side};
    });
    std::vector<uint32_t> across(triangles.size(), none);
    for (size_t first = 0, last; first < sides.size(); first = last) {
        last = first;
        while (last < sides.size() && sides[last].low == sides[first].low && sides[last].high == sides[first].high) ++last;
        if (last - first != 2) continue;
        const uint32_t a = sides[first].side, b = sides[first + 1].side;
        const uint32_t opposite = triangles[a] == triangles[b];
        across[a] = b / 3 * 2 + opposite;
        across[b] = a / 3 * 2 + opposite;
    }
    return across;
}

}  // namespace

void orientTriangles(std::vector<uint32_t>& triangles) {
    const std::vector<uint32_t> across = findNeighbours(triangles);
    const uint32_t count = uint32_t(triangles.size() / 3);
    std::vector<uint8_t> reached(count), turned(count);
    std::vector<uint32_t> part;
    for (uint32_t first = 0; first < count; ++first) {
        if (reached[first]) continue;
        part.assign(1, first);
        reached[first] = 1;
        size_t turns = 0;
        for (size_t next = 0; next < part.size(); ++next)
            for (uint32_t s = part[next] * 3; s < part[next] * 3 + 3; ++s) {
                if (across[s] == none || reached[across[s] / 2]) continue;
                const uint32_t other = across[s] / 2;
                reached[other] = 1;
                turned[other] = turned[part[next]] ^ (across[s] & 1);
                turns += turned[other];
                part.push_back(other);
            }
        const bool rest = turns * 2 > part.size();
        for (uint32_t t : part)
            if (bool(turned[t]) != rest) std::swap(triangles[3 * t + 1], triangles[3 * t + 2]);
    }
}

}  // namespace pel
