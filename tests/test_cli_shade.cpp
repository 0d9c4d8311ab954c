// `pellucid shade` and `pellucid demo`: G-buffer and scene file in, pictures out.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "cli_run.h"
#include "io/image_file.h"
#include "io/scene_file.h"
#include "tolerances.h"

using namespace pellucid;

namespace {

constexpr int width = 12, height = 5;
const std::vector<std::string> normalNames = {"View.N.X", "View.N.Y", "View.N.Z"};
const std::vector<std::string> albedoNames = {"View.Col.R", "View.Col.G", "View.Col.B"};

class Shade : public CommandTest {
  protected:
    // Normals that turn from left to right, a background of two columns, one light from +z.
    void SetUp() override {
        CommandTest::SetUp();
        gbuffer_.width = width;
        gbuffer_.height = height;
        std::vector<float> normals, albedos, ids;
        for (int i = 0; i < width * height; ++i) {
            const float angle = 0.2f * static_cast<float>(i % width);
            normals.insert(normals.end(), {std::sin(angle), 0.0f, std::cos(angle)});
            albedos.insert(albedos.end(), {0.5f, 0.25f, 0.125f});
            ids.push_back(i % width < 2 ? 0.0f : 1.0f);
        }
        gbuffer_.addInterleaved(normalNames, normals);
        gbuffer_.addInterleaved(albedoNames, albedos, io::ChannelType::Half);
        gbuffer_.addInterleaved(std::vector<std::string>{"View.Id.X"}, ids);
        io::writeExr(path("g.exr"), gbuffer_);

        scene_.channels[PEL_SLOT_NORMAL_SHADING] = {"N.X", "N.Y", "N.Z"};
        scene_.channels[PEL_SLOT_ALBEDO] = albedoNames;
        scene_.channels[PEL_SLOT_MATERIAL] = {"Id.X"};
        scene_.materials.resize(1);
        scene_.lights.resize(1);
        const float color[3] = {2.0f, 1.0f, 0.5f};
        std::copy(color, color + 3, scene_.lights[0].light.color);
        io::writeScene(path("s.toml"), scene_);
    }
    std::vector<std::string> command(const std::string& scene = "s.toml",
                                     const std::string& gbuffer = "g.exr") const {
        return {"shade", path(gbuffer), "--scene", path(scene), "-o", path("o.exr")};
    }

    io::Image gbuffer_;
    io::SceneFile scene_;
};

}  // namespace

TEST_F(Shade, TablesOfMaterialsAndProfileFiles) {
    // The same profile as a file beside the scene and as an EXR made from it; another material looks
    // otherwise.
    write("own.toml",
          "name = \"own\"\nsource = \"a test\"\nkind = \"table\"\nunit = \"mm\"\n[[sample]]\ndistance = 0\n"
          "value = [3, 2, 1]\n[[sample]]\ndistance = 4\nvalue = [0.1, 0.1, 0]\n");
    io::Image curved = gbuffer_;
    curved.addInterleaved(std::vector<std::string>{"View.C.X"},
                          std::vector<float>(size_t(width * height), 0.3f));
    io::writeExr(path("c.exr"), curved);
    scene_.channels[PEL_SLOT_CURVATURE] = {"C.X"};
    scene_.materials[0].curvatureLut = "t";
    ASSERT_EQ(run({"lut", "curvature", "--profile", path("own.toml"), "--axis", "root", "--size", "64x16",
                   "-o", path("t.exr")})
                  .exitCode,
              0);
    const auto shaded = [&](const std::string& profile, const std::string& file) {
        io::SceneLut lut;
        lut.name = "t";
        lut.profile = profile;
        lut.file = file;
        lut.info.curvature.axis = PEL_AXIS_ROOT;
        lut.info.curvature.width = 64;
        lut.info.curvature.height = 16;
        lut.info.curvature.diffusionRadius = 0;
        scene_.luts = {lut};
        io::writeScene(path("p.toml"), scene_);
        const Result result = run(command("p.toml", "c.exr"));
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return io::readImage(path("o.exr")).channel("R").pixels;
    };
    const auto own = shaded("own.toml", "");
    EXPECT_EQ(own, shaded("", "t.exr"));
    EXPECT_NE(own, shaded("marble", ""));
    scene_.luts[0].profile = "granite";  // no such material
    io::writeScene(path("p.toml"), scene_);
    expectRefused(command("p.toml", "c.exr"), 3, "granite");
}

TEST_F(Shade, PlainLightIsAlbedoTimesCosine) {
    std::vector<std::string> arguments = command();
    arguments.insert(arguments.end(), {"--json", "--stats"});
    const Result result = run(arguments);
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const nlohmann::json report = result.json();
    expectReport(report);
    EXPECT_EQ(report.at("pixels"), width * height);
    EXPECT_EQ(report.at("stats").at("pixels_shaded"), (width - 2) * height);
    const io::Image shaded = io::readImage(path("o.exr"));
    ASSERT_EQ(shaded.width, width);
    ASSERT_EQ(shaded.height, height);
    const float color[3] = {2.0f, 1.0f, 0.5f}, albedo[3] = {0.5f, 0.25f, 0.125f};
    for (size_t c = 0; c < 3; ++c) {
        const std::vector<float>& pixels = shaded.channel(std::string(1, "RGB"[c])).pixels;
        for (size_t i = 0; i < pixels.size(); ++i) {
            const size_t column = i % width;
            const float lit = std::max(0.0f, std::cos(0.2f * static_cast<float>(column)));
            EXPECT_NEAR(pixels[i], column < 2 ? 0.0f : albedo[c] * color[c] * lit, tolerance::shadeTerm) << i;
        }
    }
}

TEST_F(Shade, MissingChannelsAreAnsweredWithThoseFound) {
    scene_.channels[PEL_SLOT_CURVATURE] = {"Curvature.V"};
    io::writeScene(path("c.toml"), scene_);
    expectRefused(command("c.toml"), 3,
                  "has no channel 'Curvature.V'; it has: View.Col.R, View.Col.G, View.Col.B, View.Id.X, "
                  "View.N.X, View.N.Y, View.N.Z");
    scene_.channels[PEL_SLOT_CURVATURE].clear();
    scene_.lights[0].wideShadow = "W";
    io::writeScene(path("w.toml"), scene_);
    expectRefused(command("w.toml"), 3, "has no channel 'W'");
}

TEST_F(Shade, BadScenesNameFileAndLine) {
    std::string text = read(path("s.toml"));
    const auto refused = [&](const std::string& from, const std::string& to, const std::string& message) {
        std::string changed = text;
        const size_t at = changed.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        changed.replace(at, from.size(), to);
        const auto line = std::count(changed.begin(), changed.begin() + static_cast<long>(at), '\n') + 1;
        write("bad.toml", changed);
        expectRefused(command("bad.toml"), 3, "bad.toml:" + std::to_string(line) + ": ");
        expectRefused(command("bad.toml"), 3, message);
    };
    refused("diffusion_radius = ", "diffusion_radius = -", "must be more than 0");
    refused("diffusion_radius", "difusion_radius", "did you mean 'diffusion_radius'?");
    refused("roughness = 0.3", "roughness = \"low\"", "is a string; a number would be right");
    expectRefused(command("none.toml"), 3, "none.toml: cannot be read");
}

TEST_F(Shade, BadFilesAreRefused) {
    expectRefused(command("s.toml", "none.exr"), 3, "none.exr: cannot be read");
    write("text.exr", "no image at all");
    expectRefused(command("s.toml", "text.exr"), 3, "text.exr");
    const std::string whole = read(path("g.exr"));
    write("cut.exr", whole.substr(0, whole.size() - 30));
    expectRefused(command("s.toml", "cut.exr"), 3, "cut.exr");
    scene_.lights[0].shadowMapFile = "none.exr";
    io::writeScene(path("map.toml"), scene_);
    scene_.materials[0].material.deepScatterColor[0] = 1;
    expectRefused(command("map.toml"), 3, "none.exr: cannot be read");
    scene_.lights[0].shadowMapFile.clear();
    scene_.luts.resize(1);
    scene_.luts[0].name = "t";
    scene_.luts[0].file = "g.exr";  // an image, but no look-up table
    scene_.materials[0].curvatureLut = "t";
    io::writeScene(path("lut.toml"), scene_);
    expectRefused(command("lut.toml"), 3, "pellucid:format");
    // A look-up table, but not the one that is asked for.
    ASSERT_EQ(run({"lut", "shadow", "-o", path("t.exr"), "--size", "8x8"}).exitCode, 0);
    scene_.luts[0].file = "t.exr";
    io::writeScene(path("lut.toml"), scene_);
    expectRefused(command("lut.toml"), 3, "kind is shadow; curvature is asked for");
    ASSERT_EQ(run({"lut", "curvature", "-o", path("t.exr"), "--size", "8x8", "--axis", "root"}).exitCode, 0);
    EXPECT_EQ(run(command("lut.toml")).exitCode, 0);
    const std::string asking = read(path("lut.toml"));
    const auto expecting = [&](const std::string& keys) {
        std::string text = asking;
        text.replace(text.find("file = \"t.exr\""), 14, "file = \"t.exr\"\n" + keys);
        write("asking.toml", text);
        return command("asking.toml");
    };
    EXPECT_EQ(run(expecting("axis = \"root\"\nwidth = 8\nradius_max = 100")).exitCode, 0);
    expectRefused(expecting("axis = \"linear\""), 3, "axis is root; linear is asked for");
    expectRefused(expecting("form = \"sphere\""), 3, "form is arc; sphere is asked for");
    expectRefused(expecting("radius_min = 0.5"), 3, "radius_min is 1; 0.5 is asked for");
    expectRefused(expecting("diffusion_radius = 3"), 3, "diffusion_radius is 2.7; 3 is asked for");
    expectRefused({"shade", path("g.exr"), "--scene", path("s.toml"), "-o", path("no/o.exr")}, 2,
                  "no folder");
    expectRefused({"shade", path("g.exr"), "--scene", path("s.toml"), "-o", path("o.png")}, 2, ".exr");
    expectRefused({"shade", path("g.exr"), "-o", path("o.exr")}, 2, "--scene");
}

TEST_F(Shade, GBuffersOfARealHostGiveItsLambertPictures) {
    const char* folder = std::getenv("PELLUCID_GBUFFER_DIR");
    if (!folder) GTEST_SKIP() << "PELLUCID_GBUFFER_DIR names no folder with G-buffers of a real host";
    // Blender's conventions: position in cm, z up; a sun of strength pi is irradiance / pi of 1; the Shadow
    // pass of a Lambert material is the share of light that arrives.
    io::SceneFile scene;
    scene.channels[PEL_SLOT_NORMAL_SHADING] = {"NShading.R", "NShading.G", "NShading.B"};
    scene.channels[PEL_SLOT_POSITION] = {"Position.X", "Position.Y", "Position.Z"};
    scene.channels[PEL_SLOT_ALBEDO] = {"DiffCol.R", "DiffCol.G", "DiffCol.B"};
    scene.channels[PEL_SLOT_MATERIAL] = {"SkinMask.X"};
    scene.materials.resize(1);
    scene.lights.resize(1);
    const float toLight[3] = {0.7990018725f, -0.4494385421f, 0.3995009363f};  // of *_side.json
    std::copy(toLight, toLight + 3, scene.lights[0].light.toLight);
    scene.lights[0].wideShadow = "Shadow.R";
    io::writeScene(path("host.toml"), scene);
    for (const std::string name : {"sphere10", "head"}) {
        const std::string base = std::string(folder) + "/" + name;
        const Result result =
            run({"shade", base + "_gbuf.exr", "--scene", path("host.toml"), "-o", path("o.exr")});
        ASSERT_EQ(result.exitCode, 0) << result.err;
        const io::Image shaded = io::readImage(path("o.exr")),
                        truth = io::readImage(base + "_side_lambert.exr");
        const std::vector<float>& mask = truth.channel("Combined.A").pixels;
        for (const char* channel : {"R", "G", "B"}) {
            const std::vector<float>&a = shaded.channel(channel).pixels,
                  &b = truth.channel(std::string("Combined.") + channel).pixels;
            double sum = 0, count = 0;
            for (size_t i = 0; i < a.size(); ++i) {
                if (mask[i] == 0) continue;
                sum += (a[i] - b[i]) * (a[i] - b[i]);
                ++count;
            }
            ASSERT_GT(count, 10000);
            EXPECT_LT(std::sqrt(sum / count), tolerance::realHostLambert) << name << ' ' << channel;
        }
    }
}

TEST_F(Shade, DemoPicturesAreThoseThatShadeMakesOfItsGBuffer) {
    // A bumpy ball of 1 cm: quick, and it has a terminator, shadows and rims.
    std::ostringstream mesh;
    const int columns = 48, rows = 24;
    mesh << "OFF\n" << columns * (rows - 1) + 2 << ' ' << columns * 2 * (rows - 1) << " 0\n0 0 1\n";
    for (int r = 1; r < rows; ++r) {
        for (int c = 0; c < columns; ++c) {
            const double theta = M_PI * r / rows, phi = 2 * M_PI * c / columns;
            const double radius = 1 + 0.15 * std::sin(3 * phi) * std::sin(theta);
            mesh << radius * std::sin(theta) * std::cos(phi) << ' '
                 << radius * std::sin(theta) * std::sin(phi) << ' ' << radius * std::cos(theta) << '\n';
        }
    }
    const int south = columns * (rows - 1) + 1;
    mesh << "0 0 -1\n";
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
    const Result demo = run({"demo", ball, "-o", path("demo"), "--size", "160x90", "--json"});
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
    expectRefused({"demo", path("none.off"), "-o", path("demo")}, 3, "No such file");
    expectRefused({"demo", ball, "-o", ball}, 2, "ball.off");
    expectRefused({"demo", ball, "-o", path("demo"), "--size", "0x0"}, 2, "--size");
}
