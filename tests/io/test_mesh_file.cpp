// host/io/mesh/mesh_file.h: what is loaded, what is refused and with which message.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "io/file_error.h"
#include "io/mesh/mesh_file.h"
#include "io_files.h"

using namespace pellucid::io;

namespace {

// A regular tetrahedron, faces outwards.
const std::vector<float> corners = {1, 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1};
const std::vector<uint32_t> tetrahedron = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
const char* offTetrahedron =
    "OFF\n4 4 6\n1 1 1\n-1 -1 1\n-1 1 -1\n1 -1 -1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

class MeshFile : public FolderTest {
  protected:
    std::string loadError(const std::string& name, const std::string& text) const {
        const std::string file = write(name, text);
        return messageOf<FileError>([&] { loadMesh(file); });
    }
};

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

TEST_F(MeshFile, PlyWrittenIsPlyRead) {
    MeshData mesh = loadMesh(write("a.off", offTetrahedron));
    computeNormals(mesh);
    const std::vector<float> quality = {0, 1, 2, 3};
    writePly(path("o.ply"), mesh, quality, 0, 3);
    const MeshData again = loadMesh(path("o.ply"));
    EXPECT_EQ(again.positions, mesh.positions);
    EXPECT_EQ(again.triangles, mesh.triangles);
    ASSERT_EQ(again.normals.size(), mesh.normals.size());
    for (size_t i = 0; i < mesh.normals.size(); ++i) EXPECT_FLOAT_EQ(again.normals[i], mesh.normals[i]);
    const std::string file = read(path("o.ply"));
    EXPECT_TRUE(contains(file, "property float quality"));
    float last;  // of the fourth vertex: 6 floats, then quality, then three colours
    std::memcpy(&last, file.data() + file.find("end_header\n") + 11 + 3 * 31 + 24, 4);
    EXPECT_EQ(last, 3.0f);
}

TEST_F(MeshFile, AsciiPlyKeepsNonManifoldFaces) {
    const MeshData mesh = loadMesh(
        write("n.ply",
              "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float "
              "z\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n"
              "0 0 0\n1 0 0\n0 1 0\n0 -1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 0 1 4\n"));
    EXPECT_EQ(mesh.triangles, (std::vector<uint32_t>{0, 1, 2, 0, 1, 3, 0, 1, 4}));
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

TEST_F(MeshFile, BadPlyFilesSayWhere) {
    const std::string header =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    EXPECT_TRUE(
        contains(loadError("n.ply", header + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"), "n.ply:11: y is 'nan'"));
    EXPECT_TRUE(contains(loadError("t.ply", header + "0 0 0\n1 0 0\n"), "ends early"));
    EXPECT_TRUE(contains(loadError("i.ply", header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n"),
                         "face 0 (counted from 0) refers to vertex 7"));
    EXPECT_TRUE(contains(loadError("x.ply", "nonsense"), "x.ply:1: does not start with 'ply'"));
    const auto replaced = [&](std::string text, const std::string& from, const std::string& to) {
        return text.replace(text.find(from), from.size(), to);
    };
    const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    EXPECT_TRUE(contains(loadError("f.ply", replaced(header, "ascii 1.0", "ascii") + body),
                         "f.ply:2: 'format ENCODING 1.0'"));
    EXPECT_TRUE(contains(loadError("p.ply", replaced(header, "float z", "floot z") + body),
                         "p.ply:6: has the type 'floot'"));
    EXPECT_TRUE(
        contains(loadError("z.ply", replaced(header, "float z", "float w") + body), "vertices need 'z'"));
    EXPECT_TRUE(
        contains(loadError("e.ply", replaced(header, "end_header", "end") + body), "no line 'end_header'"));
    EXPECT_TRUE(
        contains(loadError("l.ply", header + "0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n"), "l.ply:13: the list"));
    EXPECT_EQ(loadError("o.ply", replaced(header, "element vertex", "obj_info element 7\nelement vertex") + body),
              "");
    MeshData mesh = loadMesh(write("a.off", offTetrahedron));
    mesh.positions[4] = NAN;
    writePly(path("b.ply"), mesh, std::vector<float>(4, 0.0f), 0, 1);
    EXPECT_TRUE(contains(messageOf<FileError>([&] { loadMesh(path("b.ply")); }), "vertex 1"));
    const std::string whole = read(path("b.ply"));
    EXPECT_TRUE(contains(loadError("c.ply", whole.substr(0, whole.size() - 20)), "ends early"));
}

// A length of -1 in one byte is 255 to who does not look at its type, and all those values are there.
TEST_F(MeshFile, LengthsOfPlyListsAreWholeAndNotNegative) {
    const auto file = [&](const std::string& type, const std::string& length) {
        const std::string header =
            "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float "
            "y\nproperty float z\n"
            "element face 1\nproperty list " +
            type + " int vertex_indices\nend_header\n";
        const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
        return header + std::string(reinterpret_cast<const char*>(positions), sizeof positions) + length;
    };
    const int32_t triangle[3] = {0, 1, 2};
    const std::string corners(reinterpret_cast<const char*>(triangle), sizeof triangle), many(4 * 255, '\0');
    EXPECT_EQ(loadError("good.ply", file("int", std::string("\3\0\0\0", 4) + corners)), "");
    EXPECT_TRUE(contains(loadError("negative.ply", file("char", "\xff" + many)), "negative length"));
    EXPECT_TRUE(contains(loadError("short.ply", file("short", "\xff\xff" + std::string(4 * 65535, '\0'))),
                         "negative length"));
    EXPECT_TRUE(contains(loadError("float.ply", file("float", std::string(4, '\0'))),
                         "float.ply:8: the lengths of a list are whole"));
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
    const double beta = (40 - std::pow(3 + 2 * std::cos(2 * M_PI / n), 2)) / 64;  // Loop's weight of the neighbours
    EXPECT_FLOAT_EQ(mesh.positions[2], static_cast<float>(1 - beta));
}

TEST_F(MeshFile, ScaleToHeight) {
    MeshData mesh = loadMesh(write("a.off", offTetrahedron));
    EXPECT_EQ(scaleToHeight(mesh, 240, 1), 120.0f);
    EXPECT_EQ(mesh.positions[1], 120.0f);
}

namespace {

// Values of any PLY type as bytes of either order.
class PlyBytes {
  public:
    explicit PlyBytes(bool big) : big_(big) {}
    PlyBytes& add(const std::string& type, double value) {
        if (type == "char") append(int8_t(value));
        if (type == "uchar") append(uint8_t(value));
        if (type == "short") append(int16_t(value));
        if (type == "ushort") append(uint16_t(value));
        if (type == "int") append(int32_t(value));
        if (type == "uint") append(uint32_t(value));
        if (type == "float") append(float(value));
        if (type == "double") append(value);
        return *this;
    }
    std::string bytes;

  private:
    template <class T>
    void append(T value) {
        char raw[sizeof value];
        std::memcpy(raw, &value, sizeof value);
        if (big_ == (std::endian::native == std::endian::little)) std::reverse(raw, raw + sizeof value);
        bytes.append(raw, sizeof value);
    }
    const bool big_;
};

}  // namespace

// Lists of any type of length and value, in vertices and faces, before, between and after what is wanted.
TEST_F(MeshFile, PlyListsOfEitherByteOrder) {
    const std::vector<std::string> lengths = {"char", "uchar", "short", "ushort", "int", "uint"},
                                   values = {"char", "uchar", "short", "ushort",
                                             "int",  "uint",  "float", "double"};
    for (bool big : {false, true})
        for (const std::string& length : lengths)
            for (const std::string& value : values) {
                const bool whole = value != "float" && value != "double";
                const std::string index = whole ? value : "int";
                const std::string header = std::string("ply\nformat ") +
                                           (big ? "binary_big_endian" : "binary_little_endian") +
                                           " 1.0\nelement vertex 300\nproperty list " + length + " " + value +
                                           " extra\nproperty float x\nproperty double y\nproperty " + value +
                                           " other\nproperty float z\nproperty list " + length + " " + value +
                                           " more\nelement face 2\nproperty list " + length + " " + value +
                                           " before\nproperty list " + length + " " + index +
                                           " vertex_indices\nproperty short flags\nend_header\n";
                PlyBytes out(big);
                for (int v = 0; v < 300; ++v) {
                    out.add(length, v % 3);
                    for (int i = 0; i < v % 3; ++i) out.add(value, 100 + i);
                    out.add("float", v + 0.25).add("double", -v - 0.5).add(value, 77).add("float", 2 * v);
                    out.add(length, 1).add(value, 101);
                }
                const int last = index == "char" ? 127 : index == "uchar" ? 255 : 299;
                for (const std::vector<int>& face :
                     {std::vector<int>{0, 1, last}, std::vector<int>{3, 2, 1, last - 1}}) {
                    out.add(length, 2).add(value, 1).add(value, 2);
                    out.add(length, double(face.size()));
                    for (int corner : face) out.add(index, corner);
                    out.add("short", -9);
                }
                const std::string name =
                    std::string(big ? "big" : "little") + "_" + length + "_" + value + ".ply";
                const MeshData mesh = loadMesh(write(name, header + out.bytes));
                ASSERT_EQ(mesh.vertexCount(), 300u) << name;
                for (uint32_t v : {0u, 1u, 2u, 255u, 299u}) {
                    EXPECT_EQ(mesh.positions[3 * v], v + 0.25f) << name;
                    EXPECT_EQ(mesh.positions[3 * v + 1], -0.5f - float(v)) << name;
                    EXPECT_EQ(mesh.positions[3 * v + 2], 2.0f * float(v)) << name;
                }
                const uint32_t l = uint32_t(last);
                EXPECT_EQ(mesh.triangles, (std::vector<uint32_t>{0, 1, l, 3, 2, 1, 3, 1, l - 1})) << name;
            }
}

TEST_F(MeshFile, LengthsOfBigEndianPlyListsAreChecked) {
    const auto file = [&](const std::string& type, const std::string& rest) {
        PlyBytes out(true);
        for (double x : {0, 0, 0, 1, 0, 0, 0, 1, 0}) out.add("float", x);
        return "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float "
               "y\nproperty float z\n"
               "element face 1\nproperty list " +
               type + " int vertex_indices\nend_header\n" + out.bytes + rest;
    };
    const std::string corners = PlyBytes(true).add("int", 0).add("int", 1).add("int", 2).bytes;
    EXPECT_EQ(loadError("good.ply", file("short", std::string("\0\3", 2) + corners)), "");
    EXPECT_TRUE(
        contains(loadError("swapped.ply", file("short", std::string("\3\0", 2) + corners)), "ends early"));
    EXPECT_TRUE(
        contains(loadError("negative.ply", file("int", "\xff\xff\xff\xff" + corners)), "negative length"));
    EXPECT_TRUE(contains(
        loadError("far.ply", file("short", std::string("\0\3", 2) +
                                               PlyBytes(true).add("int", 0).add("int", 1).add("int", 3).bytes)),
        "refers to vertex 3"));
    const std::string whole = file("short", std::string("\0\3", 2) + corners);
    EXPECT_TRUE(contains(loadError("cut.ply", whole.substr(0, whole.size() - 1)), "ends early"));
}
