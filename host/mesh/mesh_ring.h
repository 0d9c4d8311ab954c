// The walks round one vertex (shared/mesh.h), from the triangles that meet there.
#pragma once
#include <cstdint>
#include <vector>

#include "mesh/large_vector.h"

namespace pel {

// The other two corners of a triangle at a slot, in the order of the triangle.
struct Corner {
    uint32_t from, to;
};

class RingBuilder {
  public:
    struct Edges {
        uint32_t all = 0, border = 0, nonManifold = 0;  // to slots above `slot`
        uint32_t inconsistent = 0;  // edges whose two triangles run along them in the same direction
        Edges& operator+=(const Edges& b) {
            all += b.all, border += b.border, nonManifold += b.nonManifold, inconsistent += b.inconsistent;
            return *this;
        }
    };
    // Appends the list of `slot` to `out`. Of `corners` (count of them) the first
    // `readAhead` are read, whatever is there.
    static constexpr uint32_t readAhead = 8;
    Edges build(uint32_t slot, const Corner* corners, uint32_t count, LargeVector<uint32_t>& out);

  private:
    bool buildSmallFan(const Corner* corners, uint32_t count, LargeVector<uint32_t>& out);
    bool buildFan(const Corner* corners, uint32_t count, LargeVector<uint32_t>& out);
    void buildTrails(const Corner* corners, uint32_t count, LargeVector<uint32_t>& out);

    // One end of the edge that is opposite to the slot in a triangle.
    struct End {
        uint32_t node, backward, other, triangle;
        bool operator<(const End& b) const;
    };
    struct Node {
        uint32_t slot, next, end;  // ends that may still be free: next to end
        uint32_t free;             // how many of them are
        bool visited;
    };
    Node& node(uint32_t slot);
    void walk(Node& start, LargeVector<uint32_t>& out);

    std::vector<Corner> fan_;
    std::vector<End> ends_;
    std::vector<Node> nodes_;
    std::vector<char> used_;  // per triangle
};

}  // namespace pel
