// Triangles that disagree about the side they face: counted, and turned where that is asked for.
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

// Edges of two triangles that run along them the same way, by definition.
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
};

Oriented orient(const Mesh& mesh, const PelMeshTopologyDesc& desc, bool normals = false) {
    Oriented o{Triangles(mesh.indices.size()), {}};
    o.found = orientMesh(desc, o.indices.data(), normals ? mesh.normals.data() : nullptr);
    return o;
}

// A square of 2 * side * side triangles that face up.
Mesh square(uint32_t side) {
    Mesh mesh;
    for (uint32_t y = 0; y <= side; ++y)
        for (uint32_t x = 0; x <= side; ++x) {
            mesh.positions.insert(mesh.positions.end(), {float(x), float(y), 0});
            mesh.normals.insert(mesh.normals.end(), {0, 0, 1});
        }
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const uint32_t p = y * (side + 1) + x, q = p + side + 1;
            mesh.indices.insert(mesh.indices.end(), {p, p + 1, q + 1, p, q + 1, q});
        }
    return mesh;
}

// Root mean square over vertices of the error of H with normals made from the mesh, in parts of the true H's.
double errorOfMadeNormals(const Mesh& mesh, const std::vector<double>& truth) {
    const MeshTopology topology(device(), topologyDesc(mesh));
    const Buffer positions(device(), mesh.positions), out(device(), mesh.vertices() * sizeof(float));
    topology.curvature(meanParams(PEL_CURVATURE_QUADRIC), vertexView(positions, mesh.vertices()),
                       vertexView(out, mesh.vertices()));
    const std::vector<float> values = out.readAll<float>();
    double error = 0, all = 0;
    for (size_t v = 0; v < values.size(); ++v) {
        error += (values[v] - truth[v]) * (values[v] - truth[v]);
        all += truth[v] * truth[v];
    }
    return std::sqrt(error / all);
}

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
    mesh.indices.insert(mesh.indices.end(), {0, 1, 4});
    EXPECT_EQ(reported(mesh), 0u);
    // The analysis that is loaded again says the same.
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
        const Oriented o = orient(mesh, topologyDesc(mesh));
        EXPECT_EQ(differing(o.indices, sound.indices), 0u) << share;
        EXPECT_EQ(o.found.trianglesTurned, differing(mesh.indices, sound.indices));
        EXPECT_EQ(o.found.parts, 1u);
        EXPECT_EQ(o.found.partsTurned, 1u);
        EXPECT_EQ(o.found.partsByVolume, 1u);
        EXPECT_EQ(o.found.partsByNormals + o.found.partsByMajority + o.found.inconsistentEdges, 0u);
        // Far from the origin, and without positions: only the majority of the triangles decides.
        for (size_t i = 0; i < mesh.positions.size(); i += 3) mesh.positions[i] += 500;
        EXPECT_EQ(differing(orient(mesh, topologyDesc(mesh)).indices, sound.indices), 0u) << share;
        PelMeshTopologyDesc desc = topologyDesc(mesh);
        desc.positions = nullptr;
        const Oriented blind = orient(mesh, desc);
        EXPECT_EQ(blind.found.partsByMajority, 1u);
        const size_t wrong = differing(blind.indices, sound.indices);
        EXPECT_TRUE(share == 0.5 || wrong == (share < 0.5 ? 0 : sound.indices.size() / 3)) << wrong;
        EXPECT_EQ(inconsistent(blind.indices), 0u);
    }
}

TEST(MeshOrient, NormalsTellTheSideOfOpenParts) {
    const Mesh sound = square(30);
    Mesh mesh = sound;
    mesh.indices = flipped(sound.indices, 0.8, 11);
    Oriented o = orient(mesh, topologyDesc(mesh), true);
    EXPECT_EQ(differing(o.indices, sound.indices), 0u);
    EXPECT_EQ(o.found.partsByNormals, 1u);
    o = orient(mesh, topologyDesc(mesh));
    EXPECT_EQ(differing(o.indices, sound.indices), sound.indices.size() / 3) << "most of them face down";
    EXPECT_EQ(o.found.partsByMajority, 1u);
    // A given stride, and normals that look the other way on a closed part: these come first.
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
    // Normals that tell nothing, or are not finite, leave it to the volume.
    for (float bad : {0.0f, std::nanf("")}) {
        found = orientMesh(topologyDesc(mesh), indices.data(),
                           std::vector<float>(mesh.normals.size(), bad).data());
        EXPECT_EQ(found.partsByVolume, 1u);
        EXPECT_EQ(differing(indices, torus(40, 30).indices), 0u);
    }
}

TEST(MeshOrient, PartsAreJudgedByThemselves) {
    // One that is sound and looks inwards, one that is not, a flat one, two triangles that face one
    // another, and a degenerate one.
    Mesh mesh = torus(20, 12);
    for (size_t t = 0; t < mesh.indices.size(); t += 3) std::swap(mesh.indices[t], mesh.indices[t + 1]);
    const auto add = [&](const Mesh& other, float dx) {
        const uint32_t first = mesh.vertices();
        for (size_t i = 0; i < other.positions.size(); ++i)
            mesh.positions.push_back(other.positions[i] + (i % 3 ? 0 : dx));
        for (uint32_t i : other.indices) mesh.indices.push_back(first + i);
    };
    Mesh second = torus(20, 12);
    add(second, 10);
    add(square(3), 20);
    const Triangles sound = mesh.indices;
    const size_t inner = torus(20, 12).indices.size();
    std::swap(mesh.indices[inner + 30], mesh.indices[inner + 31]);
    mesh.indices.insert(mesh.indices.end(), {3, 3, 5});
    const Oriented o = orient(mesh, topologyDesc(mesh));
    EXPECT_EQ(differing(Triangles(o.indices.begin(), o.indices.end() - 3), sound), 0u);
    EXPECT_EQ(Triangles(o.indices.end() - 3, o.indices.end()), (Triangles{3, 3, 5}));
    EXPECT_EQ(o.found.parts, 4u) << "the degenerate triangle hangs together with nothing";
    EXPECT_EQ(o.found.partsTurned, 1u);
    EXPECT_EQ(o.found.trianglesTurned, 1u);
}

TEST(MeshOrient, SeamsAreCrossedByWelding) {
    // Every triangle with vertices of its own, as STL files have them.
    const Mesh whole = torus(24, 16);
    Mesh soup;
    const Triangles flips = flipped(whole.indices, 0.5, 3);
    for (uint32_t i : flips) {
        for (int k = 0; k < 3; ++k) soup.positions.push_back(whole.positions[3 * i + k]);
        soup.indices.push_back(uint32_t(soup.indices.size()));
    }
    EXPECT_EQ(orient(soup, topologyDesc(soup)).found.parts, soup.indices.size() / 3);
    for (const PelMeshTopologyDesc& desc : {weldedDesc(soup), weldedDesc(soup, 1e-4f)}) {
        const Oriented o = orient(soup, desc);
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
            mesh.indices.insert(mesh.indices.end(), {a, c, b, b, c, d});
        }
        return mesh;
    };
    for (bool twisted : {false, true}) {
        Mesh mesh = strip(30, twisted);
        mesh.indices = flipped(mesh.indices, 0.4, 2);
        const Oriented o = orient(mesh, topologyDesc(mesh));
        EXPECT_EQ(o.found.inconsistentEdges, twisted ? 1u : 0u);
        EXPECT_EQ(inconsistent(o.indices), o.found.inconsistentEdges);
    }
}

TEST(MeshOrient, MadeNormalsAreGoodAgain) {
    Mesh mesh = torus(sized(80, 48), sized(60, 32));
    std::vector<double> truth;
    for (size_t v = 0; v < mesh.vertices(); ++v) {
        const double s = std::hypot(mesh.positions[3 * v], mesh.positions[3 * v + 1]);
        truth.push_back(0.5 * (1 + (s - 3) / s));
    }
    const double before = errorOfMadeNormals(mesh, truth);
    mesh.indices = flipped(mesh.indices, 0.5, 1);
    const double uncorrected = errorOfMadeNormals(mesh, truth);
    mesh.indices = orient(mesh, topologyDesc(mesh)).indices;
    const double after = errorOfMadeNormals(mesh, truth);
    RecordProperty("uncorrected", std::to_string(uncorrected));
    RecordProperty("after", std::to_string(after));
    EXPECT_GT(uncorrected, 0.5);
    EXPECT_LE(after, before * 1.001);
}

TEST(MeshOrient, SaysWhatIsWrong) {
    Mesh mesh = torus(6, 6);
    Triangles out(mesh.indices.size());
    PelMeshTopologyDesc desc = topologyDesc(mesh);
    const auto message = [&](const float* normals, uint32_t stride, uint32_t* indices) {
        EXPECT_EQ(pelMeshOrient(&desc, normals, stride, indices, nullptr), PEL_ERROR_INVALID_ARGUMENT);
        return std::string(pelGetErrorMessage());
    };
    EXPECT_NE(message(nullptr, 0, nullptr).find("indices"), std::string::npos);
    EXPECT_NE(message(mesh.normals.data(), 10, out.data()).find("normalStride is 10"), std::string::npos);
    EXPECT_NE(message(mesh.normals.data(), 8, out.data()).find("normalStride is 8"), std::string::npos);
    desc.positionStride = 7;
    EXPECT_NE(message(nullptr, 0, out.data()).find("positionStride is 7"), std::string::npos);
    desc = topologyDesc(mesh);
    desc.positions = nullptr;
    EXPECT_NE(message(mesh.normals.data(), 0, out.data()).find("together with"), std::string::npos);
    desc = topologyDesc(mesh);
    mesh.indices[4] = 99;
    EXPECT_NE(message(nullptr, 0, out.data()).find("triangle 1"), std::string::npos);
    desc.numIndices = 0;
    EXPECT_EQ(pelMeshOrient(&desc, nullptr, 0, nullptr, nullptr), PEL_SUCCESS);
    // In place.
    mesh = torus(24, 16);
    mesh.indices = flipped(mesh.indices, 0.4, 9);
    EXPECT_GT(orientMesh(topologyDesc(mesh), mesh.indices.data()).trianglesTurned, 0u);
    EXPECT_EQ(differing(mesh.indices, torus(24, 16).indices), 0u);
}
