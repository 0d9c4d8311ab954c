// `pellucid curvature`: meshes, what is wrong with them, results.
#include <pellucid/pellucid.hpp>

#include "cli_mesh.h"
#include "io/image/image_file.h"
#include "io/mesh/mesh_file.h"
#include "npy.h"
#include "tolerances.h"

using namespace pellucid;

using CliCurvature = CommandOnMesh;

TEST_F(CliCurvature, CurvatureOfASphereLikeMesh) {
    const std::string mesh = icosahedron();
    const Result result =
        run({"curvature", mesh, "-o", path("c.npy"), "--estimator", "edge", "--json", "--smooth", "3"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const nlohmann::json report = result.json();
    expectReport(report);
    EXPECT_EQ(report.at("vertices"), 12);
    EXPECT_EQ(report.at("triangles"), 20);
    EXPECT_EQ(report.at("edges"), 30);
    EXPECT_TRUE(report.at("warnings").empty());
    const auto values = npy::read<float>(path("c.npy"));
    EXPECT_EQ(values.shape, (std::vector<size_t>{12}));
    for (float v : values.data) EXPECT_NEAR(v, 0.5f, 0.5f * tolerance::edgeCurvature);

    const Result ply =
        run({"curvature", mesh, "-o", path("c.ply"), "--estimator", "edge", "--scale", "4", "--smooth", "0"});
    ASSERT_EQ(ply.exitCode, 0) << ply.err;
    EXPECT_EQ(io::loadMesh(path("c.ply")).positions, io::loadMesh(mesh).positions);
    EXPECT_TRUE(contains(ply.out, "curvature_max: "));
    ASSERT_EQ(run({"curvature", mesh, "-o", path("s.npy"), "--estimator", "edge", "--scale", "4"}).exitCode,
              0);
    for (float v : npy::read<float>(path("s.npy")).data)
        EXPECT_NEAR(v, 2.0f, 2.0f * tolerance::edgeCurvature);
}

TEST_F(CliCurvature, CurvatureQuantitiesWeldAndPicture) {
    const std::string mesh = icosahedron();
    ASSERT_EQ(run({"curvature", mesh, "-o", path("m.npy"), "--estimator", "tensor", "--quantity", "gaussian",
                   "--weld", "exact", "--smooth", "0", "--smooth-radius", "0.1", "--picture", path("m.png")})
                  .exitCode,
              0);
    // The icosahedron's normals point from its centre at radius 2: every edge turns as on the sphere.
    for (float v : npy::read<float>(path("m.npy")).data)
        EXPECT_NEAR(v, 0.25f, 0.25f * tolerance::tensorCurvature);
    EXPECT_GT(std::filesystem::file_size(path("m.png")), 1000u);
    // On one range, meshes of different curvature differ in colour; each on its own, they look alike.
    const auto colored = [&](const char* scale, bool ranged) {
        std::vector<std::string> arguments = {"curvature", mesh, "-o", path("r.ply"), "--scale", scale};
        if (ranged) arguments.insert(arguments.end(), {"--range", "0", "2"});
        EXPECT_EQ(run(arguments).exitCode, 0);
        std::ifstream file(path("r.ply"), std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(file), {}};
        const size_t vertices = bytes.find("end_header\n") + 11, stride = 31;  // bytes of a vertex
        std::string colors;
        for (size_t v = 0; v < 12; ++v) colors += bytes.substr(vertices + v * stride + 28, 3);
        return colors;
    };
    EXPECT_EQ(colored("1", false), colored("2", false));
    EXPECT_NE(colored("1", true), colored("2", true));
    const std::string horned = icosahedron("9 9 9\n", "3 0 1 12\n", 13, 21);
    const auto smoothed = [&](const char* weights) {
        EXPECT_EQ(run({"curvature", horned, "-o", path("w.npy"), "--smooth-radius", "0.6", "--smooth-weights",
                       weights})
                      .exitCode,
                  0);
        return npy::read<float>(path("w.npy")).data;
    };
    EXPECT_NE(smoothed("cotangent"), smoothed("area"));
}

TEST_F(CliCurvature, WhatCanBeRepairedIsCounted) {
    // Two unreferenced vertices, a repeated index, a third face on an edge, and a face with a zero-length
    // edge.
    const std::string mesh =
        icosahedron("9 9 9\n9 9 9\n0 0 5\n0 0 5\n", "3 0 0 1\n3 0 1 14\n3 14 15 3\n", 16, 23);
    const Result result = run({"curvature", mesh, "-o", path("c.npy"), "--estimator", "edge", "--json"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const nlohmann::json report = result.json();
    EXPECT_EQ(report.at("unreferenced_vertices"), 2);
    EXPECT_EQ(report.at("degenerate_triangles"), 1);
    EXPECT_GE(report.at("nonmanifold_edges"), 1);
    EXPECT_GE(report.at("zero_length_edges"), 1);
    EXPECT_GE(report.at("warnings").size(), 4u);
    const auto values = npy::read<float>(path("c.npy")).data;
    ASSERT_EQ(values.size(), 16u);
    EXPECT_EQ(values[12], 0.0f);
    for (float v : values) EXPECT_TRUE(std::isfinite(v));
}

TEST_F(CliCurvature, TrianglesThatFaceAnotherWayAreToldOrTurned) {
    std::ifstream file(icosahedron());
    std::string text(std::istreambuf_iterator<char>(file), {});
    text.replace(text.find("3 0 11 5\n"), 8, "3 0 5 11");
    const std::string mesh = write("turned.off", text);
    const auto report = [&](std::vector<std::string> more, int exitCode) {
        std::vector<std::string> all = {"curvature", mesh, "-o", path("c.npy"), "--json"};
        all.insert(all.end(), more.begin(), more.end());
        const Result result = run(all);
        EXPECT_EQ(result.exitCode, exitCode) << result.err;
        return exitCode ? nlohmann::json() : result.json();
    };
    nlohmann::json told = report({}, 0);
    EXPECT_EQ(told.at("inconsistent_edges"), 3);
    EXPECT_EQ(told.at("low_degree_fits"), 12) << "two rings of five tell no cubic";
    ASSERT_EQ(told.at("warnings").size(), 1u);
    EXPECT_EQ(told.at("warnings")[0].get<std::string>().find("1 triangle faces another way"), 0u);
    report({"--strict"}, 3);
    told = report({"--orient", "--strict"}, 0);
    EXPECT_EQ(told.at("inconsistent_edges"), 0);
    EXPECT_EQ(told.at("triangles_turned"), 1);
    const auto values = npy::read<float>(path("c.npy")).data;
    EXPECT_EQ(run({"curvature", icosahedron(), "-o", path("whole.npy")}).exitCode, 0);
    EXPECT_EQ(values, npy::read<float>(path("whole.npy")).data);
}

TEST_F(CliCurvature, BadMeshesAreRefusedWithTheirPlace) {
    const auto refused = [&](const std::string& name, const std::string& text, const std::string& message) {
        expectRefused({"curvature", write(name, text), "-o", path("c.npy")}, 3, message);
    };
    refused("nan.off", "OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "nan.off:4: ");
    refused("index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 5\n",
            "index.off:6: vertex index 5 is out of range");
    refused("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "index.obj:4: ");
    refused("empty.ply", "", "empty");
    refused("points.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "no face");
    refused("text.stl", "hello", "is not an STL file");
    expectRefused({"curvature", path("none.off"), "-o", path("c.npy")}, 3, "No such file");
    expectRefused({"curvature", write("m.fbx", "x"), "-o", path("c.npy")}, 2, ".off, .obj, .ply, .stl");
}
