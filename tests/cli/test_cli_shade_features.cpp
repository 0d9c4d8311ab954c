// `pellucid shade`: features of scene files other than plain light.
#include "cli_shade.h"
#include "tolerances.h"

using namespace pellucid;
using namespace shade_files;

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
    ASSERT_EQ(run({"lut", "curvature", "--profile", path("own.toml"), "--size", "64x16", "-o", path("t.exr")})
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
    // A ball of radius 4 seen from the front: the curvature measured on the screen is 0.25 everywhere.
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
    ball.addInterleaved(std::vector<std::string>{"Col.R", "Col.G", "Col.B"},
                        std::vector<float>(3 * pixels, 0.5f));
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
    thick.addInterleaved(std::vector<std::string>{"Wall.V"},
                         std::vector<float>(size_t(width * height), 3.0f));
    std::vector<float> positions;
    for (int i = 0; i < width * height; ++i)
        positions.insert(positions.end(), {float(i % width), float(i / width), 0.0f});
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
    for (const auto& file : report.at("outputs"))
        EXPECT_TRUE(std::filesystem::exists(file.get<std::string>())) << file;
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
    EXPECT_EQ(result.json().at("stats").at("features"),
              nlohmann::json({"ambient", "outputs", "ambient_cube"}));
    EXPECT_NE(result.err.find("deep_scatter_ambient of material 1 does nothing"), std::string::npos)
        << result.err;
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

// A shelf in the left half of a cube's lowest face shades the left half of a floor; a cube of another shape
// is named.
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
