// Triangles with inconsistent orientation: counted, and flipped on request.
#include "mesh_fixture.h"

using namespace fixture;
using namespace pellucid;

namespace {

using Triangles = std::vector<uint32_t>;

Triangles flipped(Triangles indices, double share, uint32_t seed) {
    std::mt19937 random(seed);
    for (size_t t = 0; t < indices.size(); t += 3)
        if (random() < share * 4294967296.0) std::swap(indices[t + 1], indices[t + 2]);
    return indices;
}

// The same triangle, whichever corner comes first.
bool sameOrder(const uint32_t* a, const uint32_t* b) {
    return (a[0] == b[0] && a[1] == b[1]) || (a[0] == b[1] && a[1] == b[2]) || (a[0] == b[2] && a[1] == b[0]);
}

size_t differing(const Triangles& a, const Triangles& b) {
    size_t count = 0;
    for (size_t t = 0; t < a.size(); t += 3) count += !sameOrder(&a[t], &b[t]);
    return count;
}

// Counts the edges that two triangles traverse in the same direction, by definition.
uint32_t inconsistent(const Triangles& indices) {
    std::map<std::pair<uint32_t, uint32_t>, std::vector<bool>> edges;
    for (size_t i = 0; i < indices.size(); ++i) {
        const uint32_t a = indices[i], b = indices[i % 3 == 2 ? i - 2 : i + 1];
        edges[std::minmax(a, b)].push_back(a < b);
    }
    uint32_t count = 0;
    for (const auto& [edge, ways] : edges) count += ways.size() == 2 && ways[0] == ways[1];
    return count;
}

uint32_t reported(const Mesh& mesh) {
    PelMeshReport report = pelMeshReportDefaults();
    const MeshTopology topology(device(), topologyDesc(mesh), &report);
    return report.inconsistentEdges;
}

struct Oriented {
    Triangles indices;
    PelMeshOrientation found;
    explicit Oriented(const Mesh& mesh, bool normals = false) : Oriented(mesh, topologyDesc(mesh), normals) {}
    Oriented(const Mesh& mesh, const PelMeshTopologyDesc& desc, bool normals = false)
        : indices(mesh.indices.size()),
          found(orientMesh(desc, indices.data(), normals ? mesh.normals.data() : nullptr)) {}
};

}  // namespace

TEST(MeshOrient, CountsEdgesWhoseTrianglesDisagree) {
    Mesh mesh = torus(24, 16);
    EXPECT_EQ(reported(mesh), 0u);
    for (double share : {0.02, 0.3, 0.5, 0.9, 1.0}) {
        mesh.indices = flipped(torus(24, 16).indices, share, 5);
        EXPECT_EQ(reported(mesh), inconsistent(mesh.indices)) << share;
        EXPECT_EQ(reported(mesh) > 0, share < 1) << share;
    }
    // Where three triangles share an edge no two of them are compared; a triangle alone at an edge has none
    // to compare with.
    mesh = {};
    mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1};
    mesh.indices = {0, 1, 2, 0, 1, 3};
    EXPECT_EQ(reported(mesh), 1u);
    mesh.triangles({0, 1, 4});
    EXPECT_EQ(reported(mesh), 0u);
    // The loaded analysis has the same count.
    mesh.indices = {0, 1, 2, 0, 1, 3};
    PelMeshReport report = pelMeshReportDefaults();
    const std::vector<char> bytes = MeshTopology(device(), topologyDesc(mesh)).save();
    MeshTopology::load(device(), bytes.data(), bytes.size(), &report);
    EXPECT_EQ(report.inconsistentEdges, 1u);
}

TEST(MeshOrient, OutsideOfAClosedPartIsFound) {
    const Mesh sound = torus(40, 30);
    for (double share : {0.1, 0.5, 0.9}) {
        Mesh mesh = sound;
        mesh.indices = flipped(sound.indices, share, 7);
        const Oriented o(mesh);
        EXPECT_EQ(differing(o.indices, sound.indices), 0u) << share;
        EXPECT_EQ(o.found.trianglesTurned, differing(mesh.indices, sound.indices));
        EXPECT_EQ(o.found.parts, 1u);
        EXPECT_EQ(o.found.partsTurned, 1u);
        EXPECT_EQ(o.found.partsByVolume, 1u);
        EXPECT_EQ(o.found.partsByNormals + o.found.partsByMajority + o.found.inconsistentEdges, 0u);
        // Far from the origin, and without positions: only the majority of the triangles decides.
        for (size_t i = 0; i < mesh.positions.size(); i += 3) mesh.positions[i] += 500;
        EXPECT_EQ(differing(Oriented(mesh).indices, sound.indices), 0u) << share;
        PelMeshTopologyDesc desc = topologyDesc(mesh);
        desc.positions = nullptr;
        const Oriented blind(mesh, desc);
        EXPECT_EQ(blind.found.partsByMajority, 1u);
        const size_t wrong = differing(blind.indices, sound.indices);
        EXPECT_TRUE(share == 0.5 || wrong == (share < 0.5 ? 0 : sound.indices.size() / 3)) << wrong;
        EXPECT_EQ(inconsistent(blind.indices), 0u);
    }
}

TEST(MeshOrient, NormalsTellTheSideOfOpenParts) {
    const Mesh sound = grid(30, 30);
    Mesh mesh = sound;
    mesh.indices = flipped(sound.indices, 0.8, 11);
    Oriented o(mesh, true);
    EXPECT_EQ(differing(o.indices, sound.indices), 0u);
    EXPECT_EQ(o.found.partsByNormals, 1u);
    o = Oriented(mesh);
    EXPECT_EQ(differing(o.indices, sound.indices), sound.indices.size() / 3) << "most of them face down";
    EXPECT_EQ(o.found.partsByMajority, 1u);
    // A given stride, and normals that point the other way on a closed part: normals take precedence.
    mesh = torus(40, 30);
    mesh.indices = flipped(mesh.indices, 0.3, 12);
    std::vector<float> wide;
    for (uint32_t v = 0; v < mesh.vertices(); ++v) {
        for (int k = 0; k < 3; ++k) wide.push_back(-mesh.normals[3 * v + k]);
        wide.insert(wide.end(), {0.0f, 99.0f});
    }
    Triangles indices(mesh.indices.size());
    PelMeshOrientation found = orientMesh(topologyDesc(mesh), indices.data(), wide.data(), 20);
    EXPECT_EQ(found.partsByNormals, 1u);
    EXPECT_EQ(differing(indices, torus(40, 30).indices), indices.size() / 3);
    // If normals are zero or not finite, the volume decides.
    for (float bad : {0.0f, std::nanf("")}) {
        found = orientMesh(topologyDesc(mesh), indices.data(),
                           std::vector<float>(mesh.normals.size(), bad).data());
        EXPECT_EQ(found.partsByVolume, 1u);
        EXPECT_EQ(differing(indices, torus(40, 30).indices), 0u);
    }
}

TEST(MeshOrient, PartsAreJudgedByThemselves) {
    // A consistent part that faces inwards, an inconsistent one, a flat one, two triangles that face one
    // another, and a degenerate one.
    Mesh mesh = torus(20, 12);
    for (size_t t = 0; t < mesh.indices.size(); t += 3) std::swap(mesh.indices[t], mesh.indices[t + 1]);
    mesh.append(torus(20, 12), 10);
    mesh.append(grid(3, 3), 20);
    const Triangles sound = mesh.indices;
    const size_t inner = torus(20, 12).indices.size();
    std::swap(mesh.indices[inner + 30], mesh.indices[inner + 31]);
    mesh.triangles({3, 3, 5});
    const Oriented o(mesh);
    EXPECT_EQ(differing(Triangles(o.indices.begin(), o.indices.end() - 3), sound), 0u);
    EXPECT_EQ(Triangles(o.indices.end() - 3, o.indices.end()), (Triangles{3, 3, 5}));
    EXPECT_EQ(o.found.parts, 4u) << "the degenerate triangle hangs together with nothing";
    EXPECT_EQ(o.found.partsTurned, 1u);
    EXPECT_EQ(o.found.trianglesTurned, 1u);
}

TEST(MeshOrient, SeamsAreCrossedByWelding) {
    const Mesh whole = torus(24, 16);
    Mesh mixed = whole;
    const Triangles flips = mixed.indices = flipped(whole.indices, 0.5, 3);
    const Mesh soup = soupOf(mixed);
    EXPECT_EQ(Oriented(soup).found.parts, soup.indices.size() / 3);
    for (const PelMeshTopologyDesc& desc : {weldedDesc(soup), weldedDesc(soup, 1e-4f)}) {
        const Oriented o(soup, desc);
        EXPECT_EQ(o.found.parts, 1u);
        Triangles back;
        for (uint32_t i : o.indices) back.push_back(flips[i]);
        EXPECT_EQ(differing(back, whole.indices), 0u);
    }
}

TEST(MeshOrient, WhatHasOneSideOnlyKeepsAnEdgeThatDisagrees) {
    // A strip closed to a ring after half a turn.
    const auto strip = [](uint32_t length, bool twisted) {
        Mesh mesh;
        mesh.positions.resize(6 * length);
        for (uint32_t i = 0; i < length; ++i) {
            const uint32_t a = 2 * i, b = a + 1, last = i + 1 == length;
            const uint32_t c = last ? (twisted ? 1 : 0) : a + 2, d = last ? (twisted ? 0 : 1) : a + 3;
            mesh.triangles({a, c, b, b, c, d});
        }
        return mesh;
    };
    for (bool twisted : {false, true}) {
        Mesh mesh = strip(30, twisted);
        mesh.indices = flipped(mesh.indices, 0.4, 2);
        const Oriented o(mesh);
        EXPECT_EQ(o.found.inconsistentEdges, twisted ? 1u : 0u);
        EXPECT_EQ(inconsistent(o.indices), o.found.inconsistentEdges);
    }
}

TEST(MeshOrient, SaysWhatIsWrong) {
    Mesh mesh = torus(6, 6);
    Triangles out(mesh.indices.size());
    PelMeshTopologyDesc desc = topologyDesc(mesh);
    const auto refused = [&](const char* word, const float* normals, uint32_t stride, uint32_t* indices) {
        PelMeshOrientation found = pelMeshOrientationDefaults();
        found.parts = 7;
        expectRefused(word, [&] { return pelMeshOrient(&desc, normals, stride, indices, &found); });
        EXPECT_EQ(found.parts, 7u);
    };
    refused("indices", nullptr, 0, nullptr);
    refused("normalStride is 10", mesh.normals.data(), 10, out.data());
    refused("normalStride is 8", mesh.normals.data(), 8, out.data());
    desc.positionStride = 7;
    refused("positionStride is 7", nullptr, 0, out.data());
    desc = topologyDesc(mesh);
    desc.positions = nullptr;
    refused("only with", mesh.normals.data(), 0, out.data());
    desc = topologyDesc(mesh);
    mesh.indices[4] = 99;
    refused("triangle 1", nullptr, 0, out.data());
    desc.numIndices = 0;
    EXPECT_EQ(pelMeshOrient(&desc, nullptr, 0, nullptr, nullptr), PEL_SUCCESS);
    // In place.
    mesh = torus(24, 16);
    mesh.indices = flipped(mesh.indices, 0.4, 9);
    EXPECT_GT(orientMesh(topologyDesc(mesh), mesh.indices.data()).trianglesTurned, 0u);
    EXPECT_EQ(differing(mesh.indices, torus(24, 16).indices), 0u);
}
