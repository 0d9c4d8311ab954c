// host/io: meshes with parts, their subdivision and the cut of a neck; the heads that come with the project.
#include "io/file_error.h"
#include "io/mesh/mesh_parts.h"
#include "io_files.h"
#include "sample/vector.h"

using namespace pellucid::io;
using pellucid::sample::Vec3;

namespace {

using MeshParts = FolderTest;

// Two cubes of side 2, the second one 10 to the right.
std::string cubes() {
    std::string text;
    for (int cube = 0; cube < 2; ++cube)
        for (int i = 0; i < 8; ++i)
            text += "v " + std::to_string(10 * cube + (i & 1 ? 1 : -1)) + " " + (i & 2 ? "1" : "-1") + " " +
                    (i & 4 ? "1" : "-1") + "\n";
    const int quads[6][4] = {{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5},
                             {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}};
    for (int cube = 0; cube < 2; ++cube) {
        text += cube ? "g right\n" : "g left\n";
        for (const auto& quad : quads) {
            text += "f";
            for (int v : quad) text += " " + std::to_string(v + 8 * cube);
            text += "\n";
        }
    }
    return text;
}

Vec3 corner(const MeshData& mesh, size_t t, size_t i) {
    const float* p = &mesh.positions[3 * mesh.triangles[3 * t + i]];
    return {p[0], p[1], p[2]};
}
double area(const MeshData& m, size_t t) {
    return 0.5 * length(cross(corner(m, t, 1) - corner(m, t, 0), corner(m, t, 2) - corner(m, t, 0)));
}
// Sum of signed volumes of tetrahedra: that of the body if the surface is closed and faces outwards.
double volume(const MeshData& m) {
    double sum = 0;
    for (size_t t = 0; t < m.triangleCount(); ++t)
        sum += dot(corner(m, t, 0), cross(corner(m, t, 1), corner(m, t, 2))) / 6;
    return sum;
}

}  // namespace

TEST_F(MeshParts, GroupsAndQuadsOfAnObj) {
    const PartedMesh mesh = loadParts(write("cubes.obj", cubes()), 0);
    ASSERT_EQ(mesh.parts, (std::vector<std::string>{"left", "right"}));
    EXPECT_EQ(mesh.mesh.triangleCount(), 24u);
    ASSERT_EQ(mesh.partOf.size(), 24u);
    for (size_t t = 0; t < 24; ++t) {
        EXPECT_EQ(mesh.partOf[t], t / 12);
        EXPECT_EQ(mesh.mesh.positions[3 * mesh.mesh.triangles[3 * t]] > 5, t >= 12);
    }
    EXPECT_NEAR(volume(mesh.mesh), 16, 1e-5);
    EXPECT_EQ(mesh.part("right"), 1);
    EXPECT_EQ(mesh.part("none"), -1);
}

// The limit of a corner of n quads is (n^2 V + 4 sum E + sum F) / (n (n + 5)), E its neighbours by an edge, F
// those across a quad [Halstead, Kass, DeRose, SIGGRAPH 1993]: half of a cube's corner.
TEST_F(MeshParts, SubdivisionIsCatmullClarks) {
    const PartedMesh mesh = loadParts(write("cubes.obj", cubes()), 4);
    EXPECT_EQ(mesh.mesh.triangleCount(), 2u * 6 * 256 * 2);
    double corner = 0, face = 0;
    for (size_t v = 0; v < mesh.mesh.vertexCount(); ++v) {
        const float* p = &mesh.mesh.positions[3 * v];
        if (p[0] > 5) continue;
        corner = std::max(corner, double(p[0]) + p[1] + p[2]);
        face = std::max(face, double(p[2]));
    }
    EXPECT_NEAR(corner / 3, 0.5, 1e-3);  // after four levels
    EXPECT_GT(face, 0.6);
    EXPECT_LT(face, 1);
    for (size_t t = 0; t < mesh.mesh.triangleCount(); ++t) EXPECT_GT(area(mesh.mesh, t), 0);
}

// A quad and a pentagon with a seam between them, which stays: coordinates are linear in each face's corners.
TEST_F(MeshParts, TextureCoordinatesAreLinearAndSeamsStay) {
    const std::string text =
        "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 4 0 0\nv 5 1 0\nv 4 2 0\n"
        "vt 0 0\nvt 0.5 0\nvt 0.5 0.5\nvt 0 0.5\nvt 0.6 0\nvt 0.8 0\nvt 1 0.25\nvt 0.8 0.5\nvt 0.6 0.5\n"
        "f 1/1 2/2 3/3 4/4\nf 2/5 5/6 6/7 7/8 3/9\n";
    for (const int levels : {0, 1, 3}) {
        PartedMesh parted = loadParts(write("two.obj", text), levels);
        ASSERT_EQ(parted.cornerUvs.size(), 2 * parted.mesh.triangles.size());
        MeshData& mesh = parted.mesh;
        const size_t before = mesh.vertexCount();
        splitAtSeams(mesh, parted.cornerUvs);
        ASSERT_EQ(mesh.uvs.size(), 2 * mesh.vertexCount());
        EXPECT_EQ(mesh.vertexCount(), before + (size_t(1) << levels) + 1) << "vertices of the seam";
        // Signed areas in the texture: of each face as in the file, none turned.
        double areas[2] = {0, 0};
        for (size_t t = 0; t < mesh.triangleCount(); ++t) {
            const float* uv[3];
            for (int i = 0; i < 3; ++i) uv[i] = &mesh.uvs[2 * mesh.triangles[3 * t + i]];
            const double twice = double(uv[1][0] - uv[0][0]) * (uv[2][1] - uv[0][1]) -
                                 double(uv[2][0] - uv[0][0]) * (uv[1][1] - uv[0][1]);
            EXPECT_GT(twice, 0);
            areas[uv[0][0] + uv[1][0] + uv[2][0] > 1.65f] += 0.5 * twice;
        }
        EXPECT_NEAR(areas[0], 0.25, 1e-6);
        EXPECT_NEAR(areas[1], 0.15, 1e-6);
    }
    // A cut interpolates: at y = 1 of the quad's left edge v is 0.25.
    PartedMesh half = loadParts(write("two.obj", text), 0);
    cutAndClose(half, "", {0, 1, 0}, 1, "cap");
    ASSERT_EQ(half.cornerUvs.size(), 2 * half.mesh.triangles.size());
    for (size_t c = 0; c < half.mesh.triangles.size(); ++c) {
        const float* p = &half.mesh.positions[3 * half.mesh.triangles[c]];
        EXPECT_NEAR(half.cornerUvs[2 * c + 1], 0.25 * p[1], 1e-6) << p[0];
    }
    EXPECT_TRUE(loadParts(write("bare.obj", cubes()), 1).cornerUvs.empty());
}

TEST_F(MeshParts, ACutIsStraightAndClosed) {
    PartedMesh mesh = loadParts(write("cubes.obj", cubes()), 3);
    const double before = volume(mesh.mesh);
    cutAndClose(mesh, "left", {0, 1, 0}, 0, "cap");
    ASSERT_EQ(mesh.part("cap"), 2);
    ASSERT_EQ(mesh.partOf.size(), mesh.mesh.triangleCount());
    double lowest = 1, capArea = 0;
    std::vector<bool> used(mesh.mesh.vertexCount());
    for (size_t t = 0; t < mesh.mesh.triangleCount(); ++t) {
        for (size_t i = 0; i < 3; ++i) {
            lowest = std::min(lowest, corner(mesh.mesh, t, i).y);
            used[mesh.mesh.triangles[3 * t + i]] = true;
        }
        if (mesh.partOf[t] == 2) {
            capArea += area(mesh.mesh, t);
            EXPECT_EQ(mesh.mesh.normals[3 * mesh.mesh.triangles[3 * t] + 1], -1);
        }
    }
    EXPECT_NEAR(lowest, 0, 1e-6);
    EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
    EXPECT_GT(capArea, 1);
    // The left cube is closed: half of its volume. The right one is cut without a cap, in the plane through
    // the origin, which an open rim in that plane does not change.
    EXPECT_NEAR(volume(mesh.mesh), before / 2, 1e-4);

    PartedMesh whole = loadParts(write("cubes.obj", cubes()), 1);
    const size_t triangles = whole.mesh.triangleCount();
    cutAndClose(whole, "left", {0, 1, 0}, -5, "cap");  // misses
    EXPECT_EQ(whole.mesh.triangleCount(), triangles);
    EXPECT_EQ(whole.part("cap"), -1);
}

TEST_F(MeshParts, WhatCannotBeReadIsNamed) {
    // Not an OBJ; no face; three faces at one edge.
    const std::string fins = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n";
    write("a.off", "OFF\n0 0 0\n");
    write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    write("fins.obj", fins);
    for (const auto& [name, message] :
         {std::pair{"none.obj", "none.obj"}, {"a.off", "a.off"}, {"b.obj", "b.obj"}, {"fins.obj", "face"}})
        EXPECT_TRUE(contains(messageOf<FileError>([&] { loadParts(path(name), 1); }), message));
}

TEST(Heads, HaveTheirParts) {
    for (const char* name : {"head_female", "head_male"}) {
        const PartedMesh head = loadParts(PELLUCID_SOURCE_DIR "/data/heads/" + std::string(name) + ".obj", 1);
        for (const char* part : {"skin", "eye_left", "eye_right", "teeth_upper", "teeth_lower", "tongue"})
            EXPECT_GE(head.part(part), 0) << name << " " << part;
        EXPECT_GT(head.mesh.triangleCount(), 30000u);
        EXPECT_EQ(head.cornerUvs.size(), 2 * head.mesh.triangles.size());
        for (const float n : head.mesh.normals) ASSERT_TRUE(std::isfinite(n));
    }
}
