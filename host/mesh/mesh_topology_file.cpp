// A topology as bytes: a header, then its arrays one after another. Loading checks everything, because
// kernels use these numbers as indices without checks.
#include <algorithm>

#include "mesh/mesh_adjacency.h"
#include "mesh/mesh_topology.h"

namespace pel {
namespace {

struct Header {
    char magic[8];
    uint32_t version;   // of this layout; also distinguishes byte orders
    uint32_t words[6];  // of the arrays, in the order that save() writes them
    uint32_t checksum;  // of everything after the header
    PelMeshReport report;
};
constexpr char magic[8] = {'P', 'E', 'L', 'M', 'E', 'S', 'H', '\n'};
constexpr uint32_t version = 3;

// XXH32 [Collet] finds damage. The checks below find wrong values.
uint32_t checksumOf(const uint32_t* words, size_t count) {
    static constexpr uint32_t none = 0;  // an empty array may have no address
    return XXH32(words ? words : &none, count * sizeof *words, 0);
}

[[noreturn]] void damaged(const char* what) {
    invalidArgument("these bytes are not a mesh analysis by this version of the library: ", what,
                    "; analyse the mesh again");
}

void check(bool sound, const char* what) {
    if (!sound) damaged(what);
}

bool below(const std::vector<uint32_t>& values, uint32_t limit) {
    return std::all_of(values.begin(), values.end(), [&](uint32_t v) { return v < limit; });
}

bool rising(const std::vector<uint32_t>& values, size_t last) {
    return !values.empty() && values.front() == 0 && values.back() == last &&
           std::is_sorted(values.begin(), values.end());
}

}  // namespace

std::vector<char> MeshTopology::save() const {
    // The host's memory may be longer than what was asked for.
    const std::pair<const cl::Memory*, size_t> arrays[6] = {
        {&indices_, 3 * size_t(triangles())}, {&slotOf_, vertices()},
        {&memberOffsets_, slots() + 1},       {&members_, vertices()},
        {&slices_, sliceEntries()},           {&rings_, ringEntries_}};
    Header header{};
    std::memcpy(header.magic, magic, sizeof magic);
    header.version = version;
    header.report = report_;
    size_t total = 0;
    for (int a = 0; a < 6; ++a) {
        if (*arrays[a].first) header.words[a] = uint32_t(arrays[a].second);
        total += header.words[a];
    }
    std::vector<uint32_t> words(total);
    size_t at = 0;
    for (int a = 0; a < 6; ++a) {
        if (header.words[a] > 0)
            device_->readOnSideQueue(arrays[a].first->get(), header.words[a] * sizeof(uint32_t),
                                     words.data() + at);
        at += header.words[a];
    }
    header.checksum = checksumOf(words.data(), words.size());
    std::vector<char> bytes(sizeof header + words.size() * sizeof(uint32_t));
    std::memcpy(bytes.data(), &header, sizeof header);
    if (!words.empty())
        std::memcpy(bytes.data() + sizeof header, words.data(), words.size() * sizeof(uint32_t));
    return bytes;
}

Ref<MeshTopology> MeshTopology::load(Ref<Device> device, const void* bytes, size_t size) {
    if (!bytes) invalidArgument("`bytes` is NULL");
    Header header;
    check(size >= sizeof header, "too short");
    std::memcpy(&header, bytes, sizeof header);
    check(std::memcmp(header.magic, magic, sizeof magic) == 0, "a wrong signature");
    check(header.version == version && header.report.structSize == sizeof(PelMeshReport), "another version");
    uint64_t total = 0;
    for (uint32_t words : header.words) total += words;
    check(size == sizeof header + total * sizeof(uint32_t), "a size other than their header says");
    std::vector<uint32_t> arrays[6];
    const char* at = static_cast<const char*>(bytes) + sizeof header;
    std::vector<uint32_t> all(total);
    if (total > 0) std::memcpy(all.data(), at, total * sizeof(uint32_t));
    check(checksumOf(all.data(), all.size()) == header.checksum, "a wrong checksum");
    auto next = all.begin();
    for (int a = 0; a < 6; ++a) {
        arrays[a].assign(next, next + header.words[a]);
        next += header.words[a];
    }
    const auto& [indices, slotOf, memberOffsets, members, slices, rings] = arrays;
    const PelMeshReport& r = header.report;
    const uint32_t slots = r.uniquePositions;
    check(slots <= r.vertices && r.vertices <= PEL_MESH_SLOT, "impossible counts");
    check(indices.size() == size_t(r.triangles) * 3 && below(indices, r.vertices), "wrong indices");
    if (slotOf.empty()) {
        check(slots == r.vertices && memberOffsets.empty() && members.empty(), "a wrong mapping");
    } else {
        check(slotOf.size() == r.vertices && below(slotOf, slots), "a wrong mapping");
        check(members.size() == r.vertices && below(members, r.vertices), "a wrong mapping");
        check(memberOffsets.size() == size_t(slots) + 1 && rising(memberOffsets, members.size()),
              "a wrong mapping");
        // Every slot has a member.
        check(std::adjacent_find(memberOffsets.begin(), memberOffsets.end()) == memberOffsets.end(),
              "a wrong mapping");
    }
    check(slices.size() == (size_t(slots) + PEL_MESH_LANES - 1) / PEL_MESH_LANES + 1 &&
              rings.size() % PEL_MESH_LANES == 0 && rising(slices, rings.size() / PEL_MESH_LANES),
          "wrong neighbour lists");
    for (uint32_t entry : rings) check((entry & PEL_MESH_SLOT) < slots, "wrong neighbours");

    Ref<MeshTopology> topology = make<MeshTopology>(device);
    topology->report_ = r;
    topology->indices_ = topology->upload(indices);
    topology->uploadLists(slotOf, memberOffsets, members, slices, rings);
    return topology;
}

}  // namespace pel
