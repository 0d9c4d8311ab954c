// Mesh files with random damage: each is either a mesh whose numbers can be used, or a FileError. Nothing
// crashes or hangs.
#include <cmath>
#include <random>

#include "io/file_error.h"
#include "io/mesh/mesh_file.h"
#include "io_files.h"

using namespace pellucid::io;

namespace {

class DamagedMesh : public FolderTest {
  protected:
    static std::string damaged(std::string text, std::mt19937& random) {
        const std::string junk = "-9 1e39 nan 4294967295 /\n# end_header 99999999999";
        for (unsigned edits = 1 + random() % 4; edits > 0 && !text.empty(); --edits) {
            const size_t at = random() % text.size();
            switch (random() % 5) {
                case 0:
                    text[at] = static_cast<char>(random());
                    break;
                case 1:
                    text.erase(at, 1 + random() % 8);
                    break;
                case 2:
                    text.insert(at, junk.substr(random() % junk.size(), 1 + random() % 12));
                    break;
                case 3:
                    text.resize(at);
                    break;
                default:
                    text[at] = "0123456789 .-/\n"[random() % 15];
                    break;
            }
        }
        return text;
    }

    void check(const std::string& name, const std::string& text) {
        std::mt19937 random(20);
        ASSERT_GT(loadMesh(write(name, text)).triangleCount(), 0u);
        int loaded = 0, refused = 0;
        for (int i = 0; i < 400; ++i) {
            const std::string file = write(name, damaged(text, random));
            try {
                MeshData mesh = loadMesh(file, {.splitUvSeams = i % 2 == 0});
                ++loaded;
                for (float p : mesh.positions) ASSERT_TRUE(std::isfinite(p)) << i;
                for (uint32_t v : mesh.triangles) ASSERT_LT(v, mesh.vertexCount()) << i;
                ASSERT_TRUE(mesh.uvs.empty() || mesh.uvs.size() == 2 * mesh.vertexCount()) << i;
                computeNormals(mesh);
                for (float n : mesh.normals) ASSERT_TRUE(std::isfinite(n)) << i;
                loopSubdivide(mesh, 1);
            } catch (const FileError&) {
                ++refused;
            }
        }
        EXPECT_GT(loaded, 0);
        EXPECT_GT(refused, 0);
    }
};

}  // namespace

TEST_F(DamagedMesh, Off) {
    check("a.off",
          "NOFF\n4 4 6\n1 1 1 0 0 1\n-1 -1 1 0 0 1\n-1 1 -1 0 0 1\n1 -1 -1 0 0 1\n3 0 2 1\n3 0 1 3 1 2 3\n3 "
          "0 3 2\n3 1 2 3\n");
}

TEST_F(DamagedMesh, Obj) {
    check("a.obj",
          "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt .5 .5\nvn 0 0 1\n"
          "f 1/1/1 2/2/1 3/3/1\nf -4/-1 -2/-2 -1/1\nf 1//1 2//1 4//1\n");
}

TEST_F(DamagedMesh, PlyText) {
    check("a.ply",
          "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
          "z\nproperty float q\n"
          "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
          "0 0 0 1\n1 0 0 1\n0 1 0 2\n0 0 1 3\n3 0 1 2\n4 0 1 2 3\n");
}

TEST_F(DamagedMesh, PlyBinary) {
    MeshData mesh;
    mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    mesh.triangles = {0, 1, 2, 0, 2, 3, 0, 3, 1};
    computeNormals(mesh);
    writePly(path("seed.ply"), mesh, std::vector<float>{1, 2, 3, 4}, 0, 4);
    check("a.ply", read(path("seed.ply")));
}

TEST_F(DamagedMesh, Stl) {
    check("a.stl",
          "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
          "0\nendloop\nendfacet\n"
          "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 0 0 "
          "1\nendloop\nendfacet\nendsolid t\n");
}
