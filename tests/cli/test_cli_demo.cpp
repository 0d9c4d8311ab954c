// `pellucid demo`: mesh in, pictures out, and `pellucid shade` makes the same of what it leaves.
#include <cmath>
#include <cstring>
#include <sstream>

#include "cli_run.h"
#include "io/image/image_file.h"
#include "io/scene/scene_file.h"

using namespace pellucid;

using Demo = CommandTest;

TEST_F(Demo, PicturesAreThoseThatShadeMakesOfItsGBuffer) {
    // A bumpy ball of 1 cm: quick, and it has a terminator, shadows and rims.
    std::ostringstream mesh;
    const int columns = 48, rows = 24;
    mesh << "OFF\n" << columns * (rows - 1) + 2 << ' ' << columns * 2 * (rows - 1) << " 0\n0 0 10\n";
    for (int r = 1; r < rows; ++r) {
        for (int c = 0; c < columns; ++c) {
            const double theta = M_PI * r / rows, phi = 2 * M_PI * c / columns;
            const double radius = 10 + 1.5 * std::sin(2 * phi) * std::sin(theta);
            mesh << radius * std::sin(theta) * std::cos(phi) << ' '
                 << radius * std::sin(theta) * std::sin(phi) << ' ' << radius * std::cos(theta) << '\n';
        }
    }
    const int south = columns * (rows - 1) + 1;
    mesh << "0 0 -10\n";
    for (int c = 0; c < columns; ++c) {
        const int next = (c + 1) % columns;
        mesh << "3 0 " << 1 + c << ' ' << 1 + next << '\n';
        for (int r = 0; r + 2 < rows; ++r) {
            const int a = 1 + r * columns + c, b = 1 + r * columns + next;
            mesh << "3 " << a << ' ' << a + columns << ' ' << b << "\n3 " << b << ' ' << a + columns << ' '
                 << b + columns << '\n';
        }
        mesh << "3 " << 1 + (rows - 2) * columns + c << ' ' << south << ' ' << 1 + (rows - 2) * columns + next
             << '\n';
    }
    const std::string ball = write("ball.off", mesh.str());
    const Result demo =
        run({"demo", ball, "-o", path("demo"), "--size", "160x90", "--height", "20", "--json"});
    ASSERT_EQ(demo.exitCode, 0) << demo.err;
    expectReport(demo.json());
    EXPECT_GE(demo.json().at("stages").size(), 6u);
    const auto report = demo.json();
    for (const auto& entry : report.at("pictures")) {
        EXPECT_GT(std::filesystem::file_size(entry.get<std::string>()), 0u) << entry;
    }
    for (const std::string view : {"key", "backlit"}) {
        const std::string base = path("demo/" + view);
        const Result again =
            run({"shade", base + "_gbuffer.exr", "--scene", base + ".toml", "-o", path("again.exr")});
        ASSERT_EQ(again.exitCode, 0) << again.err;
        const io::Image first = io::readImage(base + ".exr"), second = io::readImage(path("again.exr"));
        double light = 0;
        for (const char* name : {"R", "G", "B"}) {
            const std::vector<float>&a = first.channel(name).pixels, &b = second.channel(name).pixels;
            ASSERT_EQ(a.size(), 160u * 90u);
            ASSERT_EQ(a.size(), b.size());
            EXPECT_EQ(std::memcmp(a.data(), b.data(), 4 * a.size()), 0) << view << ' ' << name;
            for (float v : a) light += v;
        }
        EXPECT_GT(light, 0);
    }
    // Every number of a stage is a number, with its unit in the key.
    for (const auto& stage : report.at("stages"))
        for (const auto& [key, value] : stage.items()) {
            ASSERT_EQ(value.is_string(), key == "stage") << stage;
            if (key == "stage") continue;
            EXPECT_TRUE(key.ends_with("_ms") || key == "bytes" ||
                        stage.contains(key.substr(0, key.find("_per"))))
                << key;
            if (key.ends_with("_per_second")) {
                EXPECT_LT(value.get<double>(), 1e11) << stage;
            }
        }
    // The scenes of which bench/roofline counts instructions can be made of the demo's, and can be read.
    ASSERT_EQ(
        std::system(
            ("python3 '" PELLUCID_SOURCE_DIR "/bench/roofline' --scenes '" + path("demo") + "'").c_str()),
        0);
    for (const std::string scene : {"surface", "taps", "wide", "blur"}) {
        const io::SceneFile read = io::readScene(path("demo/" + scene + ".toml"));
        EXPECT_EQ(read.lights.size(), 1u) << scene;
        EXPECT_EQ(read.materials.at(0).material.scattering, PEL_SCATTERING_PREINTEGRATED) << scene;
    }
    expectRefused({"demo", path("none.off"), "-o", path("demo")}, 3, "No such file");
    expectRefused({"demo", ball, "-o", ball}, 2, "ball.off");
    expectRefused({"demo", ball, "-o", path("demo"), "--size", "0x0"}, 2, "--size");
}
