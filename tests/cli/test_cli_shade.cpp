// `pellucid shade` and `pellucid warm-up`: G-buffer and scene file in, pictures out; what is wrong with
// either.
#include "cli_shade.h"
#include "tolerances.h"

using namespace pellucid;
using namespace shade_files;

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

TEST_F(Shade, APictureToLookAt) {
    std::vector<std::string> arguments = command();
    ASSERT_EQ(run(arguments).exitCode, 0);
    const io::Image radiance = io::readImage(path("o.exr"));
    for (const std::string name : {"p.png", "p.jpg", "p.bmp", "p.tga"}) {
        arguments = command();
        arguments[5] = path(name);
        arguments.insert(arguments.end(), {"--exposure", "0.5", "--tonemap", "none"});
        const Result result = run(arguments);
        ASSERT_EQ(result.exitCode, 0) << result.err;
        const io::Image picture = io::readImage(path(name));
        ASSERT_EQ(picture.width, width);
        ASSERT_EQ(picture.channels.size(), 3u);
        if (name == "p.jpg") continue;  // close to it only
        for (const char* c : {"R", "G", "B"})
            for (size_t i = 0; i < radiance.pixelCount(); ++i) {
                const double x = std::min(0.5 * radiance.channel(c).pixels[i], 1.0);
                const double srgb = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
                EXPECT_NEAR(255 * picture.channel(c).pixels[i], 255 * srgb, 0.51) << name << c << i;
            }
    }
}

TEST_F(Shade, APictureBesideTheRadianceShowsParts) {
    std::vector<std::string> arguments = command();
    arguments.insert(arguments.end(),
                     {"--picture", path("p.png"), "--show", "final,diffuse,specular", "--tonemap", "filmic"});
    const Result result = run(arguments);
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_TRUE(io::readImage(path("o.exr")).has("R"));
    const io::Image sheet = io::readImage(path("p.png"));
    EXPECT_GT(sheet.width, 3 * width);
    EXPECT_GT(sheet.height, height);
}

TEST_F(Shade, PicturesThatCannotBeAreRefused) {
    const auto refused = [&](std::vector<std::string> more, const std::string& message) {
        std::vector<std::string> arguments = command();
        arguments.insert(arguments.end(), more.begin(), more.end());
        expectRefused(arguments, 2, message);
    };
    refused({"--show", "diffuse"}, "--picture");
    refused({"--picture", path("p.exr")}, ".png");
    refused({"--picture", path("p.png"), "--tonemap", "hollywood"}, "tonemap");
    refused({"--picture", path("p.png"), "--exposure", "0"}, "exposure");
    refused({"--picture", path("p.png"), "--show", "final,nothing"}, "show");
    std::vector<std::string> arguments = command();
    arguments[5] = path("o.png");
    arguments.insert(arguments.end(), {"--picture", path("p.png")});
    expectRefused(arguments, 2, "-o is a picture already");
}

// A frame of NaN gives a warning, not a black picture without a word.
TEST_F(Shade, InvalidPixelsAreCountedAndWarnedOf) {
    const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()};
    for (const bool all : {true, false})
        for (const float value : bad) {
            io::Image damaged = gbuffer_;
            std::vector<float>& normals = damaged.channels[0].pixels;
            for (size_t i = 0; i < normals.size(); ++i)
                if (all || i % width == 3) normals[i] = value;
            io::writeExr(path("bad.exr"), damaged);
            std::vector<std::string> arguments = command("s.toml", "bad.exr");
            arguments.push_back("--strict");
            const std::string message =
                (all ? "all 50 pixels" : "5 of 50 pixels") + std::string(" of a material have NaN or Inf");
            expectRefused(arguments, 3, message);
            arguments.back() = "--json";
            const Result result = run(arguments);
            EXPECT_EQ(result.exitCode, 0) << result.err;
            EXPECT_TRUE(contains(result.err, "warning: " + message)) << result.err;
            EXPECT_EQ(result.json().at("pixels_invalid"), all ? 50 : 5);
            ASSERT_EQ(result.json().at("warnings").size(), 1u);
            std::filesystem::remove(path("o.exr"));
        }
    std::vector<std::string> arguments = command();
    arguments.insert(arguments.end(), {"--strict", "--json"});
    const Result fine = run(arguments);
    EXPECT_EQ(fine.exitCode, 0) << fine.err;
    EXPECT_EQ(fine.json().at("pixels_invalid"), 0);
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
    refused("roughness = ", "roughness = -", "must be 0 or more");
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
    // A look-up table of another kind than the scene names.
    ASSERT_EQ(run({"lut", "shadow", "-o", path("t.exr"), "--size", "8x8"}).exitCode, 0);
    scene_.luts[0].file = "t.exr";
    io::writeScene(path("lut.toml"), scene_);
    expectRefused(command("lut.toml"), 3, "kind is shadow; curvature is asked for");
    ASSERT_EQ(run({"lut", "curvature", "-o", path("t.exr"), "--size", "8x8", "--axis", "root", "--radius-min",
                   "1", "--radius-max", "100"})
                  .exitCode,
              0);
    EXPECT_EQ(run(command("lut.toml")).exitCode, 0);
    const std::string asking = read(path("lut.toml"));
    const auto expecting = [&](const std::string& keys) {
        std::string text = asking;
        text.replace(text.find("file = \"t.exr\""), 14, "file = \"t.exr\"\n" + keys);
        write("asking.toml", text);
        return command("asking.toml");
    };
    EXPECT_EQ(run(expecting("axis = \"root\"\nwidth = 8\nradius_max = 100")).exitCode, 0);
    EXPECT_EQ(run(expecting("diffusion_radius = 0\nradius_min = 0")).exitCode, 0)
        << "the profile's own, whatever it is";
    expectRefused(expecting("axis = \"linear\""), 3, "axis is root; linear is asked for");
    expectRefused(expecting("form = \"arc\""), 3, "form is sphere; arc is asked for");
    expectRefused(expecting("radius_min = 0.5"), 3, "radius_min is 1; 0.5 is asked for");
    expectRefused(expecting("diffusion_radius = 3"), 3, "diffusion_radius is 2.7; 3 is asked for");
    expectRefused({"shade", path("g.exr"), "--scene", path("s.toml"), "-o", path("no/o.exr")}, 2,
                  "no folder");
    expectRefused({"shade", path("g.exr"), "--scene", path("s.toml"), "-o", path("o.gif")}, 2, ".exr");
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
    const std::string cache = "POCL_CACHE_DIR=" + path("cache") + " PELLUCID_CACHE_DIR=" + path("binaries");
    const auto compiled = [&] {  // kernels, where the device is PoCL's
        size_t count = 0;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path("cache")))
            count += entry.path().extension() == ".so";
        return count;
    };
    const Result built = run({"warm-up", path("s.toml"), "--json"}, cache);
    ASSERT_EQ(built.exitCode, 0) << built.err;
    expectReport(built.json());
    EXPECT_GE(built.json().at("programs").get<int>(), 1);
    const size_t before = compiled();
    ASSERT_EQ(run(command("s.toml", "w.exr"), cache).exitCode, 0);
    EXPECT_EQ(compiled(), before) << "shading compiled nothing more";
    if (contains(built.json().at("device").get<std::string>(), "pthread")) {
        EXPECT_GT(before, 0u) << "PoCL keeps kernels there";
    }
    expectRefused({"warm-up", path("none.toml")}, 3, "none.toml");
}

TEST_F(Shade, AWarmUpOfALargeFrameThatScattersLeavesNothingToCompile) {
    // More vectors of pixels, and of texels of the shadow map, than the ranges for which PoCL compiles a
    // kernel by itself.
    const auto grid = [](int columns, int rows, const std::vector<std::string>& names, auto value) {
        io::Image image;
        image.width = columns, image.height = rows;
        std::vector<float> values;
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < columns; ++x)
                for (size_t c = 0; c < names.size(); ++c) values.push_back(value(x, y, c));
        image.addInterleaved(names, values);
        return image;
    };
    const std::vector<std::string> positions{"P.X", "P.Y", "P.Z"};
    io::Image frame = grid(1440, 760, positions, [](int x, int y, size_t c) {
        return c == 0 ? 0.1f * float(x - 720) : c == 1 ? 0.1f * float(380 - y) : 0.0f;
    });
    for (io::Channel& c :
         grid(1440, 760, normalNames, [](int, int, size_t c) { return c == 2 ? 1.0f : 0.0f; }).channels)
        frame.channels.push_back(std::move(c));
    for (io::Channel& c :
         grid(1440, 760, {"View.Id.X"}, [](int x, int, size_t) { return x < 300 ? 1.0f : 0.0f; }).channels)
        frame.channels.push_back(std::move(c));
    io::writeExr(path("w.exr"), frame, io::ExrCompression::Rle);
    io::writeExr(path("map.exr"),
                 grid(1200, 900, {"Z"}, [](int x, int, size_t) { return x < 400 ? 0.2f : 1.0f; }),
                 io::ExrCompression::Rle);
    scene_.channels[PEL_SLOT_POSITION] = positions;
    scene_.channels[PEL_SLOT_ALBEDO] = {};
    scene_.materials[0].profile = "skin";
    scene_.camera.position[2] = 300;
    io::SceneLight& light = scene_.lights[0];
    light.shadowMapFile = path("map.exr");
    for (int i = 0; i < 4; ++i) light.light.worldToShadow[5 * i] = i < 2 ? 0.005f : i == 2 ? -0.01f : 1.0f;
    for (int i = 0; i < 3; ++i) light.light.worldToShadow[4 * i + 3] = 0.5f;
    light.light.shadowDepthRange = 100;
    io::writeScene(path("s.toml"), scene_);
    std::filesystem::create_directories(path("cache"));
    const auto compiled = [&] {
        std::vector<std::string> kernels;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path("cache")))
            if (entry.path().extension() == ".so") kernels.push_back(entry.path());
        std::ranges::sort(kernels);
        return kernels;
    };
    const std::string cache = "PELLUCID_CACHE=auto POCL_CACHE_DIR=" + path("cache");
    const Result built = run({"warm-up", path("s.toml"), "--json"}, cache);
    ASSERT_EQ(built.exitCode, 0) << built.err;
    const std::vector<std::string> before = compiled();
    const Result shaded = run(command("s.toml", "w.exr"), cache);
    ASSERT_EQ(shaded.exitCode, 0) << shaded.err;
    EXPECT_EQ(compiled(), before);
    if (contains(built.json().at("device").get<std::string>(), "pthread")) {
        EXPECT_GT(std::ranges::count_if(before,
                                        [](const std::string& k) { return k.ends_with("light_texels.so"); }),
                  0);
    }
}
