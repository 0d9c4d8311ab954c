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

TEST_F(Shade, CurvatureFromThePictureItself) {
    // A ball of radius 4 seen from the front: its picture says 0.25 everywhere, as a channel of 0.25 does.
    const int side = 24;
    const float radius = 4, pixel = 0.2f;
    io::Image ball;
    ball.width = ball.height = side;
    std::vector<float> normals, positions, bumpy;
    for (int i = 0; i < side * side; ++i) {
        const float x = pixel * (float(i % side) - 11.5f), y = pixel * (11.5f - float(i / side));
        const float z = std::sqrt(radius * radius - x * x - y * y);
        positions.insert(positions.end(), {x, y, z});
        normals.insert(normals.end(), {x / radius, y / radius, z / radius});
        const float bump = i % 2 ? 0.1f : -0.1f;  // of a normal map: turns without the surface doing so
        bumpy.insert(bumpy.end(), {x / radius + bump, y / radius, z / radius});
    }
    const size_t pixels = size_t(side * side);
    ball.addInterleaved(std::vector<std::string>{"N.X", "N.Y", "N.Z"}, bumpy);
    ball.addInterleaved(std::vector<std::string>{"G.X", "G.Y", "G.Z"}, normals);
    ball.addInterleaved(std::vector<std::string>{"P.X", "P.Y", "P.Z"}, positions);
    ball.addInterleaved(std::vector<std::string>{"Col.R", "Col.G", "Col.B"}, std::vector<float>(3 * pixels, 0.5f));
    ball.addInterleaved(std::vector<std::string>{"Id.X"}, std::vector<float>(pixels, 1.0f));
    ball.addInterleaved(std::vector<std::string>{"Known.X"}, std::vector<float>(pixels, 1 / radius));
    ball.addInterleaved(std::vector<std::string>{"Twice.X"}, std::vector<float>(pixels, 2 / radius));
    io::writeExr(path("ball.exr"), ball);
    scene_.channels[PEL_SLOT_ALBEDO] = {"Col.R", "Col.G", "Col.B"};
    scene_.channels[PEL_SLOT_NORMAL_GEOMETRIC] = {"G.X", "G.Y", "G.Z"};
    scene_.channels[PEL_SLOT_POSITION] = {"P.X", "P.Y", "P.Z"};
    scene_.camera.position[2] = 50;
    const float sideways[3] = {0.96f, 0, 0.28f};
    std::copy(sideways, sideways + 3, scene_.lights[0].light.toLight);
    scene_.materials[0].curvatureLut = "skin";
    io::SceneLut lut;
    lut.name = "skin";
    lut.info.curvature.width = lut.info.curvature.height = 64;
    scene_.luts = {lut};
    const auto shaded = [&](const std::string& curvature) {
        scene_.channels[PEL_SLOT_CURVATURE] = {curvature};
        io::writeScene(path("ball.toml"), scene_);
        const Result result = run(command("ball.toml", "ball.exr"));
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return io::readImage(path("o.exr")).interleaved(std::vector<std::string>{"R", "G", "B"});
    };
    const std::vector<float> screen = shaded("screen"), known = shaded("Known.X"), twice = shaded("Twice.X");
    double most = 0;
    for (size_t i = 0; i < screen.size(); ++i) {
        EXPECT_NEAR(screen[i], known[i], tolerance::screenShaded);
        most = std::max<double>(most, std::abs(twice[i] - known[i]));
    }
    EXPECT_GT(most, 10 * tolerance::screenShaded) << "curvature must matter to this picture";

    scene_.channels[PEL_SLOT_POSITION].clear();
    scene_.channels[PEL_SLOT_CURVATURE] = {"screen"};
    io::writeScene(path("ball.toml"), scene_);
    expectRefused(command("ball.toml", "ball.exr"), 3, "[channels] curvature");
}

TEST_F(Shade, PartsOfThePictureAddUpToIt) {
    // A wall 3 thick, given per pixel; light from the front and from behind.
    io::Image thick = gbuffer_;
    thick.addInterleaved(std::vector<std::string>{"Wall.V"}, std::vector<float>(size_t(width * height), 3.0f));
    std::vector<float> positions;
    for (int i = 0; i < width * height; ++i) positions.insert(positions.end(), {float(i % width), float(i / width), 0.0f});
    thick.addInterleaved(std::vector<std::string>{"P.X", "P.Y", "P.Z"}, positions);
    io::writeExr(path("thick.exr"), thick);
    scene_.channels[PEL_SLOT_THICKNESS] = {"Wall.V"};
    scene_.channels[PEL_SLOT_POSITION] = {"P.X", "P.Y", "P.Z"};
    scene_.camera.position[2] = 50;
    scene_.lights.push_back(scene_.lights[0]);
    scene_.lights[1].light.toLight[2] = -1;
    std::fill_n(scene_.materials[0].material.deepScatterColor, 3, 0.5f);
    scene_.materials[0].material.specular = 1;
    scene_.outputs[PEL_SLOT_OUT_THICKNESS] = "own name.exr";  // beside the scene
    io::writeScene(path("parts.toml"), scene_);
    std::vector<std::string> arguments = command("parts.toml", "thick.exr");
    arguments.insert(arguments.end(), {"--outputs", "all", "--json", "--stats"});
    const Result result = run(arguments);
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto report = result.json();
    ASSERT_EQ(report.at("outputs").size(), 5u);
    for (const auto& file : report.at("outputs")) EXPECT_TRUE(std::filesystem::exists(file.get<std::string>())) << file;
    const auto channel = [&](const std::string& file, const std::string& name) {
        return io::readImage(path(file)).channel(name).pixels;
    };
    for (const char* name : {"R", "G", "B"}) {
        const auto sum = channel("o.exr", name), diffuse = channel("o_diffuse.exr", name),
                   deep = channel("o_deep_scatter.exr", name), specular = channel("o_specular.exr", name);
        double most[3] = {};
        for (size_t i = 0; i < sum.size(); ++i) {
            EXPECT_NEAR(sum[i], diffuse[i] + deep[i] + specular[i], 1e-6f);
            most[0] = std::max<double>(most[0], diffuse[i]), most[1] = std::max<double>(most[1], deep[i]);
            most[2] = std::max<double>(most[2], specular[i]);
        }
        for (double m : most) EXPECT_GT(m, 0.001);
    }
    const auto thickness = channel("o_thickness.exr", "Thickness.V");
    for (size_t i = 0; i < thickness.size(); ++i) EXPECT_EQ(thickness[i], i % width < 2 ? 0.0f : 3.0f);
    EXPECT_EQ(thickness, channel("own name.exr", "Thickness.V"));

    arguments = command("parts.toml", "thick.exr");
    arguments.insert(arguments.end(), {"--outputs", "diffus"});
    expectRefused(arguments, 2, "diffus");
    scene_.outputs[PEL_SLOT_OUT_THICKNESS] = "o.exr";
    io::writeScene(path("parts.toml"), scene_);
    expectRefused(command("parts.toml", "thick.exr"), 3, "written twice");
    scene_.outputs[PEL_SLOT_OUT_THICKNESS] = "o.png";
    io::writeScene(path("parts.toml"), scene_);
    expectRefused(command("parts.toml", "thick.exr"), 3, ".exr");
}

TEST_F(Shade, AnAmbientCubeIsReadFromAFile) {
    // Faces of one texel: +x is red, +z is blue, the others black; no lights.
    io::Image cube;
    cube.width = 1;
    cube.height = 6;
    std::vector<float> texels(18, 0.0f);
    texels[0] = 1, texels[14] = 1;
    cube.addInterleaved(std::vector<std::string>{"R", "G", "B"}, texels);
    io::writeExr(path("cube.exr"), cube);
    scene_.ambientCube = "cube.exr";
    scene_.lights.clear();
    scene_.materials[0].material.deepScatterAmbient = 0.5f;
    io::writeScene(path("cube.toml"), scene_);
    std::vector<std::string> arguments = command("cube.toml");
    arguments.insert(arguments.end(), {"--json", "--stats", "--outputs", "thickness"});
    const Result result = run(arguments);
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.json().at("stats").at("features"), nlohmann::json({"ambient", "outputs", "ambient_cube"}));
    EXPECT_NE(result.err.find("deep_scatter_ambient of material 1 does nothing"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("thickness output is 0 everywhere"), std::string::npos) << result.err;
    const io::Image shaded = io::readImage(path("o.exr"));
    for (size_t i = 2; i < size_t(width); ++i) {
        // From the middle of a face, 1, to the edge, where two faces meet, 1/2: linear in the tangent.
        const double angle = 0.2 * double(i), tangent = std::tan(angle);
        const double red = angle > M_PI / 4 ? 1 - 0.5 * std::abs(1 / tangent) : 0.5 * tangent;
        EXPECT_NEAR(shaded.channel("R").pixels[i], 0.5 * red, 1e-5) << i;
        EXPECT_NEAR(shaded.channel("G").pixels[i], 0, 1e-6);
    }
    cube.height = 5;
    for (io::Channel& c : cube.channels) c.pixels.resize(5);
    io::writeExr(path("cube.exr"), cube);
    expectRefused(command("cube.toml"), 3, "six square faces");
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

// A shelf in the left half of a cube's lowest face shades the left half of a floor; a cube of another shape is named.
TEST_F(Shade, ACubeShadowMapFromTheSceneFile) {
    std::vector<float> positions, up;
    for (int i = 0; i < width * height; ++i) {
        positions.insert(positions.end(), {4.0f * float(i % width) - 22, 2.0f * float(i / width), 0});
        up.insert(up.end(), {0, 0, 1});
    }
    io::Image g;
    g.width = width;
    g.height = height;
    g.addInterleaved(normalNames, up);
    g.addInterleaved(std::vector<std::string>{"P.X", "P.Y", "P.Z"}, positions);
    io::writeExr(path("floor.exr"), g);
    constexpr int size = 32;
    io::Image map;
    map.width = size;
    map.height = 6 * size;
    std::vector<float> depth(size_t(6 * size * size), 1.0f);
    for (int i = 0; i < size * size; ++i)  // of -z, u is -x
        if (i % size >= size / 2) depth[size_t(5 * size * size + i)] = 0.2f;
    map.addInterleaved(std::vector<std::string>{"Z"}, depth);
    io::writeExr(path("cube.exr"), map);

    scene_.channels = {};
    scene_.channels[PEL_SLOT_NORMAL_SHADING] = {"N.X", "N.Y", "N.Z"};
    scene_.channels[PEL_SLOT_POSITION] = {"P.X", "P.Y", "P.Z"};
    io::SceneLight& l = scene_.lights[0];
    l.light.type = PEL_LIGHT_POINT;
    l.light.position[2] = 50;
    l.light.worldToShadow[11] = -50;
    l.light.shadowProjection = PEL_SHADOW_CUBE_RADIAL;
    l.light.shadowDepthRange = 100;
    l.light.shadowFilterTexels = 24;
    for (float& c : l.light.color) c = 2500;
    scene_.materials[0].material.shadowFilterWidth = 4;
    l.shadowMapFile = path("cube.exr");
    io::writeScene(path("s.toml"), scene_);
    auto arguments = command("s.toml", "floor.exr");
    arguments.insert(arguments.end(), {"--json", "--stats"});
    const Result result = run(arguments);
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_NE(result.out.find("shadow_cube"), std::string::npos) << result.out;
    const auto out = io::readImage(path("o.exr")).interleaved(std::vector<std::string>{"R"});
    for (int i = 0; i < width * height; ++i) {
        const float x = positions[size_t(3 * i)];
        if (x < -4) {
            EXPECT_LT(out[size_t(i)], 0.01f) << x;
        } else if (x > 4) {
            EXPECT_GT(out[size_t(i)], 0.2f) << x;
        }
    }
    map.height = size;
    map.channels[0].pixels.resize(size * size);
    io::writeExr(path("cube.exr"), map);
    const Result refused = run(arguments);
    EXPECT_EQ(refused.exitCode, 3);
    EXPECT_NE(refused.err.find("32 x 192"), std::string::npos) << refused.err;
}

TEST_F(Shade, ProgramsAreBuiltAheadForTheDriversCache) {
    io::Image wide;
    wide.width = 24;
    wide.height = 8;
    const size_t pixels = wide.pixelCount();
    wide.addInterleaved(normalNames, std::vector<float>(pixels * 3, 0.577f));
    wide.addInterleaved(albedoNames, std::vector<float>(pixels * 3, 0.5f));
    wide.addInterleaved(std::vector<std::string>{"View.Id.X"}, std::vector<float>(pixels, 1.0f));
    io::writeExr(path("w.exr"), wide);
    std::filesystem::create_directories(path("cache"));
    const std::string cache = "POCL_CACHE_DIR=" + path("cache");
    const auto compiled = [&] {  // kernels, where the device is PoCL's
        size_t count = 0;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path("cache")))
            count += entry.path().extension() == ".so";
        return count;
    };
    const Result built = run({"prefill", path("s.toml"), "--json"}, cache);
    ASSERT_EQ(built.exitCode, 0) << built.err;
    expectReport(built.json());
    EXPECT_GE(built.json().at("programs").get<int>(), 1);
    const size_t before = compiled();
    ASSERT_EQ(run(command("s.toml", "w.exr"), cache).exitCode, 0);
    EXPECT_EQ(compiled(), before) << "shading compiled nothing more";
    if (contains(built.json().at("device").get<std::string>(), "pthread")) {
        EXPECT_GT(before, 0u) << "PoCL keeps kernels there";
    }
    expectRefused({"prefill", path("none.toml")}, 3, "none.toml");
}
