// The command line's contract: names, flags, exit codes, JSON on stdout and nothing else, no partial files.
#include <cmath>
#include <pellucid/pellucid.hpp>

#include "cli_run.h"
#include "io/image/image_file.h"
#include "io/lut/lut_file.h"
#include "io/mesh/mesh_file.h"
#include "npy.h"
#include "tolerances.h"

using namespace pellucid;

namespace {

class Cli : public CommandTest {
  protected:
    // A regular icosahedron of radius 2, faces outwards: its vertex normals are radial by symmetry.
    std::string icosahedron(const std::string& extraVertices = "", const std::string& extraFaces = "",
                            int vertices = 12, int faces = 20) const {
        const double g = (1 + std::sqrt(5.0)) / 2, scale = 2 / std::sqrt(1 + g * g), a = scale, b = g * scale;
        std::ostringstream text;
        text.precision(9);
        text << "OFF\n" << vertices << ' ' << faces << " 0\n";
        for (const auto& [x, y, z] : std::vector<std::array<double, 3>>{{-a, b, 0},
                                                                        {a, b, 0},
                                                                        {-a, -b, 0},
                                                                        {a, -b, 0},
                                                                        {0, -a, b},
                                                                        {0, a, b},
                                                                        {0, -a, -b},
                                                                        {0, a, -b},
                                                                        {b, 0, -a},
                                                                        {b, 0, a},
                                                                        {-b, 0, -a},
                                                                        {-b, 0, a}}) {
            text << x << ' ' << y << ' ' << z << '\n';
        }
        text << extraVertices;
        for (const char* face : {"0 11 5",  "0 5 1",  "0 1 7",  "0 7 10", "0 10 11", "1 5 9", "5 11 4",
                                 "11 10 2", "10 7 6", "7 1 8",  "3 9 4",  "3 4 2",   "3 2 6", "3 6 8",
                                 "3 8 9",   "4 9 5",  "2 4 11", "6 2 10", "8 6 7",   "9 8 1"}) {
            text << "3 " << face << '\n';
        }
        return write("mesh.off", text.str() + extraFaces);
    }
};

}  // namespace

TEST_F(Cli, DevicesAreListed) {
    const Result text = run({"devices"});
    EXPECT_EQ(text.exitCode, 0) << text.err;
    const Result result = run({"devices", "--json"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const nlohmann::json report = result.json();
    expectReport(report);
    const std::vector<PelDeviceInfo> devices = Device::all();
    ASSERT_EQ(report.at("devices").size(), devices.size());
    for (size_t i = 0; i < devices.size(); ++i) {
        const auto& d = report["devices"][i];
        EXPECT_EQ(d.at("name"), devices[i].name);
        EXPECT_EQ(d.at("compute_units"), devices[i].computeUnits);
        EXPECT_EQ(d.at("global_memory_bytes"), devices[i].globalMemoryBytes);
        EXPECT_TRUE(contains(text.out, devices[i].name));
        for (const char* key : {"version", "driver", "type", "platform", "preferred_float_width", "quirks"})
            EXPECT_TRUE(d.contains(key));
    }
}

TEST_F(Cli, DevicesAreChosenOrNamedMissing) {
    const Result byNumber = run({"devices", "--json", "--device", "0"});
    EXPECT_EQ(byNumber.exitCode, 0);
    EXPECT_EQ(byNumber.json().at("default"), 0);
    expectRefused({"devices", "--device", "no such device"}, 4, "no such device");
    expectRefused({"devices"}, 4, "abacus", "PELLUCID_DEVICE=abacus");
    // No OpenCL platform at all: the loader is shown an empty folder of drivers.
    std::filesystem::create_directories(path("no-icds"));
    expectRefused({"lut", "curvature", "-o", path("l.npy")}, 4, "pocl-opencl-icd",
                  "OCL_ICD_VENDORS=" + path("no-icds"));
}

TEST_F(Cli, WrongUseIsRefused) {
    expectRefused({}, 2, "subcommand");
    expectRefused(
        {"lut", "curvatur"}, 2,
        "no subcommand 'lut curvatur'; did you mean curvature? there are curvature, shadow, specular");
    expectRefused({"curvatur"}, 2, "curvatur");
    expectRefused({"lut", "curvature"}, 2, "--output");
    expectRefused({"lut", "curvature", "-o", path("l.npy"), "--sise", "8x8"}, 2,
                  "pellucid lut curvature has no '--sise'; did you mean --size?");
    expectRefused({"shde"}, 2, "no subcommand 'shde'; did you mean shade?");
    for (const char* size : {"8", "8x", "0x8", "-1x8", "8x8x8", "eight"}) {
        expectRefused({"lut", "curvature", "-o", path("l.npy"), std::string("--size=") + size}, 2, "--size");
    }
    expectRefused({"lut", "curvature", "-o", path("l.npy"), "--form", "cube"}, 2, "arc");
    expectRefused({"lut", "curvature", "-o", path("l.gif")}, 2, ".exr");
    expectRefused({"lut", "curvature", "-o", path("l.png"), "--encoding", "float"}, 2, "faceworks8");
    expectRefused({"lut", "curvature", "-o", path("l.npy"), "--radius-min", "-1"}, 2, "radius");
    expectRefused({"lut", "curvature", "-o", path("l.npy"), "--radius-min", "9", "--radius-max", "3"}, 2,
                  "radius");
    expectRefused({"lut", "shadow", "-o", path("l.npy"), "--sharpening", "0.5"}, 2, "sharpening");
    expectRefused({"lut", "shadow", "-o", path("l.npy"), "--diffusion-radius", "-1"}, 2, "diffusionRadius");
    const std::string mesh = icosahedron();
    expectRefused({"curvature", mesh, "-o", path("c.obj")}, 2, ".npy, .ply");
    expectRefused({"curvature", mesh, "-o", path("c.npy"), "--estimator", "guess"}, 2, "edge");
    expectRefused({"curvature", mesh, "-o", path("c.npy"), "--smooth", "-1"}, 2, "--smooth");
    expectRefused({"curvature", mesh, "-o", path("c.npy"), "--estimator", "edge", "--quantity", "mean"}, 2,
                  "tensor or quadric");
    expectRefused({"curvature", mesh, "-o", path("c.npy"), "--quantity", "size"}, 2, "gaussian");
    expectRefused({"curvature", mesh, "-o", path("c.npy"), "--weld", "-1"}, 2, "tolerance above 0");
    expectRefused({"curvature", mesh, "-o", path("c.npy"), "--smooth-radius", "-1"}, 2, "--smooth-radius");
    expectRefused({"curvature", mesh, "-o", path("c.npy"), "--smooth-weights", "length"}, 2, "cotangent");
    expectRefused({"curvature", mesh, "-o", path("c.ply"), "--range", "2", "1"}, 2, "lower one first");
    expectRefused({"curvature", mesh, "-o", path("c.ply"), "--range", "2"}, 2, "--range");
    expectRefused({"curvature", mesh, "-o", path("c.npy"), "--picture", path("c.jpg")}, 2, ".png");
    expectRefused({"curvature", mesh, "-o", path("c.npy"), "--scale", "nan"}, 2, "scale");
}

TEST_F(Cli, UnwritableOutputsAreRefusedBeforeWork) {
    const std::string mesh = icosahedron();
    expectRefused({"curvature", mesh, "-o", path("no/such/c.npy")}, 2, "no folder");
    expectRefused({"lut", "shadow", "-o", path("no/l.exr")}, 2, "no folder");
    std::filesystem::create_directories(path("d.npy"));
    expectRefused({"lut", "shadow", "-o", path("d.npy")}, 2, "is a folder");
}

TEST_F(Cli, CurvatureOfASphereLikeMesh) {
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
    ASSERT_EQ(run({"curvature", mesh, "-o", path("s.npy"), "--estimator", "edge", "--scale", "4"}).exitCode, 0);
    for (float v : npy::read<float>(path("s.npy")).data)
        EXPECT_NEAR(v, 2.0f, 2.0f * tolerance::edgeCurvature);
}

TEST_F(Cli, CurvatureQuantitiesWeldAndPicture) {
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
        const size_t vertices = bytes.find("end_header\n") + 11, stride = 31;  // position, normal, quality, colour
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

TEST_F(Cli, WhatCanBeRepairedIsCounted) {
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

TEST_F(Cli, TrianglesThatFaceAnotherWayAreToldOrTurned) {
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

TEST_F(Cli, BadMeshesAreRefusedWithTheirPlace) {
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
    expectRefused({"curvature", write("m.fbx", "x"), "-o", path("c.npy")}, 3, ".off, .obj, .ply, .stl");
}

TEST_F(Cli, LutFilesHoldTheLibrarysTexels) {
    const Device device("");
    PelCurvatureLutDesc desc = pelCurvatureLutDescDefaults();
    desc.width = 24;
    desc.height = 10;
    desc.radiusMin = 2;
    desc.radiusMax = 50;
    const Lut expected(device, desc);
    const std::vector<std::string> common = {"lut",   "curvature",    "--preset", "faceworks",    "--size",
                                             "24x10", "--radius-min", "2",        "--radius-max", "50",
                                             "-o"};
    const auto make = [&](const std::string& name, const std::string& encoding) {
        std::vector<std::string> arguments = common;
        arguments.push_back(path(name));
        if (!encoding.empty()) arguments.insert(arguments.end(), {"--encoding", encoding});
        arguments.push_back("--json");
        const Result result = run(arguments);
        ASSERT_EQ(result.exitCode, 0) << result.err;
        expectReport(result.json());
        EXPECT_EQ(result.json().at("texels"), 240);
        EXPECT_GT(result.json().at("device_ms").get<double>(), 0.0);
    };
    make("f.npy", "");
    const auto array = npy::read<float>(path("f.npy"));
    EXPECT_EQ(array.shape, (std::vector<size_t>{10, 24, 3}));
    EXPECT_EQ(array.data, expected.read<float>(PEL_LUT_FLOAT));
    make("f.exr", "float");
    const Lut again = io::readLut(device, path("f.exr"));
    EXPECT_EQ(again.read<float>(PEL_LUT_FLOAT), array.data);
    EXPECT_EQ(again.info().curvature.radiusMax, 50.0f);
    make("b.npy", "faceworks8");
    const auto bytes = npy::read<uint8_t>(path("b.npy"));
    EXPECT_EQ(bytes.shape, (std::vector<size_t>{10, 24, 4}));
    EXPECT_EQ(bytes.data, expected.read<uint8_t>(PEL_LUT_FACEWORKS8));
    for (const char* name : {"b.png", "b.bmp"}) {
        make(name, "faceworks8");
        const io::Image image = io::readImage(path(name));
        ASSERT_EQ(image.channels.size(), 4u);
        for (size_t i = 0; i < bytes.data.size(); ++i) {
            ASSERT_EQ(std::lround(255 * image.channels[i % 4].pixels[i / 4]), bytes.data[i]) << name << ' ' << i;
        }
    }
    EXPECT_EQ(run({"lut", "curvature", "--preset", "faceworks", "--size", "24x10", "--radius-min", "0.5",
                   "--encoding", "faceworks8", "-o", path("c.png"), "--json"})
                  .json()
                  .at("clipped_texels"),
              [&] {
                  desc = pelCurvatureLutDescDefaults();
                  desc.width = 24;
                  desc.height = 10;
                  desc.radiusMin = 0.5;
                  return Lut(device, desc).clippedTexels();
              }());
    make("h.exr", "half");
    EXPECT_EQ(io::readImage(path("h.exr")).channels[0].type, io::ChannelType::Half);
}

// Without more, the tables that a material makes of its profile; by a preset those of FaceWorks; and what is asked for by itself counts.
TEST_F(Cli, TablesAreAMaterialsUnlessAPresetSaysOtherwise) {
    const Device device("");
    const auto info = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "lut");
        arguments.insert(arguments.end(), {"-o", path("p.exr")});
        const Result result = run(arguments);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return io::readLut(device, path("p.exr")).info();
    };
    PelLutInfo i = info({"curvature"});
    EXPECT_EQ(i.curvature.form, PEL_FORM_SPHERE);
    EXPECT_EQ(i.curvature.axis, PEL_AXIS_ROOT);
    EXPECT_EQ(i.curvature.width, 64u);
    i = info({"curvature", "--preset", "faceworks", "--size", "32x8"});
    EXPECT_EQ(i.curvature.form, PEL_FORM_ARC);
    EXPECT_EQ(i.curvature.axis, PEL_AXIS_LINEAR);
    EXPECT_EQ(i.curvature.height, 8u);
    EXPECT_EQ(info({"curvature", "--preset", "faceworks", "--size", "32x8", "--axis", "root"}).curvature.axis,
              PEL_AXIS_ROOT);
    i = info({"shadow"});
    EXPECT_EQ(i.shadow.closedEnds, 1u);
    EXPECT_EQ(i.shadow.axis, PEL_AXIS_ROOT);
    EXPECT_EQ(i.shadow.height, 64u);
    EXPECT_EQ(info({"shadow", "--open-ends"}).shadow.closedEnds, 0u);
    i = info({"shadow", "--preset", "faceworks"});
    EXPECT_EQ(i.shadow.closedEnds, 0u);
    EXPECT_EQ(i.shadow.axis, PEL_AXIS_LINEAR);
    EXPECT_EQ(i.shadow.width, 512u);
    expectRefused({"lut", "shadow", "--preset", "unity", "-o", path("p.exr")}, 2, "faceworks");
}

// A .png that no encoding was asked for is there to be looked at, and the report says so.
TEST_F(Cli, ATableAsAPictureHasTheTablesValues) {
    const Result result = run({"lut", "shadow", "--size", "16x8", "-o", path("look.png"), "--json"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_TRUE(contains(result.json().at("encoding"), "picture"));
    ASSERT_EQ(run({"lut", "shadow", "--size", "16x8", "-o", path("t.exr"), "--json"}).json().at("encoding"),
              "float");
    const io::Image picture = io::readImage(path("look.png")), table = io::readImage(path("t.exr"));
    ASSERT_EQ(picture.channels.size(), 3u);
    for (const char* c : {"R", "G", "B"})
        for (size_t i = 0; i < 16 * 8; ++i) {
            const double x = std::clamp(double(table.channel(c).pixels[i]), 0.0, 1.0);
            const double srgb = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
            EXPECT_NEAR(255 * picture.channel(c).pixels[i], 255 * srgb, 0.51) << c << i;
        }
}

TEST_F(Cli, ShadowLutAndItsFlags) {
    ASSERT_EQ(run({"lut", "shadow", "-o", path("s.exr"), "--size", "16x8", "--width-min", "4", "--width-max",
                   "40", "--sharpening", "5", "--diffusion-radius", "1.5"})
                  .exitCode,
              0);
    const PelLutInfo info = io::readLut(Device(""), path("s.exr")).info();
    EXPECT_EQ(info.kind, PEL_LUT_SHADOW);
    EXPECT_EQ(info.shadow.width, 16u);
    EXPECT_EQ(info.shadow.height, 8u);
    EXPECT_EQ(info.shadow.widthMin, 4.0f);
    EXPECT_EQ(info.shadow.widthMax, 40.0f);
    EXPECT_EQ(info.shadow.sharpening, 5.0f);
    EXPECT_EQ(info.shadow.diffusionRadius, 1.5f);
}

// The viewer is the Python package's: what starts it hands its arguments over unread, and says what is missing.
TEST_F(Cli, ViewStartsThePython) {
    const std::string python = write("python", "#!/bin/sh\nprintf '%s\\n' \"$@\" | tail -n +7\n");
    std::filesystem::permissions(python, std::filesystem::perms::owner_all);
    setenv("PELLUCID_PYTHON", python.c_str(), 1);
    for (const std::string command : {"view", "gallery"}) {
        const Result handed = run({command, "--port", "8351", "head.obj", "--no-browser"});
        EXPECT_EQ(handed.exitCode, 0) << handed.err;
        EXPECT_NE(handed.out.find(command == "view" ? "pellucid.view\n" : "pellucid.view.gallery\n"), std::string::npos)
            << handed.out;
        EXPECT_NE(handed.out.find("--port\n8351\nhead.obj\n--no-browser\n"), std::string::npos) << handed.out;
    }
    setenv("PELLUCID_PYTHON", path("none").c_str(), 1);
    expectRefused({"view"}, 2, "cannot be started");
    unsetenv("PELLUCID_PYTHON");
}

// Every subcommand that has --device, by `describe`, asks for that device: none ignores it, and none is forgotten here.
TEST_F(Cli, EveryDeviceOptionIsHeard) {
    const std::string mesh = icosahedron(), manifest = write("m.toml", "[[lut]]\nsize = 8\n"),
                      out = path("out");
    const std::map<std::string, std::vector<std::string>> rest = {
        {"devices", {}},
        {"curvature", {mesh, "-o", out + ".npy"}},
        {"lut curvature", {"-o", out + ".exr"}},
        {"lut shadow", {"-o", out + ".exr"}},
        {"lut specular", {"-o", out + ".exr"}},
        {"lut eye", {"-o", out + ".exr"}},
        {"prefill", {}},
        {"shade", {"--outputs", "diffuse", mesh, "--scene", mesh, "-o", out + ".exr"}},
        {"reference", {mesh, "--scene", mesh, "-o", out + ".npy"}},
        {"import", {path("none.glb"), "-o", out}},
        {"batch", {manifest, "-o", scratch() + "/tables"}},
        {"demo", {"-o", scratch() + "/demo"}},
        {"bench", {"-o", scratch() + "/bench"}}};
    std::set<std::string> heard;
    const std::function<void(const nlohmann::json&, const std::string&)> walk = [&](const nlohmann::json& app,
                                                                                    const std::string& name) {
        for (const nlohmann::json& sub : app.at("subcommands"))
            walk(sub, name + (name.empty() ? "" : " ") + sub.at("name").get<std::string>());
        for (const nlohmann::json& option : app.at("options")) {
            const auto names = option.at("names").get<std::vector<std::string>>();
            if (std::find(names.begin(), names.end(), "--device") == names.end()) continue;
            ASSERT_TRUE(rest.contains(name)) << name << " has --device: add it here";
            std::vector<std::string> line;
            std::istringstream words(name);
            for (std::string word; words >> word;) line.push_back(word);
            line.insert(line.end(), {"--device", "no such device"});
            line.insert(line.end(), rest.at(name).begin(), rest.at(name).end());
            expectRefused(line, 4, "no such device");
            heard.insert(name);
        }
    };
    walk(run({"describe"}).json(), "");
    EXPECT_GE(heard.size(), 8u);
}
