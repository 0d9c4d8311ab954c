#include "mesh/mesh_adjacency.h"

#include "cl/error.h"
#include "system/threads.h"

namespace pel {

namespace {

// With fewer, a thread costs more than it saves.
constexpr size_t leastTriangles = 32768;

// Runs of slots whose corners fit into a second-level cache, but no more of them than a processor can write
// to side by side.
class Buckets {
  public:
    explicit Buckets(uint32_t slots) {
        while ((uint64_t(slots) >> shift_) >= 512) ++shift_;
        count_ = size_t(slots >> shift_) + 1;
    }
    size_t count() const { return count_; }
    size_t of(uint32_t slot) const { return slot >> shift_; }
    size_t begin(size_t bucket) const { return bucket << shift_; }

  private:
    uint32_t shift_ = 12;
    size_t count_;
};

// Results of one thread for its part of the triangles.
struct Seen {
    std::vector<uint32_t> corners;  // per bucket; then where the next one goes
    std::vector<bool> vertices;
    uint64_t distance = 0;  // between first and second slot, summed
    uint32_t degenerate = 0;
};

struct PlacedCorner {
    uint32_t slot;
    Corner corner;
};

void look(const Triangles& triangles, const Buckets& buckets, size_t begin, size_t end, Seen& seen) {
    seen.corners.resize(buckets.count());
    seen.vertices.resize(triangles.vertices);
    for (size_t t = begin; t < end; ++t) {
        for (size_t c = 0; c < 3; ++c) seen.vertices[triangles.indices[3 * t + c]] = true;
        uint32_t v[3];
        if (!triangles.slotsOf(t, v)) {
            ++seen.degenerate;
            continue;
        }
        for (uint32_t slot : v) ++seen.corners[buckets.of(slot)];
        seen.distance += v[0] > v[1] ? v[0] - v[1] : v[1] - v[0];
    }
}

// Sorts the corners of one bucket, a run of slots from `first` on.
void sortBucket(const PlacedCorner* placed, size_t count, uint32_t* begins, size_t slots, size_t first,
                size_t before, bool byFrom, Corner* out) {
    // Counts are stored one slot later: after the sums places[s] is where slot s begins, and after writing,
    // where it ends.
    std::vector<uint32_t> places(slots + 1);
    for (size_t i = 0; i < count; ++i) ++places[placed[i].slot - first + 1];
    for (size_t s = 0; s < slots; ++s) places[s + 1] += places[s];
    for (size_t s = 0; s < slots; ++s) begins[s] = uint32_t(before + places[s]);
    for (size_t i = 0; i < count; ++i) out[before + places[placed[i].slot - first]++] = placed[i].corner;
    for (size_t s = 0; byFrom && s < slots; ++s)
        std::ranges::sort(out + begins[s], out + before + places[s], {}, &Corner::from);
}

}  // namespace

CornerTable sortCorners(const Triangles& triangles) {
    if (triangles.count * 3 > UINT32_MAX / 2)
        fail(PEL_ERROR_UNSUPPORTED, triangles.count,
             " triangles are more than a topology holds (715827882): split the mesh");
    const Buckets buckets(triangles.slots);
    std::vector<Seen> parts(partsOf(triangles.count, leastTriangles));
    inParts(triangles.count, parts.size(), [&](size_t part, size_t begin, size_t end) {
        look(triangles, buckets, begin, end, parts[part]);
    });

    // Corners of a bucket lie together, those of the first part first.
    CornerTable table;
    std::vector<size_t> starts;
    size_t corners = 0;
    for (size_t bucket = 0; bucket < buckets.count(); ++bucket) {
        starts.push_back(corners);
        for (Seen& part : parts) {
            const uint32_t count = part.corners[bucket];
            part.corners[bucket] = uint32_t(corners);
            corners += count;
        }
    }
    starts.push_back(corners);
    uint64_t distance = 0;
    for (Seen& part : parts) {
        table.degenerate += part.degenerate;
        distance += part.distance;
        if (&part != &parts[0])
            for (size_t v = 0; v < triangles.vertices; ++v)
                if (part.vertices[v]) parts[0].vertices[v] = true;
    }
    table.unreferenced = uint32_t(std::count(parts[0].vertices.begin(), parts[0].vertices.end(), false));
    // With fewer slots everything stays in the second-level cache. Random slots are a third of their number
    // apart on average, those of a grid its root.
    constexpr uint32_t fewSlots = 16384;
    table.scattered = triangles.slots >= fewSlots && corners > 0 &&
                      double(distance) / double(corners / 3) > triangles.slots / 16.0;

    LargeVector<PlacedCorner> placed(corners);
    inParts(triangles.count, parts.size(), [&](size_t part, size_t begin, size_t end) {
        uint32_t v[3];
        for (size_t t = begin; t < end; ++t) {
            if (!triangles.slotsOf(t, v)) continue;
            for (size_t c = 0; c < 3; ++c)
                placed[parts[part].corners[buckets.of(v[c])]++] = {v[c], {v[(c + 1) % 3], v[(c + 2) % 3]}};
        }
    });
    table.begins.resize(size_t(triangles.slots) + 1);
    table.begins.back() = uint32_t(corners);
    table.corners.resize(corners + RingBuilder::readAhead);
    std::ranges::fill(table.corners.begin() + ptrdiff_t(corners), table.corners.end(), Corner{0, 0});
    inParts(buckets.count(), parts.size(), [&](size_t, size_t begin, size_t end) {
        for (size_t bucket = begin; bucket < end; ++bucket) {
            const size_t first = buckets.begin(bucket),
                         last = std::min<size_t>(buckets.begin(bucket + 1), triangles.slots);
            if (first < last)
                sortBucket(placed.data() + starts[bucket], starts[bucket + 1] - starts[bucket],
                           table.begins.data() + first, last - first, first, starts[bucket], table.scattered,
                           table.corners.data());
        }
    });
    return table;
}

}  // namespace pel
