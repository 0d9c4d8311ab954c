// `pellucid curvature`: meshes, what is wrong with them, results.
#include "cli_shade.h"
#include "io/mesh/mesh_file.h"
#include "npy.h"

using namespace pellucid;
using shade_files::octahedron;

namespace {

class CliCurvature : public CommandTest {
  protected:
    // What it writes of a mesh, and its report.
    std::vector<float> values(const std::string& mesh, const std::string& options) {
        write("m.off", mesh);
        report_ = reportOf("curvature @m.off -o @c.npy " + options);
        return npy::read<float>(path("c.npy")).data;
    }
    nlohmann::json report_;
};

}  // namespace

// The octahedron's normals point from its centre at radius 2: every edge turns as on the sphere.
TEST_F(CliCurvature, OfASphereLikeMesh) {
    const struct {
        const char* options;
        double expected, tolerance;
    } rows[] = {{"--estimator edge --smooth 3", 0.5, tolerance::edgeCurvature},
                {"--estimator edge --scale 4", 2, tolerance::edgeCurvature},
                {"--estimator tensor --quantity gaussian --weld exact --smooth 0 --smooth-radius 0.1 "
                 "--picture @m.png",
                 0.25, tolerance::tensorCurvature}};
    for (const auto& row : rows) {
        const std::vector<float> all = values(octahedron(), row.options);
        ASSERT_EQ(all.size(), 6u);
        for (float v : all) EXPECT_NEAR(v, row.expected, row.expected * row.tolerance) << row.options;
        expectReport(report_);
        EXPECT_EQ(report_.at("vertices"), 6);
        EXPECT_EQ(report_.at("triangles"), 8);
        EXPECT_EQ(report_.at("edges"), 12);
        EXPECT_TRUE(report_.at("warnings").empty());
    }
    expectKept("m.png", "curvature.png", "0.0003");
    EXPECT_TRUE(contains(done("curvature @m.off -o @c.ply").out, "curvature_max: "));
    EXPECT_EQ(io::loadMesh(path("c.ply")).positions, io::loadMesh(path("m.off")).positions);
}

TEST_F(CliCurvature, ColoursAndWeights) {
    // With one range, meshes of different curvature differ in colour; with their own ranges they look alike.
    write("m.off", octahedron());
    const auto colored = [&](const std::string& options) {
        done("curvature @m.off -o @r.ply --scale " + options);
        const std::string bytes = read(path("r.ply"));
        const size_t vertices = bytes.find("end_header\n") + 11, stride = 31;  // bytes of a vertex
        std::string colors;
        for (size_t v = 0; v < 6; ++v) colors += bytes.substr(vertices + v * stride + 28, 3);
        return colors;
    };
    EXPECT_EQ(colored("1"), colored("2"));
    EXPECT_NE(colored("1 --range 0 2"), colored("2 --range 0 2"));
    const std::string horned = octahedron("9 9 9\n", "3 0 2 6\n", "7 9");
    EXPECT_NE(values(horned, "--smooth-radius 0.6 --smooth-weights cotangent"),
              values(horned, "--smooth-radius 0.6 --smooth-weights area"));
}

TEST_F(CliCurvature, WhatCanBeRepairedIsCounted) {
    // Two unreferenced vertices, a repeated index, a third face on an edge, a zero-length edge.
    const auto all =
        values(octahedron("9 9 9\n9 9 9\n0 0 5\n0 0 5\n", "3 0 0 2\n3 0 2 8\n3 8 9 3\n", "10 11"),
               "--estimator edge");
    EXPECT_EQ(report_.at("unreferenced_vertices"), 2);
    EXPECT_EQ(report_.at("degenerate_triangles"), 1);
    EXPECT_GE(report_.at("nonmanifold_edges"), 1);
    EXPECT_GE(report_.at("zero_length_edges"), 1);
    EXPECT_GE(report_.at("warnings").size(), 4u);
    ASSERT_EQ(all.size(), 10u);
    EXPECT_EQ(all[6], 0.0f);
    for (float v : all) EXPECT_TRUE(std::isfinite(v));
}

// Which triangles these are: test_mesh_file.cpp.
TEST_F(CliCurvature, TrianglesThatFaceAnotherWayAreToldOrTurned) {
    std::string turned = octahedron();
    turned.replace(turned.find("3 0 2 4\n"), 7, "3 2 0 4");
    values(turned, "");
    EXPECT_EQ(report_.at("inconsistent_edges"), 3);
    EXPECT_EQ(report_.at("low_degree_fits"), 6) << "two rings of four tell no cubic";
    EXPECT_EQ(report_.at("warnings").size(), 1u);
    EXPECT_EQ(cli("curvature @m.off -o @c.npy --strict").exitCode, 3);
    EXPECT_EQ(values(turned, "--orient --strict"), values(octahedron(), ""));
}
