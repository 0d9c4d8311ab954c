// Eyes on the command line: tables of caustics, and [[eye]] in scenes.
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>

#include "cli_shade.h"
#include "io/file_error.h"
#include "io/lut/lut_file.h"

using namespace pellucid;

namespace {

class CliEye : public shade_files::Shade {
  protected:
    // The front of a ball of 12 mm, 24 x 24 pixels, material 1; units of 10 mm.
    void SetUp() override {
        Shade::SetUp();
        constexpr int side = 24;
        gbuffer_ = {};
        gbuffer_.width = gbuffer_.height = side;
        std::vector<float> positions, normals, ids;
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i) {
                const float x = 0.05f * (2 * float(i) - side + 1), y = -0.05f * (2 * float(j) - side + 1);
                const float r2 = x * x + y * y, z = std::sqrt(std::max(1.44f - r2, 0.01f));
                for (const float c : {x, y, z})
                    positions.push_back(c), normals.push_back(c / std::sqrt(r2 + z * z));
                ids.push_back(r2 < 1.4f);
            }
        gbuffer_.addInterleaved(std::vector<std::string>{"P.X", "P.Y", "P.Z"}, positions);
        gbuffer_.addInterleaved(std::vector<std::string>{"N.X", "N.Y", "N.Z"}, normals);
        gbuffer_.addInterleaved(std::vector<std::string>{"Id.X"}, ids);
        io::writeExr(path("g.exr"), gbuffer_);
        scene_.channels[PEL_SLOT_POSITION] = {"P.X", "P.Y", "P.Z"};
        scene_.channels[PEL_SLOT_ALBEDO].clear();
        scene_.options.millimetresPerUnit = 10;
        scene_.camera.position[2] = 40;
        scene_.eyes.resize(1);
        io::writeScene(path("s.toml"), scene_);
    }
    std::vector<float> shaded(const std::string& scene) {
        const Result result = run(command(scene));
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return io::readImage(path("o.exr")).interleaved(std::vector<std::string>{"R", "G", "B"});
    }
};

}  // namespace

TEST_F(CliEye, TablesAreWrittenAndReadBack) {
    const Result made = run({"lut", "eye", "-o", path("e.exr"), "--size", "32x16x8", "--chamber-depth", "3.4",
                             "--iris-radius", "5.5", "--json"});
    ASSERT_EQ(made.exitCode, 0) << made.err;
    EXPECT_EQ(made.json()["texels"], 32 * 16 * 8);
    const Lut lut = io::readLut(Device(""), path("e.exr"));
    EXPECT_EQ(lut.info().kind, PEL_LUT_EYE);
    EXPECT_EQ(lut.info().eye.depth, 8u);
    EXPECT_EQ(lut.info().eye.height, 16u);
    EXPECT_EQ(lut.info().eye.chamberDepth, 3.4f);
    EXPECT_EQ(lut.info().eye.irisRadius, 5.5f);
    EXPECT_EQ(std::string(lut.info().profile), "none");
    PelEyeLutDesc desc = pelEyeLutDescDefaults();
    desc.width = 32, desc.height = 16, desc.depth = 8, desc.chamberDepth = 3.4f, desc.irisRadius = 5.5f;
    EXPECT_EQ(lut.read<float>(PEL_LUT_FLOAT), Lut(Device(""), desc).read<float>(PEL_LUT_FLOAT));
    ASSERT_EQ(
        run({"lut", "eye", "-o", path("h.exr"), "--size", "8x8x4", "--encoding", "half", "--profile", "skin"})
            .exitCode,
        0);
    EXPECT_EQ(std::string(io::readLut(Device(""), path("h.exr")).info().profile), "skin");
    EXPECT_EQ(run({"lut", "eye", "-o", path("e.ktx2"), "--size", "8x8x4"}).exitCode, 0);
    expectRefused({"lut", "eye", "-o", path("x.exr"), "--size", "64x64"}, 2, "64x64x32");
    expectRefused({"lut", "eye", "-o", path("x.exr"), "--limbus-radius", "12"}, 2, "limbusRadius");
}

TEST_F(CliEye, SceneMakesAnEye) {
    const std::vector<float> eye = shaded("s.toml");
    io::SceneFile plain = scene_;
    plain.eyes.clear();
    io::writeScene(path("plain.toml"), plain);
    const std::vector<float> ball = shaded("plain.toml");
    size_t changed = 0;
    for (size_t i = 0; i < eye.size(); ++i) changed += eye[i] != ball[i];
    EXPECT_GT(changed, eye.size() / 10);
    // With the table from a file, and a texture as bright as no texture.
    ASSERT_EQ(run({"lut", "eye", "-o", path("e.exr")}).exitCode, 0);
    io::SceneFile same = scene_;
    same.eyes[0].caustics = "e.exr";
    io::writeScene(path("same.toml"), same);
    EXPECT_EQ(shaded("same.toml"), eye);
    const Result counted =
        run({"shade", path("g.exr"), "--scene", path("s.toml"), "-o", path("o.exr"), "--stats", "--json"});
    EXPECT_GT(counted.json()["stats"]["pixels_iris"], 0);
}

TEST_F(CliEye, ScenesComeBackAsTheyWere) {
    io::SceneEye& e = scene_.eyes[0];
    e.eye.center[1] = 0.3f, e.eye.gaze[0] = 0.1f, e.eye.pupilRadius = 1.25f, e.eye.irisSeed = 7,
    e.eye.irisColor[2] = 0.5f;
    e.eye.irisColor[0] = e.eye.irisColor[1] = 0.25f;
    e.irisTexture = path("iris.exr"), e.irisProfile = "skin", e.caustics = path("c.exr");
    scene_.reflectionCube = path("around.exr");
    scene_.channels[PEL_SLOT_WETNESS] = {"Wet.V"};
    io::writeScene(path("t.toml"), scene_);
    const io::SceneFile back = io::readScene(path("t.toml"));
    ASSERT_EQ(back.eyes.size(), 1u);
    const PelEye &is = back.eyes[0].eye, &was = e.eye;
    EXPECT_EQ(std::memcmp(&is, &was, sizeof is), 0);
    EXPECT_EQ(back.eyes[0].irisTexture, e.irisTexture);
    EXPECT_EQ(back.eyes[0].irisProfile, e.irisProfile);
    EXPECT_EQ(back.eyes[0].caustics, e.caustics);
    EXPECT_EQ(back.reflectionCube, scene_.reflectionCube);
    EXPECT_EQ(back.channels[PEL_SLOT_WETNESS], scene_.channels[PEL_SLOT_WETNESS]);
}

TEST_F(CliEye, WrongScenesAreRefused) {
    const auto refused = [&](const std::string& name, const std::string& message,
                             const std::function<void(io::SceneFile&)>& change) {
        io::SceneFile scene = scene_;
        change(scene);
        write(name, io::sceneText(scene));
        expectRefused(command(name), 3, message);
    };
    refused("a.toml", "[[material]]", [](io::SceneFile& s) { s.eyes[0].material = 9; });
    refused("b.toml", "PelEye.pupilRadius", [](io::SceneFile& s) { s.eyes[0].eye.pupilRadius = 6; });
    refused("c.toml", "PelEye.gaze", [](io::SceneFile& s) { s.eyes[0].eye.gaze[2] = 0; });
    refused("d.toml", "position", [](io::SceneFile& s) { s.channels[PEL_SLOT_POSITION].clear(); });
    refused("e.toml", "another [[eye]]", [](io::SceneFile& s) { s.eyes.push_back(s.eyes[0]); });
    write("f.toml", read(path("s.toml")) + "\n[[eye]]\nmaterial = 2\n");
    expectRefused(command("f.toml"), 3, "center");
}
