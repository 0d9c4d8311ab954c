// PLY files: what is loaded, in every type and order of bytes, and what is refused and with which message.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "mesh_files.h"

using namespace pellucid::io;

namespace {

class MeshFilePly : public MeshFile {};

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

TEST_F(MeshFilePly, PlyWrittenIsPlyRead) {
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

TEST_F(MeshFilePly, AsciiPlyKeepsNonManifoldFaces) {
    const MeshData mesh = loadMesh(
        write("n.ply",
              "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float "
              "z\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n"
              "0 0 0\n1 0 0\n0 1 0\n0 -1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 0 1 4\n"));
    EXPECT_EQ(mesh.triangles, (std::vector<uint32_t>{0, 1, 2, 0, 1, 3, 0, 1, 4}));
}

TEST_F(MeshFilePly, BadPlyFilesSayWhere) {
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
    EXPECT_EQ(
        loadError("o.ply", replaced(header, "element vertex", "obj_info element 7\nelement vertex") + body),
        "");
    MeshData mesh = loadMesh(write("a.off", offTetrahedron));
    mesh.positions[4] = NAN;
    writePly(path("b.ply"), mesh, std::vector<float>(4, 0.0f), 0, 1);
    EXPECT_TRUE(contains(messageOf<FileError>([&] { loadMesh(path("b.ply")); }), "vertex 1"));
    const std::string whole = read(path("b.ply"));
    EXPECT_TRUE(contains(loadError("c.ply", whole.substr(0, whole.size() - 20)), "ends early"));
}

// Lists of any type of length and value, in vertices and faces, before, between and after what is wanted.
TEST_F(MeshFilePly, PlyListsOfEitherByteOrder) {
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

// A length of -1 in one byte is 255 to a reader that ignores its type, and all those values are there.
TEST_F(MeshFilePly, LengthsOfListsAreChecked) {
    for (const bool big : {false, true}) {
        SCOPED_TRACE(big);
        const auto values = [&](const std::string& type, const std::vector<double>& all) {
            PlyBytes out(big);
            for (const double x : all) out.add(type, x);
            return out.bytes;
        };
        const auto file = [&](const std::string& type, const std::string& rest) {
            return std::string("ply\nformat binary_") + (big ? "big" : "little") +
                   "_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                   "element face 1\nproperty list " +
                   type + " int vertex_indices\nend_header\n" + values("float", {0, 0, 0, 1, 0, 0, 0, 1, 0}) +
                   rest;
        };
        const std::string corners = values("int", {0, 1, 2}), many(4 * 65535, '\0');
        const std::string whole = file("short", values("short", {3}) + corners);
        EXPECT_EQ(loadError("good.ply", whole), "");
        EXPECT_TRUE(contains(loadError("cut.ply", whole.substr(0, whole.size() - 1)), "ends early"));
        EXPECT_TRUE(contains(loadError("swapped.ply", file("short", values("short", {0x300}) + corners)),
                             "ends early"));
        for (const char* type : {"char", "short", "int"})
            EXPECT_TRUE(contains(loadError("negative.ply", file(type, values(type, {-1}) + many)),
                                 "negative length"));
        EXPECT_TRUE(
            contains(loadError("far.ply", file("short", values("short", {3}) + values("int", {0, 1, 3}))),
                     "refers to vertex 3"));
        EXPECT_TRUE(contains(loadError("float.ply", file("float", std::string(4, '\0'))),
                             "float.ply:8: the lengths of a list are whole"));
    }
}
