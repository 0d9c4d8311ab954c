// The add-on's zip in the installed Blender, without a window: a scene with skin, teeth, an eye and jade,
// and the button (blender_addon.py).
#include "blender.h"
#include "cli/cli_run.h"
#include "io/lut/profile_file.h"
#include "io/scene/scene_file.h"

using namespace pellucid;
namespace fs = std::filesystem;

TEST_F(CommandTest, TheAddOnRendersSkinTeethAnEyeAndJade) {
    if (!blender::installed()) GTEST_SKIP() << "blender is not installed";
    const std::string source = PELLUCID_SOURCE_DIR, zip = path("addon.zip"), out = path("out"),
                      home = path("home");
    fs::create_directories(out);
    fs::create_directories(home);
    ASSERT_EQ(
        std::system(("python3 '" + source + "/packaging/blender_addon' '" + zip + "' >/dev/null").c_str()),
        0);
    const std::string line =
        "BLENDER_USER_SCRIPTS='" + home + "' BLENDER_USER_CONFIG='" + home + "' BLENDER_USER_EXTENSIONS='" +
        home + "' PELLUCID_COMMAND='" PELLUCID_COMMAND "' '" + blender::command() +
        "' --factory-startup -b -t 2 --python '" + source + "/apps/blender/tests/blender_addon.py' -- '" +
        zip + "' '" + out + "' >'" + path("said.txt") + "' 2>&1 </dev/null";
    std::system(line.c_str());
    const std::string said = read(path("said.txt"));
    ASSERT_TRUE(fs::exists(out + "/report.json")) << said;
    const nlohmann::json report = nlohmann::json::parse(read(out + "/report.json"));
    EXPECT_EQ(report["result"][0], "FINISHED");
    EXPECT_EQ(report["size"], (std::vector<int>{320, 160}));  // 2 x 2 samples, made smaller
    EXPECT_EQ(report["plain_size"], (std::vector<int>{320, 160})) << "without anti-aliasing";
    ASSERT_TRUE(fs::exists(out + "/plain.png"));
    EXPECT_EQ(io::readImage(out + "/plain.png").width, 320);
    EXPECT_EQ(report["packed"], true);
    EXPECT_EQ(report["untouched"], true);
    EXPECT_EQ(report["images"], (std::vector<std::string>{"Pellucid"}))
        << "the second picture takes the place of the first, saved or not";
    EXPECT_TRUE(contains(report["unsaved"].get<std::string>(), "/nowhere/picture.png")) << report["unsaved"];
    EXPECT_GT(report["library"].size(), 10u);
    EXPECT_TRUE(report["without"].empty()) << "of another command";
    EXPECT_TRUE(contains(report["failure"].get<std::string>(), "/nowhere/pellucid")) << report["failure"];
    EXPECT_FALSE(contains(report["log"].get<std::string>(), "Fra:")) << "Blender's own lines are kept out";

    const io::SceneFile scene = io::readScene(out + "/kept/scene.toml");
    EXPECT_FLOAT_EQ(scene.options.millimetresPerUnit, 10);
    ASSERT_EQ(scene.materials.size(), 4u);  // by name: Eye.L, Face, Stone, Teeth
    ASSERT_EQ(scene.eyes.size(), 1u);
    EXPECT_EQ(scene.eyes[0].material, 1u);
    EXPECT_NEAR(scene.eyes[0].eye.gaze[1], -1, 1e-3);
    EXPECT_NEAR(scene.eyes[0].eye.scleraRadius, 9, 0.2);  // mm
    EXPECT_EQ(scene.materials[0].material.scattering, PEL_SCATTERING_NONE);
    const io::SceneMaterial &face = scene.materials[1], &stone = scene.materials[2],
                            &teeth = scene.materials[3];
    EXPECT_EQ(stone.profile, "jade");
    EXPECT_EQ(report["own"].dump(), R"([["pellucid_roughness2"],["pellucid_eye_iris_seed"]])");
    EXPECT_FLOAT_EQ(stone.material.roughness2, 0.25f);
    EXPECT_EQ(scene.eyes[0].eye.irisSeed, 7u);
    EXPECT_TRUE(teeth.profile.empty() && teeth.curvatureLut.empty()) << "weight 0 is no skin";
    EXPECT_EQ(teeth.material.scattering, PEL_SCATTERING_NONE);
    EXPECT_NEAR(teeth.material.roughness, 0.04, 1e-6);  // 0.2 squared
    EXPECT_NEAR(teeth.material.f0, 0.032, 1e-6);        // 0.08 * 0.4
    EXPECT_NEAR(face.material.roughness, 0.16, 1e-6);
    // Subsurface 0.5 of a radius of 0.4, 0.1, 0.05 centimetres is 4 pi times Burley's d.
    const Profile profile = io::findProfile(face.profile).profile,
                  expected = Profile::burleyDistance(
                      {float(2 / (4 * M_PI)), float(0.5 / (4 * M_PI)), float(0.25 / (4 * M_PI))});
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(profile.info().width[c] / expected.info().width[c], 1, 1e-4);

    // What is seen: skin is reddest, jade green, the eye has a dark pupil.
    const io::Image g = io::readImage(out + "/kept/gbuffer.exr"),
                    picture = io::readImage(out + "/kept/picture.exr");
    const std::vector<float>& ids = blender::pass(g, "Material Index", "IndexMA");
    double sum[5][4] = {};
    float darkest = 1;
    for (size_t i = 0; i < ids.size(); ++i) {
        const size_t id = size_t(ids[i] + 0.5f);
        ASSERT_LE(id, 4u);
        ++sum[id][3];
        for (size_t c = 0; c < 3; ++c) sum[id][c] += picture.channel(std::string(1, "RGB"[c])).pixels[i];
    }
    const size_t width = size_t(g.width), middle = size_t(g.height) / 2;
    for (size_t x = 0; x < width; ++x)
        if (ids[middle * width + x] == 1)
            darkest = std::min(darkest, picture.channel("G").pixels[middle * width + x]);
    for (size_t id = 1; id <= 4; ++id) EXPECT_GT(sum[id][3], 2000) << id;
    EXPECT_GT(sum[2][0], 1.3 * sum[2][2]);
    EXPECT_GT(sum[3][1], 1.2 * sum[3][0]);
    EXPECT_LT(darkest, 0.05);
    EXPECT_TRUE(fs::exists(out + "/picture.png"));
}
