// The command line's contract: names, flags, exit codes, JSON on stdout and nothing else, no partial files.
#include <pellucid/pellucid.hpp>

#include "cli_mesh.h"

using namespace pellucid;

using Cli = CommandOnMesh;

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
    expectRefused({"shade", "--exposre", "2"}, 2,
                  "pellucid shade has no '--exposre'; did you mean --exposure?");
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

// The viewer is part of the Python package: the command passes all arguments on, and names what is missing.
TEST_F(Cli, ViewStartsThePython) {
    const std::string python = write("python", "#!/bin/sh\nprintf '%s\\n' \"$@\" | tail -n +7\n");
    std::filesystem::permissions(python, std::filesystem::perms::owner_all);
    setenv("PELLUCID_PYTHON", python.c_str(), 1);
    for (const std::string command : {"view", "gallery"}) {
        const Result handed = run({command, "--port", "8351", "head.obj", "--no-browser"});
        EXPECT_EQ(handed.exitCode, 0) << handed.err;
        EXPECT_NE(handed.out.find(command == "view" ? "pellucid.view\n" : "pellucid.view.gallery\n"),
                  std::string::npos)
            << handed.out;
        EXPECT_NE(handed.out.find("--port\n8351\nhead.obj\n--no-browser\n"), std::string::npos) << handed.out;
    }
    setenv("PELLUCID_PYTHON", path("none").c_str(), 1);
    expectRefused({"view"}, 2, "cannot be started");
    unsetenv("PELLUCID_PYTHON");
}

// Every subcommand that has --device, by `describe`, opens that device.
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
        {"warm-up", {}},
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
