// host/io/mesh/mesh_file.h: what is loaded, what is refused and with which message. PLY:
// test_mesh_file_ply.cpp.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "mesh_files.h"

using namespace pellucid::io;

namespace {

std::string binaryStl(const std::vector<float>& facets) {
    std::string out(80, ' ');
    const auto count = static_cast<uint32_t>(facets.size() / 9);
    out.append(reinterpret_cast<const char*>(&count), 4);
    for (uint32_t f = 0; f < count; ++f) {
        out.append(12, '\0');
        out.append(reinterpret_cast<const char*>(&facets[9 * f]), 36);
        out.append(2, '\0');
    }
    return out;
}

std::vector<float> facetsOfTetrahedron() {
    std::vector<float> facets;
    for (uint32_t v : tetrahedron) facets.insert(facets.end(), &corners[3 * v], &corners[3 * v] + 3);
    return facets;
}

}  // namespace

TEST_F(MeshFile, OffKeepsVerticesAndFacesInOrder) {
    const MeshData mesh = loadMesh(write("a.off", offTetrahedron));
    EXPECT_EQ(mesh.positions, corners);
    EXPECT_EQ(mesh.triangles, tetrahedron);
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_TRUE(mesh.warnings.empty());
}

TEST_F(MeshFile, OffWithCommentsColoursAndQuads) {
    const MeshData mesh = loadMesh(write("b.off",
                                         "# made by hand\nOFF 5 2 0 # counts\n0 0 0 # first\n\n1 0 0\n1 1 "
                                         "0\n0 1 0\n2 2 2\n4 0 1 2 3 255 0 0\n3 0 1 4 9\n"));
    EXPECT_EQ(mesh.vertexCount(), 5u);
    EXPECT_EQ(mesh.triangles, (std::vector<uint32_t>{0, 1, 2, 0, 2, 3, 0, 1, 4}));
}

TEST_F(MeshFile, OffWithNormals) {
    const MeshData mesh =
        loadMesh(write("n.off", "NOFF\n3 1 0\n0 0 0 0 0 2\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n"));
    EXPECT_EQ(mesh.normals, (std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}));  // and of unit length
}

TEST_F(MeshFile, ObjWithNegativeIndicesAndSeams) {
    const std::string text =
        "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0.5 0.5\nusemtl x\n"
        "f 1/1 2/2 3/3\nf -4/-1 -2/-2 -1/1\n";
    const std::string file = write("s.obj", text);
    const MeshData whole = loadMesh(file);
    EXPECT_EQ(whole.triangles, (std::vector<uint32_t>{0, 1, 2, 0, 2, 3}));
    EXPECT_TRUE(whole.uvs.empty());
    ASSERT_EQ(whole.warnings.size(), 1u);

    const MeshData split = loadMesh(file, {.splitUvSeams = true});
    EXPECT_EQ(split.splitFrom, (std::vector<uint32_t>{0}));
    EXPECT_EQ(split.triangles, (std::vector<uint32_t>{0, 1, 2, 4, 2, 3}));
    EXPECT_EQ(split.vertexCount(), 5u);
    EXPECT_EQ((std::vector<float>(split.uvs.begin() + 8, split.uvs.end())), (std::vector<float>{0.5f, 0.5f}));
}

TEST_F(MeshFile, StlBothWays) {
    const MeshData binary = loadMesh(write("b.stl", binaryStl(facetsOfTetrahedron())));
    EXPECT_EQ(binary.vertexCount(), 4u);
    EXPECT_EQ(binary.triangleCount(), 4u);
    std::ostringstream text;
    text << "solid t\n";
    const std::vector<float> facets = facetsOfTetrahedron();
    for (size_t f = 0; f < 4; ++f) {
        text << "facet normal 0 0 0\nouter loop\n";
        for (size_t c = 0; c < 3; ++c) {
            const float* p = &facets[9 * f + 3 * c];
            text << "vertex " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
        }
        text << "endloop\nendfacet\n";
    }
    text << "endsolid t\n";
    const MeshData ascii = loadMesh(write("a.stl", text.str()));
    EXPECT_EQ(ascii.positions, binary.positions);
    EXPECT_EQ(ascii.triangles, binary.triangles);
}

TEST_F(MeshFile, NonManifoldOffSurvivesButIsNotSubdivided) {
    MeshData mesh = loadMesh(
        write("n.off", "OFF\n5 3 0\n0 0 0\n1 0 0\n0 1 0\n0 -1 0\n0 0 1\n3 0 1 2\n3 1 0 3\n3 0 1 4\n"));
    EXPECT_EQ(mesh.triangleCount(), 3u);
    const std::string message = messageOf<FileError>([&] { loopSubdivide(mesh, 1); });
    EXPECT_TRUE(contains(message, "triangle 2"));
    EXPECT_EQ(mesh.triangleCount(), 3u);
}

TEST_F(MeshFile, DegenerateFacesAreLeftInOrNamed) {
    const MeshData off = loadMesh(write("d.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 1\n3 0 1 2\n"));
    EXPECT_EQ(off.triangleCount(), 2u);  // the library counts and skips it
    for (const char* twice : {"1 2 2", "1 2 1", "1 1 2", "1 2 3 1", "1 2 3 2", "3 2 1 2"}) {
        const MeshData left =
            loadMesh(write("d.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf " + std::string(twice) + "\nf 1 2 3\n"));
        EXPECT_EQ(left.triangles.size(), 3u) << twice;
    }
    const MeshData obj = loadMesh(write("d.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\nf 1 2 3\n"));
    EXPECT_EQ(obj.triangleCount(), 1u);
    ASSERT_EQ(obj.warnings.size(), 1u);
    EXPECT_TRUE(contains(obj.warnings[0], "1 face"));
}

TEST_F(MeshFile, BadFilesSayWhere) {
    EXPECT_TRUE(contains(messageOf<FileError>([&] { loadMesh(path("none.off")); }), "No such file"));
    EXPECT_TRUE(contains(messageOf<FileError>([&] { loadMesh(folder_.string()); }), "folder"));
    EXPECT_TRUE(contains(loadError("a.gltf", "x"), ".off, .obj, .ply, .stl"));
    EXPECT_TRUE(contains(loadError("e.off", ""), "empty"));
    EXPECT_TRUE(contains(loadError("h.off", "FOO\n1 1 1\n"), "h.off:1: starts with 'FOO'"));
    EXPECT_TRUE(contains(loadError("nan.off", "OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"),
                         "nan.off:4: coordinate y is 'nan'"));
    EXPECT_TRUE(contains(loadError("w.off", "OFF\n3 1 0\n0 0 0\n1 zwei 0\n0 1 0\n3 0 1 2\n"),
                         "w.off:4: coordinate y 'zwei'"));
    EXPECT_TRUE(contains(loadError("i.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
                         "i.off:6: vertex index 3 is out of range"));
    EXPECT_TRUE(contains(loadError("t.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
                         "2 faces announced, 1 found"));
    EXPECT_TRUE(contains(loadError("z.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"), "no face"));
    EXPECT_TRUE(
        contains(loadError("big.off", "OFF\n3 4000000000 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "announced"));
    EXPECT_TRUE(contains(loadError("n.obj", "v 0 0 0\nv inf 0 0\nv 0 1 0\nf 1 2 3\n"),
                         "n.obj:2: coordinate x is 'inf'"));
    EXPECT_TRUE(
        contains(loadError("i.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n"), "i.obj:5: vertex index 4"));
    EXPECT_TRUE(
        contains(loadError("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n"), "m.obj:4: vertex index -4"));
    EXPECT_TRUE(
        contains(loadError("s.stl", binaryStl(facetsOfTetrahedron()).substr(0, 150)), "is not an STL file"));
    std::vector<float> facets = facetsOfTetrahedron();
    facets[13] = NAN;
    EXPECT_TRUE(contains(loadError("nan.stl", binaryStl(facets)), "facet 1"));
}

TEST_F(MeshFile, NormalsPointOutwardsAlsoAcrossSeams) {
    MeshData mesh = loadMesh(write("a.off", offTetrahedron));
    computeNormals(mesh);
    for (size_t i = 0; i < corners.size(); ++i) {
        EXPECT_FLOAT_EQ(mesh.normals[i], corners[i] / std::sqrt(3.0f));
    }
    MeshData soup;  // every face with corners of its own
    for (uint32_t v : tetrahedron) {
        soup.positions.insert(soup.positions.end(), &corners[3 * v], &corners[3 * v] + 3);
        soup.triangles.push_back(static_cast<uint32_t>(soup.triangles.size()));
    }
    computeNormals(soup);
    for (size_t i = 0; i < 3 * tetrahedron.size(); ++i) {
        EXPECT_EQ(soup.normals[i], mesh.normals[3 * tetrahedron[i / 3] + i % 3]);
    }
}

TEST_F(MeshFile, LoopKeepsIndicesAndClosedness) {
    MeshData mesh = loadMesh(write("a.off", offTetrahedron));
    mesh.uvs = {0, 0, 1, 0, 0, 1, 1, 1};
    loopSubdivide(mesh, 2);
    EXPECT_EQ(mesh.triangleCount(), 4u * 16u);
    EXPECT_EQ(mesh.vertexCount(), 34u);  // V - E + F = 2 with E = 1.5 F
    ASSERT_EQ(mesh.uvs.size(), 2 * mesh.vertexCount());
    EXPECT_EQ(mesh.uvs[2], 1.0f);
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    for (size_t t = 0; t < mesh.triangles.size(); t += 3) {
        for (size_t c = 0; c < 3; ++c) ++edges[{mesh.triangles[t + c], mesh.triangles[t + (c + 1) % 3]}];
    }
    for (const auto& [edge, count] : edges) {
        EXPECT_EQ(count, 1);
        EXPECT_TRUE(edges.count({edge.second, edge.first}));
    }
    // Loop's rule for 3 neighbours: alpha = (40 - (3 + 2 cos 120 degrees)^2) / 64 = 9/16 of their mean, which
    // is -1/3 of the corner; the corners' first level is therefore 1/4 of the corner.
    MeshData once = loadMesh(path("a.off"));
    loopSubdivide(once, 1);
    EXPECT_FLOAT_EQ(once.positions[0], 0.25f);
    // The UV of a new vertex is half-way along its edge: match it by the neighbours' mean of corners 0 and 1,
    // (0.5, 0).
    MeshData flat = loadMesh(path("a.off"));
    flat.uvs = {0, 0, 1, 0, 0, 1, 1, 1};
    loopSubdivide(flat, 1);
    std::multiset<std::pair<float, float>> found;
    for (size_t v = 4; v < 10; ++v) found.insert({flat.uvs[2 * v], flat.uvs[2 * v + 1]});
    EXPECT_EQ(found, (std::multiset<std::pair<float, float>>{
                         {0, .5f}, {.5f, 0}, {.5f, .5f}, {.5f, .5f}, {.5f, 1}, {1, .5f}}));
}

TEST_F(MeshFile, LoopTakesManyNeighbours) {
    std::ostringstream fan;  // a cone of 120 triangles: more neighbours than OpenMesh's table of weights has
    const int n = 120;
    fan << "OFF\n" << n + 1 << ' ' << n << " 0\n0 0 1\n";
    for (int i = 0; i < n; ++i)
        fan << std::cos(i * 2 * M_PI / n) << ' ' << std::sin(i * 2 * M_PI / n) << " 0\n";
    for (int i = 0; i < n; ++i) fan << "3 0 " << 1 + i << ' ' << 1 + (i + 1) % n << '\n';
    MeshData mesh = loadMesh(write("fan.off", fan.str()));
    loopSubdivide(mesh, 1);
    // Loop's weight of the neighbours
    const double beta = (40 - std::pow(3 + 2 * std::cos(2 * M_PI / n), 2)) / 64;
    EXPECT_FLOAT_EQ(mesh.positions[2], static_cast<float>(1 - beta));
}

TEST_F(MeshFile, ScaleToHeight) {
    MeshData mesh = loadMesh(write("a.off", offTetrahedron));
    EXPECT_EQ(scaleToHeight(mesh, 240, 1), 120.0f);
    EXPECT_EQ(mesh.positions[1], 120.0f);
}
