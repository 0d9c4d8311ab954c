// Meshes with nothing wrong, of more vertices than faces and the other way round, load without a warning from
// every format.
#include <array>
#include <regex>

#include "io/mesh/mesh_file.h"
#include "io_files.h"

using namespace pellucid::io;

namespace {

class MeshWarnings : public FolderTest {
  protected:
    void expectSilent(const std::string& name, const std::string& text, size_t triangles) const {
        const MeshData mesh = loadMesh(write(name, text));
        EXPECT_EQ(mesh.triangleCount(), triangles) << name;
        EXPECT_TRUE(mesh.warnings.empty()) << name << ": " << (mesh.warnings.empty() ? "" : mesh.warnings[0]);
    }
};

std::string ply(const std::string& vertices, size_t count, const std::string& faces, size_t faceCount) {
    return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
           std::to_string(faceCount) + "\nproperty list uchar int vertex_indices\nend_header\n" + vertices +
           faces;
}

const std::string three = "0 0 0\n1 0 0\n0 1 0\n", four = three + "0 0 1\n";

}  // namespace

TEST_F(MeshWarnings, GoodFilesOfEveryFormatHaveNone) {
    const std::string square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    const struct {
        std::string vertices, faces, objFaces;
        size_t vertexCount, faceCount, triangles;
    } meshes[] = {
        {three, "3 0 1 2\n", "f 1 2 3\n", 3, 1, 1},
        {four, "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n", "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", 4, 4, 4},
        {square, "4 0 1 2 3\n", "f 1 2 3 4\n", 4, 1, 2}};
    for (const auto& m : meshes) {
        expectSilent("a.off",
                     "OFF\n" + std::to_string(m.vertexCount) + " " + std::to_string(m.faceCount) + " 0\n" +
                         m.vertices + m.faces,
                     m.triangles);
        const std::string obj = "v " + std::regex_replace(m.vertices, std::regex("\n(?=.)"), "\nv ");
        expectSilent("a.obj", obj + m.objFaces, m.triangles);
        expectSilent("a.ply", ply(m.vertices, m.vertexCount, m.faces, m.faceCount), m.triangles);
    }
    expectSilent(
        "a.stl",
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
        "endfacet\nendsolid a\n",
        1);
}

TEST_F(MeshWarnings, TrianglesThatFaceAnotherWayThanTheirNeighboursAreToldOrTurned) {
    // A tetrahedron, outwards; its second triangle turned round; and that in vertices of their own, as STL
    // has them.
    const auto off = [](const std::string& second) {
        return "OFF\n4 4 0\n" + four + "3 0 2 1\n3 " + second + "\n3 1 2 3\n3 0 3 2\n";
    };
    EXPECT_TRUE(loadMesh(write("whole.off", off("0 1 3"))).warnings.empty());
    const std::string turned = write("turned.off", off("0 3 1"));
    MeshData mesh = loadMesh(turned);
    ASSERT_EQ(mesh.warnings.size(), 1u);
    EXPECT_EQ(mesh.warnings[0].find("1 triangle faces another way"), 0u) << mesh.warnings[0];
    EXPECT_EQ((std::vector<uint32_t>(mesh.triangles.begin() + 3, mesh.triangles.begin() + 6)),
              (std::vector<uint32_t>{0, 3, 1}));
    MeshLoadOptions options;
    options.orient = true;
    mesh = loadMesh(turned, options);
    EXPECT_TRUE(mesh.warnings.empty());
    EXPECT_EQ(mesh.trianglesTurned, 1u);
    EXPECT_EQ((std::vector<uint32_t>(mesh.triangles.begin() + 3, mesh.triangles.begin() + 6)),
              (std::vector<uint32_t>{0, 1, 3}));
    computeNormals(mesh);
    // Of the corner at the origin: outwards
    EXPECT_LT(mesh.normals[0] + mesh.normals[1] + mesh.normals[2], -1);
    const auto facet = [](const char* a, const char* b, const char* c) {
        return std::string("facet normal 0 0 0\nouter loop\nvertex ") + a + "\nvertex " + b + "\nvertex " +
               c + "\nendloop\nendfacet\n";
    };
    const char *o = "0 0 0", *x = "1 0 0", *y = "0 1 0", *z = "0 0 1";
    const std::string soup =
        "solid a\n" + facet(o, y, x) + facet(o, z, x) + facet(x, y, z) + facet(o, z, y) + "endsolid a\n";
    EXPECT_EQ(loadMesh(write("soup.stl", soup)).warnings.size(), 1u);
    EXPECT_EQ(loadMesh(write("soup.stl", soup), options).trianglesTurned, 1u);
    // Normals of the file tell the side where two of three triangles are wrong.
    const std::string obj =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 2 0\nvn 0 0 1\nf 1//1 3//1 2//1\nf 1//1 3//1 4//1\nf 4//1 "
        "5//1 3//1\n";
    mesh = loadMesh(write("flat.obj", obj), options);
    EXPECT_EQ(mesh.trianglesTurned, 2u);
    // A Moebius strip of five squares keeps an edge whatever is done.
    std::string strip = "OFF\n10 10 0\n";
    for (int i = 0; i < 10; ++i)
        strip += std::to_string(i % 7) + " " + std::to_string(i % 3) + " " + std::to_string(i) + "\n";
    for (int i = 0; i < 5; ++i) {
        const int a = 2 * i, b = a + 1, c = i < 4 ? a + 2 : 1, d = i < 4 ? a + 3 : 0;
        for (auto t : {std::array{a, c, b}, std::array{b, c, d}})
            strip +=
                "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) + "\n";
    }
    mesh = loadMesh(write("strip.off", strip), options);
    ASSERT_EQ(mesh.warnings.size(), 1u);
    EXPECT_NE(mesh.warnings[0].find("one side only: at 1 edge "), std::string::npos) << mesh.warnings[0];
}
