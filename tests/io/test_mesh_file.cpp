// host/io/mesh/mesh_file.h: the data loaded from each format, warnings, and error messages.
#include <regex>

#include "io/file_error.h"
#include "io/mesh/mesh_file.h"
#include "io_files.h"

using namespace pellucid::io;

namespace {

using Indices = std::vector<uint32_t>;
using Floats = std::vector<float>;

// A regular tetrahedron, faces outwards.
const Floats corners = {1, 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1};
const Indices tetrahedron = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
const std::string offTetrahedron =
    "OFF\n4 4 6\n1 1 1\n-1 -1 1\n-1 1 -1\n1 -1 -1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

class MeshFile : public FolderTest {
  protected:
    MeshData load(const std::string& name, const std::string& text,
                  const MeshLoadOptions& options = {}) const {
        return loadMesh(write(name, text), options);
    }
    std::string loadError(const std::string& name, const std::string& text) const {
        return messageOf<FileError>([&] { load(name, text); });
    }
    MeshData solid() const { return load("a.off", offTetrahedron); }
};

Floats facetsOfTetrahedron() {
    Floats facets;
    for (uint32_t v : tetrahedron) facets.insert(facets.end(), &corners[3 * v], &corners[3 * v] + 3);
    return facets;
}

std::string binaryStl(const Floats& facets) {
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

std::string textStl(const Floats& facets) {
    std::ostringstream text;
    text << "solid t\n";
    for (size_t i = 0; i < facets.size(); i += 3) {
        if (i % 9 == 0) text << "facet normal 0 0 0\nouter loop\n";
        text << "vertex " << facets[i] << ' ' << facets[i + 1] << ' ' << facets[i + 2] << '\n';
        if (i % 9 == 6) text << "endloop\nendfacet\n";
    }
    return text.str() + "endsolid t\n";
}

std::string asciiPly(const std::string& vertices, const std::string& faces) {
    const auto lines = [](const std::string& text) {
        return std::to_string(std::count(text.begin(), text.end(), '\n'));
    };
    return "ply\nformat ascii 1.0\nelement vertex " + lines(vertices) +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + lines(faces) +
           "\nproperty list uchar int vertex_indices\nend_header\n" + vertices + faces;
}

const std::string three = "0 0 0\n1 0 0\n0 1 0\n", four = three + "0 0 1\n";
const std::string objThree = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

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

TEST_F(MeshFile, OffKeepsVerticesAndFacesInOrder) {
    const MeshData mesh = solid();
    EXPECT_EQ(mesh.positions, corners);
    EXPECT_EQ(mesh.triangles, tetrahedron);
    EXPECT_TRUE(mesh.normals.empty());
    const MeshData quads = load("b.off",
                                "# made by hand\nOFF 5 2 0 # counts\n0 0 0 # first\n\n1 0 0\n1 1 "
                                "0\n0 1 0\n2 2 2\n4 0 1 2 3 255 0 0\n3 0 1 4 9\n");
    EXPECT_EQ(quads.vertexCount(), 5u);
    EXPECT_EQ(quads.triangles, (Indices{0, 1, 2, 0, 2, 3, 0, 1, 4}));
    const MeshData normals = load("n.off", "NOFF\n3 1 0\n0 0 0 0 0 2\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n");
    EXPECT_EQ(normals.normals, (Floats{0, 0, 1, 0, 0, 1, 0, 0, 1}));  // and of unit length
    const std::string textured =
        "STCOFF\n3 1 0\n0 0 0 9 9 9 0 0.5\n1 0 0 9 9 9 1 0.5\n0 1 0 9 9 9 0 1\n3 0 1 2\n";
    EXPECT_EQ(load("st.off", textured).uvs, (Floats{0, 0.5f, 1, 0.5f, 0, 1}));
    EXPECT_TRUE(
        contains(loadError("st.off", "STOFF\n3 1 0\n0 0 0 0\n"), "st.off:3: the texture coordinates"));
}

TEST_F(MeshFile, ObjWithNegativeIndicesAndSeams) {
    const std::string text =
        "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0.5 0.5\nusemtl x\n"
        "f 1/1 2/2 3/3\nf -4/-1 -2/-2 -1/1\n";
    const MeshData whole = load("s.obj", text);
    EXPECT_EQ(whole.triangles, (Indices{0, 1, 2, 0, 2, 3}));
    EXPECT_TRUE(whole.uvs.empty());
    EXPECT_EQ(whole.warnings.size(), 1u);
    const MeshData split = load("s.obj", text, {.splitUvSeams = true});
    EXPECT_EQ(split.splitFrom, (Indices{0}));
    EXPECT_EQ(split.triangles, (Indices{0, 1, 2, 4, 2, 3}));
    EXPECT_EQ(split.vertexCount(), 5u);
    EXPECT_EQ((Floats(split.uvs.begin() + 8, split.uvs.end())), (Floats{0.5f, 0.5f}));
}

TEST_F(MeshFile, AByteOrderMarkIsNoPartOfTheFirstLine) {
    const std::string mark = "\xEF\xBB\xBF";
    EXPECT_EQ(load("a.obj", mark + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").positions,
              (Floats{0, 0, 0, 1, 0, 0, 0, 1, 0}));
    EXPECT_EQ(load("a.off", mark + offTetrahedron).positions, corners);
}

TEST_F(MeshFile, StlBothWays) {
    const Floats facets = facetsOfTetrahedron();
    const MeshData binary = load("b.stl", binaryStl(facets)), ascii = load("a.stl", textStl(facets));
    EXPECT_EQ(binary.vertexCount(), 4u);
    EXPECT_EQ(binary.triangleCount(), 4u);
    EXPECT_EQ(ascii.positions, binary.positions);
    EXPECT_EQ(ascii.triangles, binary.triangles);
}

TEST_F(MeshFile, PlyWrittenIsPlyRead) {
    MeshData mesh = solid();
    computeNormals(mesh);
    writePly(path("o.ply"), mesh, Floats{0, 1, 2, 3}, 0, 3);
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

// Lists of any type of length and value, in vertices and faces, before, between and after what is wanted; and
// elements that are neither.
TEST_F(MeshFile, PlyListsOfEitherByteOrder) {
    const std::vector<std::string> types = {"char", "uchar", "short", "ushort",
                                            "int",  "uint",  "float", "double"};
    for (bool big : {false, true})
        for (size_t l = 0; l < 6; ++l)
            for (const std::string& value : types) {
                const std::string length = types[l], list = "property list " + length + " ",
                                  index = value == "float" || value == "double" ? "int" : value,
                                  name = std::string(big ? "big" : "little") + "_" + length + "_" + value +
                                         ".ply";
                const std::string header =
                    std::string("ply\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
                    " 1.0\nelement camera 2\n" + list + value + " marks\nproperty " + value +
                    " angle\nelement vertex 300\n" + list + value +
                    " extra\nproperty float x\nproperty double y\nproperty " + value +
                    " other\nproperty float z\n" + list + value + " more\nelement face 2\n" + list + value +
                    " before\n" + list + index + " vertex_indices\nproperty short flags\nend_header\n";
                PlyBytes out(big);
                for (int i = 0; i < 2; ++i) out.add(length, 2).add(value, 3).add(value, 4).add(value, 5);
                for (int v = 0; v < 300; ++v) {
                    out.add(length, v % 3);
                    for (int i = 0; i < v % 3; ++i) out.add(value, 100 + i);
                    out.add("float", v + 0.25).add("double", -v - 0.5).add(value, 77).add("float", 2 * v);
                    out.add(length, 1).add(value, 101);
                }
                const uint32_t last = index == "char" ? 127 : index == "uchar" ? 255 : 299;
                for (const Indices& face : {Indices{0, 1, last}, Indices{3, 2, 1, last - 1}}) {
                    out.add(length, 2).add(value, 1).add(value, 2).add(length, double(face.size()));
                    for (uint32_t corner : face) out.add(index, corner);
                    out.add("short", -9);
                }
                const MeshData mesh = load(name, header + out.bytes);
                ASSERT_EQ(mesh.vertexCount(), 300u) << name;
                for (uint32_t v : {0u, 1u, 2u, 255u, 299u}) {
                    EXPECT_EQ(mesh.positions[3 * v], v + 0.25f) << name;
                    EXPECT_EQ(mesh.positions[3 * v + 1], -0.5f - float(v)) << name;
                    EXPECT_EQ(mesh.positions[3 * v + 2], 2.0f * float(v)) << name;
                }
                EXPECT_EQ(mesh.triangles, (Indices{0, 1, last, 3, 2, 1, 3, 1, last - 1})) << name;
            }
}

// A length of -1 in one byte reads as 255 if the type is ignored, and the file has that many values.
TEST_F(MeshFile, LengthsOfListsAreChecked) {
    for (const bool big : {false, true}) {
        const auto values = [&](const std::string& type, const std::vector<double>& all) {
            PlyBytes out(big);
            for (const double x : all) out.add(type, x);
            return out.bytes;
        };
        const auto of = [&](const std::vector<double>& vertices, const std::string& types,
                            const std::string& rest) {
            return std::string("ply\nformat binary_") + (big ? "big" : "little") +
                   "_endian 1.0\nelement vertex " + std::to_string(vertices.size() / 3) +
                   "\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list " +
                   types + " vertex_indices\nend_header\n" + values("float", vertices) + rest;
        };
        const auto file = [&](const std::string& type, const std::string& rest) {
            return of({0, 0, 0, 1, 0, 0, 0, 1, 0}, type + " int", rest);
        };
        const std::string indices = values("int", {0, 1, 2}), many(4 * 65535, '\0');
        const std::string whole = file("short", values("short", {3}) + indices);
        EXPECT_EQ(loadError("good.ply", whole), "");
        for (const auto& [text, message] :
             {std::pair{whole.substr(0, whole.size() - 1), "ends early"},
              {file("short", values("short", {0x300}) + indices), "ends early"},
              {file("char", values("char", {-1}) + many), "negative length"},
              {file("short", values("short", {-1}) + many), "negative length"},
              {file("int", values("int", {-1}) + many), "negative length"},
              {file("short", values("short", {3}) + values("int", {0, 1, 3})), "refers to vertex 3"},
              {file("float", std::string(4, '\0')), "a.ply:8: the lengths of a list are whole"}})
            EXPECT_TRUE(contains(loadError("a.ply", text), message)) << big;
        // An index of -1 is no 255.
        const auto chars = [&](double last) {
            return of(std::vector<double>(3 * 256), "char char", values("char", {3, 0, 1, last}));
        };
        EXPECT_EQ(loadError("good.ply", chars(2)), "");
        EXPECT_TRUE(contains(loadError("a.ply", chars(-1)), "refers to vertex"));
    }
}

TEST_F(MeshFile, NonManifoldFacesSurviveButAreNotSubdivided) {
    const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n0 -1 0\n0 0 1\n",
                      faces = "3 0 1 2\n3 1 0 3\n3 0 1 4\n";
    MeshData mesh = load("n.off", "OFF\n5 3 0\n" + vertices + faces);
    EXPECT_EQ(mesh.triangles, (Indices{0, 1, 2, 1, 0, 3, 0, 1, 4}));
    EXPECT_EQ(load("n.ply", asciiPly(vertices, faces)).triangles, mesh.triangles);
    EXPECT_TRUE(contains(messageOf<FileError>([&] { loopSubdivide(mesh, 1); }), "triangle 2"));
    EXPECT_EQ(mesh.triangleCount(), 3u);
}

TEST_F(MeshFile, DegenerateFacesAreLeftInOrNamed) {
    const MeshData off = load("d.off", "OFF\n3 2 0\n" + three + "3 0 1 1\n3 0 1 2\n");
    EXPECT_EQ(off.triangleCount(), 2u);  // the library counts and skips it
    for (const std::string twice : {"1 2 2", "1 2 1", "1 1 2", "1 2 3 1", "1 2 3 2", "3 2 1 2"}) {
        const MeshData left = load("d.obj", objThree + "f " + twice + "\nf 1 2 3\n");
        EXPECT_EQ(left.triangleCount(), 1u) << twice;
        ASSERT_EQ(left.warnings.size(), 1u);
        EXPECT_TRUE(contains(left.warnings[0], "1 face"));
    }
}

TEST_F(MeshFile, BadFilesSayWhere) {
    EXPECT_TRUE(contains(messageOf<FileError>([&] { loadMesh(path("none.off")); }), "No such file"));
    EXPECT_TRUE(contains(messageOf<FileError>([&] { loadMesh(folder_.string()); }), "folder"));
    Floats facets = facetsOfTetrahedron();
    const std::string cutStl = binaryStl(facets).substr(0, 150);
    facets[13] = NAN;
    MeshData bad = solid();
    bad.positions[4] = NAN;
    writePly(path("b.ply"), bad, Floats(4, 0.0f), 0, 1);
    const std::string nanPly = read(path("b.ply"));
    const std::string face = "3 0 1 2\n", ply = asciiPly(three, face);
    const auto replaced = [&](std::string text, const std::string& from, const std::string& to) {
        return text.replace(text.find(from), from.size(), to);
    };
    const struct {
        const char* name;
        std::string text;
        const char* message;
    } rows[] = {
        {"a.gltf", "x", ".off, .obj, .ply, .stl"},
        {"e.off", "", "empty"},
        {"h.off", "FOO\n1 1 1\n", "h.off:1: starts with 'FOO'"},
        {"n.off", "OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "n.off:4: coordinate y is 'nan'"},
        {"w.off", "OFF\n3 1 0\n0 0 0\n1 zwei 0\n0 1 0\n3 0 1 2\n", "w.off:4: coordinate y 'zwei'"},
        {"i.off", "OFF\n3 1 0\n" + three + "3 0 1 3\n", "i.off:6: vertex index 3 is out of range"},
        {"t.off", "OFF\n3 2 0\n" + three + face, "2 faces announced, 1 found"},
        {"z.off", "OFF\n3 0 0\n" + three, "no face"},
        {"big.off", "OFF\n3 4000000000 0\n" + three + face, "announced"},
        {"n.obj", "v 0 0 0\nv inf 0 0\nv 0 1 0\nf 1 2 3\n", "n.obj:2: coordinate x is 'inf'"},
        {"i.obj", objThree + "\nf 1 2 4\n", "i.obj:5: vertex index 4"},
        {"m.obj", objThree + "f -1 -2 -4\n", "m.obj:4: vertex index -4"},
        {"c.obj", objThree + "f 1/1/1/1 2 3\n", "c.obj:4: a corner has more than the three parts"},
        {"s.stl", cutStl, "is not an STL file"},
        {"n.stl", binaryStl(facets), "facet 1"},
        {"v.stl", "solid\nfacet\nvertex 5 5 5\n" + textStl({0, 0, 0, 1, 0, 0, 0, 1, 0}), "4 vertices"},
        {"n.ply", asciiPly("0 0 0\n1 nan 0\n0 1 0\n", face), "n.ply:11: y is 'nan'"},
        {"t.ply", ply.substr(0, ply.find("0 1 0\n")), "ends early"},
        {"i.ply", asciiPly(three, "3 0 1 7\n"), "face 0 (counted from 0) refers to vertex 7"},
        {"u.ply", asciiPly(three, "3 0 1 9223372036854775807\n"), "refers to vertex 1000000000000000"},
        {"x.ply", "nonsense", "x.ply:1: does not start with 'ply'"},
        {"f.ply", replaced(ply, "ascii 1.0", "ascii"), "f.ply:2: 'format ENCODING 1.0'"},
        {"p.ply", replaced(ply, "float z", "floot z"), "p.ply:6: has the type 'floot'"},
        {"z.ply", replaced(ply, "float z", "float w"), "vertices need 'z'"},
        {"e.ply", replaced(ply, "end_header", "end"), "no line 'end_header'"},
        {"l.ply", asciiPly(three, "4 0 1 2\n"), "l.ply:13: the list"},
        {"b.ply", nanPly, "vertex 1"},
        {"c.ply", nanPly.substr(0, nanPly.size() - 20), "ends early"},
    };
    for (const auto& row : rows)
        EXPECT_TRUE(contains(loadError(row.name, row.text), row.message)) << row.name;
    EXPECT_EQ(loadError("o.ply", replaced(ply, "element vertex", "obj_info element 7\nelement vertex")), "");
}

// Meshes with nothing wrong, of more vertices than faces and the other way round, load without a warning.
TEST_F(MeshFile, GoodFilesOfEveryFormatHaveNoWarning) {
    const auto expectSilent = [&](const std::string& name, const std::string& text, size_t triangles) {
        const MeshData mesh = load(name, text);
        EXPECT_EQ(mesh.triangleCount(), triangles) << name;
        EXPECT_EQ(mesh.warnings, std::vector<std::string>()) << name;
    };
    const struct {
        std::string vertices, faces, objFaces, counts;
        size_t triangles;
    } meshes[] = {
        {three, "3 0 1 2\n", "f 1 2 3\n", "3 1", 1},
        {four, "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n", "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", "4 4", 4},
        {"0 0 0\n1 0 0\n1 1 0\n0 1 0\n", "4 0 1 2 3\n", "f 1 2 3 4\n", "4 1", 2}};
    for (const auto& m : meshes) {
        expectSilent("a.off", "OFF\n" + m.counts + " 0\n" + m.vertices + m.faces, m.triangles);
        const std::string obj = "v " + std::regex_replace(m.vertices, std::regex("\n(?=.)"), "\nv ");
        expectSilent("a.obj", obj + m.objFaces, m.triangles);
        expectSilent("a.ply", asciiPly(m.vertices, m.faces), m.triangles);
    }
    expectSilent("a.stl", textStl({0, 0, 0, 1, 0, 0, 0, 1, 0}), 1);
    expectSilent("t.obj", "v 0 0 1e-60\nv 1 0 0\nv 0 1 -1e-60\nf 1 2 3\n", 1);
    expectSilent("s.ply",  // with a property that nothing reads
                 std::regex_replace(asciiPly("0 0 0 nan\n1 0 0 1\n0 1 0 2\n", "3 0 1 2\n"),
                                    std::regex("(property float )z\n"), "$1z\n$1q\n"),
                 1);
}

TEST_F(MeshFile, TrianglesThatFaceAnotherWayThanTheirNeighboursAreToldOrTurned) {
    // A tetrahedron, outwards; its second triangle turned; and that with vertices of their own, as of STL.
    const auto off = [](const std::string& second) {
        return "OFF\n4 4 0\n" + four + "3 0 2 1\n3 " + second + "\n3 1 2 3\n3 0 3 2\n";
    };
    const auto second = [](const MeshData& m) {
        return Indices(m.triangles.begin() + 3, m.triangles.begin() + 6);
    };
    const MeshLoadOptions orient{.orient = true};
    MeshData mesh = load("turned.off", off("0 3 1"));
    ASSERT_EQ(mesh.warnings.size(), 1u);
    EXPECT_EQ(mesh.warnings[0].find("1 triangle faces the other way"), 0u) << mesh.warnings[0];
    EXPECT_EQ(second(mesh), (Indices{0, 3, 1}));
    mesh = load("turned.off", off("0 3 1"), orient);
    EXPECT_TRUE(mesh.warnings.empty());
    EXPECT_EQ(mesh.trianglesTurned, 1u);
    EXPECT_EQ(second(mesh), (Indices{0, 1, 3}));
    computeNormals(mesh);
    EXPECT_LT(mesh.normals[0] + mesh.normals[1] + mesh.normals[2], -1)
        << "of the corner at the origin: outwards";
    const std::string soup = textStl({0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0,
                                      1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 1, 0});
    EXPECT_EQ(load("soup.stl", soup).warnings.size(), 1u);
    EXPECT_EQ(load("soup.stl", soup, orient).trianglesTurned, 1u);
    // If two of three triangles are wrong, the file's normals decide (how: test_mesh_orient.cpp).
    mesh = load("flat.obj",
                "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 2 0\nvn 0 0 1\nf 1//1 3//1 2//1\nf 1//1 3//1 4//1\n"
                "f 4//1 5//1 3//1\n",
                orient);
    EXPECT_EQ(mesh.trianglesTurned, 2u);
}

TEST_F(MeshFile, NormalsOfTheFileAreUsedIfAllOfThemCanBe) {
    const auto of = [&](const std::string& third) {
        return load("n.obj",
                    "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 3 4\nvn " + third + "\nf 1//1 2//2 3//3\n");
    };
    EXPECT_EQ(of("1 0 0").normals, (std::vector<float>{0, 0, 1, 0, 0.6f, 0.8f, 1, 0, 0}));
    for (const char* third : {"0 0 0", "1e-7 0 0"}) {
        const MeshData mesh = of(third);
        EXPECT_TRUE(mesh.normals.empty()) << third;
        ASSERT_EQ(mesh.warnings.size(), 1u) << third;
        EXPECT_EQ(mesh.warnings[0].find("normals left out: 1 vertex normal"), 0u) << mesh.warnings[0];
    }
}

TEST_F(MeshFile, NormalsPointOutwardsAlsoAcrossSeams) {
    MeshData mesh = solid(), soup;  // in the soup every face has corners of its own
    computeNormals(mesh);
    for (size_t i = 0; i < corners.size(); ++i)
        EXPECT_FLOAT_EQ(mesh.normals[i], corners[i] / std::sqrt(3.0f));
    soup.positions = facetsOfTetrahedron();
    for (uint32_t i = 0; i < 12; ++i) soup.triangles.push_back(i);
    computeNormals(soup);
    for (size_t i = 0; i < 3 * tetrahedron.size(); ++i)
        EXPECT_EQ(soup.normals[i], mesh.normals[3 * tetrahedron[i / 3] + i % 3]);
}

TEST_F(MeshFile, LoopKeepsIndicesAndClosedness) {
    MeshData mesh = solid();
    mesh.uvs = {0, 0, 1, 0, 0, 1, 1, 1};
    MeshData once = mesh;
    loopSubdivide(mesh, 2);
    EXPECT_EQ(mesh.triangleCount(), 4u * 16u);
    EXPECT_EQ(mesh.vertexCount(), 34u);  // V - E + F = 2 with E = 1.5 F
    ASSERT_EQ(mesh.uvs.size(), 2 * mesh.vertexCount());
    EXPECT_EQ(mesh.uvs[2], 1.0f);
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    for (size_t t = 0; t < mesh.triangles.size(); t += 3)
        for (size_t c = 0; c < 3; ++c) ++edges[{mesh.triangles[t + c], mesh.triangles[t + (c + 1) % 3]}];
    for (const auto& [edge, count] : edges) {
        EXPECT_EQ(count, 1);
        EXPECT_TRUE(edges.count({edge.second, edge.first}));
    }
    // Loop's rule for 3 neighbours: alpha = (40 - (3 + 2 cos 120 degrees)^2) / 64 = 9/16 of their mean, which
    // is -1/3 of the corner; the corners' first level is therefore 1/4 of the corner.
    loopSubdivide(once, 1);
    EXPECT_FLOAT_EQ(once.positions[0], 0.25f);
    // The UV of a new vertex is half-way along its edge.
    std::multiset<std::pair<float, float>> found;
    for (size_t v = 4; v < 10; ++v) found.insert({once.uvs[2 * v], once.uvs[2 * v + 1]});
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
    MeshData mesh = load("fan.off", fan.str());
    loopSubdivide(mesh, 1);
    const double beta =
        (40 - std::pow(3 + 2 * std::cos(2 * M_PI / n), 2)) / 64;  // Loop's weight of the neighbours
    EXPECT_FLOAT_EQ(mesh.positions[2], static_cast<float>(1 - beta));
}

TEST_F(MeshFile, ScaleToHeight) {
    MeshData mesh = solid();
    EXPECT_EQ(scaleToHeight(mesh, 240, 1), 120.0f);
    EXPECT_EQ(mesh.positions[1], 120.0f);
}
