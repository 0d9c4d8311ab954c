// Meshes with nothing wrong, of more vertices than faces and the other way round, load without a warning from
// every format.
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
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(faceCount) +
           "\nproperty list uchar int vertex_indices\nend_header\n" + vertices + faces;
}

const std::string three = "0 0 0\n1 0 0\n0 1 0\n", four = three + "0 0 1\n";

}  // namespace

TEST_F(MeshWarnings, OneTriangle) {
    expectSilent("a.off", "OFF\n3 1 0\n" + three + "3 0 1 2\n", 1);
    expectSilent("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 1);
    expectSilent("a.ply", ply(three, 3, "3 0 1 2\n", 1), 1);
    expectSilent(
        "a.stl",
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
        "endfacet\nendsolid a\n",
        1);
}

TEST_F(MeshWarnings, AsManyFacesAsVertices) {
    const std::string faces = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    expectSilent("b.off", "OFF\n4 4 0\n" + four + faces, 4);
    expectSilent("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", 4);
    expectSilent("b.ply", ply(four, 4, faces, 4), 4);
}

TEST_F(MeshWarnings, PolygonsCountOnce) {
    const std::string square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    expectSilent("c.off", "OFF\n4 1 0\n" + square + "4 0 1 2 3\n", 2);
    expectSilent("c.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n", 2);
    expectSilent("c.ply", ply(square, 4, "4 0 1 2 3\n", 1), 2);
}
