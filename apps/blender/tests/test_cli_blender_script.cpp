// apps/blender/render_gbuffer.py in the installed Blender, then `pellucid shade` on what it wrote,
// unchanged. A scene with what a .blend file may hold (apps/blender/tests/blender_scene.py) must give
// Blender's own Lambert picture wherever its light arrives.
#include "blender.h"
#include "cli/cli_run.h"
#include "io/scene/scene_file.h"

using namespace pellucid;
namespace fs = std::filesystem;

namespace {

class BlenderScript : public CommandTest {
  protected:
    void SetUp() override {
        CommandTest::SetUp();
        if (!blender::installed()) GTEST_SKIP() << "blender is not installed";
    }

    // Runs render_gbuffer.py after the script `scene`, if one is named; said.txt has Blender's output.
    int render(const std::string& before, const std::string& arguments, const std::string& scene = "") const {
        const std::string folder = PELLUCID_SOURCE_DIR "/apps/blender/";
        return run("PELLUCID_COMMAND='" PELLUCID_COMMAND "' " + before + " '" + blender::command() +
                   "' --factory-startup -b -t 2" +
                   (scene.empty() ? "" : " --python " + folder + "tests/" + scene) + " --python " + folder +
                   "render_gbuffer.py -- " + arguments + " >" + path("said.txt") + " 2>&1 </dev/null");
    }
    // Without a .blend file.
    int render(const std::string& arguments) const { return render("", arguments); }
    // The same, which must succeed.
    void rendered(const std::string& before, const std::string& arguments,
                  const std::string& scene = "") const {
        ASSERT_EQ(render(before, arguments, scene), 0) << said();
    }
    static int run(const std::string& line) {
        const int status = std::system(line.c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    std::string said() const { return read(path("said.txt")); }

    std::vector<float> shade(const std::string& gbuffer, const std::string& scene) const {
        done("shade '" + gbuffer + "' --scene '" + scene + "' -o @out.exr");
        return rgb(io::readImage(path("out.exr")));
    }
    static std::vector<float> rgb(const io::Image& image, const std::string& pass = "",
                                  const std::string& letters = "RGB") {
        std::vector<std::string> names;
        for (const char letter : letters) names.push_back(pass + letter);
        return image.interleaved(names);
    }
};

// z of a point in a shadow map and z of the map there, nearest texel.
struct Depths {
    double point, map;
};
Depths look(const PelLight& light, const io::Image& map, const float* p) {
    double row[4];
    for (int i = 0; i < 4; ++i) {
        const float* m = light.worldToShadow + 4 * i;
        row[i] = double(m[0]) * p[0] + double(m[1]) * p[1] + double(m[2]) * p[2] + m[3];
    }
    const auto texel = [&](double t, int size) { return std::clamp(int(t * size), 0, size - 1); };
    const int x = texel(row[0] / row[3], map.width), y = texel(row[1] / row[3], map.height);
    return {row[2] / row[3], map.channel("R").pixels[size_t(y) * size_t(map.width) + size_t(x)]};
}

}  // namespace

TEST_F(BlenderScript, ABlendFileGivesBlendersLambertPicture) {
    for (const std::string light : {"SUN", "SPOT"}) {
        const std::string folder = path(light);
        rendered("PELLUCID_SCENE='" + path("scene.blend") + " " + light + "'",
                 "-o '" + folder + "' --shadow-size 512", "blender_scene.py");
        io::SceneFile scene = io::readScene(folder + "/scene.toml");
        ASSERT_EQ(scene.lights.size(), 1u);
        ASSERT_EQ(scene.materials.size(), 2u);
        EXPECT_FLOAT_EQ(scene.options.millimetresPerUnit, 10) << "a unit is a centimetre there";
        EXPECT_FLOAT_EQ(scene.materials[0].material.deepScatterNormalOffset, 0.02f);
        EXPECT_FLOAT_EQ(scene.materials[0].material.deepScatterRadius, 0.5f) << "a custom property counts";
        // The world: radiance 0.5 + 0.5 (0.6 x + 0.8 z) in red; irradiance / pi keeps 2/3 of the first order.
        const double y0 = std::sqrt(4 * M_PI), y1 = std::sqrt(4 * M_PI / 3);
        const double expected[4] = {0.5 * y0, 0, 0.8 / 3 * y1, 0.6 / 3 * y1};
        for (int i = 0; i < 9; ++i) {
            EXPECT_NEAR(scene.ambient.sh[i][0], i < 4 ? expected[i] : 0, tolerance::blenderSky) << i;
            EXPECT_EQ(scene.ambient.sh[i][1], 0);
        }
        // Blender's picture contains no light from the world.
        scene.ambient = pelAmbientDefaults();
        // Nor soft shadows.
        EXPECT_EQ(scene.lights[0].light.shadowFilterTexels, 48u);
        scene.lights[0].light.shadowFilterTexels = 0;
        io::writeScene(path("lambert.toml"), scene);
        const std::vector<float> out = shade(folder + "/gbuffer.exr", path("lambert.toml"));
        ASSERT_FALSE(out.empty());

        const io::Image g = io::readImage(folder + "/gbuffer.exr");
        EXPECT_EQ(g.width, 160);
        EXPECT_EQ(g.height, 120);
        const std::vector<float> blender = rgb(g, "Combined.");
        const std::vector<float> n = rgb(g, "NShading.");
        const std::vector<float> p = rgb(g, "Position.", "XYZ");
        const std::vector<float> id = blender::pass(g, "Material Index", "IndexMA"),
                                 depth = g.channel("Depth.Z").pixels,
                                 object = blender::pass(g, "Object Index", "IndexOB"),
                                 curvature = g.channel("Curvature.X").pixels;
        const io::Image map = io::readImage(scene.lights[0].shadowMapFile);
        const PelLight& lamp = scene.lights[0].light;
        EXPECT_NEAR(lamp.color[1], 0.8 * (light == "SUN" ? 2 / M_PI : 300 / (4 * M_PI * M_PI)), 1e-4);
        std::set<float> ids(id.begin(), id.end());
        EXPECT_EQ(ids, (std::set<float>{0, 7, 9})) << light;
        double worst[2] = {}, square[2] = {};  // [1]: spots dimmed by the cosine
        size_t lit = 0, shadowed = 0, wrong = 0;
        std::vector<float> ball;
        for (size_t i = 0; i < id.size(); ++i) {
            if (id[i] == 0) {
                ASSERT_EQ(out[3 * i], 0) << light << ", pixel " << i;
                if (object[i] == 0) {
                    EXPECT_EQ(depth[i], 1e10f);
                }
                continue;
            }
            const double radius = std::hypot(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
            if (std::abs(radius - 1) < 0.01) ball.push_back(curvature[i]);
            const bool arrives = blender[3 * i] > 1e-4f, faces = out[3 * i] > 0.05f;
            // At grazing light Cycles darkens bumped surfaces more than the cosine: the ring only shows its
            // albedo is.
            if (arrives && id[i] == 7) {
                ++lit;
                double cosine = 1;  // of the angle to a spot's axis, by which Blender 3 dims it
                if (light == "SPOT") {
                    double along = 0, distance = 0;
                    for (size_t c = 0; c < 3; ++c) {
                        const double d = p[3 * i + c] - lamp.position[c];
                        along += d * lamp.spotDirection[c];
                        distance += d * d;
                    }
                    cosine = along / std::sqrt(distance);
                }
                for (size_t c = 0; c < 3; ++c)
                    for (const bool dimmed : {false, true}) {
                        const double ours = (dimmed ? cosine : 1) * out[3 * i + c];
                        const double e = std::abs(ours - blender[3 * i + c]);
                        worst[dimmed] = std::max(worst[dimmed], e);
                        square[dimmed] += e * e;
                    }
            }
            if (!faces) continue;
            const Depths z = look(lamp, map, &p[3 * i]);
            // In shadow the map must hold a nearer surface; in the light the point itself.
            if (!arrives) ++shadowed;
            wrong += arrives ? z.point > z.map + 0.03 : z.point < z.map + 1e-3;
        }
        const bool dimmed = square[1] < square[0];
        const double rms = std::sqrt(square[dimmed] / double(3 * lit));
        std::printf("%s: RMSE %.2g, largest %.2g, %zu pixels; %zu in shadow, %zu against the map\n",
                    light.c_str(), rms, worst[dimmed], lit, shadowed, wrong);
        EXPECT_GT(lit, 2000u);
        EXPECT_LT(rms, tolerance::blenderScriptLambert) << light;
        EXPECT_GT(shadowed, 10u);
        EXPECT_LT(wrong, lit / 50) << "edges of texels only";
        // A sphere of radius 1 unit.
        ASSERT_GT(ball.size(), 1000u);
        std::nth_element(ball.begin(), ball.begin() + ptrdiff_t(ball.size() / 2), ball.end());
        EXPECT_NEAR(ball[ball.size() / 2], 1, tolerance::blenderCurvature);
    }
}

// Blender takes one point of the light for each pixel: single pixels differ, sums do not.
TEST_F(BlenderScript, AnAreaLightIsARectangle) {
    rendered("PELLUCID_SCENE='" + path("scene.blend") + " AREA'", "-o '" + path("out") + "'",
             "blender_scene.py");
    EXPECT_TRUE(contains(said(), "shines to all sides")) << said();
    io::SceneFile scene = io::readScene(path("out/scene.toml"));
    ASSERT_EQ(scene.lights.size(), 1u);
    const PelLight& l = scene.lights[0].light;
    EXPECT_EQ(l.type, PEL_LIGHT_RECTANGLE);
    EXPECT_NEAR(std::hypot(l.halfWidth[0], l.halfWidth[1], l.halfWidth[2]), 0.75f, 1e-5f);
    EXPECT_NEAR(std::hypot(l.halfHeight[0], l.halfHeight[1], l.halfHeight[2]), 0.5f, 1e-5f);
    scene.ambient = pelAmbientDefaults();
    for (io::SceneMaterial& m : scene.materials) m.material.scattering = PEL_SCATTERING_NONE;
    io::writeScene(path("lambert.toml"), scene);
    const std::vector<float> out = shade(path("out/gbuffer.exr"), path("lambert.toml"));
    const io::Image g = io::readImage(path("out/gbuffer.exr"));
    const std::vector<float> blender = rgb(g, "Combined."),
                             id = blender::pass(g, "Material Index", "IndexMA");
    double ours = 0, theirs = 0, both = 0, squares = 0;
    for (size_t i = 0; i < id.size(); ++i)
        if (id[i] == 7) {
            ours += out[3 * i], theirs += blender[3 * i];
            both += double(out[3 * i]) * blender[3 * i], squares += double(out[3 * i]) * out[3 * i];
        }
    std::printf("sum over Blender's %.3f, projection %.3f\n", ours / theirs, both / squares);
    EXPECT_GT(theirs, 100);
    EXPECT_NEAR(ours / theirs, 1, 0.02);
    EXPECT_NEAR(both / squares, 1, 0.02);
}

TEST_F(BlenderScript, AMeshFileScatters) {
    // A ball of radius 1 with y up, its north pole cut off so that axes can be told apart.
    constexpr int rings = 24, segments = 48;
    std::string vertices, faces;
    for (int r = 0; r <= rings; ++r)
        for (int s = 0; s < segments; ++s) {
            const double a = M_PI * (r + 3) / (rings + 3), b = 2 * M_PI * s / segments;
            vertices +=
                io::concat(std::sin(a) * std::cos(b), " ", std::cos(a), " ", std::sin(a) * std::sin(b), "\n");
            const int i = r * segments + s, j = r * segments + (s + 1) % segments;
            if (r < rings) faces += io::concat("4 ", i, " ", j, " ", j + segments, " ", i + segments, "\n");
        }
    const std::string mesh = write("ball.off", io::concat("OFF\n", (rings + 1) * segments, " ",
                                                          rings * segments, " 0\n", vertices, faces));
    rendered("", "'" + mesh + "' -o '" + path("out") +
                     "' --size 96x64 --up y --height 19.4 --half --shadow-size 256");
    const io::Image g = io::readImage(path("out/gbuffer.exr"));
    ASSERT_EQ(g.width, 96);
    const std::vector<float> p = rgb(g, "Position.", "XYZ");
    const std::vector<float> id = blender::pass(g, "Material Index", "IndexMA");
    const std::vector<float>& albedo = g.channel("Albedo.R").pixels;
    float low = 1e9f, high = -1e9f;
    size_t covered = 0;
    for (size_t i = 0; i < id.size(); ++i)
        if (id[i] == 1) {
            ++covered;
            EXPECT_NEAR(albedo[i], 0.72, 1e-3);
            low = std::min(low, p[3 * i + 2]);
            high = std::max(high, p[3 * i + 2]);
        }
    EXPECT_GT(covered, 1000u);
    // Skin by the tables that follow from its profile, none of an older format.
    const io::SceneFile scene = io::readScene(path("out/scene.toml"));
    EXPECT_TRUE(contains(read(path("out/scene.toml")), "\nversion = 2\n"));
    EXPECT_TRUE(scene.luts.empty());
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].profile, "skin");
    EXPECT_EQ(scene.materials[0].material.scattering, PEL_SCATTERING_PREINTEGRATED);
    EXPECT_EQ(scene.materials[0].material.shadowFilterWidth, 0) << "follows from the profile";
    // cos(20 degrees) of 10 mm, the height of which is 19.4 mm, up along z; within a pixel.
    EXPECT_NEAR(high, 9.4, 0.5);
    EXPECT_NEAR(low, -10, 0.5);
    const nlohmann::json stats =
        reportOf("shade @out/gbuffer.exr --scene @out/scene.toml -o @out/p.exr --stats").at("stats");
    const nlohmann::json features = stats.at("features");
    for (const char* feature : {"direct_scatter", "deep_scatter", "thickness_taps", "specular"})
        EXPECT_NE(std::find(features.begin(), features.end(), feature), features.end()) << feature;
    EXPECT_EQ(stats.at("pixels_invalid"), 0);
    const std::vector<float> out = rgb(io::readImage(path("out/p.exr")));
    // Past the terminator, to the right in the back, there is red light but no blue light.
    float red = 0;
    for (size_t i = 0; i < id.size(); ++i)
        if (out[3 * i + 2] < 0.2f * out[3 * i]) red = std::max(red, out[3 * i]);
    EXPECT_GT(red, 0.01f);
}

// A y-up OBJ added to a .blend file of odd names, whose camera sees none of it.
TEST_F(BlenderScript, OddThings) {
    std::string obj;  // a box of 1 x 6 x 2
    for (int i = 0; i < 8; ++i) {
        obj += i & 1 ? "v 1 " : "v 0 ";
        obj += i & 2 ? "6 " : "0 ";
        obj += i & 4 ? "2\n" : "0\n";
    }
    obj += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    const std::string mesh = write("box ü.1.obj", obj), folder = path("out \"ü\" 1.2");
    rendered("PELLUCID_SCENE='" + path("scene.blend") + "'",
             "'" + mesh + "' -o '" + folder + "' --up y --no-curvature --shadow-size 64", "blender_names.py");
    for (const char* warning : {"the camera sees none of the 2 objects", "its Alpha is left out",
                                "files are missing, which are pink: Bild", "curves: hair of Haar"})
        EXPECT_TRUE(contains(said(), warning)) << warning << "\n" << said();
    const io::SceneFile scene = io::readScene(folder + "/scene.toml");
    EXPECT_LT(scene.camera.position[2], -1e4) << "of parallel rays that go up";
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_TRUE(scene.lights[2].shadowMapFile.empty());
    ASSERT_EQ(scene.materials.size(), 2u);
    EXPECT_NE(scene.lights[0].shadowMapFile, scene.lights[1].shadowMapFile);
    shade(folder + "/gbuffer.exr", folder + "/scene.toml");
    // The light that is tilted less looks down: from the box's top, 6 up, to the text, 1 below the ground.
    const float* m = scene.lights[0].light.worldToShadow;
    const float depths = m[10] * scene.lights[0].light.shadowDepthRange;
    EXPECT_NEAR(depths, -std::cos(0.2), 1e-4);
    const io::Image map = io::readImage(scene.lights[0].shadowMapFile);
    const auto& depth = map.channel("R").pixels;
    EXPECT_LT(*std::min_element(depth.begin(), depth.end()), 0.1f) << "the box's top is near the light";
    EXPECT_GT(scene.lights[0].light.shadowDepthRange, 7 * std::cos(0.2));
}

TEST_F(BlenderScript, SaysWhatIsWrong) {
    EXPECT_EQ(render("nothing.off -o '" + path("out") + "'"), 3);
    EXPECT_TRUE(contains(said(), "nothing.off: there is no such file")) << said();
    EXPECT_EQ(render("'" + write("empty.obj", "") + "' -o '" + path("out") + "'"), 3);
    EXPECT_TRUE(contains(said(), "empty.obj: there are no faces in it")) << said();
    EXPECT_EQ(render("empty.obj -o '" + path("out") + "' --smooth 2000"), 2);
    EXPECT_TRUE(contains(said(), "--smooth must be from 0 to 1000")) << said();
    EXPECT_EQ(render("empty.obj -o '" + path("out") + "' --size 2x2"), 2);
    EXPECT_TRUE(contains(said(), "at least 4x4")) << said();
    EXPECT_EQ(render("-o '" + path("out") + "'"), 2);
    EXPECT_TRUE(contains(said(), "name a .blend file before --python, or a mesh after --")) << said();
    EXPECT_EQ(render("'" + write("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n") + "' -o '" +
                     path("out") + "' --pellucid /nowhere/pellucid"),
              3);
    EXPECT_TRUE(contains(said(), "--pellucid or PELLUCID_COMMAND")) << said();
    fs::create_directories(path("taken/gbuffer.exr"));
    EXPECT_EQ(render("'" + path("a.off") + "' -o '" + path("taken") + "'"), 3);
    EXPECT_TRUE(contains(said(), "render_gbuffer.py: " + path("taken/gbuffer.exr"))) << said();
}
